//! `voronudge evaluate`: the model's fields at given positions.

use crate::arguments::{
    CellArguments, ChosenEffects, CommonArguments, DataSetArguments, EffectArguments, ExportArguments,
    OfCells, ParameterArguments, cell_frame, environment, named,
};
use crate::boundary::domain_at;
use crate::failure::Failure;
use crate::memory::{OF_A_DESCRIBED_CELL, refuse_beyond};
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use ndarray::{Array1, Array2, Array3};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Cursor;
use std::path::Path;
use voronudge_geometry::{Tessellation, Vector, areas, perimeters};
use voronudge_io::{CellFrame, CellValues, DataSet, FrameSelection, OutputDirectory, Snapshot, YAxis};
use voronudge_model::{BlockMatrix, Model, jacobian, stress, velocities};
use voronudge_observables::mean_square_velocity;
use voronudge_report::ModelParameters;
use voronudge_report::infer_report::RunRecord;
use voronudge_report::numbers::significant;

/// Evaluates the model's velocities, areas, perimeters, stress and Jacobian at the positions of a data set.
///
/// Writes velocities.npy, areas.npy, perimeters.npy, stress.npy (force index first) and report.json. With --jacobian,
/// also writes the Jacobian of the first frame chosen: jacobian.npy (2N, 2N; x0, y0, x1, …) for up to 4000
/// coordinates, jacobian.npz (row, column, value) for more.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Frames to evaluate, counted from zero: `6`, `4..16` (end excluded) or `4,7,9` [default: all].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    effects: EffectArguments,
    /// Also write the Jacobian of the velocities with respect to the positions, for the first frame chosen.
    #[arg(long, help_heading = "Output")]
    jacobian: bool,
    #[command(flatten)]
    export: ExportArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Coordinates up to which the Jacobian is written dense.
const DENSE_LIMIT: usize = 4000;

#[derive(Serialize, JsonSchema)]
pub(crate) struct Report {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    run: RunRecord,
    /// Numbers of cells, one entry for each frame.
    cells: Cells,
    /// Parameters of the model as used, in units of the data.
    parameters: ModelParameters,
    /// Values (N) of the parameters in which cells differ, by name, with `--cell-parameter` or `--label-parameter`.
    #[serde(skip_serializing_if = "OfCells::is_empty")]
    cell_parameters: OfCells,
    /// Coefficients of the effects beyond the base model, by name of the effect.
    #[serde(skip_serializing_if = "ChosenEffects::is_empty")]
    effects: ChosenEffects,
    /// Mean stress of each frame, in 1/time, force index first; in an open field of view over the cells that count.
    stress: Vec<[[f64; 2]; 2]>,
    /// Mean square velocity of each frame, in (length/time)², over the cells with a velocity; in an open field of view over those that count.
    mean_square_velocity: Vec<f64>,
}

#[derive(Serialize, JsonSchema)]
struct Cells {
    /// Indices of the frames evaluated, zero-based.
    frames: Vec<usize>,
    /// Number of cells that are present.
    present: Vec<usize>,
    /// Number of cells with a velocity.
    with_velocity: Vec<usize>,
    /// Number of cells that count in sums: in an open field of view, those whose polygon is certain, as are those of their neighbours.
    counted: Vec<usize>,
}

/// One frame's fields.
struct Fields {
    snapshot: Snapshot,
    velocities: Vec<Vector<f64>>,
    areas: Vec<f64>,
    perimeters: Vec<f64>,
    stress: [[f64; 2]; 2],
    /// Cells that count: in an open field, those away from its rim.
    counted: Vec<bool>,
    tessellation: Tessellation,
}

impl Fields {
    /// For other programs.
    fn cells(&self, frame: usize) -> CellFrame {
        let chosen: Vec<(usize, usize)> = self.snapshot.cells.iter().copied().enumerate().collect();
        let counts = self.counted.iter().map(|&counts| f64::from(u8::from(counts))).collect();
        let values = [
            ("counts", CellValues::Numbers(counts)),
            ("velocity", CellValues::Vectors(self.velocities.clone())),
        ];
        cell_frame(frame, (&self.tessellation, &self.snapshot.positions), &chosen, values)
    }
}

