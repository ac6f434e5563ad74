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

/// `value` and the ends of its interval, all with the decimals that the interval deserves (two
/// digits of its half width).
///
/// ```
/// use voronudge_report::numbers::with_interval;
/// assert_eq!(with_interval(3.40213, [3.281, 3.522]), ["3.40", "3.28", "3.52"]);
/// ```
#[must_use]
pub fn with_interval(value: f64, interval: [f64; 2]) -> [String; 3] {
    let half = (interval[1] - interval[0]).abs() / 2.0;
    let largest = interval.map(f64::abs).into_iter().fold(value.abs(), f64::max);
    if !half.is_finite() || half == 0.0 || !(1e-4..1e6).contains(&largest) {
        return [value, interval[0], interval[1]].map(|number| significant(number, 4));
    }
    let decimals = (1 - exponent_of(half)).clamp(0, 8);
    [value, interval[0], interval[1]]
        .map(|number| if number.is_finite() { fixed(number, decimals) } else { NO_VALUE.to_owned() })
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
    let one_sided = |end: f64| {
        let distance = (value - end).abs();
        if distance > 0.0 {
            with_interval(end, [end - 2.0 * distance, end])
        } else {
            with_interval(end, [end; 2])
        }
    };
    let (value_text, text) = match interval {
        [Some(low), Some(high)] => {
            let [value, low, high] = with_interval(value, [low, high]);
            (value, format!("{low} to {high}"))
        }
        [None, Some(high)] => (significant(value, 3), format!("below {}", one_sided(high)[0])),
        [Some(low), None] => (significant(value, 3), format!("above {}", one_sided(low)[0])),
        [None, None] => (significant(value, 3), "not bounded".to_owned()),
    };
    [value_text, text]
}

/// A label with its unit (as typed) in brackets, if it has one.
///
/// ```
/// use voronudge_report::numbers::label_with_unit;
/// assert_eq!(label_with_unit("P_0", "um"), "P_0 (µm)");
/// assert_eq!(label_with_unit("α", ""), "α");
/// ```
#[must_use]
pub fn label_with_unit(label: &str, unit: &str) -> String {
    if unit.is_empty() { label.to_owned() } else { format!("{label} ({})", unit_text(unit)) }
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

/// A unit as it is printed: `um` becomes µm, `^2` becomes ², `*` becomes a dot, and a mere
/// denominator gets negative powers.
///
/// ```
/// use voronudge_report::numbers::unit_text;
/// assert_eq!(unit_text("um/min"), "µm/min");
/// assert_eq!(unit_text("1/(um^2*h)"), "µm⁻² h⁻¹");
/// ```
#[must_use]
pub fn unit_text(unit: &str) -> String {
    if let Some(powers) = unit.strip_prefix("1/").and_then(negative_powers) {
        return powers;
    }
    let mut text = String::with_capacity(unit.len());
    let mut word = String::new();
    for letter in unit.chars() {
        if letter.is_alphabetic() {
            word.push(letter);
        } else {
            text.push_str(unit_word(&word));
            word.clear();
            text.push(letter);
        }
    }
    text.push_str(unit_word(&word));
    for (typed, printed) in [("^-1", "⁻¹"), ("^-2", "⁻²"), ("^2", "²"), ("^3", "³"), ("^4", "⁴"), ("*", "·")]
    {
        text = text.replace(typed, printed);
    }
    text
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
    let largest = positions.iter().fold(0.0f64, |most, position| most.max(position.abs()));
    if largest >= 1e6 || (largest > 0.0 && largest < 1e-4) {
        return positions.iter().map(|&position| significant(position, 2)).collect();
    }
    let decimals = if step > 0.0 { (-exponent_of(step)).max(0) } else { 0 };
    positions
        .iter()
        .map(|&position| fixed(if position.abs() < step * 1e-9 { 0.0 } else { position }, decimals))
        .collect()
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

/// The factors of a denominator such as `(um^2*h)` with negative powers.
fn negative_powers(denominator: &str) -> Option<String> {
    let inner = match denominator.strip_prefix('(') {
        Some(rest) => rest.strip_suffix(')')?,
        None => denominator,
    };
    let factors = inner.split('*').map(|factor| {
        let (word, power) = factor.split_once('^').unwrap_or((factor, "1"));
        let power: i32 = power.trim().parse().ok().filter(|&power| power > 0)?;
        let word = word.trim();
        let is_word = !word.is_empty() && word.chars().all(char::is_alphabetic);
        is_word.then(|| format!("{}{}", unit_word(word), superscript(-power)))
    });
    Some(factors.collect::<Option<Vec<_>>>()?.join(" "))
}

fn unit_word(word: &str) -> &str {
    match word {
        "um" | "micron" | "microns" => "µm",
        other => other,
    }
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
    }
}
