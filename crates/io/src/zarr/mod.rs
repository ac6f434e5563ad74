//! Stores of chunks, Zarr 2 and 3: images of OME-Zarr and tracks of GEFF.

mod blosc;
mod compression;
mod geff;
mod layout;
mod metadata;
mod ome;
mod store;

pub(crate) use geff::{is_geff, read_geff};
pub(crate) use ome::read_ome;

/// Why a store cannot be read, in words.
type Fault = String;
