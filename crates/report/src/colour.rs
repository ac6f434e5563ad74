//! Colours that survive colour blindness and print, and the mapping from numbers to them.

use crate::numbers::quantile;

/// Blue of the house palette (Okabe–Ito).
pub const BLUE: &str = "#0072b2";
/// Vermillion of the house palette.
pub const VERMILLION: &str = "#d55e00";
/// Green of the house palette.
pub const GREEN: &str = "#009e73";
/// Mid grey.
pub const GREY: &str = "#8a8a8a";
/// Near black of lines and arrows.
pub const INK: &str = "#222222";

/// Stops of the map "viridis" of S. van der Walt and N. Smith (public domain), evenly spaced.
const VIRIDIS: [[u8; 3]; 8] = [
    [68, 1, 84],
    [70, 50, 127],
    [54, 92, 141],
    [39, 127, 143],
    [31, 162, 136],
    [74, 194, 110],
    [160, 219, 57],
    [254, 232, 37],
];

/// Stops of the diverging map "vik" of F. Crameri (public domain data), evenly spaced.
const VIK: [[u8; 3]; 10] = [
    [0x00, 0x12, 0x61],
    [0x03, 0x3e, 0x7d],
    [0x1e, 0x6f, 0x9d],
    [0x71, 0xa8, 0xc4],
    [0xc9, 0xdd, 0xe7],
    [0xea, 0xce, 0xbd],
    [0xd3, 0x97, 0x74],
    [0xbe, 0x65, 0x33],
    [0x8b, 0x27, 0x06],
    [0x59, 0x00, 0x08],
];

/// Which family of colours a quantity gets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Palette {
    /// Dark to light (viridis), for magnitudes.
    Sequential,
    /// Blue through pale to brown (vik), for signed departures from `centre`.
    Diverging {
        /// The value that gets the pale middle colour.
        centre: f64,
    },
}

/// Values to colours, with limits that a few outliers do not stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourScale {
    palette: Palette,
    limits: [f64; 2],
    extent: [f64; 2],
}

impl ColourScale {
    /// Number of distinct colours drawn.
    pub const LEVELS: usize = 64;

    /// A scale from the 2nd to the 98th percentile of the finite `values` (symmetric about the
    /// centre for a diverging palette); `None` if no value is finite.
    #[must_use]
    pub fn robust(values: impl IntoIterator<Item = f64>, palette: Palette) -> Option<Self> {
        let finite: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
        let low = quantile(finite.iter().copied(), 0.02)?;
        let high = quantile(finite.iter().copied(), 0.98)?;
        let extent = [
            finite.iter().copied().fold(f64::INFINITY, f64::min),
            finite.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        let [low, high] = match palette {
            Palette::Sequential => [low, high],
            Palette::Diverging { centre } => {
                let reach = (high - centre).abs().max((low - centre).abs());
                [centre - reach, centre + reach]
            }
        };
        let width = (high - low).max(1e-6 * low.abs().max(high.abs())).max(1e-12);
        let middle = low + (high - low) / 2.0;
        let limits = [middle - width / 2.0, middle + width / 2.0];
        Some(Self { palette, limits, extent })
    }

    /// The same scale with limits set by hand, for figures that are to be compared.
    #[must_use]
    pub fn with_limits(self, limits: [f64; 2]) -> Self {
        Self { limits, ..self }
    }

    /// The values at the two ends of the colour bar.
    #[must_use]
    pub fn limits(&self) -> [f64; 2] {
        self.limits
    }

    /// Whether values lie below the low limit and above the high limit.
    #[must_use]
    pub fn extended(&self) -> [bool; 2] {
        let slack = (self.limits[1] - self.limits[0]) * 1e-9;
        [self.extent[0] < self.limits[0] - slack, self.extent[1] > self.limits[1] + slack]
    }

    /// The colour class of a value, `0..LEVELS`; `None` where it is not finite.
    #[must_use]
    pub fn level(&self, value: f64) -> Option<usize> {
        let [low, high] = self.limits;
        let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
        share.is_finite().then(|| ((share * Self::LEVELS as f64) as usize).min(Self::LEVELS - 1))
    }

    /// The colour of a class, as `#rrggbb`.
    #[must_use]
    pub fn colour(&self, level: usize) -> String {
        let share = level.min(Self::LEVELS - 1) as f64 / (Self::LEVELS - 1) as f64;
        let [red, green, blue] = match self.palette {
            Palette::Sequential => between(&VIRIDIS, share),
            Palette::Diverging { .. } => diverging(share),
        };
        format!("#{red:02x}{green:02x}{blue:02x}")
    }
}

/// The diverging map at `share` in 0..1.
#[must_use]
pub fn diverging(share: f64) -> [u8; 3] {
    between(&VIK, share)
}

/// The colour at `share` in 0..1 of the way along stops.
fn between(stops: &[[u8; 3]], share: f64) -> [u8; 3] {
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let below = (place.floor() as usize).min(stops.len() - 2);
    let weight = place - below as f64;
    let mix = |channel: usize| {
        let [low, high] = [below, below + 1].map(|stop| f64::from(stops[stop][channel]));
        (low + (high - low) * weight).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_stretch_the_limits() {
        let values = (0..1000).map(f64::from).chain([1e9, f64::NAN]);
        let scale = ColourScale::robust(values, Palette::Sequential).unwrap();
        assert!(scale.limits()[1] < 1000.0);
        assert_eq!(scale.extended(), [true, true]);
        assert_eq!(scale.level(1e9), Some(ColourScale::LEVELS - 1));
        assert_eq!(scale.level(f64::NAN), None);
    }

    #[test]
    fn diverging_scales_are_symmetric() {
        let scale = ColourScale::robust([-1.0, 0.0, 3.0], Palette::Diverging { centre: 0.0 }).unwrap();
        assert!((scale.limits()[0] + scale.limits()[1]).abs() < 1e-12);
    }

    #[test]
    fn a_constant_still_has_a_colour() {
        let scale = ColourScale::robust([2.0, 2.0], Palette::Sequential).unwrap();
        assert!(scale.level(2.0).is_some());
        assert!(ColourScale::robust([], Palette::Sequential).is_none());
    }
}
