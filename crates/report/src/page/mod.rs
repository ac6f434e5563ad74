//! Self-contained HTML pages: style, script and figures are inside the file.
//!
//! A page is a template that extends `base.html` and a context of plain data. Text is escaped;
//! figures ([`Figure`]) and symbols are the only markup that passes.

mod directions;
mod discover;
mod infer;
mod kinds;
mod moduli;
mod parameter_table;
mod phase_diagram;
mod player;
mod prospects;
mod sections;
mod simulate;
mod spectrum;
mod spreads;
mod strip;
mod uncertainty;
mod words;

pub use discover::{DiscoverFigures, DiscoverPage};
pub use infer::InferPage;
pub use moduli::ModuliPage;
pub use phase_diagram::PhasePage;
pub use sections::{Section, SectionPage, Table};
pub use simulate::SimulatePage;
pub use spectrum::SpectrumPage;
pub use spreads::SpreadView;
pub use strip::StripFigures;
pub use uncertainty::Uncertainty;

use minijinja::{AutoEscape, Environment, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::error::ReportError;
use crate::infer_report::RunRecord;
use crate::numbers::significant;
use crate::svg::{SubscriptMarkup, subscripts};
use crate::units::unit_text;

const BASE: &str = include_str!("../../templates/base.html");
const MACROS: &str = include_str!("../../templates/macros.html");
const STYLE: &str = include_str!("../../templates/style.css");
const SCRIPT: &str =
    concat!(include_str!("../../templates/tabs.js"), include_str!("../../templates/keep.js"));

/// A figure with its caption.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Figure {
    /// Stand-alone SVG.
    pub svg: String,
    /// What it shows, plain text.
    pub caption: String,
}

impl Figure {
    /// A figure and its caption.
    #[must_use]
    pub fn new(svg: String, caption: &str) -> Self {
        Self { svg, caption: caption.to_owned() }
    }
}

/// A key number at the head of a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Card {
    /// Name or symbol; `_x` sets a subscript.
    pub label: String,
    /// The number with its unit.
    pub value: String,
    /// A line beneath, for example the interval.
    pub note: String,
}

/// Figures under one tab, for example those of one frame.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Panel {
    /// Name of the tab.
    pub label: String,
    /// The figures, row by row.
    pub figures: Vec<Figure>,
    /// How many figures stand side by side where there is room.
    pub columns: Columns,
}

/// How many figures stand side by side where there is room.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Columns {
    /// Two, for maps of many cells.
    Two,
    /// Three.
    Three,
}

impl Columns {
    /// The layout at which the maps of `cells` cells stay legible.
    #[must_use]
    pub fn for_cells(cells: usize) -> Self {
        if cells > 700 { Self::Two } else { Self::Three }
    }
}

/// What every page has, whatever the command.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct PageHead<'a> {
    /// Title of the page, for example the name of the data set.
    pub title: &'a str,
    /// The answer in one sentence.
    pub headline: &'a str,
    /// Further sentences, one paragraph each.
    pub summary: &'a [String],
    /// Reasons not to trust the numbers, which stand in a box of their own.
    pub doubts: &'a [String],
    /// What else the reader should know before using the numbers.
    pub warnings: Vec<&'a str>,
    /// Key numbers.
    pub cards: Vec<Card>,
    /// The run.
    pub run: &'a RunRecord,
}

impl<'a> PageHead<'a> {
    /// A page without doubts, whose warnings are those of the run.
    pub(super) fn sound(
        [title, headline]: [&'a str; 2],
        summary: &'a [String],
        cards: Vec<Card>,
        run: &'a RunRecord,
    ) -> Self {
        let warnings = run.warnings.iter().map(String::as_str).collect();
        Self { title, headline, summary, doubts: &[], warnings, cards, run }
    }
}

/// A template of this crate or of a caller; it may extend `base.html` and import `macros.html`.
#[derive(Debug, Clone, Copy)]
pub struct Template {
    /// File name, ending in `.html`.
    pub name: &'static str,
    /// Source text.
    pub source: &'static str,
}

/// Fills `template` with `context` (available as `page`) and the scaffolding.
///
/// # Errors
///
/// [`ReportError::Template`] where the template is faulty or a value is missing.
pub fn render(template: Template, context: &impl Serialize) -> Result<String, ReportError> {
    let fill = || -> Result<String, minijinja::Error> {
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| AutoEscape::Html);
        environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
        environment.add_filter("symbol", symbol);
        environment.add_filter("prose", |text: String| Value::from_safe_string(words::prose(&text)));
        environment.add_filter("significant", significant_value);
        environment.add_filter("unit", |unit: String| unit_text(&unit));
        environment.add_template("base.html", BASE)?;
        environment.add_template("macros.html", MACROS)?;
        environment.add_template(template.name, template.source)?;
        environment.get_template(template.name)?.render(minijinja::context! {
            page => Value::from_serialize(context),
            style => Value::from_safe_string(STYLE.to_owned()),
            script => Value::from_safe_string(SCRIPT.to_owned()),
        })
    };
    fill().map_err(|source| ReportError::Template { template: template.name, source })
}

/// Escaped text with subscripts as markup.
fn symbol(text: String) -> Value {
    Value::from_safe_string(subscripts(&text, SubscriptMarkup::Html))
}

/// A number with some digits; anything that is not a number is unknown.
fn significant_value(value: Value, digits: usize) -> String {
    significant(f64::try_from(value).unwrap_or(f64::NAN), digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_faulty_template_is_an_error_with_its_name() {
        let template = Template { name: "broken.html", source: "{{ page.missing.deeper }}" };
        let error = render(template, &1.0).unwrap_err();
        assert!(error.to_string().contains("broken.html"));
    }
}
