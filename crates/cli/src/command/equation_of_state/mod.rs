//! `voronudge equation-of-state`: pressure and torques of uniform tissues against their density.

mod measure;
mod page;
mod read;

pub(crate) use read::{MeasuredEquation, read};

use crate::arguments::{CommonArguments, ParameterArguments, Range, positive};
use crate::failure::Failure;
use crate::memory::{OF_A_SIMULATED_CELL, refuse_beyond};
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use measure::Request;
use ndarray::Array2;
use voronudge_report::EquationOfStateReport;
use voronudge_report::equation_of_state_report::{Measured, UniformRecord};

/// Measures the pressure, torques and moduli of uniform tissues as functions of their density.
///
/// Runs the model in periodic boxes at several densities. Writes each quantity as a .npy file of shape (densities, 2)
/// with value and standard error, report.json and report.html; `channel --equation-of-state` predicts flows from
/// them.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Densities, three or more, in units of 1/ℓ₀² with the cell size ℓ₀ of --cell-size: first, last, number of
    /// values.
    #[arg(long, num_args = 3, value_names = ["FROM", "TO", "COUNT"], default_values_t = [0.8, 1.6, 17.0], allow_negative_numbers = true)]
    density: Vec<f64>,
    /// Cell size ℓ₀ that densities are relative to, in the unit of length of the parameters.
    #[arg(long, value_name = "SIZE", default_value_t = 1.0, allow_negative_numbers = true)]
    cell_size: f64,
    /// Number of cells in each run, in a square box.
    #[arg(long, default_value_t = 400, allow_negative_numbers = true)]
    cells: usize,
    /// Number of runs at each density, at least two, each from different random positions.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true)]
    replicas: usize,
    /// Time before averaging begins [default: 20/K_P].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    relaxation: Option<f64>,
    /// Averaging time [default: 20/K_P].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    time: Option<f64>,
    /// Largest time step [default: at each density the one recommended there].
    #[arg(long, allow_negative_numbers = true)]
    dt: Option<f64>,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Replicas that nobody means.
const MOST_REPLICAS: usize = 1000;

impl Arguments {
    fn request(&self) -> Result<Request, Failure> {
        let parameters = self.parameters.resolve()?;
        if parameters.perimeter_elasticity <= 0.0 {
            return Err(Failure::new(format!(
                "K_P is {}, but it must be above zero: it sets the unit of time",
                parameters.perimeter_elasticity
            ))
            .with_hint("give --K_P above zero"));
        }
        let densities =
            Range::new("density", &self.density, "0.8 1.6 17: seventeen densities, 0.05 apart")?.values();
        if densities.len() < 3 || densities[0] <= 0.0 {
            return Err(Failure::new(format!(
                "--density has {} values from {} on, but three or more are needed, above zero",
                densities.len(),
                densities[0]
            ))
            .with_hint("moduli are slopes between densities: write for example --density 0.8 1.6 17"));
        }
        for (name, count, least, most) in
            [("replicas", self.replicas, 2, MOST_REPLICAS), ("cells", self.cells, 1, usize::MAX)]
        {
            if !(least..=most).contains(&count) {
                return Err(Failure::new(format!("--{name} is {count}, but {least} is the least"))
                    .with_hint(format!("leave --{name} out for the default; {most} is the most")));
            }
        }
        let threads = rayon::current_num_threads();
        refuse_beyond(
            format!("{threads} runs of {} cells at a time", self.cells),
            self.cells.saturating_mul(threads),
            OF_A_SIMULATED_CELL,
        )?;
        let unit_time = 20.0 / parameters.perimeter_elasticity;
        let relaxation = self.relaxation.unwrap_or(unit_time);
        if !(relaxation.is_finite() && relaxation >= 0.0) {
            return Err(Failure::new(format!("--relaxation is {relaxation}, but it must be a time"))
                .with_hint("leave --relaxation out for the default"));
        }
        Ok(Request {
            parameters,
            cell_size: positive("--cell-size", self.cell_size)?,
            densities,
            cells: self.cells,
            replicas: self.replicas,
            times: [relaxation, positive("--time", self.time.unwrap_or(unit_time))?],
            time_step: self.dt.map(|dt| positive("--dt", dt)).transpose()?,
            seed: self.common.seed,
        })
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "equation-of-state";
    type Report = EquationOfStateReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let request = self.request()?;
        let work = request.work()?;
        let mut out = self.common.output(self.parameters.file())?;
        request.doubts().into_iter().for_each(|doubt| run.warn(doubt));
        let states = work.measure(self.common.verbosity())?;
        let (points, doubts) = request.points(&states)?;
        doubts.into_iter().for_each(|doubt| run.warn(doubt));
        let report = request.report(run, points);
        write_arrays(&mut out, &report)?;
        let page = page::page(&report, &request);
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}

/// A number of a uniform tissue.
type Quantity = fn(&UniformRecord) -> Measured;

fn write_arrays(
    out: &mut voronudge_io::OutputDirectory,
    report: &EquationOfStateReport,
) -> Result<(), Failure> {
    let density: ndarray::Array1<f64> = report.points.iter().map(|point| point.density).collect();
    out.write_array("density.npy", density.view())?;
    let arrays: [(&str, Quantity); 6] = [
        ("pressure.npy", |point| point.pressure),
        ("torque.npy", |point| point.torque),
        ("shape_index.npy", |point| point.shape_index),
        ("mean_square_velocity.npy", |point| point.mean_square_velocity),
        ("bulk_modulus.npy", |point| point.bulk_modulus),
        ("odd_bulk_modulus.npy", |point| point.odd_bulk_modulus),
    ];
    for (name, of) in arrays {
        let array = Array2::from_shape_fn((report.points.len(), 2), |(row, column)| {
            let Measured { value, error } = of(&report.points[row]);
            [value, error][column]
        });
        out.write_array(name, array.view())?;
    }
    Ok(())
}
