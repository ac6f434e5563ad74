//! Large boxes are triangulated in tiles. None of that may be seen.

use crate::samples::{difference, periodic, random, sheared, squares};
use voronudge_geometry::{Error, Tessellation, Vector, areas, perimeters};

#[test]
fn tile_borders_elsewhere_give_the_same_edges() -> Result<(), Error> {
    let lengths = [160.0, 125.0];
    let positions = random(20_000, lengths, 1);
    for offset in [0.0, 31.0] {
        let domain = sheared(lengths, offset)?;
        let edges = Tessellation::new(&positions, domain)?.edges();
        for shift in [Vector::new(80.0, 62.5), Vector::new(3.0, 0.0), Vector::new(-11.0, 17.0)] {
            let shifted: Vec<_> = positions.iter().map(|r| r + shift).collect();
            assert!(edges == Tessellation::new(&shifted, domain)?.edges(), "{shift}");
        }
    }
    Ok(())
}

#[test]
fn a_void_wider_than_a_tile_is_bridged() -> Result<(), Error> {
    let lengths = [100.0, 100.0];
    let hole = |r: &Vector<f64>| (r - Vector::new(70.0, 40.0)).norm() > 38.0;
    let positions: Vec<_> = random(9000, lengths, 2).into_iter().filter(hole).collect();
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    assert_eq!(tessellation.half_edges(), 6 * positions.len());
    let total: f64 = areas(&tessellation, &positions).iter().sum();
    assert!((total / 1e4 - 1.0).abs() < 1e-12, "{total}");
    Ok(())
}

#[test]
fn cells_in_a_corner_of_the_box_reach_across_it() -> Result<(), Error> {
    let lengths = [50.0, 50.0];
    let positions = random(3000, [4.0, 4.0], 3);
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    let total: f64 = areas(&tessellation, &positions).iter().sum();
    // Thin triangles across the void lose digits: a circumradius of 25 over a spacing of 0.07.
    assert!((total / 2500.0 - 1.0).abs() < 1e-9, "{total}");
    Ok(())
}

#[test]
fn a_large_square_lattice_is_consistent_across_tiles() -> Result<(), Error> {
    let positions = squares(80, 60);
    for offset in [0.0, 7.0] {
        let tessellation = Tessellation::new(&positions, sheared([80.0, 60.0], offset)?)?;
        assert_eq!(tessellation.half_edges(), 6 * 4800);
        assert!(difference(&areas(&tessellation, &positions), &[1.0; 4800]) < 1e-9);
        assert!(difference(&perimeters(&tessellation, &positions), &[4.0; 4800]) < 1e-9);
    }
    Ok(())
}

#[test]
fn cells_on_common_circles_off_the_grid_are_consistent_across_tiles() -> Result<(), Error> {
    // A square lattice turned by atan(3/4) fits a box of five lattice constants; its coordinates round.
    let (cos, sin) = (0.8, 0.6);
    let positions: Vec<_> = squares(250, 250)
        .iter()
        .map(|r| Vector::new(r.x, r.y - 125.0))
        .map(|r| Vector::new(cos * r.x - sin * r.y, sin * r.x + cos * r.y))
        .filter(|r| {
            let inside = |x: f64| x > 20.0 - 1e-9 && x < 70.0 - 1e-9;
            inside(r.x) && inside(r.y)
        })
        .collect();
    assert_eq!(positions.len(), 2500);
    let tessellation = Tessellation::new(&positions, periodic([50.0, 50.0])?)?;
    assert_eq!(tessellation.half_edges(), 6 * 2500);
    assert!(difference(&areas(&tessellation, &positions), &[1.0; 2500]) < 1e-6);
    Ok(())
}
