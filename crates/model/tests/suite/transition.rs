//! Jumps of velocities in T1 transitions.

use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Transition, Vector};
use voronudge_model::{Exchange, Model, Parameters, velocities};

/// Cells on their way, seen on both sides of each transition: the whole field's jump is that of the four cells.
#[test]
fn the_jump_is_that_of_the_velocities() {
    let place = |i: i32, t: f64| {
        let x = f64::from(i);
        let still = Vector::new(f64::from(i % 12) + 0.3 * x.sin(), f64::from(i / 12) + 0.3 * (2.0 * x).cos());
        still + Vector::new((3.0 * x).cos(), (5.0 * x).sin()) * t
    };
    let parameters = Parameters { chirality: 0.7, preferred_perimeter: 3.9, ..Parameters::default() };
    let model = Model::chiral_voronoi(&parameters);
    let models = std::slice::from_ref(&model);
    let domain = Domain::Periodic(PeriodicBox::new([12.0, 12.0]).unwrap());
    let [first, last]: [Vec<Vector<f64>>; 2] = [0.0, 0.05].map(|t| (0..144).map(|i| place(i, t)).collect());
    let mut moving = MovingTessellation::new(&first, domain).unwrap();
    let before = moving.tessellation().clone();
    moving.renew(&last).unwrap();
    let after = moving.tessellation();
    let found = Transition::between(&before, after);
    assert!(!found.is_empty());
    for positions in [&first, &last] {
        let [old, new] = [&before, after].map(|tessellation| velocities(tessellation, positions, &model));
        let mut rest: Vec<Vector<f64>> = new.iter().zip(&old).map(|(new, old)| new - old).collect();
        let size = rest.iter().map(|v| v.norm()).fold(0.0, f64::max);
        for transition in &found {
            let ((cell, h), (other, back)) = (transition.lost, transition.gained);
            let there = Exchange::new(&before, positions, cell, h).unwrap();
            let [jump] = there.jumps(&before, positions, models)[..] else { panic!() };
            there.cells.iter().zip(jump).for_each(|(cell, jump)| rest[*cell] -= jump);
            let slopes = there.slopes(&model);
            let along = |cell: usize| Vector::new((1.3 * cell as f64).sin(), (0.7 * cell as f64).cos());
            let moved = |step: f64| {
                let moved: Vec<Vector<f64>> =
                    positions.iter().enumerate().map(|(cell, r)| r + along(cell) * step).collect();
                Exchange::new(&before, &moved, cell, h).unwrap().jumps(&before, &moved, models)[0]
            };
            let [less, more] = [-1e-6, 1e-6].map(moved);
            for (number, slopes) in slopes.iter().enumerate() {
                let slope = slopes.iter().fold(Vector::zeros(), |sum: Vector<f64>, (cell, b)| {
                    let x = along(*cell as usize);
                    sum + Vector::new(b[0] * x.x + b[1] * x.y, b[2] * x.x + b[3] * x.y)
                });
                let difference = (more[number] - less[number]) / 2e-6;
                assert!((slope - difference).norm() < 1e-6 * (1.0 + difference.norm()));
            }
            let again = Exchange::new(after, positions, other, back).unwrap();
            for (cell, reverse) in again.cells.iter().zip(again.jumps(after, positions, models)[0]) {
                let number = there.cells.iter().position(|other| other == cell).unwrap();
                assert!((jump[number] + reverse).norm() < 1e-12 * size);
            }
        }
        // What is left comes from perimeters, which change a little beyond the transition.
        assert!(size > 0.01 && rest.iter().all(|v| v.norm() < 0.2 * size));
    }
}
