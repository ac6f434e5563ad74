//! A page of sections with text, a table and figures, for commands with little to tell.

use serde::Serialize;

use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::infer_report::RunRecord;

const TEMPLATE: Template =
    Template { name: "result.html", source: include_str!("../../templates/result.html") };

/// A page of sections.
#[derive(Debug, Clone)]
pub struct ResultPage<'a> {
    /// Title, for example the name of the data set.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// Key numbers.
    pub cards: Vec<Card>,
    /// Terms and what they mean.
    pub guide: &'a [[&'a str; 2]],
    /// What the page shows.
    pub sections: Vec<ResultSection>,
    /// The run.
    pub run: &'a RunRecord,
}

/// A section of a page.
#[derive(Debug, Clone, Serialize)]
pub struct ResultSection {
    /// Its heading.
    pub heading: &'static str,
    /// Paragraphs; `_x` sets a subscript.
    pub text: Vec<String>,
    /// A table, if there is one.
    pub table: Option<ResultTable>,
    /// Figures.
    pub figures: Vec<Figure>,
}

/// A table whose first column names the rows.
#[derive(Debug, Clone, Serialize)]
pub struct ResultTable {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Rows of cells.
    pub rows: Vec<Vec<String>>,
}

#[derive(Serialize)]
struct Context<'a> {
    head: PageHead<'a>,
    guide: &'a [[&'a str; 2]],
    sections: &'a [ResultSection],
}

impl ResultPage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let head = PageHead {
            title: self.title,
            headline: self.headline,
            summary: self.summary,
            doubts: &[],
            warnings: self.run.warnings.iter().map(String::as_str).collect(),
            cards: self.cards.clone(),
            run: self.run,
        };
        render(TEMPLATE, &Context { head, guide: self.guide, sections: &self.sections })
    }
}
