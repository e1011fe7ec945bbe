//! Copies of prototypes: against the same scene with every copy written out as an object of its own,
//! against brute force, and by exact numbers.

#[path = "../answers/mod.rs"]
mod answers;
mod bad_input;
mod exact;
mod methods;
mod scenes;
mod written_out;
