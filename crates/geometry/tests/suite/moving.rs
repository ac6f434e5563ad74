//! Flips against a tessellation anew: the same arrays, whatever the path.

#![allow(clippy::unwrap_used)]

use crate::samples::{honeycomb, periodic, random, sheared, squares};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, Error, MovingTessellation, PeriodicBox, Renewal, Tessellation, Vector};

/// A jittered lattice of `side²` cells: disordered, with few very close pairs.
fn liquid(side: usize, jitter: f64, seed: u64) -> Vec<Vector<f64>> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (squares(side, side).iter())
        .map(|r| r + Vector::new(rng.random_range(-jitter..jitter), rng.random_range(-jitter..jitter)))
        .collect()
}

fn shake(positions: &mut [Vector<f64>], size: f64, rng: &mut Pcg64Mcg) {
    for r in positions {
        *r += Vector::new(rng.random_range(-size..size), rng.random_range(-size..size));
    }
}

/// Makes `steps` random displacements of a size and compares after each; returns (flips, renewals built anew).
fn follow(
    positions: &mut [Vector<f64>],
    domain: Domain,
    size: f64,
    steps: usize,
    seed: u64,
) -> (usize, usize) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut moving = MovingTessellation::new(positions, domain).unwrap();
    let (mut flips, mut rebuilt) = (0, 0);
    for step in 0..steps {
        shake(positions, size, &mut rng);
        match moving.renew(positions).unwrap() {
            Renewal::Flipped(count) => flips += count,
            Renewal::Rebuilt => rebuilt += 1,
        }
        assert!(
            *moving.tessellation() == Tessellation::new(positions, domain).unwrap(),
            "seed {seed}, step {step}"
        );
    }
    (flips, rebuilt)
}

#[test]
fn flips_give_what_a_tessellation_anew_gives() -> Result<(), Error> {
    for seed in 0..40 {
        let mut positions = liquid(12, 0.45, seed);
        let (flips, rebuilt) = follow(&mut positions, periodic([12.0; 2])?, 0.03, 40, seed);
        assert!(flips > 100 && rebuilt < 10, "{flips} flips, {rebuilt} built anew");
    }
    Ok(())
}

#[test]
fn large_displacements_are_followed_too() -> Result<(), Error> {
    let (mut flips, mut rebuilt) = (0, 0);
    for (k, size) in [0.1, 0.2, 0.5, 3.0].into_iter().enumerate() {
        let mut positions = liquid(15, 0.45, 100 + k as u64);
        let counts = follow(&mut positions, periodic([15.0; 2])?, size, 30, k as u64);
        flips += counts.0;
        rebuilt += counts.1;
    }
    assert!(flips > 1000, "{flips}");
    assert!(rebuilt > 30, "{rebuilt}");
    Ok(())
}

#[test]
fn small_and_narrow_boxes_are_followed() -> Result<(), Error> {
    for seed in 0..60 {
        for (cells, lengths, offset) in
            [(1, [1.0, 1.3], 0.2), (2, [1.0, 2.0], 0.0), (5, [2.0, 2.5], 0.7), (20, [2.0, 10.0], -3.1)]
        {
            let mut positions = random(cells, lengths, seed);
            follow(&mut positions, sheared(lengths, offset)?, 0.02, 20, seed);
        }
    }
    Ok(())
}

#[test]
fn many_threads_worth_of_cells_are_followed() -> Result<(), Error> {
    let mut positions = liquid(70, 0.45, 7);
    let (flips, _) = follow(&mut positions, periodic([70.0; 2])?, 0.02, 5, 7);
    assert!(flips > 500, "{flips}");
    Ok(())
}

#[test]
fn nothing_moves_and_nothing_flips() -> Result<(), Error> {
    let (lattice, lengths) = honeycomb(6, 6);
    for (positions, domain) in [(lattice, periodic(lengths)?), (squares(6, 5), periodic([6.0, 5.0])?)] {
        let mut moving = MovingTessellation::new(&positions, domain)?;
        assert_eq!(moving.renew(&positions)?, Renewal::Flipped(0));
    }
    Ok(())
}

/// Four cells on each circle, exactly: both ways break the tie by the same rule, wherever the cells come from.
#[test]
fn a_square_lattice_is_reached_from_all_sides() -> Result<(), Error> {
    let lattice = squares(9, 8);
    let domain = periodic([9.0, 8.0])?;
    let expected = Tessellation::new(&lattice, domain)?;
    for seed in 0..20 {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut positions = lattice.clone();
        shake(&mut positions, 0.1, &mut rng);
        let mut moving = MovingTessellation::new(&positions, domain)?;
        moving.renew(&lattice)?;
        assert!(*moving.tessellation() == expected, "{seed}");
    }
    Ok(())
}

