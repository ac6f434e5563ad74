//! `voronudge phase-diffusion`: how deformations of a pattern of cells relax.

mod page;
mod pattern;
mod report;

use crate::arguments::{CommonArguments, DataSetArguments};
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::{Args, ValueEnum};
use pattern::TrackedPattern;
use std::path::PathBuf;
use voronudge_infer::phase_diffusion::{
    Fluctuations, PhaseRequest, RateOrder, ReferencePlaces, phase_diffusion,
};
use voronudge_io::FrameSelection;
use voronudge_report::PhaseDiffusionReport;

/// Residuals of consecutive frames that correlate by more than this are not independent.
const CORRELATED: f64 = 0.3;

/// Measures the phase diffusivities of a slowly deforming periodic pattern of cells, such as convection cells:
/// compression, shear, and their chiral counterparts.
///
/// Writes report.json and report.html.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Frames to use, at least three, counted from zero: `4..16` (end excluded) or `4,7,9` [default: all].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    /// Positions at which the pattern is at rest: .npy file of shape (cells, 2), with y as in the data set [default:
    /// a constant displacement is fitted].
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// Number of wave vectors, 1 to 1000, the longest waves first. Waves of equal length are all used.
    #[arg(long, value_name = "NUMBER", default_value_t = 12, allow_negative_numbers = true)]
    wave_vectors: usize,
    /// Highest power of the wave vector in the relaxation rates.
    #[arg(long, value_enum, default_value_t = Order::Second)]
    order: Order,
    /// What causes the residuals.
    #[arg(long, value_enum, default_value_t = Cause::Measurement)]
    fluctuations: Cause,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Order {
    /// q²: the phase diffusion equation.
    Second,
    /// q² and q⁴, for waves that are not very long compared with the cells.
    Fourth,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Cause {
    /// Measurement errors about a smooth relaxation.
    Measurement,
    /// Random forces that keep the pattern moving.
    Driving,
}

/// Wave vectors whose rates are fitted in one dense problem.
const MOST_WAVE_VECTORS: usize = 1000;

impl Arguments {
    fn request(&self) -> Result<PhaseRequest, Failure> {
        if self.wave_vectors == 0 {
            return Err(
                Failure::new("--wave-vectors is 0, but at least one is needed").with_hint("12 is usual")
            );
        }
        if self.wave_vectors > MOST_WAVE_VECTORS {
            return Err(Failure::new(format!(
                "--wave-vectors is {}, but {MOST_WAVE_VECTORS} are the most",
                self.wave_vectors
            ))
            .with_hint("12 is usual"));
        }
        Ok(PhaseRequest {
            wave_vectors: self.wave_vectors,
            order: match self.order {
                Order::Second => RateOrder::Second,
                Order::Fourth => RateOrder::Fourth,
            },
            fluctuations: match self.fluctuations {
                Cause::Measurement => Fluctuations::Measurement,
                Cause::Driving => Fluctuations::Driving,
            },
            reference: if self.reference.is_some() { ReferencePlaces::Given } else { ReferencePlaces::Free },
        })
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "phase-diffusion";
    type Report = PhaseDiffusionReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let request = self.request()?;
        let data = self.data.load()?;
        let place = self.data.positions_file().display().to_string();
        let frames = match &self.frames {
            Some(selection) => {
                selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(&place))?
            }
            None => (0..data.frames()).collect(),
        };
        let out = self.common.reserve(&data.inputs)?;
        let tracked = TrackedPattern::new(&data, &frames, self.reference.as_deref())
            .map_err(|failure| failure.at(&place))?;
        let out = out.begin()?;
        let present = data.cells();
        if tracked.cells.len() < present {
            run.warn(format!(
                "{} of {present} cells are missing from a frame and are left out",
                present - tracked.cells.len()
            ));
        }
        let found =
            phase_diffusion(&tracked.pattern, &request).map_err(|error| Failure::from(error).at(&place))?;
        match (request.fluctuations, found.residual_correlation) {
            (Fluctuations::Measurement, r) if r > CORRELATED => run.warn(format!(
                "residuals of consecutive frames correlate by {r:.2}, so they are not independent errors of measurement: the standard errors are too \
                 small; try --fluctuations driving, --order fourth, fewer --wave-vectors, or frames of smaller displacements"
            )),
            (Fluctuations::Driving, r) if r < -CORRELATED => run.warn(format!(
                "residuals of consecutive frames correlate by {r:.2}, as errors of measurement make them: rates are overestimated; try \
                 --fluctuations measurement"
            )),
            _ => {}
        }
        let report = report::report(run, &data, &request, &tracked, &frames, &found);
        let title = self.data.dataset.as_ref().map_or(place, |folder| folder.display().to_string());
        let page = page::page(&title, &report, &found);
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}
