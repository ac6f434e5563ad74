//! Circulation around cells.

use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector, areas};
use voronudge_observables::vorticities;

/// Cells in no order.
fn scattered() -> Vec<Vector<f64>> {
    let place =
        |k: usize| Vector::new((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
    (0..60).map(place).collect()
}

#[test]
fn a_rigid_rotation_has_twice_its_rate() {
    let positions = scattered();
    let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
    let velocities: Vec<_> =
        positions.iter().map(|r| Some(Vector::new(3.0 - 0.9 * r.y, 0.9 * r.x))).collect();
    let found = vorticities(&tessellation, &positions, &velocities);
    let known: Vec<f64> = found.iter().copied().flatten().collect();
    assert_eq!(known.len(), (0..60).filter(|&cell| tessellation.is_closed(cell)).count());
    assert!(known.len() > 30 && known.iter().all(|own| (own - 1.8).abs() < 1e-9));
}

#[test]
fn there_is_no_circulation_around_a_whole_periodic_box() {
    let positions = scattered();
    let domain = Domain::Periodic(PeriodicBox::new([1.0, 1.0]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let velocities: Vec<_> =
        (0..60).map(|k| Some(Vector::new((k as f64).sin(), (7.0 * k as f64).cos()))).collect();
    let found = vorticities(&tessellation, &positions, &velocities);
    let circulations =
        found.iter().zip(areas(&tessellation, &positions)).map(|(own, area)| own.unwrap() * area);
    assert!(circulations.sum::<f64>().abs() < 1e-12);
}

#[test]
fn a_velocity_that_is_not_known_leaves_its_neighbours_without() {
    let positions = scattered();
    let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
    let mut velocities = vec![Some(Vector::new(1.0, 0.0)); positions.len()];
    velocities[7] = None;
    let found = vorticities(&tessellation, &positions, &velocities);
    assert_eq!(found[7], None);
    assert!(tessellation.neighbours(7).iter().all(|&other| found[other as usize].is_none()));
    assert!(found.iter().any(Option::is_some));
}
