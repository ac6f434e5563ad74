//! Frames to be drawn.

use super::outcome::units;
use crate::command::drawing::borders;
use crate::problem::Problem;
use voronudge_geometry::{CellPolygon, Domain, Vector, Visibility};
use voronudge_infer::{Inference, Observation};
use voronudge_io::DataSet;
use voronudge_observables::vorticities;
use voronudge_report::figure::FlowMap;
use voronudge_report::movie::{CellMovie, chosen};
use voronudge_report::{CellStatus, CellView, ChangedEdges, FrameView, Segment};

/// Frames drawn at most: the first, the middle and the last.
const DRAWN: usize = 3;

/// Places of the frames to be drawn in the list of all.
pub(crate) fn drawn(prepared: &Problem) -> Vec<usize> {
    // From the last frame of tracks nothing moves on.
    let moves = |index: &usize| prepared.tracks.is_none() || is_left(&prepared.observations[*index]);
    let places: Vec<usize> = (0..prepared.frames.len()).filter(moves).collect();
    let count = places.len();
    if count <= DRAWN { places } else { vec![places[0], places[count / 2], places[count - 1]] }
}

/// Whether a cell is known to move from here.
fn is_left(observation: &Observation) -> bool {
    observation.targets().next().is_some()
}

/// Velocities of one frame on their grid, if they are on one.
pub(crate) fn flow_map<'f>(
    prepared: &Problem,
    result: &Inference,
    index: usize,
    frame: &'f FrameView,
) -> Option<FlowMap<'f>> {
    let field = prepared.velocities.flow()?;
    let observation = &prepared.observations[index];
    let [x, y] = field.coordinates();
    let velocity = |v: Vector<f64>| [v.x, v.y];
    Some(FlowMap {
        frame,
        x,
        y,
        measured: (0..observation.velocities.values().len())
            .map(|datum| observation.target(datum).map(|v| velocity(v * prepared.scale.velocity())))
            .collect(),
        predicted: prepared
            .predicted_data(result, index)
            .into_iter()
            .map(|v| Some(velocity(v)).filter(|v| v[0].is_finite()))
            .collect(),
        held_out: result.frames[index]
            .held_out
            .iter()
            .map(|v| v.map(|v| velocity(v * prepared.scale.velocity())))
            .collect(),
    })
}

/// The cells of frames spread over all, as movies show them.
pub(crate) fn movie_frames(prepared: &Problem, result: &Inference, data: &DataSet) -> Vec<FrameView> {
    let cells = prepared.observations.iter().map(|own| own.positions.len()).max().unwrap_or(0);
    let time = |index: usize| prepared.frames[index] as f64 * data.frame_interval;
    let frame = |index: usize| FrameView {
        time: (data.frames() > 1).then(|| time(index)),
        ..frame_view(prepared, result, index)
    };
    chosen(prepared.frames.len(), cells).into_iter().map(frame).collect()
}

/// The same as a movie; `None` without cells.
pub(crate) fn movie(prepared: &Problem, result: &Inference, data: &DataSet) -> Option<CellMovie> {
    CellMovie::new(movie_frames(prepared, result, data), prepared.frames.len(), &units(data))
}

/// The cells of one frame.
pub(crate) fn frame_view(prepared: &Problem, result: &Inference, index: usize) -> FrameView {
    let (observation, frame) = (&prepared.observations[index], &result.frames[index]);
    let scale = &prepared.scale;
    let wrapped = |r: Vector<f64>| observation.tessellation.domain().wrap(r);
    let length = |r: Vector<f64>| [r.x * scale.length, r.y * scale.length];
    let velocity = |v: Vector<f64>| [v.x * scale.velocity(), v.y * scale.velocity()];
    let on_grid = prepared.velocities.flow().is_some();
    // Of the last frame of tracks all is known but where the cells go.
    let is_end = prepared.tracks.is_some() && !is_left(observation);
    let mut numbers = vec![None; observation.positions.len()];
    for (detection, own) in prepared.fitted_cells(index, numbers.len()).into_iter().enumerate() {
        if let Some(own) = own {
            numbers[own] = Some(prepared.snapshots[index].cells[detection]);
        }
    }
    let targets: Vec<Option<Vector<f64>>> = match on_grid {
        true => Vec::new(),
        false => (0..numbers.len()).map(|cell| observation.target(cell)).collect(),
    };
    let vorticities = vorticities(&observation.tessellation, &observation.positions, &targets);
    let mut polygon = CellPolygon::default();
    let cells = (0..observation.positions.len())
        .map(|cell| {
            let centre = wrapped(observation.positions[cell]);
            let closed = observation.tessellation.is_closed(cell);
            let counted = observation.visibility[cell] == Visibility::Counted;
            // On a grid, velocities are not of cells; those that the grid points stand for are used.
            let target = if on_grid { None } else { observation.target(cell) };
            let used = if on_grid || is_end { counted } else { target.is_some() };
            if closed {
                polygon.fill(&observation.tessellation, &observation.positions, cell);
            }
            let shape = polygon.shape();
            CellView {
                number: numbers[cell],
                centre: length(centre),
                polygon: if closed {
                    polygon.vertices().map(|c| length(centre + c)).collect()
                } else {
                    Vec::new()
                },
                area: if closed { shape.area * scale.length * scale.length } else { f64::NAN },
                perimeter: if closed { shape.perimeter * scale.length } else { f64::NAN },
                status: match (observation.is_seen(cell), used) {
                    (false, _) => CellStatus::NotDetected,
                    (true, true) => CellStatus::Used,
                    (true, false) if counted => CellStatus::LeftOut,
                    (true, false) => CellStatus::Uncertain,
                },
                measured: target.map(velocity),
                vorticity: vorticities.get(cell).copied().flatten().map(|own| own / scale.time),
                // Of tracks what is measured is a mean from frame to frame, crawling included.
                predicted: Some(if on_grid { frame.predicted[cell] } else { frame.predicted_data[cell] })
                    .filter(|v| counted && v.x.is_finite())
                    .map(velocity),
                polarity: frame.polarities.get(cell).copied().flatten().map(velocity),
                held_out: if on_grid { None } else { frame.held_out[cell].map(velocity) },
                nudge: length(frame.nudged_positions[cell] - observation.positions[cell]),
            }
        })
        .collect();
    let segments = |pairs: &[(u32, u32)]| -> Vec<Segment> {
        pairs
            .iter()
            .map(|&(a, b)| {
                let from = wrapped(observation.positions[a as usize]);
                let domain = observation.tessellation.domain();
                let across = observation.positions[b as usize] - observation.positions[a as usize];
                [length(from), length(from + domain.shortest(across))]
            })
            .collect()
    };
    FrameView {
        label: format!("frame {}", prepared.frames[index]),
        time: None,
        cells,
        changed_edges: ChangedEdges {
            lost: segments(&frame.edges_lost),
            gained: segments(&frame.edges_gained),
        },
        outline: match observation.tessellation.domain() {
            Domain::Periodic(cell_box) => {
                let [x, y] = cell_box.lengths();
                Some([[0.0, 0.0], [x * scale.length, y * scale.length]])
            }
            Domain::Open => None,
        },
        region: borders(observation.region.as_ref(), scale.length),
    }
}
