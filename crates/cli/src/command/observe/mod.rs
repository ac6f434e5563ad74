//! `voronudge observe`: what can be measured on the cells of a data set, whatever moves them.

mod nematic;
mod page;
mod report;

use crate::arguments::{CommonArguments, DataSetArguments};
use crate::boundary::domain_at;
use crate::command::fit::{MeanToRemove, check_largest_area};
use crate::failure::Failure;
use crate::memory::{OF_A_DESCRIBED_CELL, refuse_beyond};
use crate::program::Answer;
use crate::run::Run;
use clap::Args;
use ndarray::{Array2, Array3, Axis};
use nematic::NematicArguments;
use voronudge_geometry::{Domain, FieldOfView, Vector};
use voronudge_io::{DataSet, FrameSelection};
use voronudge_observables::{
    Error, Exchange, Images, Plan, Recording, exchange_statistics, exchanges, observe,
};
use voronudge_report::Units;

/// What is measured on the cells of a data set, seen or simulated: how they move, who is next to whom, shapes, order, correlations and structure factors.
///
/// Fields of view may be open, and tracks may have gaps. Writes report.json, report.html and an array (points, 4) for each function.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Frames to measure: `6`, `4..16`, `4,7,9`; zero-based, end excluded [default: all].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    /// Which motion to remove first: drift of the stage shows as one.
    #[arg(long, value_enum, default_value_t = MeanToRemove::Auto)]
    remove_mean: MeanToRemove,
    /// In an open field of view, polygons larger than this multiple of the median area are taken for holes in the data.
    #[arg(long, value_name = "FACTOR", default_value_t = 3.0, allow_negative_numbers = true)]
    largest_area: f64,
    #[command(flatten)]
    nematic: NematicArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Where velocities come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Velocities {
    Given,
    FromPositions,
    None,
}

/// A recording and how it was made.
struct Recorded {
    recording: Recording,
    velocities: Velocities,
    common_motion_removed: bool,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("observe", &arguments.common)?;
    check_largest_area(arguments.largest_area)?;
    let model = arguments.nematic.model()?;
    let data = arguments.data.load()?;
    let place = arguments.data.positions_file().display().to_string();
    let frames = match &arguments.frames {
        Some(selection) => {
            selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(&place))?
        }
        None => (0..data.frames()).collect(),
    };
    let (cells, count) = (data.cells(), frames.len());
    refuse_beyond(format!("{cells} cells in {count} frames"), cells * count, OF_A_DESCRIBED_CELL)?;
    let inputs = data.inputs.iter().map(AsRef::as_ref).chain(arguments.nematic.parameters_file());
    let out = arguments.common.reserve(inputs)?;
    let recorded = arguments.record(&data, &frames, &place)?;
    let plan = Plan::of(&recorded.recording).map_err(|error| Failure::from(error).at(&place))?;
    let nematic = arguments.nematic.measure(&recorded, &plan, model)?;
    let mut out = out.begin()?;
    if recorded.velocities == Velocities::None {
        run.warn("there are neither velocities nor several frames: nothing is said of motion");
    }
    let mut curves = observe(&recorded.recording, &plan);
    if frames.len() > 1 {
        let all = exchanges(&recorded.recording);
        out.write_array("t1.npy", rows(&all, &data, &frames).view())?;
        curves.extend(exchange_statistics(&recorded.recording, &plan, &all));
    }
    curves.extend(nematic.nematic.curves.iter().cloned());
    nematic.write(&mut out, &data, &frames)?;
    curves.sort_by_key(|curve| curve.of);
    for curve in curves.iter().filter(|curve| !curve.of.is_number()) {
        let table = Array2::from_shape_fn((curve.at.len(), 4), |(row, column)| match column {
            0 => curve.at[row],
            1 => curve.value[row],
            2 => curve.standard_error[row],
            _ => curve.count[row] as f64,
        });
        out.write_array(&format!("{}.npy", curve.of.name()), table.view())?;
    }
    let units = Units { length: data.length_unit.clone(), time: data.time_unit.clone() };
    let report =
        report::report(run.record(Some(&data)), &units, &frames, (&recorded, &plan), (&curves, &nematic));
    let json = serde_json::to_string_pretty(&report)?;
    out.write_text("report.json", &json)?;
    let title = arguments.data.dataset.as_ref().map_or(place, |folder| folder.display().to_string());
    out.write_text(
        "report.html",
        &page::page(&title, &report, &recorded.recording, (&curves, &nematic), &units)?,
    )?;
    let summary = page::summary(&report, out.path());
    run.finish(Some(out), &json, &summary)?;
    Ok(Answer::Positive)
}

/// (transitions, 9): frame, x, y, directions of the contact lost and of the one made in the axes of the data, and the numbers of the cells of both.
fn rows(all: &[Exchange], data: &DataSet, frames: &[usize]) -> Array2<f64> {
    let flip = data.y_sign();
    Array2::from_shape_fn((all.len(), 9), |(row, column)| {
        let own = &all[row];
        match column {
            0 => frames[own.frame] as f64,
            1 => own.position.x,
            2 => flip * own.position.y,
            3 => flip * own.lost_direction,
            4 => flip * own.made_direction,
            5 | 6 => own.lost[column - 5] as f64,
            _ => own.made[column - 7] as f64,
        }
    })
}

impl Arguments {
    fn record(&self, data: &DataSet, frames: &[usize], place: &str) -> Result<Recorded, Failure> {
        let at = |error: Error| match error {
            Error::Tessellation { frame, source } => {
                Failure::from(source).at(format!("{place}, frame {}", frames[frame]))
            }
            other => Failure::from(other).at(place),
        };
        let view = FieldOfView { largest_area: self.largest_area, ..data.view()? };
        let times: Vec<f64> = frames.iter().map(|frame| *frame as f64 * data.frame_interval).collect();
        let domains =
            frames.iter().map(|frame| domain_at(data, *frame)).collect::<Result<Vec<Domain>, Failure>>()?;
        let of_frame = |all: &Array3<f64>, frame: usize| -> Vec<Option<Vector<f64>>> {
            let rows = all.index_axis(Axis(0), frame);
            let vector = |v: ndarray::ArrayView1<'_, f64>| Vector::new(v[0], v[1]);
            rows.rows().into_iter().map(vector).map(|v| (v.x + v.y).is_finite().then_some(v)).collect()
        };
        let all = |array: &Array3<f64>| -> Vec<Vec<Option<Vector<f64>>>> {
            frames.iter().map(|frame| of_frame(array, *frame)).collect()
        };
        let images = if data.unwrapped { Images::Followed } else { Images::Nearest };
        let mut recording =
            Recording::new(&times, all(&data.positions), &domains, &view, images).map_err(at)?;
        let velocities = match &data.velocities {
            Some(given) => {
                recording = recording.with_velocities(&all(given)).map_err(at)?;
                Velocities::Given
            }
            None if frames.len() > 1 => Velocities::FromPositions,
            None => Velocities::None,
        };
        let common_motion_removed = match self.remove_mean {
            MeanToRemove::None => false,
            MeanToRemove::PerFrame => true,
            MeanToRemove::Auto => velocities == Velocities::FromPositions && domains.contains(&Domain::Open),
        };
        if common_motion_removed {
            recording = recording.without_common_motion();
        }
        if velocities == Velocities::FromPositions {
            recording = recording.with_mean_velocities();
        }
        Ok(Recorded { recording, velocities, common_motion_removed })
    }
}
