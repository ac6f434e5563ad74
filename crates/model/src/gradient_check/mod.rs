//! Every derivative and every symmetry of the model, checked on given positions against independent ways to get it.
//!
//! The sparse Jacobian is assembled from derivatives of single elements. Here it meets what takes nothing for granted:
//! central differences of the velocities, and dual numbers through the whole system. Velocities meet the gradient of the
//! energy they descend, and the tissue as it was moved, wrapped, turned and mirrored. The list of terms is
//! [`base_terms`] and the catalogue of effects, so a new effect is checked from the moment it exists.
//! Data that effects refer to (labels, earlier velocities, a map, an edge) are made up. The columns of an effect are
//! checked together, with different coefficients; responses on top of the base model.
//!
//! Some rows are missing: an effect that refers to directions of the frame has no rotation and no mirror, one that does
//! not conserve momentum no sum, and one whose Jacobian leaves something out
//! ([`Exactness`]) is not compared or to that accuracy only.
//!
//! Each row of the report states its largest error *relative to the largest magnitude of the quantity compared*. Where
//! symmetry makes a quantity vanish, as on the honeycomb, only rounding is left to compare. The magnitude therefore
//! includes what rounding can do, counted 1e10 times so that it stays within the tolerance of 1e-10: for the Jacobian
//! `8 ε max(|f| / h)`, with `f` the force of one cell on another and `h` the step of central differences there; for the
//! velocity of cell `i` `8 ε (max|f| + d Σ_j |J_ij|)`, with `d` the largest distance of neighbours or, where the
//! positions themselves are mapped and hence rounded, the largest coordinate.
//!
//! In an open field of view, velocities without a value (on the rim and next to it) are left out, and so is the
//! momentum. Where four cells lie on a circle to rounding, two topologies are equally good and give different forces;
//! such places are left out where a row needs a second tessellation. Cells within some 1e-8 of a position where a formula
//! is singular, such as another cell, are displaced by dual numbers only. A row without anything to compare is not reported.
//!
//! ```
//! use voronudge_geometry::{Domain, PeriodicBox, Vector};
//! use voronudge_model::{Parameters, gradient_check};
//!
//! let positions: Vec<_> = (0..36)
//!     .map(|i| Vector::new((i % 6) as f64 + 0.3 * (i as f64).sin(), (i / 6) as f64 + 0.3 * (2.0 * i as f64).cos()))
//!     .collect();
//! let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0])?);
//! let report = gradient_check::check(&positions, domain, &Parameters { chirality: 0.5, ..Parameters::default() })?;
//! assert!(report.passed());
//! # Ok::<(), voronudge_geometry::Error>(())
//! ```

mod comparison;
mod differences;
mod duals;
mod polygons;
mod report;
mod sample;
mod symmetry;

pub use crate::Axis;
pub use report::{GradientReport, GradientRow, Place, Quantity};

use crate::{
    BlockMatrix, Column, Effect, Environment, Exactness, FlowResponse, ForceTerm, Model, PARAMETER_NAMES,
    Parameters, Parity, base_terms, jacobian, velocities,
};
use comparison::Comparison;
use sample::Sample;
use symmetry::Images;
use voronudge_geometry::{Domain, Error, Scalar, Vector};

/// Name of the rows of the whole base model.
pub const MODEL: &str = "chiral Voronoi model";

/// Name of the rows of a model given to [`check_model`].
pub const MODEL_WITH_EFFECTS: &str = "model with effects";

/// Name of the rows that concern no force.
pub const GEOMETRY: &str = "geometry";

/// Number of cells up to which all are displaced. Of more cells, `CELL_LIMIT² / N` are, evenly spaced by index, so that
/// the time does not grow with the square of their number.
pub const CELL_LIMIT: usize = 600;

/// Number of cells that are displaced to check an effect of the catalogue.
pub const EFFECT_CELLS: usize = 24;

/// Checks the base terms (for a coefficient of one), the base model with `parameters`, every effect that applies, and the
/// geometry, at `positions` (N).
///
/// # Errors
/// [`Error`] if the positions cannot be tessellated.
pub fn check(
    positions: &[Vector<f64>],
    domain: Domain,
    parameters: &Parameters<f64>,
) -> Result<GradientReport, Error> {
    let sample = Sample::new(positions, domain)?;
    let images = Images::of(&sample)?;
    let mut rows = polygons::rows(&sample);
    for term in base_terms(parameters.preferred_area) {
        let model = Model::single(term);
        rows.extend(Subject::new(term.name(), model, &sample, CELL_LIMIT).rows(&images));
    }
    let base = Subject::new(MODEL, Model::chiral_voronoi(parameters), &sample, CELL_LIMIT);
    rows.extend(base.rows(&images));
    rows.extend(differences::parameters(&base, parameters));
    for effect in Effect::all() {
        if let Some(model) = effect_model(effect, parameters, &sample) {
            rows.extend(Subject::new(effect.id, model, &sample, EFFECT_CELLS).rows(&images));
        }
    }
    Ok(GradientReport { cells: positions.len(), displaced: sample.displaced.len(), rows })
}

