//! A page of sections, each of text, a table and figures.

use schemars::JsonSchema;
use serde::Serialize;

use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::infer_report::RunRecord;

const TEMPLATE: Template =
    Template { name: "sections.html", source: include_str!("../../templates/sections.html") };

/// A section; empty parts are left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct Section {
    /// Heading.
    pub heading: String,
    /// Paragraphs above the table and the figures; `_x` sets a subscript.
    pub text: Vec<String>,
    /// Lines of a table: name and content.
    pub rows: Vec<[String; 2]>,
    /// A table with a header.
    pub table: Option<Table>,
    /// Figures, two side by side where there is room.
    pub figures: Vec<Figure>,
}

/// A table whose first column names the rows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct Table {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Rows of cells.
    pub rows: Vec<Vec<String>>,
}

/// A page whose sections are its caller's.
#[derive(Debug, Clone, Copy)]
pub struct SectionPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// Key numbers.
    pub cards: &'a [Card],
    /// Terms and their meaning, under "How to read this page".
    pub guide: &'a [[&'a str; 2]],
    /// The sections.
    pub sections: &'a [Section],
    /// The run.
    pub run: &'a RunRecord,
}

#[derive(Serialize, JsonSchema)]
struct Context<'a> {
    head: PageHead<'a>,
    guide: &'a [[&'a str; 2]],
    sections: &'a [Section],
}

impl SectionPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let head = PageHead::sound([self.title, self.headline], self.summary, self.cards.to_vec(), self.run);
        render(TEMPLATE, &Context { head, guide: self.guide, sections: self.sections })
    }
}
