//! What cells at a distance have in common.

use crate::curve::Sums;
use crate::hexatic::of_cell;
use crate::{Curve, Frame, Plan, Quantity, Recording};
use rayon::prelude::*;
use voronudge_geometry::{Places, Vector, areas, shape_tensors};

/// Correlations of velocities, of hexatic order and of places.
pub(crate) fn correlations(recording: &Recording, plan: &Plan) -> [Curve; 3] {
    let of_frame = |frame: &usize| of_frame(&recording.frames()[*frame], plan);
    let all: Vec<[Sums; 3]> = plan.stills.par_iter().map(of_frame).collect();
    let total = |k: usize| all.iter().fold(Sums::new(plan.bins), |sums, own| sums.merge(&own[k]));
    [
        total(0).curve(Quantity::VelocityCorrelation, plan.distances()),
        total(1).curve(Quantity::HexaticCorrelation, plan.distances()),
        total(2).curve(Quantity::PairCorrelation, plan.distances()),
    ]
}

fn of_frame(frame: &Frame, plan: &Plan) -> [Sums; 3] {
    let [mut flow, mut order, mut density] = [(); 3].map(|()| Sums::new(plan.bins));
    let places = places(frame, plan.bins as f64 * plan.bin());
    let hexatic: Vec<Option<Vector<f64>>> = (0..frame.tracks.len())
        .map(|cell| frame.counted[cell].then(|| of_cell(&frame.tessellation, &frame.positions, cell)))
        .collect();
    let per_area = density_of(frame);
    for cell in frame.in_view() {
        let r = wrapped(frame, cell);
        let part = plan.parts[frame.tracks[cell]];
        let rings = plan.rings_in_view(frame, r);
        for ring in 0..rings {
            density.add(ring, part, 0.0, plan.ring_area(ring) * per_area);
        }
        for (other, ring) in others(&places, r, plan) {
            // A cell that never counts goes with the one that does.
            let its_part = if frame.counted[other] { plan.parts[frame.tracks[other]] } else { part };
            let parts = [part, its_part];
            if ring < rings {
                density.add_pair(ring, parts, 1.0, 0.0);
            }
            if let (Some(own), Some(its)) = (hexatic[cell], hexatic[other]) {
                order.add_pair(ring, parts, own.dot(&its), 1.0);
            }
            if let (Some(own), Some(its)) = (frame.velocities[cell], frame.velocities[other])
                && frame.counted[other]
            {
                let squares = 0.5 * (own.norm_squared() + its.norm_squared());
                flow.add_pair(ring, parts, own.dot(&its), squares);
            }
        }
    }
    [flow, order, density]
}

/// The cells around a place but at none, and in which bin of distances each is.
fn others<'a>(places: &'a Places, r: Vector<f64>, plan: &Plan) -> impl Iterator<Item = (usize, usize)> + 'a {
    let (bin, bins) = (plan.bin(), plan.bins);
    places.within(r, bins as f64 * bin).filter_map(move |(other, way)| {
        let distance = way.norm();
        let ring = (distance / bin) as usize;
        (distance > 0.0 && ring < bins).then_some((other, ring))
    })
}

/// How alike the shapes of two cells are, by their distance: `⟨Q_i : Q_j⟩` over the mean square of both.
pub(crate) fn shape_correlation(recording: &Recording, plan: &Plan) -> Curve {
    let of_frame = |number: &usize| {
        let frame = &recording.frames()[*number];
        let mut sums = Sums::new(plan.bins);
        let shapes = shape_tensors(&frame.tessellation, &frame.positions);
        let places = places(frame, plan.bins as f64 * plan.bin());
        let part = |cell: usize| plan.parts[frame.tracks[cell]];
        for cell in frame.in_view() {
            for (other, ring) in others(&places, wrapped(frame, cell), plan) {
                if frame.counted[other] {
                    let [own, its] = [cell, other].map(|cell| Vector::from(shapes[cell]));
                    let squares = 0.5 * (own.norm_squared() + its.norm_squared());
                    sums.add_pair(ring, [part(cell), part(other)], own.dot(&its), squares);
                }
            }
        }
        sums
    };
    let all: Vec<Sums> = plan.stills.par_iter().map(of_frame).collect();
    let total = all.iter().fold(Sums::new(plan.bins), Sums::merge);
    total.curve(Quantity::NematicCorrelation, plan.distances())
}

/// Cells per area: one over the mean area of those that count.
fn density_of(frame: &Frame) -> f64 {
    let areas = areas(&frame.tessellation, &frame.positions);
    let (sum, count) =
        frame.in_view().fold((0.0, 0.0), |(sum, count), cell| (sum + areas[cell], count + 1.0));
    count / sum
}

/// Where a cell is, in the box.
pub(crate) fn wrapped(frame: &Frame, cell: usize) -> Vector<f64> {
    frame.tessellation.domain().wrap(frame.positions[cell])
}

/// The cells of a frame.
pub(crate) fn places(frame: &Frame, reach: f64) -> Places {
    let cells = (0..frame.tracks.len()).map(|cell| frame.positions[cell]);
    Places::new(cells, frame.tessellation.domain(), reach)
}
