//! Half-integer defects of the director field.

use super::director::DirectorField;
use crate::pairs::wrapped;
use crate::{Frame, Recording};
use std::f64::consts::{PI, TAU};
use voronudge_geometry::{Domain, Vector};

/// Newton steps from where the field vanishes in the triangle, and how far they may lead, in smoothing widths.
const STEPS: usize = 6;
const FARTHEST: f64 = 0.5;

/// Smoothing widths from the border of an open field within which no defect is told: cells that are not seen would have a say there.
pub(super) const MARGIN: f64 = 2.0;

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

/// The defects of a frame: triangles of neighbours around which the smoothed field turns. Those in a periodic box have charges that sum to nought.
pub(super) fn of_frame(
    recording: &Recording,
    number: usize,
    field: &DirectorField<'_>,
    width: f64,
) -> Vec<Defect> {
    let frame = &recording.frames()[number];
    let values = field.at_cells();
    let mut defects = Vec::new();
    for triangle in frame.tessellation.triangles() {
        let cells = triangle.cells.map(|cell| cell as usize);
        if !cells.iter().all(|cell| frame.counted[*cell]) {
            continue;
        }
        let own = cells.map(|cell| values[cell]);
        let turns = turns(own);
        if turns == 0.0 {
            continue;
        }
        let first = wrapped(frame, cells[0]);
        let corner = |k: usize| {
            let [from, to] = [cells[0], cells[k]].map(|cell| frame.positions[cell]);
            frame.tessellation.domain().displacement(from, to, triangle.images[k])
        };
        let corners = [Vector::zeros(), corner(1), corner(2)];
        let start = first + zero(corners, own);
        let place = polished(field, start, FARTHEST * width);
        let nearest = (0..3).min_by(|a, b| {
            let distance = |k: &usize| (first + corners[*k] - place).norm_squared();
            distance(a).total_cmp(&distance(b))
        });
        let charge = 0.5 * turns;
        let position = frame.tessellation.domain().wrap(place);
        if is_told(frame, position, width) {
            let direction = field.at(position).direction(charge);
            let cell = cells[nearest.unwrap_or(0)];
            defects.push(Defect { frame: number, position, charge, direction, cell });
        }
    }
    defects
}

/// Whether a place is far enough from the border of what was seen.
pub(super) fn is_told(frame: &Frame, place: Vector<f64>, width: f64) -> bool {
    match (&frame.region, frame.tessellation.domain()) {
        (_, Domain::Periodic(_)) | (None, Domain::Open) => true,
        (Some(region), Domain::Open) => region.distance_from_border(place) >= MARGIN * width,
    }
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
    let [[u, v], [a, c], [b, d]] = values;
    let [a, b, c, d] = [a - u, b - u, c - v, d - v];
    let determinant = a * d - b * c;
    let (s, t) = ((b * v - d * u) / determinant, (c * u - a * v) / determinant);
    let place = corners[1] * s + corners[2] * t;
    if (place.x + place.y).is_finite() { place } else { (corners[1] + corners[2]) / 3.0 }
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
