//! Text of a page: escaped where it is made, with a little markup.

use std::ops::Add;

use serde::Serialize;

use super::parameter_table::symbol_of;
use super::words::effect_name;
use crate::svg::{SubscriptMarkup, escape, subscripts};

/// Text as it stands in a page. Nothing but what is made here is markup: whatever comes from data stays text.
///
/// A string becomes text by `into`; in it `_x` and `_{xy}` set subscripts. Pieces are joined by `+`.
///
/// ```
/// use voronudge_report::page::Text;
/// let text = Text::from("K_P < ") + Text::bold("2") + " " + Text::plain("file_1");
/// assert_eq!(text.as_markup(), "K<sub>P</sub> &lt; <b>2</b> file_1");
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Text(String);

impl Text {
    /// As it is, underscores too: names of files, units as they were given.
    #[must_use]
    pub fn plain(text: &str) -> Self {
        Self(escape(text))
    }

    /// A sentence of a report: symbols with subscripts, names of parameters and effects as they are printed.
    #[must_use]
    pub fn prose(text: &str) -> Self {
        let is_inner = |letter: char| letter.is_alphanumeric() || letter == '_';
        let mut markup = String::with_capacity(text.len());
        let mut word = String::new();
        for letter in text.chars().chain(std::iter::once('\0')) {
            if is_inner(letter) {
                word.push(letter);
                continue;
            }
            markup.push_str(&subscripts(&printed_word(&word), SubscriptMarkup::Html));
            word.clear();
            if letter != '\0' {
                markup.push_str(&escape(letter.encode_utf8(&mut [0; 4])));
            }
        }
        Self(markup)
    }

    /// In bold.
    #[must_use]
    pub fn bold(text: impl Into<Self>) -> Self {
        Self(format!("<b>{}</b>", text.into().0))
    }

    /// As a power.
    #[must_use]
    pub fn superscript(text: impl Into<Self>) -> Self {
        Self(format!("<sup>{}</sup>", text.into().0))
    }

    /// Marked with a class of `style.css`.
    #[must_use]
    pub fn marked(class: &'static str, text: impl Into<Self>) -> Self {
        Self(format!("<span class=\"{class}\">{}</span>", text.into().0))
    }

    /// One below the other.
    #[must_use]
    pub fn lines(lines: impl IntoIterator<Item = Self>) -> Self {
        Self(lines.into_iter().map(|line| line.0).collect::<Vec<_>>().join("<br>"))
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// As HTML.
    #[must_use]
    pub fn as_markup(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Text {
    fn from(text: &str) -> Self {
        Self(subscripts(text, SubscriptMarkup::Html))
    }
}

impl From<&String> for Text {
    fn from(text: &String) -> Self {
        text.as_str().into()
    }
}

impl From<String> for Text {
    fn from(text: String) -> Self {
        text.as_str().into()
    }
}

impl<T: Into<Text>> Add<T> for Text {
    type Output = Self;

    fn add(mut self, next: T) -> Self {
        self.0.push_str(&next.into().0);
        self
    }
}

/// A word with the symbol it stands for; an underscore behind more than one letter joins words.
fn printed_word(word: &str) -> String {
    let symbol = symbol_of(word);
    match word.split_once('_') {
        Some((head, _)) if symbol == word && head.chars().count() != 1 => effect_name(word),
        _ => symbol,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_tells_symbols_from_names_of_effects() {
        let text = "density_gradient moves K_P_alpha and P_0, not <alpha>";
        let markup = "density gradient moves K<sub>P</sub> α and P<sub>0</sub>, not &lt;α&gt;";
        assert_eq!(Text::prose(text).as_markup(), markup);
    }
}
