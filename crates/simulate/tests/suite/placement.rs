//! Places drawn at random, and the seeds that decide them.

use voronudge_geometry::PeriodicBox;
use voronudge_simulate::{Error, RandomPlacement, generator, seed_of_replica, seed_of_run};

#[test]
fn a_distance_that_cannot_be_kept_is_relaxed() {
    let cell_box = PeriodicBox::sheared([7.0, 3.0], 1.3).unwrap();
    let placement = RandomPlacement { least_distance: 1.5, ..RandomPlacement::new(40, cell_box) };
    let positions = placement.draw(&mut generator(3)).unwrap();
    assert_eq!(positions.len(), 40);
    let spacing = (cell_box.area() / 40.0).sqrt();
    for i in 0..40 {
        for j in 0..i {
            assert!(cell_box.shortest(positions[i] - positions[j]).norm() > 0.5 * spacing);
        }
    }
}

#[test]
fn the_seed_decides() {
    let cell_box = PeriodicBox::new([4.0, 4.0]).unwrap();
    let draw = |seed| RandomPlacement::new(16, cell_box).draw(&mut generator(seed)).unwrap();
    assert_eq!(draw(1), draw(1));
    assert_ne!(draw(1), draw(2));
}

#[test]
fn runs_of_neighbouring_seeds_share_nothing() {
    let mut seen = std::collections::BTreeSet::new();
    for seed in 0..30 {
        assert!((0..100).all(|replica| seen.insert(seed_of_replica(seed, replica))), "{seed}");
        for point in 1..10 {
            assert!((0..10).all(|replica| seen.insert(seed_of_run(seed, point, replica))), "{seed}");
        }
    }
}

#[test]
fn unusable_requests_are_refused() {
    let cell_box = PeriodicBox::new([4.0, 4.0]).unwrap();
    let none = RandomPlacement::new(0, cell_box).draw(&mut generator(1));
    assert_eq!(none, Err(Error::NoCells));
    let placement = RandomPlacement { least_distance: -0.1, ..RandomPlacement::new(4, cell_box) };
    assert_eq!(placement.draw(&mut generator(1)), Err(Error::LeastDistance { value: -0.1 }));
}
