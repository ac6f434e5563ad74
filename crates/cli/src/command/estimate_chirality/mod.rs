//! `voronudge estimate-chirality`: α from the velocities across and along a channel.

mod line;
mod page;

pub(crate) use line::{Tissue, slope};

use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::{Args, ValueEnum};
use serde_json::Value;
use std::path::{Path, PathBuf};
use voronudge_infer::{Intercept, LinePoint};
use voronudge_io::{FlowProfile, read_flow_profile};
use voronudge_report::Units;
use voronudge_report::channel_report::ChiralityReport;
use voronudge_simulate::measure::Estimate;

/// Estimates the chirality from the flow in a channel, by the slope of v_y against v_x.
///
/// Writes report.json and report.html.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder written by `channel`, or a table with the columns x (distance from the edge), v_x, v_y and, if known,
    /// the standard errors v_x_error and v_y_error.
    #[arg(value_name = "PROFILES")]
    profiles: PathBuf,
    /// Preferred perimeter in cell sizes, P_0/l_0 [default: that of the folder; otherwise unknown].
    #[arg(long, value_name = "P_0/l_0", allow_negative_numbers = true)]
    shape_index: Option<f64>,
    /// Area elasticity K_A l_0^2/K_P, dimensionless [default: that of the folder; otherwise 0].
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    area_elasticity: Option<f64>,
    /// Leave out positions nearer to the edge than this [default: in a folder, where cells are born; otherwise 0].
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    from: Option<f64>,
    /// Leave out positions farther from the edge than this [default: none].
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Intercept of the line at v_x = 0: zero by symmetry, or free for velocities with an offset.
    #[arg(long, value_enum, default_value_t = InterceptName::Zero)]
    intercept: InterceptName,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InterceptName {
    /// The line passes through the origin.
    Zero,
    /// The intercept is fitted.
    Free,
}

/// What a folder of `channel` says of its tissue.
#[derive(Default)]
struct Known {
    shape_index: Option<f64>,
    area_elasticity: Option<f64>,
    from: Option<f64>,
    units: Option<Units>,
}

/// Share of the flow along the channel below which there is none across.
const NO_FLOW: f64 = 1e-9;

impl Reporting for Arguments {
    const NAME: &'static str = "estimate-chirality";
    type Report = ChiralityReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let (table, known) = if self.profiles.is_dir() {
            (self.profiles.join("folded_profile.csv"), known(&self.profiles.join("report.json")))
        } else {
            (self.profiles.clone(), Known::default())
        };
        for (name, value) in [
            ("--shape-index", self.shape_index),
            ("--area-elasticity", self.area_elasticity),
            ("--from", self.from),
            ("--to", self.to),
        ] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value >= 0.0)) {
                return Err(Failure::new(format!(
                    "{name} is {value}, but it must be finite and not negative"
                ))
                .with_hint("leave it out for the default"));
            }
        }
        let profile = read_flow_profile(&table)?;
        let range = [self.from.or(known.from), self.to];
        let (intercept, intercept_kind) = match self.intercept {
            InterceptName::Zero => (Intercept::Zero, "zero"),
            InterceptName::Free => (Intercept::Free, "free"),
        };
        let tissue = Tissue {
            shape_index: self.shape_index.or(known.shape_index),
            area_elasticity: self.area_elasticity.or(known.area_elasticity).unwrap_or(0.0),
        };
        let points = points(&profile);
        let largest = |of: fn(&LinePoint) -> f64| points.iter().map(|(_, p)| of(p).abs()).fold(0.0, f64::max);
        let [across, along] = [largest(|p| p.x), largest(|p| p.y)];
        if across <= NO_FLOW * along {
            return Err(Failure::new(format!("v_x is at most {across:e} beside a v_y of up to {along:e}, so there is no flow across to compare with"))
                .at(table.display())
                .with_hint("are the columns of the table the right ones?"));
        }
        let line = slope(&points, range, intercept, tissue)?.ok_or_else(|| {
            Failure::new(format!("the velocities tell no slope of v_y against v_x in {} rows", points.len()))
                .at(table.display())
                .with_hint("at least three rows are needed within --from and --to, with velocities larger than their errors")
        })?;
        let out = self.common.output([&table])?;
        if profile.errors.is_none() {
            run.warn("the table has no errors (v_x_error, v_y_error): both velocities count alike, and the interval is from the scatter");
        }
        if let Some(chi_square) = line.reduced_chi_square.filter(|chi_square| *chi_square > 3.0) {
            run.warn(format!(
                "v_y is not proportional to v_x within the errors (chi square {chi_square:.1} per degree of freedom); the interval is \
                 widened by that, but alpha may be off by more"
            ));
        }
        let mut record = run.record(None);
        record.inputs = vec![voronudge_report::infer_report::InputFile {
            path: profile.input.path.display().to_string(),
            sha256: profile.input.sha256.clone(),
        }];
        let report = ChiralityReport { run: record, line, intercept_kind };
        let title = self.profiles.display().to_string();
        let page = page::page(&title, &points, &report, known.units.as_ref());
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}

/// Points of the line from averages at distances from the edge; without errors if one is unknown.
pub(crate) fn line_points(distances: &[f64], velocity: &[Vec<Estimate>; 2]) -> Vec<(f64, LinePoint)> {
    let pairs = || velocity[0].iter().zip(&velocity[1]);
    let known = pairs().all(|(x, y)| x.error.is_some() && y.error.is_some());
    let errors =
        |x: &Estimate, y: &Estimate| known.then_some(()).and(x.error).zip(y.error).map(|(x, y)| [x, y]);
    let point = |(x, y): (&Estimate, &Estimate)| LinePoint { x: x.value, y: y.value, errors: errors(x, y) };
    distances.iter().copied().zip(pairs().map(point)).collect()
}

fn points(profile: &FlowProfile) -> Vec<(f64, LinePoint)> {
    let [v_x, v_y] = &profile.velocity;
    let errors = |row: usize| profile.errors.as_ref().map(|errors| [errors[0][row], errors[1][row]]);
    let point = |row: usize| LinePoint { x: v_x[row], y: v_y[row], errors: errors(row) };
    profile.x.iter().enumerate().map(|(row, x)| (*x, point(row))).collect()
}

/// What the report of `channel` says; nothing where there is none.
fn known(report: &Path) -> Known {
    let read = || -> Option<Value> { serde_json::from_str(&std::fs::read_to_string(report).ok()?).ok() };
    let Some(json) = read() else {
        return Known::default();
    };
    let number = |pointer: &str| json.pointer(pointer).and_then(Value::as_f64);
    let text = |pointer: &str| Some(json.pointer(pointer)?.as_str()?.to_owned());
    let size = number("/cell_size");
    let per = |value: Option<f64>, unit: Option<f64>| value.zip(unit).map(|(value, unit)| value / unit);
    let square = size.map(|size| size * size);
    Known {
        shape_index: per(number("/parameters/P_0"), size),
        area_elasticity: per(number("/parameters/K_A"), number("/parameters/K_P"))
            .zip(square)
            .map(|(ratio, square)| ratio * square),
        from: number("/chirality_from_flow/range/0"),
        units: text("/units/length").zip(text("/units/time")).map(|(length, time)| Units { length, time }),
    }
}
