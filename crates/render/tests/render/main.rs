//! Pictures of scenes whose light is known by formula.

mod checkpoints;
mod costs;
mod determinism;
mod energy;
mod eye;
mod layers;
mod limits;
mod refraction;
mod shadows;
mod size;
mod stage;
