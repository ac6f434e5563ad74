//! Small letters on images of few colours.

use font8x8::UnicodeFonts;

/// Width and height of a letter in pixels.
pub(super) const LETTER: usize = 16;
/// Pixels for each dot of a letter.
const DOT: usize = 2;

/// Calls `dot` for each pixel of a line of letters whose upper left corner is `at`.
pub(super) fn letters(at: [usize; 2], text: &str, mut dot: impl FnMut(usize, usize)) {
    for (index, letter) in plain(text).chars().enumerate() {
        let rows = font8x8::BASIC_FONTS.get(letter).or_else(|| font8x8::LATIN_FONTS.get(letter));
        let rows = rows.or_else(|| font8x8::GREEK_FONTS.get(letter)).unwrap_or_default();
        for (y, row) in rows.into_iter().enumerate() {
            for x in (0..8).filter(|x| row >> x & 1 == 1) {
                for pixel in 0..DOT * DOT {
                    dot(at[0] + index * LETTER + x * DOT + pixel % DOT, at[1] + y * DOT + pixel / DOT);
                }
            }
        }
    }
}

/// Width of a text in pixels.
pub(super) fn width(text: &str) -> usize {
    plain(text).chars().count() * LETTER
}

/// The text in letters that there are: `ℓ₀ τ⁻¹` becomes `l0 τ^-1`.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    let mut raised = false;
    for letter in text.chars() {
        let exponent = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻".chars().zip("0123456789-".chars()).find(|(from, _)| *from == letter);
        let subscript = "₀₁₂₃₄₅₆₇₈₉".chars().zip("0123456789".chars()).find(|(from, _)| *from == letter);
        if exponent.is_some() && !raised {
            plain.push('^');
        }
        raised = exponent.is_some();
        plain.push(match (exponent.or(subscript), letter) {
            (Some((_, digit)), _) => digit,
            (None, 'ℓ') => 'l',
            (None, '−' | '–') => '-',
            (None, 'µ') => 'μ',
            (None, own) => own,
        });
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_written_in_letters_that_there_are() {
        assert_eq!(plain("0.5 ℓ₀ h⁻¹"), "0.5 l0 h^-1");
        assert_eq!(plain("µm²"), "μm^2");
        for letter in "speed 0.5 l0^-2 μmτατ×=.".chars() {
            let mut dots = 0;
            letters([0, 0], &letter.to_string(), |_, _| dots += 1);
            assert!(letter == ' ' || dots > 0, "{letter}");
        }
    }
}
