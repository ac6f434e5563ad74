//! From the residual to an effect that the model lacks.

mod result;

pub use result::*;

use crate::{Error, Observation};

/// Fits the base model to snapshots, finds what it leaves unexplained, and adds the effects that explain it.
///
/// # Errors
/// [`Error`] if the base model cannot be fitted or the caller stops.
pub fn discover(
    _frames: &[Observation],
    _search: &Search,
    _observe: Observer<'_>,
) -> Result<Discovery, Error> {
    Err(Error::NothingToFit)
}
