//! `voronudge discover`: what the base model leaves unexplained, and which effect explains it.

mod candidates;
mod checks;
mod effects;
mod forecasts;
mod history;
mod material;
mod measured;
mod onward;
mod page;
mod phrases;
mod predictions;
mod report;
mod sentences;
mod stretch;
mod summary;
mod surroundings;

use super::fit::measured::{frames, measured, velocities};
use super::fit::{
    ConstraintArguments, Inquiry, SearchArguments, SnapshotArguments, arrays, export, latent, measurement,
    outcome, spreads, tracks, words,
};
use super::replicates::{Kept, ReplicateArguments};
use crate::arguments::{CommonArguments, ExportArguments, MovieArguments};
use crate::failure::Failure;
use crate::problem::{Measured, Problem};
use crate::progress::Progress;
use crate::reporting::{Answer, Rendered, Reporting};
use crate::run::Run;
use candidates::SearchOptions;
use checks::CheckArguments;
use clap::Args;
use forecasts::ForecastArguments;
use history::{GivenDifference, History};
use material::{Past, Searched};
use predictions::PredictionArguments;
use report::Found;
use surroundings::FieldArguments;
use voronudge_infer::{Constraints, Part, Scale};
use voronudge_io::{DataSet, Difference, Noise};
use voronudge_model::Effect;
use voronudge_report::DiscoverReport;

/// Finds what the base model leaves unexplained, adds the effects that explain it, and compares the errors before and
/// after on data that the fit has not seen.
///
/// Writes report.json, report.html and, with names that begin with before_ and after_, nudged_positions.npy,
/// predicted_velocities.npy and residual_velocities.npy (for a flow field predicted_flow.npy and residual_flow.npy).
/// If there are tracks and no velocities, the tracks themselves are searched; this also writes trajectories.npy and,
/// if cells crawl, polarities.npy. If cells differ, after_deviation_*.npy holds the deviation of each cell.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    snapshots: SnapshotArguments,
    #[command(flatten)]
    field: FieldArguments,
    /// Derive velocities from tracked positions by differences, if no velocities are given [default: fit the tracks
    /// themselves].
    #[arg(long, value_name = "central|forward|backward")]
    difference: Option<Difference>,
    /// What the given velocities are, which decides from which earlier velocities they may be predicted [default:
    /// instantaneous].
    #[arg(long, value_enum)]
    given_difference: Option<GivenDifference>,
    #[command(flatten)]
    export: ExportArguments,
    #[command(flatten)]
    movie: MovieArguments,
    /// Open report.html in the browser when done.
    #[arg(long)]
    open_report: bool,
    #[command(flatten)]
    options: SearchOptions,
    #[command(flatten)]
    predictions: PredictionArguments,
    #[command(flatten)]
    forecast: ForecastArguments,
    #[command(flatten)]
    check: CheckArguments,
    #[command(flatten)]
    latent: latent::LatentArguments,
    #[command(flatten)]
    known: ConstraintArguments,
    #[command(flatten)]
    method: SearchArguments,
    #[command(flatten)]
    replicates: ReplicateArguments,
    #[command(flatten)]
    common: CommonArguments,
}

