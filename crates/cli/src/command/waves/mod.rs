//! `voronudge waves`: how waves of a tissue fluctuate and relax.

mod arrays;
mod beside;
mod figures;
mod page;
mod report;

use crate::arguments::{CommonArguments, ParameterArguments};
use crate::command::recorded::{Recorded, RecordingArguments, Velocities};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use beside::Beside;
use clap::{Args, ValueEnum};
use voronudge_geometry::Domain;
use voronudge_observables::{FluctuationRequest, Fluctuations, Plan, WaveField, fluctuations};
use voronudge_report::Units;
use voronudge_report::WavesReport;

/// Measures odd waves from fluctuations: the dynamic structure factor of a recording, and the matrix D(q) by which
/// its waves relax, compared with that of a model.
///
/// Writes report.json, report.html, dynamical_matrix.npy and dynamic_structure_*.npy.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recording: RecordingArguments,
    /// Field that is resolved into waves.
    #[arg(long, value_enum, default_value_t = Field::Auto)]
    field: Field,
    /// First lag, in frames, from which covariances are used [default: the first that localisation errors without
    /// memory do not affect].
    #[arg(long, value_name = "FRAMES")]
    first_lag: Option<usize>,
    /// Further lag, in frames, over which the relaxation of waves is measured [default: about half a relaxation time
    /// of each shell].
    #[arg(long, value_name = "FRAMES")]
    lag: Option<usize>,
    /// Largest wave number, in units of the inverse mean spacing of the cells.
    #[arg(long, value_name = "NUMBER", default_value_t = 3.0, allow_negative_numbers = true)]
    largest_wave_number: f64,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Field {
    /// Displacements if cells keep their places, else velocities.
    Auto,
    /// Displacements from the mean positions of the cells.
    Displacements,
    /// Velocities at the current positions of the cells.
    Velocities,
}

impl Arguments {
    fn request(&self) -> Result<FluctuationRequest, Failure> {
        let largest = self.largest_wave_number;
        if !(largest.is_finite() && largest > 0.0) {
            return Err(Failure::new(format!(
                "--largest-wave-number is {largest}, but it must be finite and above zero"
            ))
            .with_hint("3 reaches waves of two spacings; neighbours are at about 6"));
        }
        if self.lag == Some(0) {
            return Err(Failure::new("--lag is 0, but waves relax over one frame at least")
                .with_hint("leave it out for about half a relaxation time"));
        }
        Ok(FluctuationRequest {
            field: match self.field {
                Field::Auto => None,
                Field::Displacements => Some(WaveField::Displacements),
                Field::Velocities => Some(WaveField::Velocities),
            },
            first_lag: self.first_lag,
            lag: self.lag,
            largest,
        })
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "waves";
    type Report = WavesReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        self.recording.check()?;
        let request = self.request()?;
        let parameters = self.parameters.is_given().then(|| self.parameters.resolve()).transpose()?;
        let data = self.recording.data.load()?;
        let place = self.recording.location();
        let frames = self.recording.frames(&data)?;
        let inputs = data.inputs.iter().map(AsRef::as_ref).chain(self.parameters.file());
        let out = self.common.reserve(inputs)?;
        let recorded = self.recording.record(&data, &frames)?;
        let at = |error| Failure::from(error).at_unless_interrupted(&place);
        let plan = Plan::of(&recorded.recording).map_err(at)?;
        let mut out = out.begin()?;
        let mut progress = Progress::new(self.common.verbosity());
        let mut tell =
            |stage: &'static str, done: usize, all: usize| progress.step(stage, done as u64, all as u64);
        let found = fluctuations(&recorded.recording, &plan, &request, &mut tell).map_err(at)?;
        let beside = match &parameters {
            Some(parameters) => {
                Beside::new(&recorded.recording, &plan, &found, parameters, &mut |done, all| {
                    progress.step("Jacobian", done as u64, all as u64)
                })?
            }
            None => Beside::nothing(&found),
        };
        progress.finish();
        let units = Units { length: data.length_unit.clone(), time: data.time_unit.clone() };
        let linear = report::linear(&found);
        warn(run, &recorded, &found, linear);
        arrays::write(&mut out, &found, &beside)?;
        let report = report::report(
            run.record(Some(&data)),
            &units,
            &frames,
            (&recorded, &plan),
            (&found, &beside),
            linear,
        );
        let title = self.recording.title();
        let page = page::page(&title, &report, (&found, &beside));
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}

/// What the reader should know before using the numbers.
fn warn(
    run: &mut Run,
    Recorded { recording, velocities, .. }: &Recorded,
    found: &Fluctuations,
    linear: Option<f64>,
) {
    let told = || found.shells.iter().filter_map(|shell| shell.relaxation.as_ref());
    if told().next().is_none() {
        run.warn(
            "covariances of no shell are those of a relaxation: frames may be too far apart, or too few",
        );
    }
    let few = told().filter(|own| !own.is_reliable()).count();
    if few > 0 {
        run.warn(format!(
            "the recording is too short for {few} of {} shells, with fewer than eight times of the slowest relaxation: their rates and errors cannot be relied on, and are left out of moduli and verdicts",
            found.shells.len()
        ));
    }
    if recording.frames().iter().any(|frame| frame.tessellation.domain() == Domain::Open) {
        run.warn(
            "waves are seen through a window, whose tapers mix them with others: rates of waves longer than some fifth of the window can be off by a factor of two, and moduli are not told",
        );
    }
    if linear.is_some_and(|p| p < report::NOT_LINEAR) {
        run.warn(
            "waves do not relax linearly and without memory: D(q) depends on the lag, and is a rate at this lag only",
        );
    }
    if found.field == WaveField::Velocities && *velocities == Velocities::FromPositions {
        run.warn("velocities are displacements until the next frame; what is faster than frames is not seen");
    }
}
