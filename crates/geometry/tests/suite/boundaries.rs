//! Periodic images: tiny boxes, sheared boxes, cells outside the box.

use crate::samples::{difference, honeycomb, periodic, random, sheared};
use voronudge_geometry::{Domain, Error, PeriodicBox, Tessellation, Vector, areas, perimeters};

#[test]
fn tiny_boxes_are_tiled_by_cells_that_neighbour_themselves() -> Result<(), Error> {
    for cells in 1..=5 {
        for seed in 0..20 {
            for (lengths, offset) in
                [([1.0, 1.0], 0.0), ([1.0, 6.0], 0.0), ([5.0, 1.0], 0.4), ([1.0, 1.0], 0.37)]
            {
                let positions = random(cells, lengths, seed);
                let tessellation = Tessellation::new(&positions, sheared(lengths, offset)?)?;
                assert_eq!(tessellation.half_edges(), 6 * cells);
                let total: f64 = areas(&tessellation, &positions).iter().sum();
                assert!(
                    (total / (lengths[0] * lengths[1]) - 1.0).abs() < 1e-12,
                    "{cells} cells, seed {seed}"
                );
            }
        }
    }
    Ok(())
}

#[test]
fn one_cell_in_a_box_has_the_polygon_of_the_lattice() -> Result<(), Error> {
    // The triangular lattice, as one cell in a sheared box.
    let a = (2.0 / 3f64.sqrt()).sqrt();
    let domain = sheared([a, a * 3f64.sqrt() / 2.0], a / 2.0)?;
    let positions = [Vector::new(0.3, 0.2)];
    let tessellation = Tessellation::new(&positions, domain)?;
    assert_eq!(tessellation.neighbours(0), [0; 6]);
    assert!((areas(&tessellation, &positions)[0] - 1.0).abs() < 1e-13);
    assert!((perimeters(&tessellation, &positions)[0] - 3.722_419_436_408_398).abs() < 1e-12);
    Ok(())
}

#[test]
fn a_shear_by_the_box_length_changes_nothing() -> Result<(), Error> {
    let lengths = [9.0, 7.0];
    let positions = random(80, lengths, 5);
    for offset in [0.0, 1.3, -4.0] {
        let tessellation = Tessellation::new(&positions, sheared(lengths, offset)?)?;
        let sizes = areas(&tessellation, &positions);
        assert!((sizes.iter().sum::<f64>() - 63.0).abs() < 1e-11);
        for turns in [1.0, -1.0, 40.0] {
            let other = Tessellation::new(&positions, sheared(lengths, offset + turns * lengths[0])?)?;
            assert!(difference(&areas(&other, &positions), &sizes) < 1e-11);
            assert!(
                difference(&perimeters(&other, &positions), &perimeters(&tessellation, &positions)) < 1e-11
            );
        }
    }
    Ok(())
}

#[test]
fn an_affine_shear_of_half_a_column_maps_the_honeycomb_onto_itself() -> Result<(), Error> {
    let (positions, [x, y]) = honeycomb(6, 6);
    // u = γ y with γ such that neighbouring rows slide by one lattice constant.
    let gamma = (x / 6.0) / (y / 6.0);
    let slid: Vec<_> = positions.iter().map(|r| Vector::new(r.x + gamma * r.y, r.y)).collect();
    let tessellation = Tessellation::new(&slid, sheared([x, y], gamma * y)?)?;
    assert!(difference(&areas(&tessellation, &slid), &[1.0; 36]) < 1e-12);
    assert!(difference(&perimeters(&tessellation, &slid), &[3.722_419_436_408_398; 36]) < 1e-12);
    Ok(())
}

#[test]
fn cells_may_be_given_outside_the_box() -> Result<(), Error> {
    for offset in [0.0, 2.3] {
        let cell_box = PeriodicBox::sheared([6.0, 8.0], offset)?;
        let positions = random(70, [6.0, 8.0], 6);
        let inside = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
        let scattered: Vec<_> = positions
            .iter()
            .enumerate()
            .map(|(i, r)| r + cell_box.translation([(i % 7) as i32 - 3, (i % 5) as i32 - 2]))
            .collect();
        let outside = Tessellation::new(&scattered, Domain::Periodic(cell_box))?;
        // Only the names of the images differ.
        for cell in 0..positions.len() {
            assert_eq!(inside.neighbours(cell), outside.neighbours(cell));
            for (h, g) in inside.ring(cell).zip(outside.ring(cell)) {
                let (d, e) =
                    (inside.displacement(&positions, cell, h), outside.displacement(&scattered, cell, g));
                assert!((d - e).norm() < 1e-12);
            }
        }
        assert!(difference(&areas(&inside, &positions), &areas(&outside, &scattered)) < 1e-11);
    }
    Ok(())
}

#[test]
fn a_cell_on_the_border_of_the_box_counts_once() -> Result<(), Error> {
    let mut positions = random(40, [5.0, 5.0], 8);
    // Just below the box, where wrapping rounds up to its very end; on its corner; on its far side.
    positions[0] = Vector::new(2.0, -1e-18);
    positions[1] = Vector::new(0.0, 0.0);
    positions[2] = Vector::new(5.0, 3.0);
    let tessellation = Tessellation::new(&positions, periodic([5.0, 5.0])?)?;
    assert!((areas(&tessellation, &positions).iter().sum::<f64>() - 25.0).abs() < 1e-12);
    Ok(())
}

#[test]
fn wrapping_lands_in_the_box_and_differs_by_a_lattice_vector() {
    let cell = PeriodicBox::sheared([3.0, 2.0], 0.7).unwrap();
    for r in [Vector::new(-0.1, 5.3), Vector::new(7.0, -4.1), Vector::new(0.0, 0.0)] {
        let w = cell.wrap(r);
        assert!((0.0..3.0).contains(&w.x) && (0.0..2.0).contains(&w.y), "{w}");
        assert!((r - w - cell.translation(cell.image(r))).norm() < 1e-14);
    }
}

#[test]
fn any_shear_makes_a_box_of_the_same_lattice() {
    let cell = PeriodicBox::sheared([3.0, 2.0], 0.7).unwrap();
    for strain in [0.0, 1.3, -2000.0, 6143.0, 6145.0, -1e4, 123_456.5, -1e8] {
        let sheared = cell.after_shear(strain).unwrap();
        let widths = (0.7 + 2.0 * strain - sheared.offset()) / 3.0;
        assert!((widths - widths.round()).abs() < 1e-7, "{strain}: {widths}");
        assert_eq!(widths.round() == 0.0, (0.7 + 2.0 * strain).abs() < 3.0 * 4096.0, "{strain}");
    }
    assert!(cell.runs_on(3000.0) && !cell.runs_on(3200.0) && !cell.runs_on(f64::NAN));
    for strain in [f64::NAN, f64::INFINITY, 2e9] {
        assert!(matches!(cell.after_shear(strain), Err(Error::BoxOffset { .. })));
    }
}

#[test]
fn unusable_boxes_are_refused() {
    assert!(matches!(PeriodicBox::new([0.0, 1.0]), Err(Error::BoxSide { axis: 'x', .. })));
    assert!(matches!(PeriodicBox::new([1.0, f64::NAN]), Err(Error::BoxSide { axis: 'y', .. })));
}
