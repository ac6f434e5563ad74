//! Empty places, compared with the data's own polygons.
//!
//! The circle through three neighbouring cells holds no other cell. In a complete tissue the logarithms of the radii of these
//! circles are close to normal. A cell that was not seen leaves a circle about as large as a cell is apart from its
//! neighbours, out of line with the rest. Middle and width are those of the middle half of the radii, which few voids do not
//! move.

use super::LEVEL;
use crate::{Observation, Velocities};
use statrs::distribution::{ContinuousCDF, DiscreteCDF, Normal, Poisson};
use voronudge_geometry::{CellPolygon, Domain, Vector};

/// Circles are counted beyond so many widths of the distribution.
const BEYOND: [f64; 4] = [3.2, 3.7, 4.2, 4.7];

/// A void's radius is at least this many medians: in a lattice, whose radii are all alike, a defect is no void.
const LEAST: f64 = 1.4;

/// Interquartile range of a normal distribution in units of its standard deviation.
const QUARTILES: f64 = 1.349;

/// Fewer circles than this have no distribution.
const FEWEST: usize = 60;

/// Empty places that a complete tissue would hardly have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voids {
    /// How many there are.
    pub found: usize,
    /// How many a complete tissue with the same distribution would have.
    pub expected: f64,
}

/// An empty circle through three cells.
struct Circle {
    centre: Vector<f64>,
    radius: f64,
}

/// The voids of some frames, if there are more than chance makes.
pub(crate) fn voids(frames: &[Observation]) -> Option<Voids> {
    let circles: Vec<Vec<Circle>> = frames.iter().map(circles).collect();
    let mut radii: Vec<f64> = circles.iter().flatten().map(|circle| circle.radius.ln()).collect();
    if radii.len() < FEWEST {
        return None;
    }
    radii.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| radii[((radii.len() - 1) as f64 * share) as usize];
    let (middle, width) = (at(0.5), (at(0.75) - at(0.25)) / QUARTILES);
    let normal = Normal::new(0.0, 1.0).ok()?;
    let mut best: Option<(f64, Voids)> = None;
    for z in BEYOND {
        let limit = (z * width).max(LEAST.ln());
        let expected = radii.len() as f64 * normal.sf(limit / width);
        let of_frames = circles.iter().zip(frames);
        let found = of_frames
            .map(|(own, frame)| separate(own, frame.tessellation.domain(), (middle + limit).exp()))
            .sum::<usize>();
        let p = match (found, Poisson::new(expected)) {
            (0, _) => 1.0,
            (found, Ok(chance)) => chance.sf(found as u64 - 1),
            (_, Err(_)) => 0.0,
        };
        // The same voids counted at several limits.
        if p * (BEYOND.len() as f64) < LEVEL && best.as_ref().is_none_or(|(least, _)| p < *least) {
            best = Some((p, Voids { found, expected }));
        }
    }
    best.map(|(_, voids)| voids)
}

/// Circles larger than some radius, those of one void counted once: the centre of a circle must not lie in a larger one.
fn separate(circles: &[Circle], domain: Domain, radius: f64) -> usize {
    let mut large: Vec<&Circle> = circles.iter().filter(|circle| circle.radius > radius).collect();
    large.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut kept: Vec<&Circle> = Vec::new();
    for circle in large {
        let apart = |other: &&Circle| domain.shortest(circle.centre - other.centre).norm() > other.radius;
        if kept.iter().all(apart) {
            kept.push(circle);
        }
    }
    kept.len()
}

/// The circles at the vertices of polygons that are certain, next to cells whose velocities are explained.
fn circles(frame: &Observation) -> Vec<Circle> {
    let tessellation = &frame.tessellation;
    let is_certain = |cell: usize| frame.visibility[cell].has_certain_polygon_or_hole();
    let is_explained = |cell: usize| match &frame.velocities {
        Velocities::OfCells(velocities) => velocities[cell].is_some(),
        Velocities::OnGrid(_) => true,
    };
    let mut polygon = CellPolygon::default();
    let mut circles = Vec::new();
    for cell in (0..frame.positions.len()).filter(|cell| is_certain(*cell)) {
        polygon.fill(tessellation, &frame.positions, cell);
        let ring = tessellation.neighbours(cell);
        for (m, corner) in polygon.vertices().enumerate() {
            let others = [ring[m], ring[(m + 1) % ring.len()]];
            // Each triangle once, from the lowest of its cells; and where nothing is explained nothing is spoilt.
            let is_first = others.iter().all(|other| *other as usize > cell || !is_certain(*other as usize));
            if is_first && (is_explained(cell) || others.iter().any(|other| is_explained(*other as usize))) {
                circles.push(Circle { centre: frame.positions[cell] + corner, radius: corner.norm() });
            }
        }
    }
    circles
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;
    use voronudge_geometry::{FieldOfView, PeriodicBox};

    /// A jittered lattice of 256 cells without some.
    fn tissue(missed: usize, seed: u64) -> Observation {
        let mut generator = Pcg64::seed_from_u64(seed);
        let mut positions: Vec<Vector<f64>> = (0..256)
            .map(|i| {
                let (row, column) = (f64::from(i / 16), f64::from(i % 16));
                let mut jitter = || generator.random_range(-0.15..0.15);
                Vector::new(column + 0.5 * (row % 2.0) + jitter(), row + jitter())
            })
            .collect();
        for _ in 0..missed {
            positions.swap_remove(generator.random_range(0..positions.len()));
        }
        let domain = Domain::Periodic(PeriodicBox::new([16.0, 16.0]).unwrap());
        let still = vec![Some(Vector::zeros()); positions.len()];
        Observation::new(0, positions, still, domain, FieldOfView::default()).unwrap()
    }

    #[test]
    fn complete_tissues_seldom_have_voids_and_those_with_missed_cells_do() {
        let found = |missed| (0..100).filter(|seed| voids(&[tissue(missed, *seed)]).is_some()).count();
        assert!(found(0) <= 2, "{} of 100 without a missed cell", found(0));
        assert!(found(8) >= 95, "{} of 100 with 8 of 256 missed", found(8));
    }

    #[test]
    fn a_void_counts_once() {
        let found = voids(&[tissue(8, 1)]).unwrap();
        assert!(found.found <= 8 && found.expected < 1.0, "{found:?}");
    }
}
