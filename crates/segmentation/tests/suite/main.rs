//! Images whose cells are known, and what is found in them.
#![allow(clippy::unwrap_used, clippy::panic)]

mod agreement;
mod extrema;
mod linking;
mod mask;
mod outlines;
mod raster;
