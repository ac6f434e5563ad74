//! Claims of the product as a whole: what is put into a simulation comes out of a fit, and the model does what theory says.

#![allow(clippy::unwrap_used, reason = "a test may fail anywhere")]

mod channel;
mod detections;
mod differing;
mod doubts;
mod mean_field;
mod measured;
mod moduli;
mod recovery;
mod spectrum;
mod strips;
