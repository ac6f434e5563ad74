//! What is true of every tessellation, and what is known of special ones.
#![allow(clippy::unwrap_used, clippy::panic)]

mod agreement;
mod arithmetic;
mod boundaries;
mod diagonals;
mod extrema;
mod field_of_view;
mod gaussian_patches;
mod large;
mod linking;
mod mask;
mod moving;
mod outlines;
mod overlap;
mod polygon;
mod raster;
mod refused;
mod region;
mod samples;
mod sides;
mod tessellation;
