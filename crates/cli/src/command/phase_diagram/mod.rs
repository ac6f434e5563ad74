//! `voronudge phase-diagram`: measurements over preferred perimeter and chirality.

mod diagram;
mod outcome;
mod page;
mod point;
pub(crate) mod points;
pub(crate) mod request;
mod scaling;
mod work;

pub(crate) use outcome::finish;
pub(crate) use scaling::ScalingArguments;

use crate::arguments::{CommonArguments, Shard, SpreadArguments};
use crate::failure::Failure;
use crate::output::{NO_INPUTS, read_if_there};
use crate::progress::Progress;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use points::{Header, Points};
use request::{GridArguments, Request};
use std::collections::BTreeSet;
use std::path::Path;
use voronudge_io::{Journal, OutputFolder, Recording};
use voronudge_report::PhaseReport;
use work::{Ending, work};

/// Computes a phase diagram: velocities, order, T1 transitions and more over preferred perimeter and chirality.
///
/// Runs the model in a periodic box at every point of a grid. Writes each quantity and its standard error as .npy
/// files of shape (n_alpha, n_P0), the axes P_0.npy and alpha.npy, points.jsonl with all runs, report.json and
/// report.html.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    grid: GridArguments,
    #[command(flatten)]
    spreads: SpreadArguments,
    /// Continue the interrupted diagram in --out, or start one if there is none. A complete diagram is not repeated.
    #[arg(long, help_heading = "General")]
    resume: bool,
    /// Make only one part of the runs, such as 1/4; `merge` combines all parts.
    #[arg(long, value_name = "PART/OF", help_heading = "General")]
    shard: Option<Shard>,
    #[command(flatten)]
    scaling: ScalingArguments,
    #[command(flatten)]
    common: CommonArguments,
}

impl Reporting for Arguments {
    const NAME: &'static str = "phase-diagram";
    type Report = PhaseReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let request = Request::new(&self.grid, self.spreads.resolve()?, self.common.seed)?;
        let scaling = self.scaling.resolve()?;
        let out = &self.common.claim(NO_INPUTS)?;
        let header = Header { request, shard: self.shard.unwrap_or(Shard::WHOLE) };
        let (mut journal, mut points) = open(out, header, self.resume)?;
        let request = points.header.request.clone();
        let coarse = request.coarse_points();
        if coarse > 0 {
            run.warn(format!(
                "the time step {} is above the one advised at {coarse} of {} points; velocities there can come out wrong by tens of per cent",
                request.dt.unwrap_or(f64::NAN),
                request.points()
            ));
        }
        let done: BTreeSet<_> = points.records.iter().map(|record| (record.point, record.replica)).collect();
        let mut jobs = request.jobs(points.header.shard);
        let all = jobs.len();
        jobs.retain(|job| !done.contains(&(job.point, job.replica)));
        let mut progress = Progress::new(self.common.verbosity());
        let ending = work(&request, jobs, (&mut journal, &mut points.records), &mut progress)?;
        if ending == Ending::Interrupted {
            let text = format!("interrupted after {} of {all} runs, which are kept", points.records.len());
            return Err(
                Failure::interrupted_at(text).with_hint("the same command with --resume goes on from there")
            );
        }
        points.sort();
        let results = journal.results()?;
        finish(run, &points, &scaling, results)
    }
}

/// The runs of a diagram that ended, if it is of the same request.
fn finished(out: &Path, header: &Header) -> Result<Option<Points>, Failure> {
    let path = out.join(points::FILE);
    let Some(text) = read_if_there(&path)? else { return Ok(None) };
    // One that another version made is made again.
    let found = Points::parse(text.lines(), path.display()).ok();
    Ok(found.filter(|found| matches!(found.header.difference(header), Ok(None))))
}

/// Begins a journal, or goes on with one of the same request.
fn open(folder: &OutputFolder, header: Header, resume: bool) -> Result<(Journal, Points), Failure> {
    let out = folder.path();
    let place = || out.display().to_string();
    if Recording::find(out)?.is_some() {
        return Err(Failure::new(format!("{} holds a run of simulate that was interrupted", place()))
            .with_hint("give another --out, or remove its folder .voronudge-run"));
    }
    let Some(lines) = Journal::find(out)? else {
        let known = if resume { finished(out, &header)? } else { None };
        let journal = Journal::begin(folder, &serde_json::to_string(&header)?)?;
        return Ok((journal, known.unwrap_or(Points { header, records: Vec::new() })));
    };
    if !resume {
        return Err(Failure::new(format!("{} holds a run that was interrupted", place()))
            .with_hint("add --resume to go on with it, or remove its folder .voronudge-run"));
    }
    let points = Points::parse(lines.iter().map(String::as_str), place())?;
    if let Some(name) = points.header.difference(&header)? {
        return Err(Failure::new(format!("the interrupted diagram has another \"{name}\""))
            .at(place())
            .with_hint("repeat the options of the interrupted diagram, or give another --out"));
    }
    let (journal, _) = Journal::resume(folder)?;
    Ok((journal, points))
}
