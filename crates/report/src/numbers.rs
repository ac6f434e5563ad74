//! Numbers as a reader wants to see them: digits, round lengths, ticks, quantiles.

/// What stands in for a number that is not known (not finite).
pub const NO_VALUE: &str = "–";

/// `value` with `digits` significant digits and a true minus sign; powers of ten for the very
/// large and the very small; [`NO_VALUE`] where it is not finite.
///
/// ```
/// use voronudge_report::numbers::significant;
/// assert_eq!(significant(-0.012345, 3), "−0.0123");
/// assert_eq!(significant(1.5e-7, 2), "1.5×10⁻⁷");
/// assert_eq!(significant(f64::NAN, 2), "–");
/// ```
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NO_VALUE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    let scientific = format!("{:.*e}", digits - 1, value);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = i32::try_from(digits).unwrap_or(3) - 1 - exponent;
        fixed(value, decimals.max(0))
    } else {
        let power = superscript(exponent);
        format!("{}×10{power}", mantissa.replace('-', "−"))
    }
}

/// `value` and the ends of its interval, with the decimals that the interval deserves: two digits of its half width.
///
/// An end is never rounded to the estimate or past it, nor to zero: one that lies within five units of the last digit of
/// the estimate gets two digits of its own distance, and a small one a digit other than zero.
///
/// ```
/// use voronudge_report::numbers::with_interval;
/// assert_eq!(with_interval(3.40213, [3.281, 3.522]), ["3.40", "3.28", "3.52"]);
/// assert_eq!(with_interval(1.0, [0.558, 41.6]), ["1.00", "0.56", "42"]);
/// assert_eq!(with_interval(0.31, [0.0004, 0.62]), ["0.31", "0.0004", "0.62"]);
/// ```
#[must_use]
pub fn with_interval(value: f64, interval: [f64; 2]) -> [String; 3] {
    let (value, [low, high]) = printed(value, interval.map(Some));
    [value, low.unwrap_or_default(), high.unwrap_or_default()]
}

/// `value` and its interval as text; an end that is `None` is not bounded.
///
/// ```
/// use voronudge_report::numbers::interval_text;
/// assert_eq!(interval_text(3.402, [Some(3.281), Some(3.522)]), ["3.40", "3.28 to 3.52"]);
/// assert_eq!(interval_text(1.0, [None, Some(3.1)]), ["1.00", "below 3.1"]);
/// assert_eq!(interval_text(1.0, [Some(0.2), None]), ["1.00", "above 0.20"]);
/// assert_eq!(interval_text(1.0, [None, None]), ["1.00", "not bounded"]);
/// ```
#[must_use]
pub fn interval_text(value: f64, interval: [Option<f64>; 2]) -> [String; 2] {
    let (value, [low, high]) = printed(value, interval);
    let text = match (low, high) {
        (Some(low), Some(high)) => format!("{low} to {high}"),
        (None, Some(high)) => format!("below {high}"),
        (Some(low), None) => format!("above {low}"),
        (None, None) => "not bounded".to_owned(),
    };
    [value, text]
}

/// `value` with at most six significant digits and no trailing zeros, for numbers that were given
/// rather than measured.
///
/// ```
/// use voronudge_report::numbers::as_given;
/// assert_eq!(as_given(0.1), "0.1");
/// assert_eq!(as_given(20.0), "20");
/// ```
#[must_use]
pub fn as_given(value: f64) -> String {
    let text = significant(value, 6);
    match text.split_once('×') {
        Some((mantissa, power)) => format!("{}×{power}", without_trailing_zeros(mantissa)),
        None => without_trailing_zeros(&text).to_owned(),
    }
}

