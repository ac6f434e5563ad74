//! The journal of a run of many fits, and the part that it writes.

use super::header::Header;
use super::lines::{Agreement, FILE, Made, Series, outcome_line};
use super::{CommandLine, ReplicateArguments};
use crate::failure::Failure;
use crate::output::read_if_there;
use crate::progress::Progress;
use crate::reporting::Rendered;
use crate::run::Run;
use std::ops::ControlFlow;
use std::path::Path;
use voronudge_infer::{Inference, Keeper, Known};
use voronudge_io::{DataSet, Journal, OutputDirectory, OutputFolder, Recording};

/// Keeps what fits to synthetic data come to in a journal in the output directory. There is none before the first has ended.
pub(crate) struct Kept {
    folder: OutputFolder,
    /// What the synthetic data are called.
    name: &'static str,
    made: Made,
    /// Whether only a part is made.
    is_part: bool,
    /// Whether other machines made some.
    is_merge: bool,
    /// Series that have begun in this run.
    begun: usize,
    /// Series that the journal has lines of.
    written: usize,
    journal: Option<Journal>,
    /// Why the run was stopped, if not by the user.
    fault: Option<Failure>,
    /// By how much fits differ that should be the same.
    rounded: Option<f64>,
}

impl Kept {
    /// What is known before a run begins: by the parts that are merged, and by a run of the same request that was interrupted.
    pub fn open(
        folder: &OutputFolder,
        (command, name): (&str, &'static str),
        arguments: &ReplicateArguments,
        (run, data): (&Run, &DataSet),
    ) -> Result<Self, Failure> {
        let parts = arguments.parts.as_ref();
        let line = parts.map_or_else(CommandLine::typed, |parts| parts.line.clone());
        let header = Header::new((command, &line), run.seed(), arguments.shard, data)?;
        let is_merge = parts.is_some();
        let mut made = Made { header, series: Vec::new() };
        if let Some(parts) = parts.map(|parts| &parts.made) {
            if let Some(name) = made.header.difference(&parts.header) {
                return Err(Failure::new(format!("the parts have another \"{name}\" than there is now"))
                    .with_hint(
                        "merge with the version, and beside the data, that the parts were made with",
                    ));
            }
            made.series.clone_from(&parts.series);
        }
        let (mut journal, mut written) = (None, 0);
        if let Some(earlier) = interrupted(folder.path(), &made.header, arguments.resume)? {
            written = earlier.series.len();
            made.add(earlier.series);
            journal = Some(Journal::resume(folder)?.0);
        } else if arguments.resume
            && let Some(earlier) = finished(folder.path(), &made.header)?
        {
            made.add(earlier.series);
        }
        let is_part = arguments.shard.is_some();
        let folder = folder.clone();
        let (fault, rounded) = (None, None);
        Ok(Self { folder, name, made, is_part, is_merge, begun: 0, written, journal, fault, rounded })
    }

    /// Whether the run ends with its part of the fits.
    pub fn is_part(&self) -> bool {
        self.is_part
    }

    /// Fits that were made, and how many there are to be made, as far as is known.
    fn progress(&self) -> [usize; 2] {
        let shard = self.made.header.shard;
        let all = self.made.series.iter().map(|own| (0..own.count).filter(|index| shard.has(*index)).count());
        [self.made.series.iter().map(|own| own.outcomes.len()).sum(), all.sum()]
    }

    /// The failure of the run as the user is told of it.
    pub fn failed(&mut self, failure: Failure) -> Failure {
        if let Some(fault) = self.fault.take() {
            return fault;
        }
        let [made, all] = self.progress();
        if failure.exit_code() != 130 || self.journal.is_none() || made == 0 {
            return failure;
        }
        let hint = match self.is_merge {
            false => "the same command with --resume goes on from there",
            true => "the same command goes on from there",
        };
        Failure::interrupted_at(format!("interrupted after {made} of {all} {}, which are kept", self.name))
            .with_hint(hint)
    }

    /// Warns if fits that should be the same are so but for rounding.
    pub fn caution(&self, run: &mut Run) {
        if let Some(difference) = self.rounded {
            run.warn(format!(
                "the {} were made from a fit that differs from this one by rounding ({difference:.0e}), as on another kind of processor: \
                 results may differ in their last digits from those of a run in one place",
                self.name
            ));
        }
    }

    /// Ends a run that makes a part: with what it has come to, once all fits of the part are made.
    pub fn finish_part<R>(
        mut self,
        come_to: Result<(), Failure>,
        (run, mut out): (&mut Run, OutputDirectory),
        progress: &Progress,
    ) -> Result<Rendered<R>, Failure> {
        let come_to = match progress.heed() {
            Ok(()) if self.fault.is_none() && self.begun > 0 && self.is_complete() => Ok(()),
            Ok(()) => come_to,
            Err(interrupted) => Err(interrupted),
        };
        come_to.map_err(|failure| self.failed(failure))?;
        self.caution(run);
        out.write_text(FILE, &self.made.to_text()?)?;
        let failed =
            self.made.series.iter().flat_map(|own| own.outcomes.values()).filter(|own| own.is_none());
        let summary = format!(
            "{}: {} {}, {} failed\nwritten to {}\n",
            self.made.header.shard,
            self.progress()[0],
            self.name,
            failed.count(),
            out.path().join(FILE).display()
        );
        let json = serde_json::to_string(&self.made.header)?;
        out.end_run();
        Ok(Rendered::without_report(Some(out), json, summary))
    }

    fn is_complete(&self) -> bool {
        let [made, all] = self.progress();
        made == all
    }

    /// Adds lines to the journal, which begins with the first.
    fn write(&mut self, line: &str) -> Result<(), Failure> {
        let journal = match self.journal.take() {
            Some(journal) => journal,
            None => Journal::begin(&self.folder, &serde_json::to_string(&self.made.header)?)?,
        };
        let journal = self.journal.insert(journal);
        for at in self.written..self.begun {
            journal.append(&self.made.series[at].to_line(at)?)?;
            self.written = at + 1;
        }
        Ok(journal.append(line)?)
    }

    /// Goes on, unless something went wrong.
    fn unless(&mut self, result: Result<(), Failure>) -> ControlFlow<()> {
        match result {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                self.fault.get_or_insert(failure);
                ControlFlow::Break(())
            }
        }
    }