impl Reporting for Arguments {
    const NAME: &'static str = "evaluate";
    type Report = Report;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let effects = self.effects.resolve()?;
        let data = self.data.load()?;
        let mut parameters = self.parameters.resolve()?;
        let frames = match &self.frames {
            Some(selection) => selection
                .resolve(data.frames())
                .map_err(|error| Failure::from(error).at(self.data.positions_file().display()))?,
            None => (0..data.frames()).collect(),
        };
        let (cells, count) = (data.cells(), frames.len());
        refuse_beyond(format!("{cells} cells in {count} frames"), cells * count, OF_A_DESCRIBED_CELL)?;
        let first = frames.first().copied().unwrap_or(0);
        let own = self.cells.of_data(&data, first, &mut parameters)?;
        let inputs = data.inputs.iter().map(AsRef::as_ref).chain(self.parameters.file());
        let mut out = self.common.output(inputs.map(Path::to_owned).chain(self.cells.files()))?;
        // Files with y down show the mirror image: inside, y is up, and so is the sense of α.
        let base = Model::chiral_voronoi(&parameters);
        let mut fields = Vec::new();
        for (index, &frame) in frames.iter().enumerate() {
            let place = || format!("{}, frame {frame}", self.data.positions_file().display());
            let domain = domain_at(&data, frame)?;
            let snapshot = Snapshot::new(&data, frame);
            let tessellation = Tessellation::new(&snapshot.positions, domain)
                .map_err(|error| Failure::from(snapshot.in_file_numbers(error)).at(place()))?;
            let view = data.view()?.judge(&tessellation, &snapshot.positions);
            let surroundings = environment(&tessellation, &snapshot.positions, &view)?;
            let labels = data.labels_of(&snapshot, frame);
            let surroundings =
                own.of_cells(surroundings, &snapshot.cells, labels).map_err(|failure| failure.at(place()))?;
            let model = effects.add_to(base.clone(), surroundings, domain)?;
            let moving = velocities(&tessellation, &snapshot.positions, &model);
            if moving.iter().any(|v| v.x.is_infinite() || v.y.is_infinite()) {
                return Err(Failure::new("velocities are too large to be numbers")
                    .at(place())
                    .with_hint("give parameters in units in which lengths and times of cells are about 1"));
            }
            if index == 0 && self.jacobian {
                let matrix = jacobian(&tessellation, &snapshot.positions, &model);
                if frames.len() > 1 {
                    run.warn(format!("the Jacobian is that of frame {frame} only"));
                }
                write_jacobian(&mut out, &matrix, &snapshot, &data)?;
            }
            fields.push(Fields {
                velocities: moving,
                areas: areas(&tessellation, &snapshot.positions),
                perimeters: perimeters(&tessellation, &snapshot.positions),
                stress: oriented(
                    stress(&tessellation, &snapshot.positions, &model, |cell| view.counts(cell)),
                    data.y_axis,
                ),
                counted: (0..snapshot.cells.len()).map(|cell| view.counts(cell)).collect(),
                tessellation,
                snapshot,
            });
        }
        write_fields(&mut out, &data, &fields)?;
        self.export.write(&mut out, &data, || {
            fields.iter().zip(&frames).map(|(own, &frame)| own.cells(frame)).collect()
        })?;
        let finite = |f: &Fields| f.velocities.iter().filter(|v| v.x.is_finite()).count();
        let report = Report {
            run: run.record(Some(&data)),
            cells: Cells {
                present: fields.iter().map(|f| f.velocities.len()).collect(),
                with_velocity: fields.iter().map(finite).collect(),
                counted: fields
                    .iter()
                    .map(|f| f.counted.iter().filter(|counted| **counted).count())
                    .collect(),
                frames,
            },
            parameters: named(&parameters),
            cell_parameters: own.of_data(&data, first),
            effects,
            stress: fields.iter().map(|f| f.stress).collect(),
            mean_square_velocity: fields
                .iter()
                .map(|f| {
                    let counted: Vec<Vector<f64>> = f
                        .velocities
                        .iter()
                        .zip(&f.counted)
                        .filter(|(_, counted)| **counted)
                        .map(|(v, _)| *v)
                        .collect();
                    mean_square_velocity(&counted)
                })
                .collect(),
        };
        let mut summary = String::new();
        for (index, frame) in report.cells.frames.iter().enumerate() {
            let _ = writeln!(
                summary,
                "frame {frame}: {} cells, {} that count, mean square velocity {}",
                report.cells.present[index],
                report.cells.counted[index],
                significant(report.mean_square_velocity[index], 4)
            );
        }
        let _ = writeln!(summary, "written to {}", out.path().display());
        Rendered::new(out, &report, summary)
    }
}

