//! The check can fail: each comparison meets an error that it must find.

use super::*;
use crate::{CorticalChirality, parameter_derivatives};
use voronudge_geometry::PeriodicBox;

fn sample(shift: f64) -> Sample {
    let positions: Vec<_> = (0..64)
        .map(|i| (f64::from(i % 8), f64::from(i / 8), f64::from(i)))
        .map(|(x, y, i)| Vector::new(x + 0.3 * i.sin() + shift * (3.0 * i).sin(), y + 0.3 * (2.0 * i).cos()))
        .collect();
    Sample::new(&positions, Domain::Periodic(PeriodicBox::new([8.0, 8.0]).unwrap())).unwrap()
}

fn failing(subject: &Subject) -> Vec<Quantity> {
    let images = Images::of(subject.sample).unwrap();
    let rows = subject.rows(&images);
    rows.iter().filter(|row| !row.passed()).map(|row| row.quantity).collect()
}

fn model(chirality: f64) -> Model<f64> {
    Model::chiral_voronoi(&Parameters { chirality, ..Parameters::default() })
}

#[test]
fn nothing_fails_without_an_error() {
    let sample = sample(0.0);
    assert_eq!(failing(&Subject::new(MODEL, model(0.5), &sample, CELL_LIMIT)), []);
}

#[test]
fn the_jacobian_of_slightly_different_positions_is_noticed() {
    let (sample, other) = (sample(0.0), sample(1e-5));
    let mut subject = Subject::new(MODEL, model(0.5), &sample, CELL_LIMIT);
    subject.jacobian = jacobian(&other.tessellation, &other.positions, &subject.model);
    assert_eq!(failing(&subject), [Quantity::JacobianByDifferences, Quantity::JacobianByDuals]);
}

#[test]
fn a_single_wrong_entry_is_noticed_and_located() {
    let sample = sample(0.0);
    let mut subject = Subject::new(MODEL, model(0.5), &sample, CELL_LIMIT);
    let largest = subject.jacobian.block.iter().flatten().fold(0.0, |max: f64, entry| max.max(entry.abs()));
    let at = subject.jacobian.row_start[20] + 3;
    let by = subject.jacobian.column[at] as usize;
    subject.jacobian.block[at][2] += 1e-5 * largest;
    let place = Place::Entry { cell: 20, axis: Axis::Y, by, along: Axis::X };
    for (quantity, comparison) in [
        (Quantity::JacobianByDifferences, differences::jacobian(&subject)),
        (Quantity::JacobianByDuals, duals::jacobian(&subject)),
    ] {
        let row = comparison.row(MODEL, quantity).unwrap();
        assert!(!row.passed());
        assert_eq!(row.place, place);
        assert!((row.worst / 1e-5 - 1.0).abs() < 1e-2, "{}", row.worst);
    }
}

#[test]
fn an_entry_that_is_not_a_number_is_noticed() {
    let sample = sample(0.0);
    let mut subject = Subject::new(MODEL, model(0.5), &sample, CELL_LIMIT);
    subject.jacobian.block[17][1] = f64::NAN;
    let row = duals::jacobian(&subject).row(MODEL, Quantity::JacobianByDuals).unwrap();
    assert!(!row.passed() && row.worst.is_infinite());
}

#[test]
fn a_chiral_force_is_not_taken_for_the_gradient_of_an_energy() {
    let sample = sample(0.0);
    let mut subject = Subject::new(MODEL, model(0.0), &sample, CELL_LIMIT);
    subject.velocities = Subject::new(MODEL, model(1e-4), &sample, CELL_LIMIT).velocities;
    for (quantity, comparison) in [
        (Quantity::EnergyByDuals, duals::energy(&subject)),
        (Quantity::EnergyByDifferences, differences::energy(&subject)),
    ] {
        assert!(!comparison.row(MODEL, quantity).unwrap().passed());
    }
}

#[test]
fn a_mirror_that_does_not_reverse_chirality_is_noticed() {
    let sample = sample(0.0);
    let mut subject =
        Subject::new("wrong parity", Model::single(CorticalChirality.into()), &sample, CELL_LIMIT);
    for v in &mut subject.velocities {
        *v = -*v;
    }
    let failing = failing(&subject);
    for quantity in [Quantity::Translation, Quantity::Wrapping, Quantity::Rotation, Quantity::Mirror] {
        assert!(failing.contains(&quantity));
    }
}

#[test]
fn a_force_from_outside_is_noticed() {
    let sample = sample(0.0);
    let mut subject = Subject::new(MODEL, model(0.5), &sample, CELL_LIMIT);
    for v in &mut subject.velocities {
        v.x += 1e-6;
    }
    let failing = failing(&subject);
    assert!(failing.contains(&Quantity::Momentum) && failing.contains(&Quantity::Rotation));
}

#[test]
fn a_wrong_parameter_derivative_is_noticed() {
    let sample = sample(0.0);
    let parameters = Parameters { chirality: 0.5, ..Parameters::default() };
    let subject = Subject::new(MODEL, Model::chiral_voronoi(&parameters), &sample, CELL_LIMIT);
    assert!(differences::parameters(&subject, &parameters).iter().all(GradientRow::passed));
    let other = Parameters { chirality: 0.5, perimeter_elasticity: 1.1, ..parameters };
    let exact = parameter_derivatives(&sample.tessellation, &sample.positions, &other);
    let rows = differences::parameters_against(&subject, &parameters, &exact);
    assert!(rows.iter().any(|row| !row.passed()));
}
