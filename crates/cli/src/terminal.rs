//! What is said on stdout and stderr. Nobody may be listening: then the work goes on.

use std::io::{self, ErrorKind, Write};

/// Digits of a number from which on it is written with an exponent.
const LONG: usize = 24;

/// Prints a result on stdout. A reader that has gone away is no fault.
///
/// # Errors
/// Those of writing, such as that of a full disk.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        printed => printed,
    }
}

/// Says something beside the result on stderr, if anybody listens.
pub(crate) fn note(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", legible(text));
}

/// A text as it is, but without control characters, which names of files and of units can hold, and with numbers of many digits
/// shortened.
pub(crate) fn legible(text: &str) -> String {
    let mut legible = String::with_capacity(text.len());
    let mut digits = String::new();
    for letter in text.chars() {
        if letter.is_ascii_digit() || letter == '.' {
            digits.push(letter);
            continue;
        }
        shorten(&mut digits, &mut legible);
        match letter.is_control() && letter != '\n' {
            true => legible.extend(letter.escape_default()),
            false => legible.push(letter),
        }
    }
    shorten(&mut digits, &mut legible);
    legible
}

/// Moves what may be a number to the end of a text.
fn shorten(digits: &mut String, text: &mut String) {
    let end = digits.trim_end_matches('.').len();
    let dots = digits.split_off(end);
    match digits.parse::<f64>() {
        Ok(number) if digits.len() > LONG => *text += &format!("{number:.4e}"),
        _ => *text += digits,
    }
    *text += &dots;
    digits.clear();
}

#[cfg(test)]
mod tests {
    use super::legible;

    #[test]
    fn a_terminal_gets_no_control_characters() {
        assert_eq!(legible("a\u{1b}[2Jb\r\nc\u{9b}"), "a\\u{1b}[2Jb\\r\nc\\u{9b}");
        assert_eq!(legible("ψ_6 of 10 µm"), "ψ_6 of 10 µm");
    }

    #[test]
    fn numbers_of_many_digits_are_short() {
        assert_eq!(legible(&format!("--K_P is {}", 1e150)), "--K_P is 1.0000e150");
        assert_eq!(legible("seed 18446744073709551615"), "seed 18446744073709551615");
        assert_eq!(legible(&format!("in one step of {}.", 1e-200)), "in one step of 1.0000e-200.");
    }
}
