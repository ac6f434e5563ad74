//! What is true of every tessellation, and what is known of special ones.

mod boundaries;
mod large;
mod moving;
mod overlap;
mod polygon;
mod refused;
mod samples;
mod tessellation;
