//! Units as they are printed: factors with powers, one space between them, as in `µm min⁻¹`.

use crate::numbers::superscript;

/// Units of length and time as the data set states them, for axis labels, scale bars and tables.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct Units {
    /// Unit of length, for example `um`.
    pub length: String,
    /// Unit of time, for example `min`.
    pub time: String,
}

impl Units {
    /// The unit of a quantity with these powers of length and time; empty if both are zero.
    ///
    /// ```
    /// use voronudge_report::Units;
    /// let units = Units { length: "um".into(), time: "min".into() };
    /// assert_eq!(units.powers(-2, -1), "µm⁻² min⁻¹");
    /// assert_eq!(units.powers(0, 0), "");
    /// ```
    #[must_use]
    pub fn powers(&self, length: i32, time: i32) -> String {
        let factors = [(&self.length, length), (&self.time, time)];
        let printed = factors.into_iter().filter(|(_, exponent)| *exponent != 0);
        printed.map(|(unit, exponent)| raised(unit, exponent)).collect::<Vec<_>>().join(" ")
    }

    /// The unit of length, for example `µm`.
    #[must_use]
    pub fn length_text(&self) -> String {
        self.powers(1, 0)
    }

    /// The unit of time, for example `min`.
    #[must_use]
    pub fn time_text(&self) -> String {
        self.powers(0, 1)
    }

    /// The unit of velocity, for example `µm min⁻¹`.
    #[must_use]
    pub fn velocity_text(&self) -> String {
        self.powers(1, -1)
    }
}

/// A unit as it is printed, from one as it is typed: `um` becomes µm, and quotients become powers. What is no product of
/// powers stays as it is.
///
/// ```
/// use voronudge_report::units::unit_text;
/// assert_eq!(unit_text("um/min"), "µm min⁻¹");
/// assert_eq!(unit_text("1/(um^2*h)"), "µm⁻² h⁻¹");
/// assert_eq!(unit_text("µm⁻² h⁻¹"), "µm⁻² h⁻¹");
/// ```
#[must_use]
pub fn unit_text(unit: &str) -> String {
    raised(unit, 1)
}

/// A unit as it is typed, to a power.
fn raised(unit: &str, exponent: i32) -> String {
    let (above, below) = unit.split_once('/').unwrap_or((unit, ""));
    match (factors(above, exponent), factors(below, -exponent)) {
        (Some(above), Some(below)) => [above, below].concat().join(" "),
        _ => power(unit, exponent),
    }
}

/// A label with its unit (as typed) in brackets, if it has one.
///
/// ```
/// use voronudge_report::units::label_with_unit;
/// assert_eq!(label_with_unit("P_0", "um"), "P_0 (µm)");
/// assert_eq!(label_with_unit("α", ""), "α");
/// ```
#[must_use]
pub fn label_with_unit(label: &str, unit: &str) -> String {
    if unit.is_empty() { label.to_owned() } else { format!("{label} ({})", unit_text(unit)) }
}

/// The factors of a product such as `um^2*h` or `(um^2*h)`, each to a further power.
fn factors(product: &str, sign: i32) -> Option<Vec<String>> {
    let inner = match product.strip_prefix('(') {
        Some(rest) => rest.strip_suffix(')')?,
        None => product,
    };
    let typed = inner.split(['*', '·', ' ']).filter(|factor| !matches!(*factor, "" | "1"));
    let printed = typed.map(|factor| {
        let digits = factor.trim_start_matches(|letter| !is_superscript(letter));
        let (word, exponent) = match factor.split_once('^') {
            Some((word, exponent)) => (word, exponent.parse().ok()?),
            None if digits.is_empty() => (factor, 1),
            None => (factor.strip_suffix(digits)?, exponent_in(digits)?),
        };
        let is_word = word.starts_with(char::is_alphabetic) && !word.contains(['/', '(', ')', '^']);
        is_word.then(|| power(unit_word(word), sign * exponent))
    });
    printed.collect()
}

fn is_superscript(letter: char) -> bool {
    letter == '⁻' || digit_in(letter).is_some()
}

fn digit_in(letter: char) -> Option<usize> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == letter)
}

fn exponent_in(superscript: &str) -> Option<i32> {
    let (sign, digits) = match superscript.strip_prefix('⁻') {
        Some(digits) => (-1, digits),
        None => (1, superscript),
    };
    let digits = digits.chars().map(digit_in).collect::<Option<Vec<_>>>()?;
    Some(sign * digits.iter().fold(0, |number, digit| 10 * number + *digit as i32))
}

/// A unit to a power; a compound one in brackets.
fn power(unit: &str, exponent: i32) -> String {
    match (exponent, unit.contains([' ', '/'])) {
        (1, _) => unit.to_owned(),
        (_, true) => format!("({unit}){}", superscript(exponent)),
        (_, false) => format!("{unit}{}", superscript(exponent)),
    }
}

fn unit_word(word: &str) -> &str {
    match word {
        "um" | "micron" | "microns" => "µm",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_type_a_unit_is_printed_in_one() {
        for typed in ["um^2/min", "um^2*min^-1", "µm² min⁻¹", "um^2·min^-1"] {
            assert_eq!(unit_text(typed), "µm² min⁻¹", "{typed}");
        }
        assert_eq!(unit_text("ℓ₀"), "ℓ₀");
        assert_eq!(unit_text("1/τ"), "τ⁻¹");
        assert_eq!(unit_text(""), "");
    }

    #[test]
    fn what_is_no_product_of_powers_stays() {
        for typed in ["a/b/c", "per cell (mean)", "m^x", "5 min"] {
            assert_eq!(unit_text(typed), typed);
        }
        let units = Units { length: "um".into(), time: "5 min".into() };
        assert_eq!(units.powers(1, -1), "µm (5 min)⁻¹");
    }

    #[test]
    fn powers_of_quotients_are_powers() {
        let units = Units { length: "ℓ₀".into(), time: "1/K_P".into() };
        assert_eq!(units.time_text(), "K_P⁻¹");
        assert_eq!(units.velocity_text(), "ℓ₀ K_P");
        assert_eq!(units.powers(2, -2), "ℓ₀² K_P²");
    }
}
