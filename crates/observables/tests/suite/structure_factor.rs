//! Structure factors of places and velocities that are known.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{PeriodicBox, Vector};
use voronudge_observables::{StructureFactor, structure_factor};

#[test]
fn random_positions_and_velocities_are_white() {
    let cell_box = PeriodicBox::sheared([20.0, 15.0], 4.0).unwrap();
    let mut rng = Pcg64::seed_from_u64(3);
    let mut pair = |a: f64, b: f64| Vector::new(rng.random_range(0.0..a), rng.random_range(0.0..b));
    let positions: Vec<_> = (0..1200).map(|_| pair(20.0, 15.0)).collect();
    let velocities: Vec<_> = (0..1200).map(|_| pair(2.0, 2.0) - Vector::new(1.0, 1.0)).collect();
    let shells = structure_factor(&positions, &velocities, &cell_box, 8.0);
    let average = |part: fn(&StructureFactor) -> f64| {
        let count: usize = shells.iter().map(|s| s.wave_vectors).sum();
        shells.iter().map(|s| part(s) * s.wave_vectors as f64).sum::<f64>() / count as f64
    };
    assert!((average(|s| s.density) - 1.0).abs() < 0.12);
    // The mean square of a component uniform in ±1 is 1/3.
    assert!((average(|s| s.longitudinal) * 3.0 - 1.0).abs() < 0.12);
    assert!((average(|s| s.transverse) * 3.0 - 1.0).abs() < 0.12);
}

#[test]
fn images_do_not_matter_and_a_shear_wave_is_transverse() {
    let cell_box = PeriodicBox::sheared([10.0, 10.0], 3.0).unwrap();
    let q = std::f64::consts::TAU / 10.0;
    let positions: Vec<_> =
        (0..400).map(|i| Vector::new(f64::from(i % 20) * 0.5, f64::from(i / 20) * 0.5)).collect();
    let velocities: Vec<_> = positions.iter().map(|r| Vector::new((q * r.y).cos(), 0.0)).collect();
    let moved: Vec<_> = (positions.iter().enumerate())
        .map(|(i, r)| r + cell_box.translation([i as i32 % 3, i as i32 % 5]))
        .collect();
    let (there, here) = (
        structure_factor(&moved, &velocities, &cell_box, 2.0),
        structure_factor(&positions, &velocities, &cell_box, 2.0),
    );
    for (there, here) in there.iter().zip(&here) {
        assert!((there.transverse - here.transverse).abs() < 1e-9);
        assert!(here.longitudinal < 1e-20);
    }
    let total: f64 = here.iter().map(|s| s.transverse * s.wave_vectors as f64).sum();
    // ±q share the amplitude ½: (N/2)²/N.
    assert!((total - 100.0).abs() < 1e-9, "{total}");
}
