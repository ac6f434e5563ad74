//! Self-contained HTML pages: style, script and figures are inside the file.
//!
//! A page is a head and sections, and a section is a heading and blocks ([`Block`]): plain data that one template, `page.html`, writes. Text is escaped where it
//! is made ([`Text`]); figures ([`Figure`]) are the only markup that passes.

mod block;
mod directions;
mod discover;
mod infer;
mod kinds;
mod parameter_table;
mod player;
mod prospects;
mod spreads;
mod table;
mod text;
mod uncertainty;
mod words;

pub use block::{Block, Panel};
pub use discover::{DiscoverFigures, DiscoverPage};
pub use infer::InferPage;
pub use player::Player;
pub use spreads::SpreadView;
pub use table::{Cell, Row, Table};
pub use text::Text;
pub use uncertainty::Uncertainty;

use minijinja::{AutoEscape, Environment, Value};
use serde::Serialize;

use crate::error::ReportError;
use crate::infer_report::RunRecord;
use crate::numbers::significant;
use crate::svg::element;

const TEMPLATE: &str = include_str!("../../templates/page.html");
const STYLE: &str = include_str!("../../templates/style.css");
const SCRIPT: &str =
    concat!(include_str!("../../templates/tabs.js"), include_str!("../../templates/keep.js"));

/// A figure with its caption.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Stand-alone SVG.
    pub svg: String,
    /// What it shows; `_x` sets a subscript.
    pub caption: String,
}

impl Figure {
    /// A figure and its caption.
    #[must_use]
    pub fn new(svg: String, caption: &str) -> Self {
        Self { svg, caption: caption.to_owned() }
    }

    /// What a screen reader says of it, from its title.
    #[must_use]
    pub fn title(&self) -> String {
        element(&self.svg, "title").unwrap_or_default()
    }

    /// The numbers in a chart, as CSV.
    #[must_use]
    pub fn table(&self) -> Option<String> {
        element(&self.svg, "metadata")
    }
}

/// A key number at the head of a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Card {
    /// Name or symbol; `_x` sets a subscript.
    pub label: String,
    /// The number with its unit.
    pub value: String,
    /// A line beneath, for example the interval.
    pub note: String,
}

impl Card {
    /// A name or symbol, the number with its unit, and a line beneath.
    #[must_use]
    pub fn new(label: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> Self {
        Self { label: label.into(), value: value.into(), note: note.into() }
    }
}

/// A part of a page under a heading; one without content is left out.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Section {
    heading: String,
    blocks: Vec<Block>,
}

impl Section {
    /// A section without content.
    #[must_use]
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), blocks: Vec::new() }
    }

    /// With one more block, unless it is empty.
    #[must_use]
    pub fn with(self, block: impl Into<Block>) -> Self {
        self.with_all([block])
    }

    /// With these blocks beneath those it has; empty ones are left out.
    #[must_use]
    pub fn with_all<B: Into<Block>>(mut self, blocks: impl IntoIterator<Item = B>) -> Self {
        self.blocks.extend(blocks.into_iter().map(Into::into).filter(|block| !block.is_empty()));
        self
    }

    /// With a block under a heading of its own, and how it is to be read; nothing of that if the block is empty.
    #[must_use]
    pub fn with_part(self, heading: &str, how: &str, block: Block) -> Self {
        match block.is_empty() {
            true => self,
            false => self.with(Block::heading(heading)).with(Block::paragraph(how)).with(block),
        }
    }
}

/// A page.
///
/// ```
/// # use voronudge_report::infer_report::RunRecord;
/// use voronudge_report::page::{Block, Page, Section};
/// # fn page(run: &RunRecord) -> Result<String, voronudge_report::ReportError> {
/// let cells = Section::new("Cells").with(Block::paragraph("All of them rest."));
/// Page { sections: vec![cells], ..Page::new("100 cells", "A solid.", run) }.render()
/// # }
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Page {
    /// Title, for example the name of the data set.
    pub title: String,
    /// The answer in one plain sentence.
    pub headline: String,
    /// What is said beneath it.
    pub summary: Vec<Block>,
    /// Reasons not to trust the numbers, which stand in a box of their own.
    pub doubts: Vec<String>,
    /// Key numbers.
    pub cards: Vec<Card>,
    /// What stands under "How to read this page".
    pub guide: Vec<Block>,
    /// The sections.
    pub sections: Vec<Section>,
    /// The run. Its warnings stand in a box, those that are doubts left out.
    pub run: RunRecord,
}

impl Page {
    /// A page of a title, the answer in one plain sentence, and the run.
    #[must_use]
    pub fn new(title: impl Into<String>, headline: impl Into<String>, run: &RunRecord) -> Self {
        let (title, headline) = (title.into(), headline.into());
        let (summary, doubts, cards, guide, sections) = Default::default();
        Self { title, headline, summary, doubts, cards, guide, sections, run: run.clone() }
    }

    /// The figures, in the order in which they are met; of a movie what stands in its place.
    #[must_use]
    pub fn into_figures(self) -> Vec<Figure> {
        let sections = self.sections.into_iter().flat_map(|section| section.blocks);
        self.summary.into_iter().chain(self.guide).chain(sections).flat_map(Block::into_figures).collect()
    }

    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let is_doubt = |warning: &&String| self.doubts.contains(warning);
        let warnings: Vec<&String> = self.run.warnings.iter().filter(|own| !is_doubt(own)).collect();
        fill("page.html", TEMPLATE, &minijinja::context! { page => self, warnings })
    }
}

/// Fills the template `source` with `context` and the scaffolding.
fn fill(template: &'static str, source: &str, context: &Value) -> Result<String, ReportError> {
    let fill = || -> Result<String, minijinja::Error> {
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| AutoEscape::Html);
        environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
        environment.add_filter("symbol", |text: &str| safe(Text::from(text)));
        environment.add_filter("prose", |text: &str| safe(Text::prose(text)));
        environment.add_filter("significant", significant);
        for (name, source) in [("style", STYLE), ("script", SCRIPT)] {
            environment.add_global(name, Value::from_safe_string(source.to_owned()));
        }
        environment.template_from_named_str(template, source)?.render(context)
    };
    fill().map_err(|source| ReportError::Template { template, source })
}

/// Markup that is not escaped again.
fn safe(text: Text) -> Value {
    Value::from_safe_string(text.as_markup().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_faulty_template_is_an_error_with_its_name() {
        let page = minijinja::context! { page => 1.0 };
        let error = fill("broken.html", "{{ page.missing.deeper }}", &page).unwrap_err();
        assert!(error.to_string().contains("broken.html"));
    }
}
