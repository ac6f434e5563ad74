//! Which diagonal of a quadrilateral is an edge, whatever the numbers of its cells and wherever they come from.

use crate::samples::{periodic, random, squares};
use voronudge_geometry::{Domain, Error, MovingTessellation, PeriodicBox, Renewal, Tessellation, Vector};

/// Four cells, the first, in a disordered tissue with room for them.
fn among_others(four: [Vector<f64>; 4]) -> Vec<Vector<f64>> {
    let middle = Vector::new(4.25, 4.25);
    let shaken = squares(9, 9).into_iter().enumerate().map(|(k, r)| {
        let k = k as f64;
        r + Vector::new((3.0 * k).sin(), (5.0 * k).cos()) * 0.2
    });
    four.into_iter().map(|r| r + middle).chain(shaken.filter(|r| (r - middle).norm() > 2.6)).collect()
}

/// Flips from a quadrilateral with either diagonal: the one that there is at the end.
fn chosen(four: [Vector<f64>; 4]) -> [usize; 2] {
    let domain = periodic([9.0; 2]).unwrap();
    let last = among_others(four);
    let expected = Tessellation::new(&last, domain).unwrap();
    let joined = |tessellation: &Tessellation, [a, b]: [usize; 2]| {
        tessellation.neighbours(a).iter().any(|other| *other as usize == b)
    };
    let middle = four.iter().sum::<Vector<f64>>() / 4.0;
    let mut flips = Vec::new();
    for (pair, other) in [([0, 2], [1, 3]), ([1, 3], [0, 2])] {
        // Two cells that are near each other are joined.
        let nearer = |k: usize| middle + (four[k] - middle) * if pair.contains(&k) { 0.45 } else { 1.0 };
        let first = among_others(std::array::from_fn(nearer));
        let mut moving = MovingTessellation::new(&first, domain).unwrap();
        assert!(joined(moving.tessellation(), pair) && !joined(moving.tessellation(), other));
        let Renewal::Flipped(count) = moving.renew(&last).unwrap() else { panic!("rebuilt") };
        flips.push(count);
        assert!(*moving.tessellation() == expected);
    }
    // One of the two ways is no flip of theirs.
    assert!(flips.iter().any(|count| *count > 0));
    let both = [[0, 2], [1, 3]].map(|pair| joined(&expected, pair));
    assert_ne!(both[0], both[1], "one diagonal of the two");
    if both[0] { [0, 2] } else { [1, 3] }
}

/// The same sites, the first of them any of the four.
fn numbered_from<T: Copy>(sites: [T; 4], first: usize) -> [T; 4] {
    std::array::from_fn(|k| sites[(first + k) % 4])
}

#[test]
fn the_shorter_diagonal_of_a_rhombus_is_chosen() {
    let rhombus = [[0.0, -1.0], [1.5, 0.0], [0.0, 1.0], [-1.5, 0.0]].map(Vector::from);
    for first in 0..4 {
        let short = if first % 2 == 0 { [0, 2] } else { [1, 3] };
        assert_eq!(chosen(numbered_from(rhombus, first)), short, "{first}");
    }
}

#[test]
fn four_sites_on_a_circle_make_a_fan_from_the_lowest() {
    // No coordinate is rounded.
    let corners = [[-0.75, -0.75], [0.75, -0.75], [0.75, 0.75], [-0.75, 0.75]].map(Vector::from);
    for lowest in 0..4 {
        assert_eq!(chosen(numbered_from(corners, lowest)), [0, 2], "{lowest}");
    }
}

/// A box that becomes a rectangle from oblique ones to either side: one of its diagonals remains, the same from both.
#[test]
fn images_of_one_cell_on_a_circle_are_decided_too() {
    let positions = [Vector::new(0.3, 0.2)];
    for lengths in [[1.0, 1.0], [1.0, 3.0]] {
        let rectangle = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
        let expected = Tessellation::new(&positions, rectangle).unwrap();
        assert_eq!(expected.ring(0).len(), 6);
        for offset in [-0.2, 0.2] {
            let oblique = Domain::Periodic(PeriodicBox::sheared(lengths, offset).unwrap());
            let mut moving = MovingTessellation::new(&positions, oblique).unwrap();
            moving.renew_in(&positions, rectangle).unwrap();
            assert!(*moving.tessellation() == expected, "{lengths:?} {offset}");
        }
    }
}

/// Two cells beside a wall and their images lie on a circle, but for rounding, which an exact predicate of another library decides.
#[test]
fn mirror_images_get_the_diagonal_that_exact_arithmetic_gives_them() -> Result<(), Error> {
    let mut beside_walls = 0;
    for (seed, axis) in [(1, 0), (2, 1), (3, 0), (4, 1)] {
        let mut positions = random(60, [6.0, 10.0], seed);
        let cells = positions.len();
        positions.extend_from_within(..);
        positions[cells..].iter_mut().for_each(|r| r[axis] = -r[axis]);
        let mut lengths = [6.0, 10.0];
        lengths[axis] *= 2.0;
        let domain = periodic(lengths)?;
        let tessellation = Tessellation::new(&positions, domain)?;
        for cell in 0..positions.len() {
            let ring: Vec<usize> = tessellation.ring(cell).collect();
            for m in 0..ring.len() {
                let site = |h: usize| (tessellation.neighbour(h), tessellation.image(h));
                let [before, to, after] = [m + ring.len() - 1, m, m + 1].map(|m| site(ring[m % ring.len()]));
                let mut sites = [(cell, [0, 0]), before, to, after];
                let first = (0..4).min_by_key(|k| sites[*k]).unwrap();
                sites.rotate_left(first);
                let (origin, [x, y]) = sites[0];
                let [a, b, c, d] = sites.map(|(other, image)| {
                    let image = [image[0] - x, image[1] - y];
                    let r = domain.displacement(positions[origin], positions[other], image);
                    robust::Coord { x: r.x, y: r.y }
                });
                let inside = robust::incircle(a, b, c, d);
                assert!(if first % 2 == 0 { inside <= 0.0 } else { inside >= 0.0 }, "{sites:?}");
                let mut own = sites.map(|site| site.0 % cells);
                own.sort_unstable();
                beside_walls += usize::from(own[0] == own[1] && own[2] == own[3]);
            }
        }
    }
    assert!(beside_walls > 100, "{beside_walls}");
    Ok(())
}
