//! Lengths of sides, and those that shrink through zero.

use voronudge_geometry::{
    Domain, MovingTessellation, PeriodicBox, Renewal, Side, Tessellation, Transition, Vector,
};

#[test]
fn gradients_are_those_of_the_lengths() {
    let positions: Vec<Vector<f64>> = (0..36)
        .map(|i| {
            let x = f64::from(i);
            Vector::new(f64::from(i % 6) + 0.25 * x.sin(), f64::from(i / 6) + 0.25 * (2.0 * x).cos())
        })
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let length = |positions: &[Vector<f64>], cell, h| {
        Side::new(&tessellation, positions, cell, h).map(|side| side.length).unwrap()
    };
    for cell in 0..36 {
        for h in tessellation.ring(cell) {
            let side = Side::new(&tessellation, &positions, cell, h).unwrap();
            let seen_from_there =
                Side::new(&tessellation, &positions, tessellation.neighbour(h), tessellation.twin(h))
                    .unwrap();
            assert!((side.length - seen_from_there.length).abs() < 1e-12);
            for (moved, gradient) in side.cells.iter().zip(side.gradient) {
                for axis in 0..2 {
                    let step = 1e-6;
                    let at = |sign: f64| {
                        let mut positions = positions.clone();
                        positions[*moved][axis] += sign * step;
                        length(&positions, cell, h)
                    };
                    let difference = (at(1.0) - at(-1.0)) / (2.0 * step);
                    let scale = 1.0 + gradient.norm();
                    assert!((difference - gradient[axis]).abs() < 1e-6 * scale, "{difference} {gradient}");
                }
            }
        }
    }
}

#[test]
fn a_side_without_an_end_is_none() {
    let corners = [[0.0, 0.0], [1.0, 0.1], [0.4, 1.0], [0.5, 0.4]].map(|[x, y]| Vector::new(x, y));
    let tessellation = Tessellation::new(&corners, Domain::Open).unwrap();
    let count = (0..4)
        .flat_map(|cell| tessellation.ring(cell).map(move |h| (cell, h)))
        .filter(|&(cell, h)| Side::new(&tessellation, &corners, cell, h).is_some())
        .count();
    // Three sides meet at the inner cell, each seen from two cells; from those on the hull one end is missing for
    // the sides between them only.
    assert_eq!(count, 6);
}

/// Small displacements of cells in a periodic box: as many transitions as flips, each with a side that shrinks through zero.
#[test]
fn transitions_are_the_flips() {
    let place = |i: i32, t: f64| {
        let x = f64::from(i);
        let still = Vector::new(f64::from(i % 12) + 0.3 * x.sin(), f64::from(i / 12) + 0.3 * (2.0 * x).cos());
        still + Vector::new((3.0 * x).cos(), (5.0 * x).sin()) * t
    };
    let domain = Domain::Periodic(PeriodicBox::new([12.0, 12.0]).unwrap());
    let [first, last]: [Vec<Vector<f64>>; 2] = [0.0, 0.05].map(|t| (0..144).map(|i| place(i, t)).collect());
    let mut moving = MovingTessellation::new(&first, domain).unwrap();
    let before = moving.tessellation().clone();
    let Renewal::Flipped(flips) = moving.renew(&last).unwrap() else { panic!("rebuilt") };
    let after = moving.tessellation();
    let found = Transition::between(&before, after);
    assert!(flips > 0);
    assert_eq!(found.len(), flips);
    assert!(Transition::between(&before, &before).is_empty());
    for Transition { lost, gained } in found {
        let length =
            |tessellation, positions, (cell, h)| Side::new(tessellation, positions, cell, h).unwrap().length;
        assert!(length(&before, &first, lost) > 0.0 && length(&before, &last, lost) < 0.0);
        assert!(length(after, &first, gained) < 0.0 && length(after, &last, gained) > 0.0);
    }
}
