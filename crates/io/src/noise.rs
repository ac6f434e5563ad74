//! The size of measurement noise, and its text.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, SettingFault};

/// The size of measurement noise: one standard deviation per component.
///
/// As text: a number is [`Noise::Absolute`], a number with `%` is [`Noise::Relative`]; `estimated` says that it is not known.
///
/// ```
/// use voronudge_io::Noise;
/// assert_eq!("0.3".parse::<Noise>()?, Noise::Absolute(0.3));
/// assert_eq!("2 %".parse::<Noise>()?, Noise::Relative(0.02));
/// assert_eq!("estimated".parse::<Noise>()?, Noise::Estimated);
/// # Ok::<(), voronudge_io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Noise {
    /// In the units of the data.
    Absolute(f64),
    /// As a fraction (0.02 for 2 %) of the typical cell spacing l0 for positions, of the root
    /// mean square velocity for velocities.
    Relative(f64),
    /// Not known. Errors that single cells have count by their ratios.
    Estimated,
}

impl Noise {
    /// The word for noise that is not known.
    const ESTIMATED: &str = "estimated";

    /// What can be given.
    pub(crate) const EXPECTED: &str =
        "a number in data units, a percentage such as \"2 %\", or \"estimated\"";

    /// Reads a number, or a number with a per cent sign; `key` names the setting in errors.
    pub(crate) fn parse(key: &'static str, text: &str) -> Result<Self, SettingFault> {
        let trimmed = text.trim();
        let noise = match trimmed.strip_suffix('%') {
            None if trimmed == Self::ESTIMATED => Some(Self::Estimated),
            Some(number) => hundredth(number.trim()).map(Self::Relative),
            None => trimmed.parse().ok().map(Self::Absolute),
        };
        let noise = noise.ok_or_else(|| SettingFault::Unknown {
            key,
            found: text.to_owned(),
            expected: Self::EXPECTED,
        })?;
        noise.check(key)?;
        Ok(noise)
    }

    pub(crate) fn check(self, key: &'static str) -> Result<(), SettingFault> {
        let (Self::Absolute(value) | Self::Relative(value)) = self else { return Ok(()) };
        if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(SettingFault::Negative { key, value }) }
    }
}

impl FromStr for Noise {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        Self::parse("noise", text).map_err(Error::Setting)
    }
}

impl fmt::Display for Noise {
    /// The text that parses back to exactly the same value.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Absolute(value) => write!(f, "{value}"),
            Self::Relative(fraction) => write!(f, "{} %", percent(fraction)),
            Self::Estimated => f.write_str(Self::ESTIMATED),
        }
    }
}

/// A fraction's decimal digits as a percentage, moved rather than multiplied, which would round.
fn percent(fraction: f64) -> String {
    let exact = shift_exponent(&format!("{fraction:e}"), 2).unwrap_or_default();
    let plain = exact.parse::<f64>().map(|value| value.to_string());
    match plain {
        Ok(plain) if hundredth(&plain) == Some(fraction) => plain,
        _ => exact,
    }
}

/// A decimal number divided by 100 by moving its exponent, so that "2" gives exactly 0.02.
fn hundredth(text: &str) -> Option<f64> {
    shift_exponent(text, -2)?.parse().ok()
}

fn shift_exponent(text: &str, by: i32) -> Option<String> {
    let (digits, exponent) = match text.split_once(['e', 'E']) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    Some(format!("{digits}e{}", exponent.checked_add(by)?))
}
