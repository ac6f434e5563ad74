//! What a command is: options as clap read them, which run to an answer. One that writes a report checks its request, works on it and
//! renders what comes of it; all else is the same for all of them and stands here.

use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::run::Run;
use crate::{browser, terminal};
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use std::marker::PhantomData;
use voronudge_io::OutputDirectory;
use voronudge_report::page::{Figure, Page};
use voronudge_report::schema_of;

/// What a command that ran has to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Exit code 0.
    Positive,
    /// Exit code 1: it ran, but found no acceptable fit, or a check failed.
    Negative,
}

impl Answer {
    /// The answer to a question of yes or no.
    pub fn of(positive: bool) -> Self {
        if positive { Self::Positive } else { Self::Negative }
    }

    /// What a command that only prints has to say.
    pub fn printed(text: &str) -> Result<Self, Failure> {
        terminal::print(text).map_err(|error| Failure::new(format!("stdout cannot be written: {error}")))?;
        Ok(Self::Positive)
    }
}

/// The name of a command, and what describes its report.
pub(crate) type Described = (&'static str, fn() -> Schema);

/// A command with its options.
pub(crate) trait Command {
    /// Runs it.
    fn run(self) -> Result<Answer, Failure>;

    /// The reports that it and the commands below it write.
    fn described() -> Vec<Described> {
        Vec::new()
    }
}

/// A command that writes a report.
pub(crate) trait Reporting: Sized {
    /// Its name on the command line.
    const NAME: &'static str;
    /// What is in its report.json.
    type Report: Serialize + JsonSchema;

    /// What all of them are asked.
    fn common(&self) -> &CommonArguments;

    /// Checks the request, works on it and renders what comes of it.
    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure>;
}

impl<T: Reporting> Command for T {
    fn run(self) -> Result<Answer, Failure> {
        let mut run = Run::begin(T::NAME, self.common())?;
        self.work(&mut run)?.deliver(&run)
    }

    fn described() -> Vec<Described> {
        vec![(T::NAME, schema_of::<T::Report>)]
    }
}

/// What a command has come to, in the output folder but not yet in place.
pub(crate) struct Rendered<R> {
    out: Option<OutputDirectory>,
    /// What --format json prints.
    json: String,
    /// What is printed otherwise.
    summary: String,
    answer: Answer,
    /// Those of the page.
    figures: Vec<Figure>,
    /// Whether the page is shown in a browser.
    shown: bool,
    report: PhantomData<R>,
}

impl<R: Serialize> Rendered<R> {
    /// A report, which is written if there is an output folder, and what is printed.
    pub fn new(
        out: impl Into<Option<OutputDirectory>>,
        report: &R,
        summary: impl Into<String>,
    ) -> Result<Self, Failure> {
        let json = serde_json::to_string_pretty(report)?;
        let mut out = out.into();
        if let Some(out) = &mut out {
            out.write_text("report.json", &json)?;
        }
        Ok(Self::without_report(out, json, summary.into()))
    }

    /// The same with a page.
    pub fn with_page(
        mut out: OutputDirectory,
        report: &R,
        page: Page,
        summary: impl Into<String>,
    ) -> Result<Self, Failure> {
        out.write_text("report.html", &page.render()?)?;
        Ok(Self { figures: page.into_figures(), ..Self::new(out, report, summary)? })
    }
}

impl<R> Rendered<R> {
    /// Results that are no report, such as those of a part.
    pub fn without_report(out: Option<OutputDirectory>, json: String, summary: String) -> Self {
        Self {
            out,
            json,
            summary,
            answer: Answer::Positive,
            figures: Vec::new(),
            shown: false,
            report: PhantomData,
        }
    }

    pub fn with_answer(self, answer: Answer) -> Self {
        Self { answer, ..self }
    }

    /// Whether the page is to be shown in a browser.
    pub fn shown(self, shown: bool) -> Self {
        Self { shown, ..self }
    }

    /// Puts the results in place and prints them.
    fn deliver(mut self, run: &Run) -> Result<Answer, Failure> {
        if let Some(out) = self.out.as_mut().filter(|_| run.keeps_figures) {
            keep(&self.figures, out)?;
        }
        let page = self.out.as_ref().filter(|_| self.shown).map(|out| out.path().join("report.html"));
        run.finish(self.out, &self.json, &self.summary)?;
        page.iter().for_each(|page| browser::open(page));
        Ok(self.answer)
    }
}

/// Writes figures as files of their own, with the numbers of those that have some.
fn keep(figures: &[Figure], out: &mut OutputDirectory) -> Result<(), Failure> {
    for (index, figure) in figures.iter().enumerate() {
        let title = figure.title().to_lowercase();
        let words =
            title.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        let name = format!("figure-{:02}-{}", index + 1, words.collect::<Vec<_>>().join("-"));
        out.write_text(&format!("{name}.svg"), &figure.svg)?;
        if let Some(table) = figure.table() {
            out.write_text(&format!("{name}.csv"), &table)?;
        }
    }
    Ok(())
}
