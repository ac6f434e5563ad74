//! The gradient check passes on tissues of every kind, and covers every term.

use crate::samples::{Tissue, honeycomb, jittered, parameters, periodic, random, sheared};
use voronudge_geometry::{Domain, Error, Vector};
use voronudge_model::gradient_check::{CELL_LIMIT, GEOMETRY, GradientReport, MODEL, Quantity, check};
use voronudge_model::{Effect, ForceTerm, PARAMETER_NAMES, Parity, base_terms};

fn checked((positions, domain): Tissue) -> Result<GradientReport, Error> {
    let report = check(&positions, domain, &parameters())?;
    for row in &report.rows {
        assert!(row.passed(), "{}, {}: {:.1e} at {}", row.term, row.quantity, row.worst, row.place);
        assert!(row.compared > 0);
    }
    assert!(report.passed());
    Ok(report)
}

fn has(report: &GradientReport, term: &str, quantity: Quantity) -> bool {
    report.rows.iter().any(|row| row.term == term && row.quantity == quantity)
}

#[test]
fn random_tissues_in_a_box() -> Result<(), Error> {
    for (seed, cells) in [(1, 60), (2, 150), (3, 400)] {
        let side = f64::from(cells as u32).sqrt();
        checked((random(cells, [side, side], seed), periodic([side, side])?))?;
    }
    checked((random(90, [6.0, 15.0], 4), periodic([6.0, 15.0])?))?;
    checked((random(90, [6.0, 15.0], 5), sheared([6.0, 15.0], 1.9)?))?;
    Ok(())
}

#[test]
fn random_tissues_in_an_open_field() -> Result<(), Error> {
    for (seed, cells) in [(11, 60), (12, 150), (13, 300)] {
        let side = f64::from(cells as u32).sqrt();
        checked((random(cells, [side, side], seed), Domain::Open))?;
    }
    checked((jittered(9, 9, 0.3, 14), Domain::Open))?;
    Ok(())
}

#[test]
fn tissues_in_other_units_far_from_the_origin() -> Result<(), Error> {
    let micrometres = |r: &Vector<f64>| r * 12.0 + Vector::new(300.0, -150.0);
    let positions = jittered(10, 10, 0.35, 15).iter().map(micrometres).collect();
    checked((positions, periodic([120.0, 120.0])?))?;
    Ok(())
}

#[test]
fn nearly_degenerate_tissues() -> Result<(), Error> {
    // Four cells nearly on a circle everywhere: sides of length ~ jitter.
    for jitter in [1e-3, 1e-6, 1e-10, 0.0] {
        checked((jittered(8, 8, jitter, 21), periodic([8.0, 8.0])?))?;
        checked((jittered(8, 8, jitter, 22), Domain::Open))?;
    }
    // Two cells nearly at one point: the derivative grows with the inverse of their distance.
    for distance in [1e-2, 1e-4, 1e-6] {
        let mut positions = jittered(8, 8, 0.3, 23);
        positions[12] = positions[40] + Vector::new(0.6, 0.8) * distance;
        checked((positions, periodic([8.0, 8.0])?))?;
    }
    // A void, with circumcircles much larger than a cell.
    let outside = |r: &Vector<f64>| (r - Vector::new(7.0, 6.0)).norm() > 4.5;
    checked((random(200, [14.0, 14.0], 24).into_iter().filter(outside).collect(), periodic([14.0, 14.0])?))?;
    Ok(())
}

#[test]
fn the_honeycomb_where_all_forces_vanish() -> Result<(), Error> {
    let (positions, lengths) = honeycomb(8, 8);
    checked((positions, periodic(lengths)?))?;
    Ok(())
}

#[test]
fn tiny_boxes() -> Result<(), Error> {
    for cells in 1..=6 {
        for seed in 0..4 {
            let side = f64::from(cells as u32).sqrt();
            checked((random(cells, [side, side], 30 + seed), periodic([side, side])?))?;
            checked((random(cells, [side, side], 40 + seed), sheared([side, side], 0.3 * side)?))?;
        }
    }
    Ok(())
}

#[test]
fn every_term_the_model_and_the_geometry_are_covered() -> Result<(), Error> {
    let report = checked((random(100, [10.0, 10.0], 51), periodic([10.0, 10.0])?))?;
    let always = [
        Quantity::JacobianByDifferences,
        Quantity::JacobianByDuals,
        Quantity::Momentum,
        Quantity::Translation,
        Quantity::Wrapping,
        Quantity::Rotation,
        Quantity::Mirror,
    ];
    for term in base_terms(1.0) {
        for quantity in [Quantity::EnergyByDuals, Quantity::EnergyByDifferences] {
            assert_eq!(has(&report, term.name(), quantity), term.has_energy());
        }
    }
    for name in base_terms(1.0).iter().map(ForceTerm::name).chain([MODEL]) {
        assert!(always.iter().all(|&quantity| has(&report, name, quantity)), "{name}");
    }
    assert!(PARAMETER_NAMES.iter().all(|name| has(&report, MODEL, Quantity::ParameterDerivative(name))));
    for quantity in [Quantity::AreaGradient, Quantity::PerimeterGradient, Quantity::VertexMotion] {
        assert!(has(&report, GEOMETRY, quantity));
    }
    Ok(())
}

#[test]
fn every_effect_is_covered_in_a_box_or_in_an_open_field() -> Result<(), Error> {
    let positions = jittered(11, 11, 0.35, 52);
    let reports =
        [checked((positions.clone(), periodic([11.0, 11.0])?))?, checked((positions, Domain::Open))?];
    let covered = |id: &str, quantity| reports.iter().any(|report| has(report, id, quantity));
    let has_columns = |effect: &&Effect| {
        !effect.is_of_polarity() && !effect.is_random_motion() && effect.differing_parameter().is_none()
    };
    for effect in Effect::all().iter().filter(has_columns) {
        assert!(covered(effect.id, Quantity::Translation), "{}", effect.id);
        // Second derivatives are left out of these two.
        let first_order = ["time_lag", "centroid_bias"].contains(&effect.id);
        for quantity in [Quantity::JacobianByDuals, Quantity::JacobianByDifferences] {
            assert_eq!(covered(effect.id, quantity), !first_order, "{}", effect.id);
        }
        let turns = !matches!(effect.parity, Parity::Oriented);
        for quantity in [Quantity::Rotation, Quantity::Mirror] {
            assert_eq!(covered(effect.id, quantity), turns, "{}", effect.id);
        }
    }
    Ok(())
}

#[test]
fn all_cells_are_displaced_unless_they_are_many() -> Result<(), Error> {
    let few = checked((random(120, [10.0, 12.0], 61), periodic([10.0, 12.0])?))?;
    assert_eq!((few.cells, few.displaced), (120, 120));
    let many = checked((jittered(60, 60, 0.35, 62), periodic([60.0, 60.0])?))?;
    assert_eq!((many.cells, many.displaced), (3600, CELL_LIMIT * CELL_LIMIT / 3600));
    Ok(())
}

#[test]
fn an_open_field_has_no_momentum_row() -> Result<(), Error> {
    let report = checked((random(100, [10.0, 10.0], 71), Domain::Open))?;
    assert!(report.rows.iter().all(|row| row.quantity != Quantity::Momentum));
    assert!(report.rows.iter().any(|row| row.quantity == Quantity::Rotation));
    Ok(())
}

#[test]
fn what_cannot_be_tessellated_is_an_error() {
    let positions = [Vector::new(0.0, 0.0), Vector::new(1.0, 0.0)];
    assert!(matches!(check(&positions, Domain::Open, &parameters()), Err(Error::TooFewCells { .. })));
}
