//! Half-integer defects of the director field.

use super::director::{DirectorField, Local};
use crate::pairs::wrapped;
use crate::{Frame, Recording};
use std::f64::consts::{PI, TAU};
use voronudge_geometry::{Domain, Vector};

/// Newton steps from where the field vanishes in the triangle, and how far they may lead, in smoothing widths.
const STEPS: usize = 6;
const FARTHEST: f64 = 0.5;

/// Smoothing widths from the border of an open field within which no defect is told.
const MARGIN: f64 = 2.0;

/// A point where the director turns by half a turn on the way around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defect {
    /// Frame in which it is.
    pub frame: usize,
    /// Where, in the box.
    pub position: Vector<f64>,
    /// ½ or −½: turns of the director, anticlockwise, on one way round anticlockwise.
    pub charge: f64,
    /// Of +½ the direction in which the head of the comet points (`−∇·Q`), of −½ one of the three along which its arms lie; radians.
    pub direction: f64,
    /// The cell of the triangle around it that is nearest, by its number in the frame.
    pub cell: usize,
}

/// A triangle of neighbours that count.
pub(super) struct Corners {
    pub cells: [usize; 3],
    /// Where the first is, in the box, and all three from there.
    first: Vector<f64>,
    from_first: [Vector<f64>; 3],
}

impl Corners {
    pub fn area(&self) -> f64 {
        let [_, a, b] = self.from_first;
        0.5 * (a.x * b.y - a.y * b.x).abs()
    }

    /// The cell nearest to a place.
    fn nearest(&self, place: Vector<f64>) -> usize {
        let distance = |k: &usize| (self.first + self.from_first[*k] - place).norm_squared();
        let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.cells[nearest.unwrap_or(0)]
    }
}

/// The triangles in which defects are told: of cells that count, far enough from the border of an open field, as cells that are not seen would have a say there.
pub(super) fn triangles(frame: &Frame, width: f64) -> impl Iterator<Item = Corners> + '_ {
    let domain = frame.tessellation.domain();
    let all = frame.tessellation.triangles().into_iter();
    all.filter_map(move |triangle| {
        let cells = triangle.cells.map(|cell| cell as usize);
        let first = wrapped(frame, cells[0]);
        let from_first = std::array::from_fn(|k| {
            domain.displacement(frame.positions[cells[0]], frame.positions[cells[k]], triangle.images[k])
        });
        let own = Corners { cells, first, from_first };
        let middle = domain.wrap(first + (own.from_first[1] + own.from_first[2]) / 3.0);
        let is_inside = match (&frame.region, domain) {
            (Some(region), Domain::Open) => region.distance_from_border(middle) >= MARGIN * width,
            _ => true,
        };
        (is_inside && cells.iter().all(|cell| frame.counted[*cell])).then_some(own)
    })
}

/// The defects of a frame: triangles of neighbours around which the smoothed field turns. Those in a periodic box have charges that sum to nought.
pub(super) fn of_frame(
    recording: &Recording,
    number: usize,
    field: &DirectorField<'_>,
    width: f64,
) -> Vec<Defect> {
    let frame = &recording.frames()[number];
    let values = field.at_cells();
    let defect = |triangle: Corners| {
        let own = triangle.cells.map(|cell| values[cell]);
        let charge = 0.5 * turns(own);
        if charge == 0.0 {
            return None;
        }
        let start = triangle.first + zero(triangle.from_first, own);
        let place = polished(field, start, FARTHEST * width);
        let position = frame.tessellation.domain().wrap(place);
        let direction = field.at(position).direction(charge);
        Some(Defect { frame: number, position, charge, direction, cell: triangle.nearest(place) })
    };
    triangles(frame, width).filter_map(defect).collect()
}

/// Turns of a vector on the way from one corner of a triangle to the next and back: 1, 0 or −1.
fn turns(values: [[f64; 2]; 3]) -> f64 {
    let angles = values.map(|[x, y]| y.atan2(x));
    let to_next = |k: usize| {
        let turn = angles[(k + 1) % 3] - angles[k];
        turn - TAU * (turn / TAU).round()
    };
    let sum: f64 = (0..3).map(to_next).sum();
    if sum.abs() < PI { 0.0 } else { sum.signum() }
}

/// Where the linear interpolation between three corners vanishes.
fn zero(corners: [Vector<f64>; 3], values: [[f64; 2]; 3]) -> Vector<f64> {
    let [first, second, third] = values;
    let along = |other: [f64; 2]| [other[0] - first[0], other[1] - first[1]];
    let shares = Local { value: first, gradient: [along(second), along(third)] }.step_to_zero();
    let [s, t] = shares.map_or([1.0 / 3.0; 2], |shares| [shares.x, shares.y]);
    corners[1] * s + corners[2] * t
}

/// The zero of the field near a place, or that place.
fn polished(field: &DirectorField<'_>, start: Vector<f64>, farthest: f64) -> Vector<f64> {
    let domain = field.domain();
    let mut place = start;
    for _ in 0..STEPS {
        let Some(step) = field.at(domain.wrap(place)).step_to_zero() else { return start };
        place += step;
        if (place - start).norm() > farthest {
            return start;
        }
    }
    place
}
