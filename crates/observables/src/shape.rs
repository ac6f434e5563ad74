//! Areas and shapes of cells.

use crate::curve::Sums;
use crate::hexatic::{hexatic_among, of_cell};
use crate::{Curve, Frame, Plan, Quantity, Recording};
use voronudge_geometry::{Tessellation, Vector, areas, perimeters};

/// Bins of the shape index, from the first on, and of the area in units of its mean.
const SHAPES: (f64, f64, usize) = (3.5, 0.05, 30);
const AREAS: (f64, f64, usize) = (0.0, 0.1, 26);
/// Numbers of neighbours that are told apart, the first and how many.
const NEIGHBOURS: (usize, usize) = (3, 8);

/// The shape index `P_i/√A_i` of each cell (N): 3.545 for a circle, 3.722 for a regular hexagon, more for longer cells. NaN
/// for cells on the hull of an open field.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation, honeycomb};
/// use voronudge_observables::shape_indices;
/// let (positions, lengths) = honeycomb(4, 4);
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new(lengths)?))?;
/// let hexagon = (8.0 * 3f64.sqrt()).sqrt();
/// assert!(shape_indices(&tessellation, &positions).iter().all(|p| (p - hexagon).abs() < 1e-12));
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn shape_indices(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    let areas = areas(tessellation, positions);
    perimeters(tessellation, positions)
        .iter()
        .zip(areas)
        .map(|(perimeter, area)| perimeter / area.sqrt())
        .collect()
}

/// Areas, shapes, neighbours and hexatic order of the cells that count.
pub(crate) fn configuration(recording: &Recording, plan: &Plan) -> Vec<Curve> {
    let bins = |(first, width, count): (f64, f64, usize)| -> Vec<f64> {
        (0..count).map(|bin| first + (bin as f64 + 0.5) * width).collect()
    };
    let [mut mean, mut order] = [(); 2].map(|()| Sums::new(1));
    let [mut shape, mut area] = [SHAPES, AREAS].map(|(_, _, count)| Sums::new(count));
    let mut around = Sums::new(NEIGHBOURS.1);
    let mean_area = plan.spacing * plan.spacing;
    for frame in plan.stills.iter().map(|frame| &recording.frames()[*frame]) {
        let indices = shape_indices(&frame.tessellation, &frame.positions);
        let own = areas(&frame.tessellation, &frame.positions);
        for cell in frame.in_view() {
            let part = plan.parts[frame.tracks[cell]];
            mean.add(0, part, indices[cell], 1.0);
            order.add(0, part, of_cell(&frame.tessellation, &frame.positions, cell).norm(), 1.0);
            distribute(&mut shape, SHAPES, part, indices[cell]);
            distribute(&mut area, AREAS, part, own[cell] / mean_area);
            let (first, count) = NEIGHBOURS;
            let sides = frame.tessellation.neighbours(cell).len();
            (0..count).for_each(|k| around.add(k, part, f64::from(u8::from(first + k == sides)), 1.0));
        }
    }
    let neighbours = (0..NEIGHBOURS.1).map(|k| (NEIGHBOURS.0 + k) as f64).collect();
    vec![
        mean.curve(Quantity::MeanShapeIndex, vec![0.0]),
        shape.curve(Quantity::ShapeIndex, bins(SHAPES)),
        area.curve(Quantity::Area, bins(AREAS)),
        around.curve(Quantity::Neighbours, neighbours),
        whole_order(recording, plan),
        order.curve(Quantity::HexaticModulus, vec![0.0]),
    ]
}

/// Takes a value into the density of its distribution.
pub(crate) fn distribute(sums: &mut Sums, (first, width, count): (f64, f64, usize), part: usize, value: f64) {
    let bin = ((value - first) / width).floor();
    (0..count).for_each(|k| sums.add(k, part, f64::from(u8::from(bin == k as f64)), width));
}

/// `Ψ₆` of each frame, on average. Frames are not independent of each other, and parts have orders of their own: no error is told.
fn whole_order(recording: &Recording, plan: &Plan) -> Curve {
    let of_frame = |frame: &Frame| {
        hexatic_among(&frame.tessellation, &frame.positions, |cell| frame.counted[cell]).order()
    };
    let all: Vec<f64> = plan.stills.iter().map(|frame| of_frame(&recording.frames()[*frame])).collect();
    Curve {
        of: Quantity::HexaticOrder,
        at: vec![0.0],
        value: vec![all.iter().sum::<f64>() / all.len() as f64],
        standard_error: vec![f64::NAN],
        count: vec![all.len()],
    }
}
