//! Pictures of scenes whose light is known by formula.

mod determinism;
mod energy;
mod limits;
mod refraction;
mod shadows;
mod stage;