/// The largest of 1, 2, 5 times a power of ten that is not above `bound`; `None` unless `bound` is
/// positive and finite.
#[must_use]
pub fn nice_below(bound: f64) -> Option<f64> {
    if !bound.is_finite() || bound <= 0.0 {
        return None;
    }
    let power = 10f64.powi(exponent_of(bound));
    let lead = bound / power * (1.0 + 1e-9);
    let factor = match lead {
        lead if lead >= 5.0 => 5.0,
        lead if lead >= 2.0 => 2.0,
        _ => 1.0,
    };
    Some(factor * power)
}

/// At most about `count` round tick positions inside `[low, high]`, a step of 1, 2 or 5 times a
/// power of ten apart.
#[must_use]
pub fn ticks(range: [f64; 2], count: usize) -> Vec<f64> {
    let [low, high] = range;
    let span = high - low;
    let slots = count.max(1) as f64;
    if !span.is_finite() || span <= 0.0 {
        return Vec::new();
    }
    let rough = span / slots;
    let Some(mut step) = nice_below(rough) else {
        return Vec::new();
    };
    while span / step > slots {
        let Some(next) = nice_below(step * 2.6) else {
            break;
        };
        step = next;
    }
    let first = (low / step - 1e-9).ceil();
    let last = (high / step + 1e-9).floor();
    let number = (last - first).max(-1.0) as usize + 1;
    (0..number.min(100)).map(|index| (first + index as f64) * step).collect()
}

/// Labels for equally spaced `positions`, all with the same decimals.
#[must_use]
pub fn tick_labels(positions: &[f64]) -> Vec<String> {
    let step = match positions {
        [first, second, ..] => (second - first).abs(),
        [only] => only.abs(),
        [] => return Vec::new(),
    };
    if plain_power(positions) != 0 {
        return positions.iter().map(|&position| significant(position, 2)).collect();
    }
    let decimals = if step > 0.0 { (-exponent_of(step)).max(0) } else { 0 };
    positions
        .iter()
        .map(|&position| fixed(if position.abs() < step * 1e-9 { 0.0 } else { position }, decimals))
        .collect()
}

/// The power of ten in which labels of positions are short.
fn plain_power(positions: &[f64]) -> i32 {
    let largest = positions.iter().fold(0.0f64, |most, position| most.max(position.abs()));
    if largest >= 1e6 || (largest > 0.0 && largest < 1e-4) { exponent_of(largest) } else { 0 }
}

/// Ticks of a linear axis. Their labels are in units of a power of ten where plain ones would be long; the label of the axis says so.
///
/// ```
/// use voronudge_report::numbers::Ticks;
/// let ticks = Ticks::new([-3e-13, 2e-13], 6);
/// assert_eq!(ticks.labels(), ["−3", "−2", "−1", "0", "1", "2"]);
/// assert_eq!(ticks.axis_label("residual (µm/min)"), "residual (10⁻¹³ µm/min)");
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Ticks {
    positions: Vec<f64>,
    labels: Vec<String>,
    power: i32,
}

impl Ticks {
    /// At most about `count` [`ticks`] inside a range.
    #[must_use]
    pub fn new(range: [f64; 2], count: usize) -> Self {
        let positions = ticks(range, count);
        let power = plain_power(&positions);
        let scaled: Vec<f64> = positions.iter().map(|position| position / 10f64.powi(power)).collect();
        Self { positions, labels: tick_labels(&scaled), power }
    }

    /// Where they are.
    #[must_use]
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// What they say.
    #[must_use]
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// Each with its label.
    #[must_use]
    pub fn labelled(&self) -> Vec<(f64, String)> {
        self.positions.iter().copied().zip(self.labels.iter().cloned()).collect()
    }

    /// The label of an axis with these ticks, its unit in brackets at the end if it has one.
    #[must_use]
    pub fn axis_label(&self, label: &str) -> String {
        let power = format!("10{}", superscript(self.power));
        match (self.power, label.ends_with(')').then(|| label.rsplit_once('(')).flatten()) {
            (0, _) => label.to_owned(),
            (_, Some((name, unit))) => format!("{name}({power} {unit}"),
            (_, None) => format!("{label} ({power})"),
        }
    }
}

