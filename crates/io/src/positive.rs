//! Settings that must be above zero.

use crate::error::SettingFault;

/// A setting that must be finite and above zero.
pub(crate) fn positive(key: &'static str, value: f64) -> Result<(), SettingFault> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(SettingFault::NotPositive { key, value }) }
}