#[test]
fn cells_that_run_across_the_boundary_keep_their_neighbours() -> Result<(), Error> {
    let domain = periodic([10.0; 2])?;
    let mut positions = liquid(10, 0.4, 3);
    let mut moving = MovingTessellation::new(&positions, domain)?;
    let velocities = liquid(10, 0.4, 4);
    for _ in 0..400 {
        for (i, (r, v)) in positions.iter_mut().zip(&velocities).enumerate() {
            *r += Vector::new(0.1, -0.07) + v * (0.002 * (i as f64).sin());
        }
        moving.renew(&positions)?;
    }
    assert!(positions.iter().all(|r| r.x > 30.0), "several boxes on");
    assert_eq!(*moving.tessellation(), Tessellation::new(&positions, domain)?);
    Ok(())
}

#[test]
fn a_box_that_is_sheared_is_followed() -> Result<(), Error> {
    let mut positions = liquid(12, 0.4, 5);
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut moving = MovingTessellation::new(&positions, periodic([12.0; 2])?)?;
    let mut flips = 0;
    for step in 1..=400 {
        shake(&mut positions, 0.01, &mut rng);
        let strain = 0.01 * f64::from(step);
        for r in &mut positions {
            r.x += 0.01 * r.y;
        }
        let domain = Domain::Periodic(PeriodicBox::sheared([12.0; 2], 12.0 * strain)?);
        if let Renewal::Flipped(count) = moving.renew_in(&positions, domain)? {
            flips += count;
        }
        assert!(*moving.tessellation() == Tessellation::new(&positions, domain)?, "{step}");
    }
    assert!(flips > 500, "{flips}");
    Ok(())
}

#[test]
fn unusable_positions_are_refused_and_can_be_followed_by_good_ones() -> Result<(), Error> {
    let domain = periodic([8.0; 2])?;
    let positions = liquid(8, 0.4, 6);
    let mut moving = MovingTessellation::new(&positions, domain)?;
    for wrong in [Vector::new(f64::NAN, 0.0), Vector::new(1.0, f64::INFINITY), positions[5]] {
        let mut broken = positions.clone();
        broken[3] = wrong;
        assert!(moving.renew(&broken).is_err());
        moving.renew(&positions)?;
        assert_eq!(*moving.tessellation(), Tessellation::new(&positions, domain)?);
    }
    let fewer = &positions[..50];
    assert_eq!(moving.renew(fewer)?, Renewal::Rebuilt);
    assert_eq!(*moving.tessellation(), Tessellation::new(fewer, domain)?);
    Ok(())
}

/// Cells go and come as they do in tissues that proliferate: new ones take the numbers of those that are gone, what is left is closed up or added.
fn exchange(positions: &mut Vec<Vector<f64>>, places: &[Vector<f64>], gone: usize, rng: &mut Pcg64Mcg) {
    let mut gone: Vec<usize> = (0..gone).map(|_| rng.random_range(0..positions.len())).collect();
    gone.sort_unstable();
    gone.dedup();
    for (order, place) in places.iter().enumerate() {
        match gone.get(order) {
            Some(cell) => positions[*cell] = *place,
            None => positions.push(*place),
        }
    }
    for cell in gone.into_iter().skip(places.len()).rev() {
        positions.remove(cell);
    }
}

/// Goes on with other cells, and compares.
fn exchanged(
    moving: &mut MovingTessellation,
    positions: &[Vector<f64>],
    domain: Domain,
    words: &str,
) -> Result<Renewal, Error> {
    let (next, renewal) = moving.exchanged(positions, domain)?;
    assert!(*next.tessellation() == Tessellation::new(positions, domain)?, "{words}");
    *moving = next;
    Ok(renewal)
}

/// Wherever cells go and come, among many or few others, beside each other and across the boundary, all arrays are those of a tessellation anew.
#[test]
fn cells_that_come_and_go_leave_the_others() -> Result<(), Error> {
    let (mut local, mut anew) = (0, 0);
    for seed in 0..30 {
        let side = 8 + seed as usize % 5;
        let domain =
            if seed % 3 == 0 { sheared([side as f64; 2], 0.3)? } else { periodic([side as f64; 2])? };
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut positions = liquid(side, 0.45, seed);
        let mut moving = MovingTessellation::new(&positions, domain)?;
        for round in 0..40 {
            shake(&mut positions, 0.03, &mut rng);
            moving.renew(&positions)?;
            let (gone, born) = (rng.random_range(0..4), rng.random_range(0..4));
            let middle = positions[rng.random_range(0..positions.len())];
            let reach = if round % 2 == 0 { 0.5 } else { side as f64 };
            let mut near =
                || middle + Vector::new(rng.random_range(-reach..reach), rng.random_range(-reach..reach));
            let places: Vec<_> = (0..born).map(|_| near()).collect();
            exchange(&mut positions, &places, gone, &mut rng);
            let words = format!("seed {seed}, round {round}: {gone} gone, {born} born");
            match exchanged(&mut moving, &positions, domain, &words)? {
                Renewal::Flipped(_) => local += 1,
                Renewal::Rebuilt => anew += 1,
            }
        }
    }
    assert!(local > 1000, "{local} exchanged, {anew} anew");
    Ok(())
}

