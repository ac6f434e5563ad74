//! `import flow`: a dense optical flow, or tables of vectors on a grid.

use super::ScaleArguments;
use super::notes::{records, told};
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;
use voronudge_io::{DataSet, FlowColumnNames, FlowOptions, FlowSummary, import_flow};
use voronudge_report::infer_report::RunRecord;
use voronudge_report::shape_report::NoteRecord;

/// More grid points in a frame than the cells of any tissue need.
const MANY_POINTS: usize = 100_000;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Arrays of shape (ny, nx, 2) or (frames, ny, nx, 2), .npy, or tables with the columns x, y, u, v. If there are
    /// several files, each is one frame.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    scale: ScaleArguments,
    /// Side of the squares over which an array is averaged, in units of length after scaling; not for tables
    /// [default: one pixel].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    grid_spacing: Option<f64>,
    /// Positions of the cells, .npy, in units of length after scaling, which complete the data set.
    #[arg(long, value_name = "FILE")]
    positions: Option<PathBuf>,
    /// Name of the column with the frame number, for tables [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    frame_column: Option<String>,
    /// Name of the column with x [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    x_column: Option<String>,
    /// Name of the column with y [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    y_column: Option<String>,
    /// Name of the column with the displacement along x [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    u_column: Option<String>,
    /// Name of the column with the displacement along y [default: recognised by common names].
    #[arg(long, value_name = "NAME")]
    v_column: Option<String>,
    /// Name of the mask column: vectors whose mask is not 0 are left out [default: `mask`, if there is one].
    #[arg(long, value_name = "NAME")]
    mask_column: Option<String>,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    run: RunRecord,
    /// Number of frames.
    frames: usize,
    /// Number of the first frame if a table has a column of frames, otherwise 0.
    first_frame: i64,
    /// Number of grid points along y.
    rows: usize,
    /// Number of grid points along x.
    columns: usize,
    /// Distance between grid points along x and y, in units of length.
    spacing: [f64; 2],
    /// Number of grid points without a vector, summed over frames.
    missing_points: usize,
    /// Number of cells; `null` if their positions were not given.
    cells: Option<usize>,
    /// What was read from the files, what was guessed, and what is doubtful.
    notes: Vec<NoteRecord>,
}

impl Reporting for Arguments {
    const NAME: &'static str = "import";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let out = self.common.reserve(self.files.iter().chain(&self.positions))?;
        let scale = self.scale;
        let is_scaled = scale.image.pixel_size.is_some() || scale.image.frame_interval.is_some();
        let options = FlowOptions {
            columns: FlowColumnNames {
                frame: self.frame_column,
                x: self.x_column,
                y: self.y_column,
                u: self.u_column,
                v: self.v_column,
                mask: self.mask_column,
            },
            boundary: scale.boundary(),
            scale: scale.image.scale(),
            grid_spacing: self.grid_spacing,
            positions: self.positions,
        };
        let import = import_flow(&self.files, &options)?;
        let mut out = out.begin()?;
        warn(run, &import.summary, is_scaled);
        let understood = told(run, &import.notes);
        import.save(&mut out)?;
        let summary = &import.summary;
        let report = Report {
            run: run.record(Some(&import.dataset)),
            frames: summary.frames,
            first_frame: summary.first_frame,
            rows: summary.rows,
            columns: summary.columns,
            spacing: summary.spacing,
            missing_points: summary.missing,
            cells: import.is_complete().then(|| import.dataset.cells()),
            notes: records(&import.notes),
        };
        let mut text = describe(summary, &import.dataset) + &understood;
        text += &format!("written to {}\n", out.path().display());
        if !import.is_complete() {
            let there = out.path().join("positions.npy").exists();
            let what = if there {
                "positions.npy stays as it was, it must be"
            } else {
                "still missing: positions.npy"
            };
            let (unit, y_axis) = (&import.dataset.length_unit, import.dataset.y_axis);
            text += &format!("{what} of shape ({}, cells, 2), in {unit} with y {y_axis}\n", summary.frames);
        }
        Rendered::new(out, &report, text)
    }
}

fn warn(run: &mut Run, summary: &FlowSummary, is_scaled: bool) {
    let points = summary.rows * summary.columns;
    if points > MANY_POINTS {
        run.warn(format!(
            "{points} grid points in a frame are more than cells need; --grid-spacing averages over squares"
        ));
    }
    let unit = summary.stated_unit.as_deref().unwrap_or("px");
    if is_scaled && !unit.to_lowercase().contains("px") && !unit.to_lowercase().contains("pix") {
        run.warn(format!(
            "the table gives displacements in {unit}, but they were taken for pixels per frame and scaled"
        ));
    }
}

fn describe(summary: &FlowSummary, data: &DataSet) -> String {
    // Single precision leaves out the digits that rounding made.
    let [x, y] = summary.spacing.map(|spacing| spacing as f32);
    format!(
        "{} frames of {} × {} grid points, {x} × {y} {} apart ({} without a velocity)\n",
        summary.frames, summary.columns, summary.rows, data.length_unit, summary.missing
    )
}
