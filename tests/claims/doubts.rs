//! A fit doubts data that are not what it takes them for, and seldom others.

use claims::{Noise, Tissue};
use std::ops::ControlFlow;
use voronudge_geometry::{CellPolygon, FieldOfView, Vector};
use voronudge_infer::{Doubt, KnownNoise, Observation, Part, Request, infer};

const NOISE: Noise = Noise { position: 0.015, velocity: 0.05 };
const CELLS: usize = 196;

fn doubts(frame: Observation, request: &Request) -> Vec<Doubt> {
    infer(&[frame], request, &mut |_| ControlFlow::Continue(())).unwrap().doubts
}

/// Fits with estimated noise of tissues made of a fault: how many of them doubt the part.
fn doubted(sets: u64, part: impl Fn(Part) -> bool, fault: impl Fn(&Tissue, u64) -> Observation) -> usize {
    let one = |seed: &u64| {
        let tissue = Tissue::new(CELLS, 700 + seed).unwrap();
        let request = tissue.request(KnownNoise::default());
        doubts(fault(&tissue, 900 + seed), &request).iter().any(|doubt| part(doubt.part()))
    };
    (0..sets).filter(one).count()
}

fn observed(
    like: &Observation,
    positions: Vec<Vector<f64>>,
    velocities: Vec<Option<Vector<f64>>>,
) -> Observation {
    Observation::new(0, positions, velocities, like.tessellation.domain(), FieldOfView::default()).unwrap()
}

#[test]
#[ignore = "slow"]
fn complete_tissues_are_seldom_doubted() {
    let found = doubted(8, |_| true, |tissue, seed| tissue.measured(NOISE, seed).unwrap());
    assert!(found <= 1, "{found} of 8");
}

#[test]
#[ignore = "slow"]
fn missed_cells_are_doubted() {
    let found = doubted(
        6,
        |part| matches!(part, Part::Cells | Part::Outliers),
        |tissue, seed| {
            let whole = tissue.measured(NOISE, seed).unwrap();
            let kept = |cell: &usize| !(cell + seed as usize).is_multiple_of(49);
            let cells: Vec<usize> = (0..CELLS).filter(kept).collect();
            let positions = cells.iter().map(|cell| whole.positions[*cell]).collect();
            let velocities = cells.iter().map(|cell| whole.velocities.values()[*cell]).collect();
            observed(&whole, positions, velocities)
        },
    );
    assert!(found >= 5, "{found} of 6");
}

#[test]
#[ignore = "slow"]
fn centroids_taken_for_sites_are_doubted() {
    let found = doubted(
        4,
        |part| part == Part::Positions,
        |tissue, seed| {
            let whole = tissue.measured(NOISE, seed).unwrap();
            let mut polygon = CellPolygon::default();
            let centroids = (0..CELLS).map(|cell| {
                polygon.fill(&tissue.tessellation, &tissue.positions, cell);
                let corners: Vec<Vector<f64>> = polygon.vertices().collect();
                let fans = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
                let (sum, area) = fans.fold((Vector::zeros(), 0.0), |(sum, area), (a, b)| {
                    let cross = a.x * b.y - a.y * b.x;
                    (sum + (a + b) * cross / 6.0, area + 0.5 * cross)
                });
                whole.positions[cell] + sum / area
            });
            let centroids = centroids.collect();
            observed(&whole, centroids, whole.velocities.values().to_vec())
        },
    );
    assert!(found >= 3, "{found} of 4");
}

#[test]
fn differences_over_long_steps_are_doubted() {
    let tissue = Tissue::new(CELLS, 700).unwrap();
    let request = Request { frame_interval: Some(0.15), ..tissue.request(KnownNoise::default()) };
    let found = doubts(tissue.measured(NOISE, 900).unwrap(), &request);
    assert!(found.iter().any(|doubt| matches!(doubt, Doubt::LongSteps(step) if (step - 0.15).abs() < 0.01)));
}
