//! The smoothest fields that a domain allows.

use super::ResidualField;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, Vector};

/// Waves of a periodic box, one of each pair of opposite ones.
const WAVES: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]];

/// Orthonormal functions over the places: in a periodic box the constant and the four longest waves (nine functions), in
/// an open field polynomials up to degree two (six). Each is a list over the places. Empty with fewer than twice as many
/// places as functions.
pub(super) fn low_modes(frame: &ResidualField<'_>) -> Vec<Vec<f64>> {
    let functions = match frame.domain {
        Domain::Periodic(_) => waves(frame),
        Domain::Open => polynomials(frame),
    };
    if frame.places.len() < 2 * functions.len() { Vec::new() } else { orthonormal(functions) }
}

/// Coordinates in units of the lattice vectors of a periodic box, or of the rectangle `[low, high]`.
pub(super) fn fractions(domain: Domain, place: Vector<f64>, [low, high]: [Vector<f64>; 2]) -> [f64; 2] {
    match domain {
        Domain::Periodic(cell) => {
            let y = place.y / cell.lengths()[1];
            let x = (place.x - y * cell.offset()) / cell.lengths()[0];
            [x - x.floor(), y - y.floor()]
        }
        Domain::Open => {
            let size = high - low;
            [(place.x - low.x) / size.x, (place.y - low.y) / size.y]
        }
    }
}

/// The smallest rectangle around some places.
pub(super) fn extent<'a>(places: impl Iterator<Item = &'a Vector<f64>>) -> [Vector<f64>; 2] {
    let start = [Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)];
    places.fold(start, |[low, high], place| [low.inf(place), high.sup(place)])
}

fn waves(frame: &ResidualField<'_>) -> Vec<Vec<f64>> {
    let rectangle = extent(frame.places.iter());
    let at: Vec<[f64; 2]> = frame.places.iter().map(|r| fractions(frame.domain, *r, rectangle)).collect();
    let mut functions = vec![vec![1.0; at.len()]];
    for [a, b] in WAVES {
        functions.push(at.iter().map(|[x, y]| (TAU * (a * x + b * y)).cos()).collect());
        functions.push(at.iter().map(|[x, y]| (TAU * (a * x + b * y)).sin()).collect());
    }
    functions
}

fn polynomials(frame: &ResidualField<'_>) -> Vec<Vec<f64>> {
    let [low, high] = extent(frame.places.iter());
    let (middle, size) = (0.5 * (low + high), 0.5 * (high - low).norm());
    let at: Vec<Vector<f64>> = frame.places.iter().map(|r| (r - middle) / size).collect();
    let monomials: [fn(&Vector<f64>) -> f64; 6] =
        [|_| 1.0, |r| r.x, |r| r.y, |r| r.x * r.x, |r| r.x * r.y, |r| r.y * r.y];
    monomials.iter().map(|f| at.iter().map(f).collect()).collect()
}

/// Gram and Schmidt, twice against rounding; functions that depend on earlier ones are left out.
fn orthonormal(functions: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let norm = |f: &[f64]| f.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut function in functions {
        let before = norm(&function);
        for other in basis.iter().chain(&basis) {
            let share: f64 = function.iter().zip(other).map(|(f, o)| f * o).sum();
            function.iter_mut().zip(other).for_each(|(f, o)| *f -= share * o);
        }
        let after = norm(&function);
        if after > 1e-9 * before {
            function.iter_mut().for_each(|f| *f /= after);
            basis.push(function);
        }
    }
    basis
}
