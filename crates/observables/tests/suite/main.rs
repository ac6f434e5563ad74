//! Measurements against what is known of what is measured.
#![allow(clippy::unwrap_used, clippy::panic)]

mod avalanches;
mod block_average;
mod exchanges;
mod fluctuations;
mod measurements;
mod nematic;
mod rate_matrix;
mod structure_factor;
mod vorticity;