    /// Takes a series for the same as one that is known.
    fn agree(&mut self, earlier: &Series, now: &Series) -> Result<(), Failure> {
        match Agreement::of(earlier, now) {
            Agreement::Exact => Ok(()),
            Agreement::Rounded(difference) => {
                self.rounded = Some(self.rounded.unwrap_or(0.0).max(difference));
                Ok(())
            }
            Agreement::None => {
                let who = if self.is_merge { "of the parts" } else { "kept by the interrupted run" };
                Err(Failure::new(format!("the {} {who} were made from another fit than this one", self.name))
                    .with_hint("another program or another kind of machine made them; make them anew"))
            }
        }
    }
}

impl Keeper for Kept {
    fn begin(&mut self, made_from: &Inference, count: usize) -> ControlFlow<()> {
        let now = Series::new(made_from, count);
        self.begun += 1;
        let agreed = match self.made.series.get(self.begun - 1).cloned() {
            Some(earlier) => self.agree(&earlier, &now),
            None => {
                self.made.series.push(now);
                Ok(())
            }
        };
        self.unless(agreed)
    }

    fn known(&self, index: usize) -> Known {
        let series = self.begun.checked_sub(1).and_then(|last| self.made.series.get(last));
        match series.and_then(|own| own.outcomes.get(&index)) {
            Some(outcome) => Known::Made(outcome.clone()),
            None if self.made.header.shard.has(index) => Known::Missing,
            None => Known::Elsewhere,
        }
    }

    fn keep(&mut self, index: usize, outcome: Option<&[f64]>) -> ControlFlow<()> {
        let last = self.begun.saturating_sub(1);
        if let Some(series) = self.made.series.get_mut(last) {
            series.outcomes.insert(index, outcome.map(<[f64]>::to_vec));
        }
        let written = outcome_line(last, index, outcome).and_then(|line| self.write(&line));
        self.unless(written)
    }
}

/// What an interrupted run of the same request has kept; none if there is none. Where there is another, or it is not to be resumed, it is not
/// overwritten.
fn interrupted(out: &Path, header: &Header, resume: bool) -> Result<Option<Made>, Failure> {
    let place = out.display();
    if Recording::find(out)?.is_some() {
        return Err(Failure::new(format!("{place} holds a run of simulate that was interrupted"))
            .with_hint("give another --out, or remove its folder .voronudge-run"));
    }
    // A header alone is worth nothing.
    let Some(lines) = Journal::find(out)?.filter(|lines| lines.len() > 1) else { return Ok(None) };
    if !resume {
        return Err(Failure::new(format!("{place} holds a run that was interrupted"))
            .with_hint("add --resume to go on with it, or remove its folder .voronudge-run"));
    }
    let made = Made::parse(lines.iter().map(String::as_str), place)?;
    let parts = (made.header.shard != header.shard).then(|| "--shard".to_owned());
    if let Some(name) = header.difference(&made.header).or(parts) {
        return Err(Failure::new(format!("the interrupted run has another \"{name}\""))
            .at(out.display())
            .with_hint("repeat the options of the interrupted run, or give another --out"));
    }
    Ok(Some(made))
}

/// The fits of a part that ended, if it is of the same request.
fn finished(out: &Path, header: &Header) -> Result<Option<Made>, Failure> {
    let path = out.join(FILE);
    let Some(text) = read_if_there(&path)? else { return Ok(None) };
    // One that another version made is made again.
    let found = Made::parse(text.lines(), path.display()).ok();
    Ok(found.filter(|own| own.header.shard == header.shard && header.difference(&own.header).is_none()))
}
