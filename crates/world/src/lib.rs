//! A scene made ready for rays: the accelerators, and what rays ask of them.
//!
//! [`World`] is the one door between the structures below it and everything that traces rays
//! above it. Its answers are the same bits whatever structure finds them.

mod query;

pub use query::{Counters, Departure, Hit, RayQuery, Region, SurfaceHit};
