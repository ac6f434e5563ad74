//! `voronudge infer`: parameters of the model from snapshots, by nudged inference.

mod activity;
mod answers;
mod kinds;
mod method;
mod page;
mod questions;
mod report;
mod spreads;
mod summary;
mod verdict;

use super::fit::measured::{frames, measured};
use super::fit::{
    ConstraintArguments, Inquiry, SnapshotArguments, arrays, export, latent, measurement, tracks, views,
    with_location, words,
};
use super::replicates::{Kept, ReplicateArguments};
use crate::arguments::{CommonArguments, ExportArguments, MovieArguments};
use crate::failure::Failure;
use crate::problem::Measured;
use crate::progress::Progress;
use crate::reporting::{Answer, Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use method::MethodArguments;
use questions::UncertaintyArguments;
use voronudge_infer::{Activity, Drives, prospects};
use voronudge_io::Difference;
use voronudge_model::CellParameter;
use voronudge_model::effect::LabelledParameter;
use voronudge_report::InferReport;

/// Infers K_A, K_P, P_0 and alpha from cell positions and velocities by nudged inference (NADA).
///
/// Velocities, of cells or on a grid, are read from the data set. If there are none, the tracks of the cells are
/// fitted themselves, which also writes trajectories.npy. Writes report.json, report.html, nudged_positions.npy,
/// predicted_velocities.npy and residual_velocities.npy (for a flow field predicted_flow.npy and residual_flow.npy),
/// and latent_cells.npy with the cells that were not detected.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    snapshots: SnapshotArguments,
    /// Derive velocities from tracked positions by differences, if no velocities are given [default: fit the tracks
    /// themselves].
    #[arg(long, value_name = "central|forward|backward")]
    difference: Option<Difference>,
    /// Let cells crawl: each has a polarity, a velocity of its own that it forgets at some rate. Fits its speed v_0
    /// and rotational diffusion D_r together with the model. For tracks of three frames or more.
    #[arg(long, help_heading = "Cells that crawl")]
    active: bool,
    /// As --active, and also let the polarities turn towards those of the neighbours, at a rate J that is fitted.
    #[arg(long, help_heading = "Cells that crawl")]
    align: bool,
    /// As --active, and also let the polarities turn away from contacts, and fit how fast, b.
    #[arg(long, help_heading = "Cells that crawl")]
    contact_inhibition: bool,
    /// As --active, and also let the polarities turn towards the velocity that the forces produce, at a rate kappa
    /// that is fitted.
    #[arg(long, help_heading = "Cells that crawl")]
    velocity_alignment: bool,
    /// Let cells differ in one or more of the parameters K_A, P_0, A_0 and alpha, separated by commas, as in `--vary
    /// alpha`. For velocities of cells.
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',', value_parser = spreads::parameter, help_heading = "Cells that differ")]
    vary: Vec<CellParameter>,
    /// Fit separate parameters for the cells of each label: P_0, alpha or both, and with both of them also K_P
    /// (`P_0,alpha` or `K_P,P_0,alpha`).
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',', value_parser = kinds::parameter, help_heading = "Cells that differ")]
    by_label: Vec<LabelledParameter>,
    #[command(flatten)]
    export: ExportArguments,
    #[command(flatten)]
    movie: MovieArguments,
    /// Open report.html in the browser when done.
    #[arg(long, help_heading = "Output")]
    open_report: bool,
    #[command(flatten)]
    latent: latent::LatentArguments,
    #[command(flatten)]
    known: ConstraintArguments,
    #[command(flatten)]
    method: MethodArguments,
    #[command(flatten)]
    uncertainty: UncertaintyArguments,
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

    /// Refuses what is for velocities, where tracks are fitted.
    fn check_tracks(&self) -> Result<(), Failure> {
        let asked = [
            (self.method.is_descent(), "--method descent"),
            (self.snapshots.background.is_some(), "--background"),
            (!self.vary.is_empty(), "--vary"),
            (self.uncertainty.is_asked(), "--profile, --landscape or --bootstrap"),
        ];
        match asked.into_iter().find(|(given, _)| *given) {
            None => Ok(()),
            Some((_, option)) => Err(Failure::new(format!(
                "{option} needs velocities, but there are only tracks"
            ))
            .with_hint(format!(
                "leave out {option}, or give --difference central for velocities from the tracks"
            ))),
        }
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "infer";
    type Report = InferReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<InferReport>, Failure> {
        // From here on Ctrl-C ends the command where nothing is left behind.
        let mut progress = Progress::new(self.common.verbosity());
        self.snapshots.check()?;
        self.latent.check()?;
        let constraints = self.known.constraints()?;
        let method = self.method.method()?;
        self.uncertainty.check(&constraints, self.replicates.shard)?;
        let data = self.snapshots.data.load()?;
        let out = self.common.reserve(&data.inputs)?;
        let velocities = measured(&self.snapshots, &data, self.difference)?;
        if let Some(difference @ (Difference::Forward | Difference::Backward)) = velocities.derived() {
            run.warn(format!(
                "velocities are {difference} differences, which share the error of the position they start or end at: it acts \
                 as a spurious force; central differences do not"
            ));
        }
        let frames = frames(&velocities, &self.snapshots, &data)?;
        if matches!(velocities, Measured::Tracks(_)) {
            self.check_tracks()?;
        }
        let inquiry = Inquiry {
            arguments: &self.snapshots,
            data: &data,
            constraints,
            method,
            seed: self.common.seed,
            detections: self.latent.detections(),
            scale: None,
        };
        let mut prepared = inquiry.prepare(velocities, frames, run)?;
        let drives = Drives {
            contact_inhibition: self.contact_inhibition,
            velocity_alignment: self.velocity_alignment,
        };
        if self.active || self.align || drives.any() {
            activity::check(prepared.tracks.as_ref())?;
            prepared.request.drives = drives;
            prepared.request.activity = if self.align { Activity::Alignment } else { Activity::Polarity };
        }
        spreads::check(&self.vary, &prepared, self.uncertainty.is_asked())?;
        prepared.request.varied.clone_from(&self.vary);
        let kinds = kinds::check(&self.by_label, &prepared, &data, !self.vary.is_empty())?;
        let mut out = out.begin()?;
        let folder = out.path().to_owned();
        let mut kept = Kept::open(out.folder(), ("infer", "replicates"), &self.replicates, (run, &data))?;
        let told_apart = kinds.map_or(Ok(()), |kinds| prepared.distinguish(kinds, &data));
        let understood = told_apart.and_then(|()| prepared.understand(&mut |state| progress.tell(state)));
        measurement::caution(&prepared, run);
        let fitted = understood.and_then(|()| prepared.infer(&mut |state| progress.tell(state)));
        let answered = fitted.and_then(|(result, tracked)| {
            let answers = self.uncertainty.ask(&prepared, &result, &mut kept, &mut progress)?;
            Ok((result, tracked, answers))
        });
        progress.finish();
        let answered = answered.map_err(|error| with_location(&prepared, error, &self.snapshots));
        if kept.is_part() {
            return kept.finish_part(answered.map(|_| ()), (run, out), &progress);
        }
        let (result, tracked, answers) = answered.map_err(|failure| kept.failed(failure))?;
        kept.caution(run);
        let doubts = words::doubts(&result, &answers.profiles, prepared.request.method);
        doubts.iter().for_each(|(_, doubt)| run.warn(doubt));
        let caution = tracked.as_ref().and_then(|tracked| activity::caution(&result, tracked));
        caution.into_iter().for_each(|caution| run.warn(caution));
        spreads::cautions(&result).into_iter().for_each(|caution| run.warn(caution));
        arrays::write(&mut out, "", &data, &prepared, &result)?;
        super::fit::spreads::write(&mut out, "", &data, &prepared, &result)?;
        latent::write(&mut out, &data, &prepared, &result)?;
        self.export.write(&mut out, &data, || export::frames(&prepared, &result))?;
        let movie = views::movie(&prepared, &result, &data);
        self.movie.write(&mut out, movie.as_ref(), run)?;
        let followed = prepared.tracks.as_ref().zip(tracked.as_ref());
        if let Some((movie, tracked)) = followed {
            tracks::write(&mut out, "", &data, (&prepared, movie), tracked)?;
        }
        let foreseen = match &tracked {
            Some(tracked) => tracked.prospects.clone(),
            None => prospects(&prepared.observations, &prepared.request, &result).ok().flatten(),
        };
        let told = followed.map(|(movie, tracked)| {
            (tracks::report(&prepared, movie, &result, tracked), activity::report(&data, &prepared, tracked))
        });
        let report = report::report(
            (run, &data, self.snapshots.stated(&data)),
            &prepared,
            &result,
            (&answers, foreseen.as_ref()),
            told,
        );
        let page = page::page(&self, &data, (&prepared, &result), &report, &answers, movie.as_ref())?;
        let summary = summary::summary(&report, &folder);
        out.end_run();
        let answer = Answer::of(result.is_acceptable());
        let rendered = Rendered::with_page(out, &report, page, summary)?.with_answer(answer);
        progress.heed().map_err(|failure| kept.failed(failure))?;
        Ok(rendered.shown(self.open_report))
    }
}
