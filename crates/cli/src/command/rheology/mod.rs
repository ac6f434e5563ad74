//! `voronudge rheology`: the moduli of a fitted tissue, with what the fit does not know.

mod measure;
mod page;
mod posterior;

use crate::arguments::CommonArguments;
use crate::command::moduli::protocol::ProtocolArguments;
use crate::command::simulate::{Start, StartArguments};
use crate::failure::Failure;
use crate::memory::{OF_A_STRAINED_CELL, refuse_beyond};
use crate::progress::Progress;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use measure::Work;
use posterior::Posterior;
use std::path::PathBuf;
use std::sync::Mutex;
use voronudge_report::infer_report::InputFile;
use voronudge_report::rheology_report::RheologyReport;
use voronudge_simulate::seed_of_replica;

/// Measures the moduli B, A, μ, Kᵒ, viscosities, and storage and loss moduli that fits of `infer` imply, with
/// intervals that include the errors of the parameters.
///
/// Writes report.json and report.html. Times and rates are in units of 1/K_P, frequencies in those of the data.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Reports of `infer`, or folders that hold them; several reports in temporal order.
    #[arg(required = true, value_name = "REPORT")]
    reports: Vec<PathBuf>,
    /// Time of each report [default: the mean of its frames].
    #[arg(long, value_name = "TIME", num_args = 1.., allow_negative_numbers = true)]
    times: Vec<f64>,
    /// Number of tissues to simulate at each choice of parameters, 2 to 1000.
    #[arg(long, default_value_t = 8, allow_negative_numbers = true)]
    replicas: u64,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    protocol: ProtocolArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Replicas that nobody means.
const MOST_REPLICAS: u64 = 1000;

impl Reporting for Arguments {
    const NAME: &'static str = "rheology";
    type Report = RheologyReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        self.protocol.check()?;
        if !(2..=MOST_REPLICAS).contains(&self.replicas) {
            return Err(Failure::new(format!(
                "--replicas is {}, but it must be from 2 to {MOST_REPLICAS}",
                self.replicas
            ))
            .with_hint("8 is usual"));
        }
        if !self.start.is_random() {
            return Err(Failure::new(format!("--start {}: tissues start at random here", self.start.name()))
                .with_hint("leave --start out; `voronudge moduli` takes others"));
        }
        if !(self.times.is_empty() || self.times.len() == self.reports.len()) {
            return Err(Failure::new(format!(
                "{} times for {} reports",
                self.times.len(),
                self.reports.len()
            ))
            .with_hint("give one of --times for each report, or none"));
        }
        if let Some(time) = self.times.iter().find(|time| !time.is_finite()) {
            return Err(Failure::new(format!("--times holds {time}, but times must be finite"))
                .with_hint("give one number for each report"));
        }
        let fits = self.reports.iter().map(|path| Posterior::read(path)).collect::<Result<Vec<_>, _>>()?;
        for (fit, label) in fits.iter().filter_map(|fit| Some((fit, fit.label?))) {
            run.warn(format!(
                "{}: moduli are those of a tissue of cells of label {label} alone; for all kinds together see moduli --label-parameter",
                fit.path.display()
            ));
        }
        for (fit, sentence) in fits.iter().filter_map(|fit| Some((fit, fit.misfit.as_ref()?))) {
            run.warn(format!("{}: the fit says of itself: {sentence}", fit.path.display()));
        }
        let units = fits[0].units.clone();
        if let Some(other) = fits.iter().find(|fit| fit.units != units) {
            return Err(Failure::new(format!(
                "in units of {} and {}, but the first report in {} and {}",
                other.units.length, other.units.time, units.length, units.time
            ))
            .at(other.path.display())
            .with_hint("fit all data in the same units"));
        }
        let seeds: Vec<u64> =
            (0..self.replicas).map(|replica| seed_of_replica(self.common.seed, replica)).collect();
        let starts: Vec<Start> =
            seeds.iter().map(|&seed| Start::of(&self.start, seed, 1)).collect::<Result<_, _>>()?;
        let cells = starts[0].positions.len();
        refuse_beyond(format!("moduli of {cells} cells"), cells, OF_A_STRAINED_CELL)?;
        let area = starts[0].cell_box.area() / cells as f64;
        if (area - 1.0).abs() > 1e-9 {
            return Err(Failure::new(format!("--box gives each cell the area {area}, but here it is 1"))
                .with_hint("leave --box out: the fit tells the size of the cells"));
        }
        let out = self.common.output(fits.iter().map(|fit| fit.input.path.as_path()))?;
        let progress = Mutex::new(Progress::new(self.common.verbosity()));
        let work = Work { starts: &starts, arguments: &self.protocol, progress: &progress };
        let mut fitted = Vec::new();
        for (k, fit) in fits.iter().enumerate() {
            let name =
                if fits.len() > 1 { format!("fit {} of {}", k + 1, fits.len()) } else { "fit".to_owned() };
            let at = self.times.get(k).copied().unwrap_or(fit.frame);
            fitted.push(work.fitted(fit, at, &name)?);
        }
        if let Ok(shown) = progress.lock() {
            shown.finish();
        }
        if fitted.iter().any(|fit| fit.at_rest > 0 && fit.flowing > 0) {
            run.warn("some tissues of one fit came to rest and others flow: it is close to the transition, and means over both say little");
        }
        let mut record = run.record(None);
        record.inputs = (fits.iter())
            .map(|fit| InputFile {
                path: fit.input.path.display().to_string(),
                sha256: fit.input.sha256.clone(),
            })
            .collect();
        let against = if self.times.is_empty() { "frame" } else { "time" };
        let report = RheologyReport { run: record, units, cells, seeds, against, fits: fitted };
        let page = page::page(&report);
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}