impl Arguments {
    /// Follows the command line of parts with what these have made.
    pub fn merged(
        self,
        common: impl FnOnce(CommonArguments) -> CommonArguments,
        replicates: ReplicateArguments,
    ) -> Self {
        let common = common(self.common);
        Self { open_report: false, replicates, common, ..self }
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "discover";
    type Report = DiscoverReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(mut self, run: &mut Run) -> Result<Rendered<DiscoverReport>, Failure> {
        // From here on Ctrl-C ends the command where nothing is left behind.
        let mut progress = Progress::new(self.common.verbosity());
        self.snapshots.check()?;
        self.latent.check()?;
        let constraints = self.known.constraints()?;
        let candidates = self.options.candidates()?;
        self.options.check(self.replicates.shard)?;
        let mut data = self.snapshots.data.load()?;
        let map = self.field.load(&mut data)?;
        self.check.possible(&self, &data, self.difference)?;
        let coming = self.forecast.leave(&mut self.snapshots, &data, self.difference)?;
        let snapshots = &self.snapshots;
        let out = self.common.reserve(&data.inputs)?;
        let asked = Asked { arguments: &self, constraints: &constraints, candidates: &candidates };
        let raw = asked.raw(&data, run)?;
        let others = self.predictions.load(&asked, (&mut data, &raw.prepared), run)?;
        let mut out = out.begin()?;
        let folder = out.path().to_owned();
        let mut kept = Kept::open(out.folder(), ("discover", "null sets"), &self.replicates, (run, &data))?;
        let searched = asked.searched(&raw, (&data, map.as_ref()), &mut kept, &mut progress);
        if kept.is_part() {
            progress.finish();
            return kept.finish_part(searched.map(|_| ()), (run, out), &progress);
        }
        let searched = searched.inspect_err(|_| progress.finish()).map_err(|failure| kept.failed(failure))?;
        kept.caution(run);
        let units = outcome::units(&data);
        let forecast = match &coming {
            Some(coming) => coming.forecast(&asked, (&data, &units), &searched, run, &mut progress),
            None => Ok(None),
        };
        let compared =
            self.check.compare(&asked, (&data, &units), (&searched, coming.as_ref()), run, &mut progress);
        progress.finish();
        let compared = compared.map_err(|failure| kept.failed(failure))?;
        let forecast = forecast.map_err(|failure| kept.failed(failure))?;
        let Searched { prepared, search, discovery } = searched;
        measurement::caution(&prepared, run);
        let predictors = raw.past.and_then(|past| past.predictors);
        let last = &discovery.after.inference;
        let doubts = words::doubts(last, &[], prepared.request.method);
        // Whether what is left has a structure is told in the answer itself.
        let told = doubts.iter().filter(|(part, _)| *part != Part::Pattern.name());
        told.for_each(|(_, doubt)| run.warn(doubt));
        for (prefix, fitted) in [("before_", &discovery.before), ("after_", &discovery.after)] {
            arrays::write(&mut out, prefix, &data, &prepared, &fitted.inference)?;
            if let (Some(movie), Some(tracked)) = (&prepared.tracks, &fitted.tracked) {
                tracks::write(&mut out, prefix, &data, (&prepared, movie), tracked)?;
            }
        }
        spreads::write(&mut out, "after_", &data, &prepared, last)?;
        latent::write(&mut out, &data, &prepared, last)?;
        self.export.write(&mut out, &data, || export::frames(&prepared, last))?;
        let movie = page::movie(&prepared, &discovery, &data);
        self.movie.write(&mut out, movie.as_ref(), run)?;
        let predictions =
            others.iter().filter_map(|other| other.predicted(&search, &discovery, run)).collect();
        let followed = prepared.tracks.as_ref().zip(discovery.after.tracked.as_ref());
        let tracks = followed.map(|(movie, tracked)| tracks::report(&prepared, movie, last, tracked));
        let found = Found {
            data: &data,
            prepared: &prepared,
            stated: snapshots.stated(&data),
            tracks,
            search: &search,
            predictors,
            predictions,
            forecast,
            compared,
        };
        let report = report::report(run, &found, &discovery);
        let page = page::page(&snapshots.title(), &found, &discovery, &report, movie)?;
        let summary = summary::summary(&report, &folder);
        out.end_run();
        let answer = Answer::of(last.is_acceptable());
        let rendered = Rendered::with_page(out, &report, page, summary)?.with_answer(answer);
        progress.heed().map_err(|failure| kept.failed(failure))?;
        Ok(rendered.shown(self.open_report))
    }
}

/// What is asked of every data set.
struct Asked<'a> {
    arguments: &'a Arguments,
    constraints: &'a Constraints,
    candidates: &'a [&'static Effect],
}

