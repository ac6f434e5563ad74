//! Numbers as pages and programs print them.

/// A number, and how finely it is printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Printed {
    pub value: f64,
    /// One in the last digit.
    pub unit: f64,
}

/// Digits of exponents in print.
const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
/// A value on the brink of two roundings agrees with both, to this share of a unit.
const BRINK: f64 = 1e-6;

impl Printed {
    /// Whether a value is this number once it is rounded to as many digits.
    pub fn is_rounded(self, value: f64) -> bool {
        (value - self.value).abs() <= self.unit * (0.5 + BRINK)
    }

    /// The value to as many digits, and two more.
    pub fn alike(self, value: f64) -> String {
        let exponent = self.unit.log10().round() as i32 - 2;
        if (-8..=0).contains(&exponent) {
            format!("{value:.*}", exponent.unsigned_abs() as usize)
        } else if value.is_finite() {
            format!("{value:.4e}")
        } else {
            value.to_string()
        }
    }
}

/// A text that is a number and nothing else: `0.345`, `−.36`, `4e-25`, `2.97·10⁻²⁹`, `10⁻⁴`, `12 739`.
pub fn parse(text: &str) -> Option<Printed> {
    let letters: Vec<char> = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    let (found, end) = scan(&letters, 0)?;
    (end == letters.len()).then_some(found)
}

/// The numbers in a line, those that are part of a name (`l_0`, `P2`) left out.
pub fn numbers(line: &str) -> Vec<f64> {
    let letters: Vec<char> = line.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < letters.len() {
        let before = at.checked_sub(1).map(|k| letters[k]);
        let in_name = before.is_some_and(|letter| letter.is_alphanumeric() || letter == '_');
        // A sign after a digit or a bracket is no part of the number.
        let after_digit = before.is_some_and(|letter| letter.is_ascii_digit() || letter == ')');
        let begins = if is_sign(letters[at]) { !after_digit } else { !in_name };
        match scan(&letters, at).filter(|_| begins) {
            Some((number, end)) => {
                found.push(number.value);
                at = end;
            }
            None => at += 1,
        }
    }
    found
}

fn is_sign(letter: char) -> bool {
    matches!(letter, '-' | '−' | '+')
}

/// The number that begins at a place, and where it ends.
fn scan(letters: &[char], begin: usize) -> Option<(Printed, usize)> {
    let at = |k: usize| letters.get(k).copied().unwrap_or(' ');
    let mut end = begin + usize::from(is_sign(at(begin)));
    let sign = if matches!(at(begin), '-' | '−') { -1.0 } else { 1.0 };
    let mut digits = String::new();
    let mut after_point = None;
    loop {
        match at(end) {
            digit if digit.is_ascii_digit() => digits.push(digit),
            '.' if after_point.is_none() && at(end + 1).is_ascii_digit() => after_point = Some(digits.len()),
            _ => break,
        }
        end += 1;
    }
    let decimals = after_point.map_or(0, |whole| digits.len() - whole) as i32;
    if digits.is_empty() {
        return None;
    }
    let mut exponent = -decimals;
    if matches!(at(end), 'e' | 'E')
        && let Some((power, after)) = whole(letters, end + 1)
    {
        (exponent, end) = (exponent + power, after);
    } else if matches!(at(end), '×' | '·') && (at(end + 1), at(end + 2)) == ('1', '0') {
        let (power, after) = raised(letters, end + 3)?;
        (exponent, end) = (exponent + power, after);
    } else if digits == "10"
        && after_point.is_none()
        && let Some((power, after)) = raised(letters, end)
    {
        (digits, exponent, end) = ("1".into(), power, after);
    }
    let scaled = |digits: &str| format!("{digits}e{exponent}").parse::<f64>().ok();
    Some((Printed { value: sign * scaled(&digits)?, unit: scaled("1")? }, end))
}

/// A whole number with its sign.
fn whole(letters: &[char], begin: usize) -> Option<(i32, usize)> {
    let signed = letters.get(begin).copied().is_some_and(is_sign);
    let first = begin + usize::from(signed);
    let count = letters.get(first..)?.iter().take_while(|letter| letter.is_ascii_digit()).count();
    let size: i32 = letters[first..first + count].iter().collect::<String>().parse().ok()?;
    let negative = signed && letters[begin] != '+';
    Some((if negative { -size } else { size }, first + count))
}

/// A whole number in raised digits.
fn raised(letters: &[char], begin: usize) -> Option<(i32, usize)> {
    let negative = letters.get(begin) == Some(&'⁻');
    let first = begin + usize::from(negative);
    let digit = |letter: &char| RAISED.chars().position(|raised| raised == *letter);
    let digits: Vec<usize> = letters.get(first..)?.iter().map_while(digit).collect();
    if digits.is_empty() {
        return None;
    }
    let size = digits.iter().fold(0, |size, digit| 10 * size + *digit as i32);
    Some((if negative { -size } else { size }, first + digits.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_they_are_printed() {
        let of = |text: &str| parse(text).map(|number| (number.value, number.unit));
        assert_eq!(of("0.345"), Some((0.345, 0.001)));
        assert_eq!(of("−.36"), Some((-0.36, 0.01)));
        assert_eq!(of("4e-25"), Some((4e-25, 1e-25)));
        assert_eq!(of("7.6742e0"), Some((7.6742, 1e-4)));
        assert_eq!(of("8.35×10⁻⁵"), Some((8.35e-5, 1e-7)));
        assert_eq!(of("2·10⁻⁴"), Some((2e-4, 1e-4)));
        assert_eq!(of("10⁻⁴"), Some((1e-4, 1e-4)));
        assert_eq!(of("12 739"), Some((12739.0, 1.0)));
        assert_eq!(of("+0.10"), Some((0.1, 0.01)));
        for no in ["", "−", "a", "3 a", "1.", "e5", "2×10"] {
            assert_eq!(of(no), None, "{no}");
        }
    }

    #[test]
    fn numbers_in_a_line_are_found_in_order() {
        assert_eq!(numbers("P_0 / l_0   4.12  3.91 to 4.39 τ⁻¹"), [4.12, 3.91, 4.39]);
        assert_eq!(numbers("λ = −2.57 + 6.99 i"), [-2.57, 6.99]);
        assert_eq!(numbers("| 1 | -0.2437 ± 0.0012, +3e2 |"), [1.0, -0.2437, 0.0012, 300.0]);
        assert_eq!(numbers("frames 4-16, P2, 1.1e-15."), [4.0, 16.0, 1.1e-15]);
    }

    #[test]
    fn a_value_agrees_if_it_is_rounded_to_what_is_printed() {
        let printed = parse("0.345").unwrap();
        assert!(printed.is_rounded(0.3454) && printed.is_rounded(0.3446) && printed.is_rounded(0.3455));
        assert!(!printed.is_rounded(0.34551) && !printed.is_rounded(0.3444) && !printed.is_rounded(f64::NAN));
        assert!(parse("8.35×10⁻⁵").unwrap().is_rounded(8.347e-5));
        assert!(!parse("8.35×10⁻⁵").unwrap().is_rounded(8.36e-5));
        assert_eq!(printed.alike(0.4), "0.40000");
        assert_eq!(parse("4e-25").unwrap().alike(5.25e-25), "5.2500e-25");
    }
}
