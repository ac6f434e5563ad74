//! Frames to be drawn.

use crate::command::drawing::borders;
use crate::problem::Problem;
use voronudge_geometry::{CellPolygon, Domain, Vector, Visibility};
use voronudge_infer::Inference;
use voronudge_report::figure::FlowMap;
use voronudge_report::{CellStatus, CellView, ChangedEdges, FrameView, Segment};

/// Frames drawn at most: the first, the middle and the last.
const DRAWN: usize = 3;

/// Places of the frames to be drawn in the list of all.
pub(crate) fn drawn(prepared: &Problem) -> Vec<usize> {
    let count = prepared.frames.len();
    if count <= DRAWN { (0..count).collect() } else { vec![0, count / 2, count - 1] }
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

/// The cells of one frame.
pub(crate) fn frame_view(prepared: &Problem, result: &Inference, index: usize) -> FrameView {
    let (observation, frame) = (&prepared.observations[index], &result.frames[index]);
    let scale = &prepared.scale;
    let wrapped = |r: Vector<f64>| observation.tessellation.domain().wrap(r);
    let length = |r: Vector<f64>| [r.x * scale.length, r.y * scale.length];
    let velocity = |v: Vector<f64>| [v.x * scale.velocity(), v.y * scale.velocity()];
    let on_grid = prepared.velocities.flow().is_some();
    let mut polygon = CellPolygon::default();
    let cells = (0..observation.positions.len())
        .map(|cell| {
            let centre = wrapped(observation.positions[cell]);
            let closed = observation.tessellation.is_closed(cell);
            let counted = observation.visibility[cell] == Visibility::Counted;
            // On a grid, velocities are not of cells; those that the grid points stand for are used.
            let target = if on_grid { None } else { observation.target(cell) };
            let used = if on_grid { counted } else { target.is_some() };
            if closed {
                polygon.fill(&observation.tessellation, &observation.positions, cell);
            }
            let shape = polygon.shape();
            CellView {
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