impl Asked<'_> {
    /// The tracks, where there are no velocities and none are to be derived.
    fn tracks(&self, data: &DataSet, run: &mut Run) -> Result<Option<Problem>, Failure> {
        let arguments = self.arguments;
        let snapshots = &arguments.snapshots;
        let velocities = measured(snapshots, data, arguments.difference)?;
        let Measured::Tracks(means) = &velocities else { return Ok(None) };
        let refused = [
            (arguments.given_difference.is_some(), "--given-difference"),
            (snapshots.background.is_some(), "--background"),
            (arguments.options.null_sets.is_some_and(|count| count > 0), "--null-sets"),
            (arguments.replicates.shard.is_some(), "--shard"),
            (arguments.predictions.is_asked(), "--predict"),
            (arguments.field.is_asked(), "--field"),
        ];
        if let Some((_, option)) = refused.into_iter().find(|(given, _)| *given) {
            return Err(Failure::new(format!(
                "{option} is for velocities that are given or derived, but there are only tracks, which are fitted themselves"
            ))
            .with_hint(format!("leave out {option}, or give --difference central for velocities")));
        }
        let frames = match snapshots.frames {
            Some(_) => frames(&velocities, snapshots, data)?,
            None => stretch::middle(means, run).collect(),
        };
        self.inquiry(snapshots, data, None).prepare(velocities, frames, run).map(Some)
    }

    fn inquiry<'q>(
        &self,
        snapshots: &'q SnapshotArguments,
        data: &'q DataSet,
        scale: Option<Scale>,
    ) -> Inquiry<'q> {
        Inquiry {
            arguments: snapshots,
            data,
            constraints: self.constraints.clone(),
            method: self.arguments.method.method(),
            seed: self.arguments.common.seed,
            detections: self.arguments.latent.detections(),
            scale,
        }
    }

    /// Snapshots and what preceded them, in their own scale or, of another data set, in that of the fit.
    fn prepare(
        &self,
        snapshots: &SnapshotArguments,
        data: &DataSet,
        other: Option<Scale>,
        run: &mut Run,
    ) -> Result<(Problem, Past), Failure> {
        let Self { arguments, candidates, .. } = self;
        let difference = arguments.difference.unwrap_or(Difference::Forward);
        let velocities = velocities(snapshots, data, difference)?;
        let history = History::new(data, &velocities, arguments.given_difference)?;
        let frames = frames(&velocities, snapshots, data)?;
        let kept = history::keep_frames(history.as_ref(), data, frames, candidates);
        let (kind, noise) = (shared_errors(&velocities), unknown_noise(data));
        let prepared = self.inquiry(snapshots, data, other).prepare(velocities, kept.frames, run)?;
        match other {
            None => kind.into_iter().chain(noise).chain(kept.warning).for_each(|warning| run.warn(warning)),
            // What is wrong with the kind of data was said of the first.
            Some(_) => kept
                .warning
                .into_iter()
                .for_each(|warning| run.warn(format!("{}: {warning}", snapshots.title()))),
        }
        Ok((prepared, Past { history, predictors: kept.predictors }))
    }

    /// Another data set in the scale of the fit, with what surrounds and preceded it.
    fn other(
        &self,
        snapshots: &SnapshotArguments,
        data: &DataSet,
        scale: Scale,
        run: &mut Run,
    ) -> Result<Problem, Failure> {
        let (mut prepared, Past { history, .. }) = self.prepare(snapshots, data, Some(scale), run)?;
        surroundings::surround(&mut prepared, (snapshots, data), None, history.as_ref())?;
        Ok(prepared)
    }
}

/// What the error of a shared position does to differences.
fn shared_errors(velocities: &Measured) -> Option<String> {
    let (kind, force) = match velocities.derived()? {
        Difference::Forward => ("forward", "start at: it acts as a spurious restoring force"),
        Difference::Backward => ("backward", "end at: it acts as a spurious repelling force"),
        Difference::Central => return None,
    };
    Some(format!(
        "velocities are {kind} differences, which share the error of the position they {force}; --difference central does not, \
         but needs more frames for earlier velocities"
    ))
}

/// What an estimate of the noise contains.
fn unknown_noise(data: &DataSet) -> Option<String> {
    let is_known = |noise: Option<Noise>| noise.is_some_and(|noise| noise != Noise::Estimated);
    let what = match [data.position_noise, data.velocity_noise].map(is_known) {
        [true, true] => return None,
        [false, true] => "position noise",
        [true, false] => "velocity noise",
        [false, false] => "noise of positions and velocities",
    };
    Some(format!(
        "the {what} is not given, so it is estimated from what the fit leaves: an effect that is missing inflates the estimate, \
         which is an upper bound; state position_noise and velocity_noise where they are known"
    ))
}
