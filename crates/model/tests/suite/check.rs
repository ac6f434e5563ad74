//! The check can fail: each comparison meets an error that it must find.

use crate::samples::periodic;
use voronudge_geometry::{Domain, Tessellation, Vector};
use voronudge_model::gradient_check::{
    GradientReport, GradientRow, Place, Quantity, check_claimed, check_claimed_parameters,
};
use voronudge_model::{
    Axis, BlockMatrix, CorticalChirality, Model, PARAMETER_NAMES, Parameters, Term, jacobian,
    parameter_derivatives, velocities,
};

/// What is said of a model.
struct Claim {
    positions: Vec<Vector<f64>>,
    domain: Domain,
    model: Model<f64>,
    velocities: Vec<Vector<f64>>,
    jacobian: BlockMatrix,
}

fn places(shift: f64) -> Vec<Vector<f64>> {
    (0..64)
        .map(|i| (f64::from(i % 8), f64::from(i / 8), f64::from(i)))
        .map(|(x, y, i)| Vector::new(x + 0.3 * i.sin() + shift * (3.0 * i).sin(), y + 0.3 * (2.0 * i).cos()))
        .collect()
}

impl Claim {
    /// What is true, of cells that are shifted a little.
    fn of(model: Model<f64>, shift: f64) -> Self {
        let (positions, domain) = (places(shift), periodic([8.0, 8.0]).unwrap());
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let velocities = velocities(&tessellation, &positions, &model);
        let jacobian = jacobian(&tessellation, &positions, &model);
        Self { positions, domain, model, velocities, jacobian }
    }

    fn check(&self) -> GradientReport {
        check_claimed(&self.positions, self.domain, &self.model, &self.velocities, &self.jacobian).unwrap()
    }

    fn failing(&self) -> Vec<Quantity> {
        self.check().rows.iter().filter(|row| !row.passed()).map(|row| row.quantity).collect()
    }

    fn row(&self, quantity: Quantity) -> GradientRow {
        self.check().rows.into_iter().find(|row| row.quantity == quantity).unwrap()
    }
}

fn model(chirality: f64) -> Model<f64> {
    Model::chiral_voronoi(&Parameters { chirality, ..Parameters::default() })
}

#[test]
fn nothing_fails_without_an_error() {
    assert_eq!(Claim::of(model(0.5), 0.0).failing(), []);
}

#[test]
fn the_jacobian_of_slightly_different_positions_is_noticed() {
    let jacobian = Claim::of(model(0.5), 1e-5).jacobian;
    let claim = Claim { jacobian, ..Claim::of(model(0.5), 0.0) };
    assert_eq!(claim.failing(), [Quantity::JacobianByDifferences, Quantity::JacobianByDuals]);
}

#[test]
fn a_single_wrong_entry_is_noticed_and_located() {
    let mut claim = Claim::of(model(0.5), 0.0);
    let largest = claim.jacobian.block.iter().flatten().fold(0.0, |max: f64, entry| max.max(entry.abs()));
    let at = claim.jacobian.row_start[20] + 3;
    let by = claim.jacobian.column[at] as usize;
    claim.jacobian.block[at][2] += 1e-5 * largest;
    let place = Place::Entry { cell: 20, axis: Axis::Y, by, along: Axis::X };
    for quantity in [Quantity::JacobianByDifferences, Quantity::JacobianByDuals] {
        let row = claim.row(quantity);
        assert!(!row.passed());
        assert_eq!(row.place, place);
        assert!((row.worst / 1e-5 - 1.0).abs() < 1e-2, "{}", row.worst);
    }
}

#[test]
fn an_entry_that_is_not_a_number_is_noticed() {
    let mut claim = Claim::of(model(0.5), 0.0);
    claim.jacobian.block[17][1] = f64::NAN;
    let row = claim.row(Quantity::JacobianByDuals);
    assert!(!row.passed() && row.worst.is_infinite());
}

#[test]
fn a_chiral_force_is_not_taken_for_the_gradient_of_an_energy() {
    // The base model without chirality.
    let mut passive = model(0.0);
    passive.terms.retain(|weighted| weighted.term != Term::from(CorticalChirality));
    assert_eq!(Claim::of(passive.clone(), 0.0).failing(), []);
    let velocities = Claim::of(model(1e-4), 0.0).velocities;
    let claim = Claim { velocities, ..Claim::of(passive, 0.0) };
    for quantity in [Quantity::EnergyByDuals, Quantity::EnergyByDifferences] {
        assert!(!claim.row(quantity).passed());
    }
}

#[test]
fn a_mirror_that_does_not_reverse_chirality_is_noticed() {
    let mut claim = Claim::of(Model::single(CorticalChirality.into()), 0.0);
    for v in &mut claim.velocities {
        *v = -*v;
    }
    let failing = claim.failing();
    for quantity in [Quantity::Translation, Quantity::Wrapping, Quantity::Rotation, Quantity::Mirror] {
        assert!(failing.contains(&quantity));
    }
}

#[test]
fn a_force_from_outside_is_noticed() {
    let mut claim = Claim::of(model(0.5), 0.0);
    for v in &mut claim.velocities {
        v.x += 1e-6;
    }
    let failing = claim.failing();
    assert!(failing.contains(&Quantity::Momentum) && failing.contains(&Quantity::Rotation));
}

#[test]
fn a_wrong_parameter_derivative_is_noticed() {
    let parameters = Parameters { chirality: 0.5, ..Parameters::default() };
    let Claim { positions, domain, .. } = Claim::of(Model::chiral_voronoi(&parameters), 0.0);
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let checked = |of: &Parameters<f64>| {
        let derivatives = parameter_derivatives(&tessellation, &positions, of);
        check_claimed_parameters(&positions, domain, &parameters, &derivatives).unwrap()
    };
    let right = checked(&parameters);
    assert!(right.passed() && right.rows.len() == PARAMETER_NAMES.len());
    assert!(!checked(&Parameters { perimeter_elasticity: 1.1, ..parameters }).passed());
}