/// The `fraction` quantile of the finite `values` (linear between order statistics); `None` if
/// there are none.
#[must_use]
pub fn quantile(values: impl IntoIterator<Item = f64>, fraction: f64) -> Option<f64> {
    let mut finite: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    let last = finite.len().checked_sub(1)?;
    let place = fraction.clamp(0.0, 1.0) * last as f64;
    let below = finite[(place.floor() as usize).min(last)];
    let above = finite[(place.ceil() as usize).min(last)];
    Some(below + (above - below) * place.fract())
}

/// An integer exponent as superscript characters.
#[must_use]
pub fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            _ => '⁹',
        })
        .collect()
}

fn without_trailing_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// Ends within so many units of the last digit of the estimate get digits of their own.
const NEAR: f64 = 5.0;

/// Numbers and distances this much smaller than an interval are zero to rounding.
const NOTHING: f64 = 1e-9;

/// A value and the ends of its interval, for [`with_interval`] and [`interval_text`].
fn printed(value: f64, interval: [Option<f64>; 2]) -> (String, [Option<String>; 2]) {
    let ends: Vec<f64> = interval.into_iter().flatten().collect();
    let reach = match ends[..] {
        [low, high] => (high - low).abs() / 2.0,
        [end] => (value - end).abs(),
        _ => f64::NAN,
    };
    let largest = ends.iter().fold(value.abs(), |most, end| most.max(end.abs()));
    if !(reach > 0.0 && reach.is_finite() && largest.is_finite()) {
        let digits = if ends.is_empty() { 3 } else { 4 };
        let plain = |number: f64| significant(number, digits);
        return (plain(value), interval.map(|end| end.map(plain)));
    }
    // The power of ten of the value, unless that is far below the ends.
    let sized = if value.abs() > 0.05 * largest { value.abs() } else { largest };
    let power = if (1e-4..1e6).contains(&largest) { 0 } else { exponent_of(sized) };
    let scale = 10f64.powi(power);
    let with_digits = |digits: i32, size: f64| (digits - 1 - exponent_of(size / scale)).clamp(0, 12);
    let unit = |decimals: i32| scale * 0.1f64.powi(decimals);
    let common = with_digits(2, reach);
    let beside_value = |end: f64| {
        let distance = (value - end).abs();
        let is_near = distance > NOTHING * reach && distance < NEAR * unit(common);
        if is_near { with_digits(2, distance) } else { common }
    };
    let of_end = |end: f64| {
        let decimals = beside_value(end);
        let would_vanish = end.abs() > NOTHING * reach && end.abs() < 0.5 * unit(decimals);
        if would_vanish { with_digits(1, end.abs()) } else { decimals }
    };
    // One end says little about the digits of the value.
    let of_value = if ends.len() == 1 && value != 0.0 { with_digits(3, value.abs()) } else { 0 };
    let of_value = ends.iter().map(|&end| beside_value(end)).fold(of_value, i32::max);
    let text = |number: f64, decimals: i32| match power {
        0 => fixed(number, decimals),
        power => format!("{}×10{}", fixed(number / scale, decimals), superscript(power)),
    };
    (text(value, of_value), interval.map(|end| end.map(|end| text(end, of_end(end)))))
}

/// ⌊log₁₀ |x|⌋ of a positive finite number, safe at the powers of ten.
fn exponent_of(value: f64) -> i32 {
    let exponent = value.abs().log10().floor() as i32;
    if 10f64.powi(exponent + 1) <= value.abs() * (1.0 + 1e-12) { exponent + 1 } else { exponent }
}

