//! Areas and perimeters.

use crate::samples::{difference, honeycomb, periodic, random, sheared, squares};
use voronudge_geometry::{CellPolygon, Domain, Error, Tessellation, Vector, areas, perimeters};

#[test]
fn areas_tile_the_box() -> Result<(), Error> {
    for (seed, cells) in [7, 30, 100, 400].into_iter().enumerate() {
        for (lengths, offset) in [([5.0, 5.0], 0.0), ([20.0, 3.0], 0.0), ([4.0, 9.0], 1.7)] {
            let positions = random(cells, lengths, seed as u64);
            let tessellation = Tessellation::new(&positions, sheared(lengths, offset)?)?;
            let areas = areas(&tessellation, &positions);
            let total: f64 = areas.iter().sum();
            // Rounding of each area, of the order of N ε.
            assert!((total / (lengths[0] * lengths[1]) - 1.0).abs() < 1e-12, "{cells} cells, {total}");
            assert!(areas.iter().all(|&a| a > 0.0));
        }
    }
    Ok(())
}

#[test]
fn an_open_field_has_the_polygons_of_the_box_it_is_cut_from() -> Result<(), Error> {
    let lengths = [6.0, 5.0];
    let positions = random(40, lengths, 3);
    let boxed = Tessellation::new(&positions, periodic(lengths)?)?;
    let copies = (0..9).map(|k| Vector::new((k % 3) as f64 * lengths[0], (k / 3) as f64 * lengths[1]));
    let field: Vec<_> = copies.flat_map(|shift| positions.iter().map(move |r| r + shift)).collect();
    let open = Tessellation::new(&field, Domain::Open)?;
    let central = 4 * positions.len()..5 * positions.len();
    assert!(central.clone().all(|cell| open.is_closed(cell)));
    let found = (areas(&open, &field), perimeters(&open, &field));
    // Coordinates three times as large round to three times as much.
    assert!(difference(&found.0[central.clone()], &areas(&boxed, &positions)) < 1e-12);
    assert!(difference(&found.1[central.clone()], &perimeters(&boxed, &positions)) < 1e-12);
    assert!((found.0[central].iter().sum::<f64>() - 30.0).abs() < 1e-12);
    for cell in 0..open.len() {
        assert_eq!(found.0[cell].is_nan(), !open.is_closed(cell));
    }
    Ok(())
}

#[test]
fn honeycomb_cells_are_regular_hexagons() -> Result<(), Error> {
    // Side of a regular hexagon of unit area: 3√3/2 d² = 1.
    let d = (2.0 / (3.0 * 3f64.sqrt())).sqrt();
    assert!((6.0 * d - 3.722_419_436_408_398).abs() < 1e-12);
    let (positions, lengths) = honeycomb(6, 8);
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    let mut polygon = CellPolygon::<f64>::default();
    for cell in 0..positions.len() {
        polygon.fill(&tessellation, &positions, cell);
        assert_eq!(polygon.len(), 6);
        assert!((polygon.shape().area - 1.0).abs() < 1e-13);
        assert!((polygon.shape().perimeter - 6.0 * d).abs() < 1e-13);
        assert!(polygon.side_lengths().all(|length| (length - d).abs() < 1e-13));
        assert!(polygon.vertices().all(|c| (c.norm() - d).abs() < 1e-13));
    }
    Ok(())
}

#[test]
fn square_cells_have_area_1_and_perimeter_4() -> Result<(), Error> {
    let positions = squares(8, 6);
    for domain in [periodic([8.0, 6.0])?, Domain::Open] {
        let tessellation = Tessellation::new(&positions, domain)?;
        // On a straight rim, whether a cell is on the hull is left to rounding; inside nothing is.
        let inside = |cell: &usize| (1..7).contains(&(cell % 8)) && (1..5).contains(&(cell / 8));
        let cells: Vec<usize> = match domain {
            Domain::Open => (0..48).filter(inside).collect(),
            Domain::Periodic(_) => (0..48).collect(),
        };
        let (areas, perimeters) = (areas(&tessellation, &positions), perimeters(&tessellation, &positions));
        for cell in cells {
            assert!((areas[cell] - 1.0).abs() < 1e-9, "cell {cell}: {}", areas[cell]);
            assert!((perimeters[cell] - 4.0).abs() < 1e-9, "cell {cell}: {}", perimeters[cell]);
        }
    }
    Ok(())
}

#[test]
fn sides_add_up_to_the_perimeter_and_none_is_negative() -> Result<(), Error> {
    let positions = random(300, [10.0, 10.0], 11);
    let tessellation = Tessellation::new(&positions, periodic([10.0, 10.0])?)?;
    let mut polygon = CellPolygon::<f64>::default();
    for cell in 0..positions.len() {
        polygon.fill(&tessellation, &positions, cell);
        let lengths: Vec<f64> = polygon.side_lengths().collect();
        assert!(lengths.iter().all(|&length| length > -1e-12));
        assert!((lengths.iter().sum::<f64>() - polygon.shape().perimeter).abs() < 1e-12);
    }
    Ok(())
}
