//! What cannot be tessellated, and the error that says why.

use crate::samples::{periodic, random};
use voronudge_geometry::{Domain, Error, PeriodicBox, Tessellation, Vector};

fn error(positions: &[Vector<f64>], domain: Domain) -> Option<Error> {
    Tessellation::new(positions, domain).err()
}

#[test]
fn positions_that_are_no_numbers_are_named() -> Result<(), Error> {
    for domain in [periodic([5.0, 5.0])?, Domain::Open] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
            for axis in 0..2 {
                let mut positions = random(20, [5.0, 5.0], 1);
                positions[13][axis] = value;
                let found = error(&positions, domain);
                assert!(matches!(found, Some(Error::Position { cell: 13, .. })), "{value}: {found:?}");
            }
        }
    }
    Ok(())
}

#[test]
fn cells_very_many_boxes_away_are_refused() -> Result<(), Error> {
    let mut positions = random(20, [5.0, 5.0], 2);
    for value in [1e6, -1e6, 1e17] {
        positions[4].y = value;
        assert!(matches!(error(&positions, periodic([5.0, 5.0])?), Some(Error::Position { cell: 4, .. })));
    }
    Ok(())
}

/// Where determinants overflow, a tessellation is right or refused.
#[test]
fn huge_coordinates_come_to_an_end() -> Result<(), Error> {
    let positions = random(120, [8.0, 8.0], 1);
    for unit in [2f64.powi(180), 2f64.powi(230), 2f64.powi(300)] {
        let scaled: Vec<_> = positions.iter().map(|r| r * unit).collect();
        for (domain, other) in
            [(periodic([8.0, 8.0])?, periodic([8.0 * unit; 2])?), (Domain::Open, Domain::Open)]
        {
            match Tessellation::new(&scaled, other) {
                Ok(found) => assert_eq!(found.edges(), Tessellation::new(&positions, domain)?.edges()),
                Err(error) => assert!(matches!(error, Error::Inconsistent { .. }), "{error}"),
            }
        }
    }
    Ok(())
}

#[test]
fn duplicates_are_named() -> Result<(), Error> {
    let mut positions = random(30, [5.0, 5.0], 3);
    positions[17] = positions[5];
    for domain in [periodic([5.0, 5.0])?, Domain::Open] {
        let found = error(&positions, domain);
        assert!(
            matches!(found, Some(Error::DuplicateCells { first: 5, second: 17, x, .. }) if x == positions[5].x),
            "{found:?}"
        );
    }
    Ok(())
}

#[test]
fn duplicates_after_wrapping_are_named() -> Result<(), Error> {
    let cell_box = PeriodicBox::sheared([4.0, 8.0], 0.5)?;
    let mut positions = random(30, [4.0, 8.0], 4);
    positions[2] = Vector::new(1.5, 2.25);
    positions[29] = positions[2] + cell_box.translation([-1, 2]);
    let found = error(&positions, Domain::Periodic(cell_box));
    assert!(matches!(found, Some(Error::DuplicateCells { first: 2, second: 29, .. })), "{found:?}");
    assert!(error(&positions, Domain::Open).is_none());
    Ok(())
}

#[test]
fn cells_on_a_line_have_no_field() {
    for direction in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0), Vector::new(1.0, 2.0)] {
        let line: Vec<_> = (0..10).map(|i| direction * f64::from(i)).collect();
        assert_eq!(error(&line, Domain::Open), Some(Error::Collinear { cells: 10 }));
    }
}

#[test]
fn cells_on_a_line_fill_a_box() -> Result<(), Error> {
    let line: Vec<_> = (0..10).map(|i| Vector::new(f64::from(i) + 0.5, 1.0)).collect();
    let tessellation = Tessellation::new(&line, periodic([10.0, 3.0])?)?;
    let areas = voronudge_geometry::areas(&tessellation, &line);
    assert!(areas.iter().all(|a| (a - 3.0).abs() < 1e-6), "{areas:?}");
    Ok(())
}

#[test]
fn too_few_cells_are_counted() -> Result<(), Error> {
    let positions = random(2, [1.0, 1.0], 5);
    for found in 0..=2 {
        assert_eq!(error(&positions[..found], Domain::Open), Some(Error::TooFewCells { found, required: 3 }));
    }
    assert_eq!(error(&[], periodic([1.0, 1.0])?), Some(Error::TooFewCells { found: 0, required: 1 }));
    Ok(())
}

#[test]
fn unusable_boxes_are_refused() {
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(PeriodicBox::new([length, 1.0]), Err(Error::BoxSide { axis: 'x', .. })));
        assert!(matches!(PeriodicBox::new([1.0, length]), Err(Error::BoxSide { axis: 'y', .. })));
    }
    // Images are counted in 16 bits: a shear of very many boxes would be taken for another one.
    for offset in [f64::NAN, f64::INFINITY, 4e4, -1e9] {
        assert!(matches!(PeriodicBox::sheared([1.0, 1.0], offset), Err(Error::BoxOffset { .. })));
    }
    assert!(PeriodicBox::sheared([1.0, 1.0], 8000.0).is_ok());
}

#[test]
fn every_error_has_a_message_in_lower_case_and_a_hint() {
    let errors = [
        Error::BoxSide { axis: 'x', length: 0.0 },
        Error::Grid { axis: 'x', origin: 0.0, spacing: 0.0 },
        Error::Position { cell: 3, x: f64::NAN, y: 0.0 },
        Error::TooFewCells { found: 1, required: 3 },
        Error::DuplicateCells { first: 0, second: 1, x: 0.0, y: 0.0 },
        Error::Collinear { cells: 4 },
        Error::Inconsistent { cells: 4, cell: 0 },
        Error::TooManyCells { cells: 5, limit: 4 },
    ];
    for error in errors {
        let text = error.to_string();
        assert!(!text.ends_with('.') && !text.starts_with(char::is_uppercase), "{text}");
        assert!(error.hint().is_some());
    }
}
