//! The page of the command `simulate`.

use schemars::JsonSchema;
use serde::Serialize;

use super::player::Player;
use super::{Card, Figure, PageHead, Template, render};
use crate::error::ReportError;
use crate::infer_report::RunRecord;
use crate::movie::CellMovie;

const TEMPLATE: Template =
    Template { name: "simulate.html", source: include_str!("../../templates/simulate.html") };

/// Everything the page of `simulate` shows.
#[derive(Debug, Clone, Copy)]
pub struct SimulatePage<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// The answer in one plain sentence.
    pub headline: &'a str,
    /// Further plain sentences, one paragraph each.
    pub summary: &'a [String],
    /// Key numbers.
    pub cards: &'a [Card],
    /// The cells at the end of the run.
    pub configuration: &'a Figure,
    /// The cells of all frames, if there are any.
    pub movie: Option<&'a CellMovie>,
    /// What happened in time.
    pub course: &'a [Figure],
    /// What the tissue is like at the end.
    pub structure: &'a [Figure],
    /// The run.
    pub run: &'a RunRecord,
}

#[derive(Serialize, JsonSchema)]
struct Context<'a> {
    head: PageHead<'a>,
    configuration: &'a Figure,
    player: Option<Player>,
    course: &'a [Figure],
    structure: &'a [Figure],
}

impl SimulatePage<'_> {
    /// The HTML text of the page.
    ///
    /// # Errors
    ///
    /// [`ReportError::Template`] if the template cannot be filled.
    pub fn render(&self) -> Result<String, ReportError> {
        let head = PageHead::sound([self.title, self.headline], self.summary, self.cards.to_vec(), self.run);
        let Self { configuration, movie, course, structure, .. } = *self;
        let player = |movie| Player::new(movie, configuration.svg.clone(), &configuration.caption);
        let player = movie.map(player).transpose()?;
        render(TEMPLATE, &Context { head, configuration, player, course, structure })
    }
}