/// Checks one model at `positions` (N), in the environment that is made up for effects.
///
/// # Errors
/// [`Error`] if the positions cannot be tessellated.
pub fn check_model(
    positions: &[Vector<f64>],
    domain: Domain,
    model: &Model<f64>,
) -> Result<GradientReport, Error> {
    let sample = Sample::new(positions, domain)?;
    let images = Images::of(&sample)?;
    let subject =
        Subject::new(MODEL_WITH_EFFECTS, model.clone().within(&sample.environment), &sample, EFFECT_CELLS);
    let displaced = subject.displaced.len();
    Ok(GradientReport { cells: positions.len(), displaced, rows: subject.rows(&images) })
}

/// Checks velocities (N) and their derivatives by the positions that are said to be those of a model, under the name [`MODEL`].
///
/// # Errors
/// [`Error`] if the positions cannot be tessellated.
pub fn check_claimed(
    positions: &[Vector<f64>],
    domain: Domain,
    model: &Model<f64>,
    velocities: &[Vector<f64>],
    jacobian: &BlockMatrix,
) -> Result<GradientReport, Error> {
    let sample = Sample::new(positions, domain)?;
    let subject = Subject {
        velocities: velocities.to_vec(),
        jacobian: jacobian.clone(),
        ..Subject::new(MODEL, model.clone(), &sample, CELL_LIMIT)
    };
    let rows = subject.rows(&Images::of(&sample)?);
    Ok(GradientReport { cells: positions.len(), displaced: subject.displaced.len(), rows })
}

/// Checks velocities that are said to be the derivatives of those of the base model by each of [`PARAMETER_NAMES`] (each N),
/// under the name [`MODEL`].
///
/// # Errors
/// [`Error`] if the positions cannot be tessellated.
pub fn check_claimed_parameters(
    positions: &[Vector<f64>],
    domain: Domain,
    parameters: &Parameters<f64>,
    derivatives: &[Vec<Vector<f64>>; PARAMETER_NAMES.len()],
) -> Result<GradientReport, Error> {
    let sample = Sample::new(positions, domain)?;
    let base = Subject::new(MODEL, Model::chiral_voronoi(parameters), &sample, CELL_LIMIT);
    let rows = differences::parameters_against(&base, parameters, derivatives);
    Ok(GradientReport { cells: positions.len(), displaced: sample.displaced.len(), rows })
}

/// The labels, earlier velocities, map and edge that are made up for effects that need them.
///
/// # Errors
/// [`Error`] if the positions cannot be tessellated.
pub fn made_up_environment(positions: &[Vector<f64>], domain: Domain) -> Result<Environment, Error> {
    Ok(Sample::new(positions, domain)?.environment.as_ref().clone())
}

/// The columns of an effect with different coefficients; responses on top of the base model.
fn effect_model(effect: &Effect, parameters: &Parameters<f64>, sample: &Sample) -> Option<Model<f64>> {
    let columns = effect.columns(&sample.environment, sample.tessellation.domain()).ok()?;
    let responds = columns.iter().any(|column| matches!(column, Column::Response(_)));
    let start = match responds {
        true => Model::chiral_voronoi(parameters),
        false => Model::with_coefficients(&[], &[]),
    };
    let model = columns.iter().enumerate().fold(start, |model, (k, &column)| {
        model.with(column, if responds { 0.05 } else { 1.0 } * 0.8f64.powi(k as i32))
    });
    Some(model.within(&sample.environment))
}

/// The tolerance where the reference is exact to rounding.
const ROUNDING_TOLERANCE: f64 = 1e-10;

/// What some roundings of numbers of the given size add to the magnitude that errors are relative to.
fn floor(size: f64) -> f64 {
    8.0 * f64::EPSILON * size / ROUNDING_TOLERANCE
}

/// Two ways to get the velocity of a cell.
struct Pair {
    cell: usize,
    found: Vector<f64>,
    expected: Vector<f64>,
}

/// A model under check, with what is compared.
struct Subject<'a> {
    name: &'static str,
    model: Model<f64>,
    sample: &'a Sample,
    velocities: Vec<Vector<f64>>,
    jacobian: BlockMatrix,
    /// `Σ_j |J_ij|` of every cell.
    row_sums: Vec<f64>,
    /// The cells that are displaced.
    displaced: Vec<usize>,
    /// The largest force of one cell on another.
    force: f64,
    /// The largest ratio of such a force to a step.
    slope: f64,
}

impl<'a> Subject<'a> {
    fn new(name: &'static str, model: Model<f64>, sample: &'a Sample, most: usize) -> Self {
        let velocities = velocities(&sample.tessellation, &sample.positions, &model);
        let jacobian = jacobian(&sample.tessellation, &sample.positions, &model);
        let row_sum = |row| jacobian.row(row).flat_map(|(_, b)| b).map(|entry| entry.abs()).sum();
        let row_sums = (0..jacobian.rows()).map(row_sum).collect();
        let [force, slope] = sample.magnitudes(&model);
        let (all, count) = (&sample.displaced, sample.displaced.len().min(most));
        let displaced = (0..count).map(|k| all[k * all.len() / count]).collect();
        Self { name, model, sample, velocities, jacobian, row_sums, displaced, force, slope }
    }

