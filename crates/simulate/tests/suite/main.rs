//! The simulator against limits known on paper, other ways to the same numbers, and itself.
#![allow(clippy::unwrap_used)]

mod driving;
mod integration;
mod measures;
mod phases;
mod sensitivity;
mod turnover;
mod uniform;
mod walls;
