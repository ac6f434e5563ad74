//! Velocities from tracked positions.

use ndarray::{Array3, array};
use voronudge_io::{Boundary, DataSet, Difference, derive_velocities};

use crate::assert_told;

fn movie(positions: Array3<f64>, boundary: Boundary) -> DataSet {
    DataSet {
        frame_interval: 0.5,
        length_unit: "length".into(),
        time_unit: "time".into(),
        ..DataSet::new(positions, boundary)
    }
}

/// x, y of one cell in a frame.
fn of(velocities: &Array3<f64>, frame: usize, cell: usize) -> [f64; 2] {
    [velocities[[frame, cell, 0]], velocities[[frame, cell, 1]]]
}

fn absent(velocity: [f64; 2]) -> bool {
    velocity.iter().all(|component| component.is_nan())
}

#[test]
fn each_difference_is_what_its_formula_says() {
    let data = movie(array![[[0.0, 0.0]], [[1.0, 2.0]], [[4.0, 3.0]]], Boundary::Open);
    let central = derive_velocities(&data, Difference::Central).unwrap();
    assert_eq!(of(&central, 1, 0), [4.0, 3.0]);
    assert!(absent(of(&central, 0, 0)) && absent(of(&central, 2, 0)));
    let forward = derive_velocities(&data, Difference::Forward).unwrap();
    assert_eq!(of(&forward, 0, 0), [2.0, 4.0]);
    assert_eq!(of(&forward, 1, 0), [6.0, 2.0]);
    assert!(absent(of(&forward, 2, 0)));
    let backward = derive_velocities(&data, Difference::Backward).unwrap();
    assert!(absent(of(&backward, 0, 0)));
    assert_eq!(of(&backward, 2, 0), [6.0, 2.0]);
}

#[test]
fn an_absent_frame_takes_away_what_needs_it() {
    let mut positions = Array3::from_shape_fn((5, 2, 2), |(f, c, a)| (f + 10 * c + a) as f64);
    positions[[2, 1, 0]] = f64::NAN;
    positions[[2, 1, 1]] = f64::NAN;
    let data = movie(positions, Boundary::Open);
    let measured = |difference| -> Vec<bool> {
        let velocities = derive_velocities(&data, difference).unwrap();
        (0..5).map(|frame| !absent(of(&velocities, frame, 1))).collect()
    };
    assert_eq!(measured(Difference::Central), [false; 5]);
    assert_eq!(measured(Difference::Forward), [true, false, false, true, false]);
    assert_eq!(measured(Difference::Backward), [false, true, false, false, true]);
}

#[test]
fn a_step_across_the_periodic_boundary_is_short() {
    let lengths = [10.0, 20.0];
    let data = movie(array![[[9.5, 0.5]], [[0.5, 19.5]], [[1.5, 18.5]]], Boundary::Periodic { lengths });
    let central = derive_velocities(&data, Difference::Central).unwrap();
    assert_eq!(of(&central, 1, 0), [2.0, -2.0]);
    let forward = derive_velocities(&data, Difference::Forward).unwrap();
    assert_eq!(of(&forward, 0, 0), [2.0, -2.0]);
}

#[test]
fn a_central_difference_may_span_more_than_half_the_box() {
    // Two steps of 4 in a box of 10: the way is 8, its shortest image would be −2.
    let lengths = [10.0, 10.0];
    let data = movie(array![[[0.0, 0.0]], [[4.0, 0.0]], [[8.0, 0.0]]], Boundary::Periodic { lengths });
    let central = derive_velocities(&data, Difference::Central).unwrap();
    assert_eq!(of(&central, 1, 0), [8.0, 0.0]);
}

#[test]
fn unwrapped_positions_are_taken_as_they_are() {
    let lengths = [10.0, 10.0];
    let mut data = movie(array![[[0.0, 0.0]], [[7.0, 0.0]]], Boundary::Periodic { lengths });
    data.unwrapped = true;
    let forward = derive_velocities(&data, Difference::Forward).unwrap();
    assert_eq!(of(&forward, 0, 0), [14.0, 0.0]);
}

#[test]
fn wrapping_positions_does_not_change_velocities() {
    let lengths = [7.0, 5.0];
    let free = Array3::from_shape_fn((6, 4, 2), |(f, c, a)| {
        // Steps up to 2.4, below half of either length.
        1.3 * c as f64 + (f as f64 * (0.4 * c as f64 - 0.7)) * if a == 0 { 1.0 } else { -1.7 }
    });
    let mut wrapped = free.clone();
    for ((_, _, axis), value) in wrapped.indexed_iter_mut() {
        *value = value.rem_euclid(lengths[axis]);
    }
    for difference in [Difference::Central, Difference::Forward, Difference::Backward] {
        let open = derive_velocities(&movie(free.clone(), Boundary::Open), difference).unwrap();
        let data = movie(wrapped.clone(), Boundary::Periodic { lengths });
        let periodic = derive_velocities(&data, difference).unwrap();
        for (a, b) in open.iter().zip(&periodic) {
            // Coordinates up to 20 carry rounding of 4e-15, divided by an interval of 0.5.
            assert!((a - b).abs() < 1e-13 || (a.is_nan() && b.is_nan()), "{a} {b}");
        }
    }
}

#[test]
fn too_few_frames_are_told() {
    let data = movie(array![[[0.0, 0.0]], [[1.0, 0.0]]], Boundary::Open);
    assert_told(
        derive_velocities(&data, Difference::Central),
        &["central differences need 3 frames, the data set has 2"],
        "--velocities",
    );
    let data = movie(array![[[0.0, 0.0]]], Boundary::Open);
    for difference in [Difference::Forward, Difference::Backward] {
        let fact = format!("{difference} differences need 2 frames, the data set has 1");
        assert_told(derive_velocities(&data, difference), &[&fact], "longer movie");
    }
}

#[test]
fn differences_have_names() {
    for difference in [Difference::Central, Difference::Forward, Difference::Backward] {
        let named: Difference = difference.to_string().parse().unwrap();
        assert_eq!(named, difference);
    }
    let facts = ["difference is \"middle\", expected \"central\", \"forward\""];
    assert_told("middle".parse::<Difference>(), &facts, "as the message says");
}
