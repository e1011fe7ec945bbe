//! What is promised of every ray, against formulas, integers and identities.
//!
//! `OCTRAY_CASES` multiplies the rays of every test here; the runs with a million rays a promise:
//!
//! ```text
//! OCTRAY_CASES=100 cargo test --release -p octray-world --test exactness
//! ```
//!
//! That octrees find to the bit what brute force finds is tested in `solids.rs`.

mod abutting;
mod cancelling;
mod cauchy;
#[allow(dead_code, reason = "the fuzzer draws more")]
#[path = "../differential/draw.rs"]
mod draw;
mod elliptic;
mod menger;
mod metamorphic;
mod place;
#[allow(dead_code, reason = "membership is the oracle of other tests")]
#[path = "../random/mod.rs"]
mod random;
mod ray_grid;
mod start;
mod subject;
mod volumes;
mod voxels;
