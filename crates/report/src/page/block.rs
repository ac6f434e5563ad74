//! What sections of a page are made of.

use serde::Serialize;

use super::player::Player;
use super::{Figure, Table, Text};
use crate::error::ReportError;
use crate::movie::CellMovie;

/// A part of a section. Classes are those of `style.css`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Block {
    /// A paragraph.
    Paragraph {
        /// How it looks; empty for most.
        class: &'static str,
        /// What it says.
        text: Text,
    },
    /// A heading within a section.
    Heading {
        /// What it says.
        text: Text,
    },
    /// Sentences, one for each point.
    List {
        /// The points.
        items: Vec<Text>,
    },
    /// Terms with their meaning, or questions with answers.
    Terms {
        /// How it looks; empty for most.
        class: &'static str,
        /// Both of each.
        entries: Vec<[Text; 2]>,
    },
    /// A table.
    Table(Table),
    /// A figure with its caption.
    Figure(Figure),
    /// Cells that move.
    Player(Player),
    /// Figures under tabs.
    Tabs {
        /// One for each tab.
        panels: Vec<Panel>,
    },
    /// What is laid out together.
    Group {
        /// How it is laid out: `figures pairs`, `beside`, `single`, …
        class: &'static str,
        /// What is in it.
        blocks: Vec<Block>,
    },
    /// What is seen after a click.
    Fold {
        /// What is seen before.
        summary: Text,
        /// What is in it.
        blocks: Vec<Block>,
    },
}

/// Figures under one tab, for example those of one frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Panel {
    label: String,
    /// How many figures stand side by side where there is room.
    class: &'static str,
    figures: Vec<Figure>,
}

impl Panel {
    /// A tab of this name; maps of many cells stand two side by side, others three.
    #[must_use]
    pub fn new(label: &str, cells: usize, figures: Vec<Figure>) -> Self {
        let class = if cells > 700 { "figures two" } else { "figures three" };
        Self { label: label.to_owned(), class, figures }
    }
}

impl Block {
    /// A paragraph of a class.
    #[must_use]
    pub fn of_class(class: &'static str, text: impl Into<Text>) -> Self {
        Self::Paragraph { class, text: text.into() }
    }

    /// A paragraph.
    #[must_use]
    pub fn paragraph(text: impl Into<Text>) -> Self {
        Self::of_class("", text)
    }

    /// A paragraph at the head of a page.
    #[must_use]
    pub fn summary(text: impl Into<Text>) -> Self {
        Self::of_class("summary", text)
    }

    /// A paragraph in small print.
    #[must_use]
    pub fn remark(text: impl Into<Text>) -> Self {
        Self::of_class("remark", text)
    }

    /// A heading within a section.
    #[must_use]
    pub fn heading(text: impl Into<Text>) -> Self {
        Self::Heading { text: text.into() }
    }

    /// Points, one below the other.
    #[must_use]
    pub fn list<T: Into<Text>>(items: impl IntoIterator<Item = T>) -> Self {
        Self::List { items: items.into_iter().map(Into::into).collect() }
    }

    /// Terms with their meaning.
    #[must_use]
    pub fn terms<T: Into<Text> + Clone>(entries: &[[T; 2]]) -> Self {
        Self::Terms {
            class: "",
            entries: entries.iter().map(|entry| entry.clone().map(Into::into)).collect(),
        }
    }

    /// Lines of names and contents.
    #[must_use]
    pub fn facts<T: Into<Text>>(rows: impl IntoIterator<Item = [T; 2]>) -> Self {
        Self::Table(Table::plain(rows))
    }

    /// A table that scrolls where it is wider than its page.
    #[must_use]
    pub fn table(table: Table) -> Self {
        Self::group("scroll", [Self::Table(table)])
    }

    /// Figures, two side by side where there is room.
    #[must_use]
    pub fn pairs(figures: impl IntoIterator<Item = Figure>) -> Self {
        Self::group("figures pairs", figures)
    }

    /// Parts that are laid out together; those that are empty are left out.
    #[must_use]
    pub fn group<B: Into<Self>>(class: &'static str, blocks: impl IntoIterator<Item = B>) -> Self {
        let blocks = blocks.into_iter().map(Into::into).filter(|block| !block.is_empty()).collect();
        Self::Group { class, blocks }
    }

    /// A movie, and what stands in its place without a script and in print.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if its numbers cannot be written.
    pub fn player(movie: &CellMovie, still: &Figure) -> Result<Self, ReportError> {
        Player::new(movie, still).map(Self::Player)
    }

    /// The figures in it.
    pub(super) fn into_figures(self) -> Vec<Figure> {
        match self {
            Self::Figure(figure) => vec![figure],
            Self::Player(player) => vec![player.into_still()],
            Self::Tabs { panels } => panels.into_iter().flat_map(|panel| panel.figures).collect(),
            Self::Group { blocks, .. } | Self::Fold { blocks, .. } => {
                blocks.into_iter().flat_map(Self::into_figures).collect()
            }
            Self::Paragraph { .. }
            | Self::Heading { .. }
            | Self::List { .. }
            | Self::Terms { .. }
            | Self::Table(_) => Vec::new(),
        }
    }

    /// Whether nothing would be seen of it.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Paragraph { text, .. } | Self::Heading { text } => text.is_empty(),
            Self::List { items } => items.is_empty(),
            Self::Terms { entries, .. } => entries.is_empty(),
            Self::Table(table) => table.is_empty(),
            Self::Tabs { panels } => panels.is_empty(),
            Self::Group { blocks, .. } | Self::Fold { blocks, .. } => blocks.is_empty(),
            Self::Figure(_) | Self::Player(_) => false,
        }
    }
}

impl From<Figure> for Block {
    fn from(figure: Figure) -> Self {
        Self::Figure(figure)
    }
}
