//! The physics of the model: derivatives, symmetries, and limits known on paper.

mod effects;
mod gradients;
mod honeycomb;
mod jacobian;
mod lanes;
mod physics;
mod samples;
mod threads;