/// Mirror images, of which two and two lie on a circle, with the numbers behind those of the cells.
#[test]
fn cells_between_mirrors_come_and_go() -> Result<(), Error> {
    let mirrored = |cells: &[Vector<f64>]| -> Vec<Vector<f64>> {
        cells.iter().copied().chain(cells.iter().map(|r| Vector::new(-r.x, r.y))).collect()
    };
    let domain = periodic([20.0, 10.0])?;
    let (mut local, mut anew) = (0, 0);
    for seed in 0..10 {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut cells: Vec<_> = liquid(10, 0.4, seed).iter().map(|r| r + Vector::new(0.5, 0.5)).collect();
        let mut moving = MovingTessellation::new(&mirrored(&cells), domain)?;
        for round in 0..20 {
            let (gone, born) = (rng.random_range(0..3), rng.random_range(0..3));
            let mut near = || Vector::new(rng.random_range(0.05..2.0), rng.random_range(0.0..10.0));
            let places: Vec<_> = (0..born).map(|_| near()).collect();
            exchange(&mut cells, &places, gone, &mut rng);
            let positions = mirrored(&cells);
            let words = format!("seed {seed}, round {round}: {gone} gone, {born} born");
            match exchanged(&mut moving, &positions, domain, &words)? {
                Renewal::Flipped(_) => local += 1,
                Renewal::Rebuilt => anew += 1,
            }
        }
    }
    assert!(local > 150, "{local} exchanged, {anew} anew");
    Ok(())
}

/// What cannot be exchanged is told as it is of a tessellation anew, and other orders are built anew.
#[test]
fn exchanges_of_all_kinds_are_answered() -> Result<(), Error> {
    let (positions, domain) = (liquid(9, 0.4, 1), periodic([9.0; 2])?);
    let moving = MovingTessellation::new(&positions, domain)?;
    for wrong in [Vector::new(f64::NAN, 0.0), positions[5]] {
        let mut broken = positions.clone();
        broken.push(wrong);
        assert!(moving.exchanged(&broken, domain).is_err());
    }
    let mut turned = positions.clone();
    turned.swap(3, 60);
    let wider = periodic([9.5, 9.0])?;
    for (cells, domain) in [(&turned[..], domain), (&positions[..40], domain), (&positions, wider)] {
        let (next, renewal) = moving.exchanged(cells, domain)?;
        assert_eq!(renewal, Renewal::Rebuilt);
        assert_eq!(*next.tessellation(), Tessellation::new(cells, domain)?);
    }
    Ok(())
}

/// Small displacements of the cells within leave the hull of an open field; larger ones of all cells change it now and then.
#[test]
fn an_open_field_is_followed_too() {
    let (mut flips, mut rebuilt) = (0, 0);
    for seed in 0..20 {
        let few = follow(&mut liquid(12, 0.45, seed), Domain::Open, 0.005, 40, seed);
        (flips, rebuilt) = (flips + few.0, rebuilt + few.1);
        follow(&mut liquid(6, 0.45, seed), Domain::Open, 0.1, 40, seed);
        follow(&mut liquid(2, 0.3, seed), Domain::Open, 0.2, 40, seed);
    }
    assert!(flips > 400 && rebuilt < 400, "{flips} flips, {rebuilt} of 800 built anew");
}

/// A fan of triangles that are all counter-clockwise and wind around their common cell twice, in a star: convex at each of its points.
#[test]
fn a_hull_that_is_gone_round_twice_is_none() -> Result<(), Error> {
    let on_circle = |k: usize, step: usize| {
        let angle = 0.3 + std::f64::consts::TAU * (k * step) as f64 / 5.0;
        Vector::new(angle.cos(), angle.sin()) * (1.0 + 0.01 * k as f64)
    };
    let star = |step: usize| -> Vec<Vector<f64>> {
        std::iter::once(Vector::new(0.02, 0.01)).chain((0..5).map(|k| on_circle(k, step))).collect()
    };
    let mut moving = MovingTessellation::new(&star(1), Domain::Open)?;
    assert_eq!(moving.renew(&star(2))?, Renewal::Rebuilt);
    assert_eq!(*moving.tessellation(), Tessellation::new(&star(2), Domain::Open)?);
    Ok(())
}

/// Cells on a common circle may have either diagonal: an open field is then built anew, and is that.
#[test]
fn ties_of_an_open_field_are_left_to_a_tessellation_anew() -> Result<(), Error> {
    let lattice = squares(5, 5);
    let mut shaken = lattice.clone();
    // Within the hull of the corners, so that it stays.
    for (k, r) in shaken.iter_mut().enumerate() {
        *r *= 1.0 - 0.02 * (k as f64).sin().abs();
    }
    let mut moving = MovingTessellation::new(&shaken, Domain::Open)?;
    for positions in [&lattice, &shaken, &lattice] {
        moving.renew(positions)?;
        assert_eq!(*moving.tessellation(), Tessellation::new(positions, Domain::Open)?);
    }
    Ok(())
}
