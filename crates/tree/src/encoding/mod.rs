//! Other ways to keep the cells of a [`crate::CellTree`].

mod lvsi;

pub use lvsi::{Found, Lvsi, LvsiStats, LvsiStore, LvsiTable, TableSize};