fn write_fields(out: &mut OutputDirectory, data: &DataSet, fields: &[Fields]) -> Result<(), Failure> {
    let vectors = data.vectors_as_given(fields.iter().map(|f| (&f.snapshot, f.velocities.as_slice())));
    out.write_array("velocities.npy", vectors.view())?;
    let scalars = data.scalars_as_given(fields.iter().map(|f| (&f.snapshot, f.areas.as_slice())));
    out.write_array("areas.npy", scalars.view())?;
    let scalars = data.scalars_as_given(fields.iter().map(|f| (&f.snapshot, f.perimeters.as_slice())));
    out.write_array("perimeters.npy", scalars.view())?;
    let stress = Array3::from_shape_fn((fields.len(), 2, 2), |(frame, i, j)| fields[frame].stress[i][j]);
    if data.frames() == 1 {
        out.write_array("stress.npy", stress.index_axis(ndarray::Axis(0), 0))?;
    } else {
        out.write_array("stress.npy", stress.view())?;
    }
    Ok(())
}

/// A tensor in the axes of the files: mixed components change sign where y points down.
fn oriented(tensor: [[f64; 2]; 2], y_axis: YAxis) -> [[f64; 2]; 2] {
    match y_axis {
        YAxis::Up => tensor,
        YAxis::Down => [[tensor[0][0], -tensor[0][1]], [-tensor[1][0], tensor[1][1]]],
    }
}

/// The Jacobian in the numbering and axes of the files. Rows of cells without a velocity are NaN in the dense form and
/// missing in the sparse one.
fn write_jacobian(
    out: &mut OutputDirectory,
    matrix: &BlockMatrix,
    snapshot: &Snapshot,
    data: &DataSet,
) -> Result<(), Failure> {
    let n = 2 * data.cells();
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..matrix.rows() {
        for (column, block) in matrix.row(row) {
            for (k, entry) in block.iter().enumerate() {
                let mirrored = data.y_axis == YAxis::Down && (k == 1 || k == 2);
                rows.push(2 * snapshot.cells[row] + k / 2);
                columns.push(2 * snapshot.cells[column] + k % 2);
                values.push(if mirrored { -entry } else { *entry });
            }
        }
    }
    if n <= DENSE_LIMIT {
        let mut dense = Array2::from_elem((n, n), f64::NAN);
        rows.iter().for_each(|&row| dense.row_mut(row).fill(0.0));
        for ((&row, &column), &value) in rows.iter().zip(&columns).zip(&values) {
            dense[(row, column)] = value;
        }
        out.write_array("jacobian.npy", dense.view())?;
        return Ok(());
    }
    let integers = |indices: Vec<usize>| Array1::from_iter(indices.into_iter().map(|index| index as i64));
    let mut bytes = Cursor::new(Vec::new());
    let failed = |error: ndarray_npy::WriteNpzError| Failure::new(format!("jacobian.npz: {error}"));
    let mut npz = ndarray_npy::NpzWriter::new_compressed(&mut bytes);
    npz.add_array("row", &integers(rows)).map_err(failed)?;
    npz.add_array("column", &integers(columns)).map_err(failed)?;
    npz.add_array("value", &Array1::from(values)).map_err(failed)?;
    npz.add_array("shape", &integers(vec![n, n])).map_err(failed)?;
    npz.finish().map_err(failed)?;
    out.write_bytes("jacobian.npz", bytes.get_ref())?;
    Ok(())
}
