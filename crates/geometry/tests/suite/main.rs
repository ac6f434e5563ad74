//! What is true of every tessellation, and what is known of special ones.

mod boundaries;
mod field_of_view;
mod large;
mod moving;
mod overlap;
mod polygon;
mod refused;
mod samples;
mod tessellation;