    fn rows(&self, images: &Images) -> Vec<GradientRow> {
        let mut comparisons = Vec::new();
        let exactness = self.model.responses.iter().map(|w| w.response.exactness());
        if exactness.clone().all(|exactness| exactness != Exactness::FirstOrder) {
            comparisons.push((Quantity::JacobianByDifferences, differences::jacobian(self)));
            comparisons.push((Quantity::JacobianByDuals, duals::jacobian(self)));
        }
        if let Some(descent) = self.descent() {
            comparisons.push((Quantity::EnergyByDuals, duals::energy(&descent)));
            comparisons.push((Quantity::EnergyByDifferences, differences::energy(&descent)));
        }
        let periodic = matches!(self.sample.tessellation.domain(), Domain::Periodic(_));
        if periodic && self.conserves_momentum() {
            comparisons.push((Quantity::Momentum, self.momentum()));
        }
        comparisons.extend(images.compare(self));
        let mut rows: Vec<GradientRow> =
            comparisons.into_iter().filter_map(|(quantity, c)| c.row(self.name, quantity)).collect();
        for exactness in exactness {
            if let Exactness::Truncated(part) = exactness {
                // What is left out of an entry is a sum of several parts.
                for row in rows.iter_mut().filter(|row| row.quantity == Quantity::JacobianByDuals) {
                    row.tolerance = row.tolerance.max(10.0 * part);
                }
            }
        }
        rows
    }

    /// At the rim of an open field, where polygons can be needles, effects are not compared.
    fn is_effect(&self) -> bool {
        let base = base_terms(0.0).map(|term| term.name());
        !self.model.responses.is_empty() || self.model.terms.iter().any(|w| !base.contains(&w.term.name()))
    }

    fn parities(&self) -> impl Iterator<Item = Parity> {
        let of_terms = self.model.terms.iter().map(|w| w.term.parity());
        of_terms.chain(self.model.responses.iter().map(|w| w.response.parity()))
    }

    fn conserves_momentum(&self) -> bool {
        self.model.terms.iter().all(|w| w.term.conserves_momentum())
            && self.model.responses.iter().all(|w| w.response.conserves_momentum())
    }

    /// The part of the model that descends an energy, if there is one.
    fn descent(&self) -> Option<Subject<'a>> {
        let model = self.model.passive();
        let descends = self.model.responses.is_empty() && !model.terms.is_empty();
        let is_all = model.terms.len() == self.model.terms.len();
        descends.then(|| {
            let mut descent = Self::new(self.name, model, self.sample, self.displaced.len());
            if is_all {
                descent.velocities.clone_from(&self.velocities);
            }
            descent
        })
    }

    fn momentum(&self) -> Comparison {
        let total: Vector<f64> = self.velocities.iter().sum();
        let magnitude = |(cell, v): (usize, &Vector<f64>)| v.norm() + self.rounding(cell, self.sample.widest);
        let scale = self.velocities.iter().enumerate().map(magnitude).sum();
        let mut comparison = Comparison::relative_to(scale);
        for axis in Axis::BOTH {
            comparison.add(total[axis.index()], 0.0, || Place::Total { axis });
        }
        comparison
    }

    /// Velocities against velocities, when rounding acts on numbers of size `length`.
    fn compare(&self, length: f64, pairs: &[Pair]) -> Comparison {
        let largest = pairs.iter().map(|pair| pair.expected.amax()).fold(0.0, f64::max);
        let mut comparison = Comparison::relative_to(1.0);
        for &Pair { cell, found, expected } in pairs {
            let magnitude = largest + self.rounding(cell, length);
            let error = if found == expected { Vector::zeros() } else { (found - expected) / magnitude };
            comparison.add_vector(error, Vector::zeros(), |axis| Place::Cell { cell, axis });
        }
        comparison
    }

    /// The magnitude to add to that of a cell's velocity.
    fn rounding(&self, cell: usize, length: f64) -> f64 {
        // The formulas of effects take more steps, each of which rounds.
        let steps = if self.is_effect() { 4.0 } else { 1.0 };
        steps * floor(self.force + length * self.row_sums[cell])
    }

    /// A comparison of entries of the Jacobian.
    fn of_slopes(&self) -> Comparison {
        Comparison::relative_to(floor(self.slope))
    }

    fn moves(&self, cell: usize) -> bool {
        let known = self.velocities[cell].iter().all(|v| v.is_finite());
        known && (self.sample.trusted[cell] || !self.is_effect())
    }
}

/// Energy of one cell under the terms that have one.
fn cell_energy<S: Scalar>(model: &Model<S>, shape: voronudge_geometry::Shape<S>) -> S {
    let energies = model.terms.iter().filter_map(|w| Some(w.term.energy(shape)? * w.coefficient));
    energies.fold(S::constant(0.0), |sum, energy| sum + energy)
}
