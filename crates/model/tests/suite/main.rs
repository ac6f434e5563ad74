//! The physics of the model: derivatives, symmetries, and limits known on paper.
#![allow(clippy::unwrap_used, clippy::panic)]

mod cell_parameters;
mod check;
mod effects;
mod gradients;
mod honeycomb;
mod internal_drag;
mod jacobian;
mod lanes;
mod physics;
mod samples;
mod threads;
mod transition;
