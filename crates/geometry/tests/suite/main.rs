//! What is true of every tessellation, and what is known of special ones.
#![allow(clippy::unwrap_used, clippy::panic)]

mod arithmetic;
mod boundaries;
mod diagonals;
mod field_of_view;
mod gaussian_patches;
mod large;
mod moving;
mod overlap;
mod polygon;
mod refused;
mod region;
mod samples;
mod sides;
mod tessellation;
