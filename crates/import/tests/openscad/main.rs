//! What OpenSCAD's dumps mean, statement by statement.

mod colors;
mod extrusions;
mod messages;
mod polyhedra;
mod reading;
mod statements;