fn fixed(value: f64, decimals: i32) -> String {
    let text = format!("{value:.*}", usize::try_from(decimals).unwrap_or(0));
    let is_zero = text.chars().all(|letter| matches!(letter, '-' | '0' | '.'));
    match text.strip_prefix('-') {
        Some(magnitude) if is_zero => magnitude.to_owned(),
        Some(magnitude) => format!("−{magnitude}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_are_one_two_five() {
        assert_eq!(nice_below(0.99), Some(0.5));
        assert_eq!(nice_below(1000.0), Some(1000.0));
        assert_eq!(nice_below(0.00031), Some(0.0002));
        assert_eq!(nice_below(f64::NAN), None);
        assert_eq!(nice_below(0.0), None);
    }

    #[test]
    fn ticks_stay_inside_and_are_few() {
        for range in [[0.0, 1.0], [-3.2, 7.9], [1e-9, 3e-9], [-0.001, 0.0], [99.0, 100.0]] {
            let positions = ticks(range, 5);
            assert!((2..=6).contains(&positions.len()), "{range:?}: {positions:?}");
            let slack = (range[1] - range[0]) * 1e-6;
            assert!(positions.iter().all(|&x| x >= range[0] - slack && x <= range[1] + slack));
        }
        assert!(ticks([1.0, 1.0], 5).is_empty());
        assert!(ticks([f64::NAN, 1.0], 5).is_empty());
    }

    #[test]
    fn tick_labels_share_their_decimals() {
        assert_eq!(tick_labels(&[-0.5, 0.0, 0.5]), ["−0.5", "0.0", "0.5"]);
        assert_eq!(tick_labels(&[0.0, 20.0]), ["0", "20"]);
    }

    #[test]
    fn quantiles_skip_what_is_not_finite() {
        assert_eq!(quantile([f64::NAN, 1.0, 3.0, f64::INFINITY], 0.5), Some(2.0));
        assert_eq!(quantile([f64::NAN], 0.5), None);
    }

    #[test]
    fn intervals_decide_the_digits() {
        assert_eq!(with_interval(0.5, [f64::NAN, 1.0]), ["0.5000", "–", "1.000"]);
        assert_eq!(with_interval(12.0, [-8.0, 32.0]), ["12", "−8", "32"]);
        assert_eq!(with_interval(8.596e-6, [2.883e-7, 1.690e-5]), ["8.6×10⁻⁶", "0.3×10⁻⁶", "16.9×10⁻⁶"]);
        assert_eq!(interval_text(0.051, [Some(-3.1), None]), ["0.0510", "above −3.1"]);
    }

    /// The text of a number with a power of ten, as a number.
    fn read(text: &str) -> f64 {
        let text = text.replace('−', "-");
        let Some((mantissa, power)) = text.split_once("×10") else { return text.parse().unwrap() };
        let power: String = power
            .chars()
            .map(|c| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|d| d == c).map_or('-', |d| char::from(b'0' + d as u8)))
            .collect();
        format!("{mantissa}e{power}").parse().unwrap()
    }

    #[test]
    fn ends_stay_on_their_side_of_the_estimate_and_of_zero() {
        let sizes = [1e-9, 3.3e-4, 0.0449, 0.442, 0.97, 1.0, 2.51, 40.6, 987.0];
        for value in [-0.9962_f64, 0.0, 0.004_99, 1.0, 9.996, 12_345.678, 3.4e-7, 2.2e8] {
            for (below, above) in sizes.iter().flat_map(|a| sizes.iter().map(move |b| (a, b))) {
                let (low, high) =
                    (value - below * value.abs().max(0.1), value + above * value.abs().max(0.1));
                let texts = with_interval(value, [low, high]);
                let [v, l, h] = [&texts[0], &texts[1], &texts[2]].map(|text| read(text));
                let told = (high - low) * 1e-8;
                assert!(value - low < told || l < v, "{low} {value} {high}: {texts:?}");
                assert!(high - value < told || v < h, "{low} {value} {high}: {texts:?}");
                for (exact, shown) in [(low, l), (high, h)] {
                    let same_side = exact.abs() < told || exact.signum() == shown.signum() && shown != 0.0;
                    assert!(same_side, "{exact} as {shown}: {texts:?}");
                }
            }
        }
    }
}
