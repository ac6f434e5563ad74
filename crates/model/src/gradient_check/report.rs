//! What a gradient check found.

use super::ROUNDING_TOLERANCE;
use crate::Axis;
use std::fmt;

/// The outcome of a gradient check.
#[derive(Debug, Clone, PartialEq)]
pub struct GradientReport {
    /// Number of cells.
    pub cells: usize,
    /// Number of cells that were displaced to check derivatives: fewer than `cells` if these are many.
    pub displaced: usize,
    /// One row for each term and quantity.
    pub rows: Vec<GradientRow>,
}

impl GradientReport {
    /// Whether every row is within its tolerance.
    pub fn passed(&self) -> bool {
        self.rows.iter().all(GradientRow::passed)
    }
}

/// One quantity of one term.
#[derive(Debug, Clone, PartialEq)]
pub struct GradientRow {
    /// Name of the term, or [`MODEL`](super::MODEL) or [`GEOMETRY`](super::GEOMETRY).
    pub term: String,
    /// What was compared.
    pub quantity: Quantity,
    /// The largest error, relative to the largest magnitude of the quantity. Infinite if a value is missing.
    pub worst: f64,
    /// Where the largest error is.
    pub place: Place,
    /// How many numbers were compared.
    pub compared: usize,
    /// The largest relative error that passes.
    pub tolerance: f64,
}

impl GradientRow {
    /// Whether the error is within the tolerance.
    pub fn passed(&self) -> bool {
        self.worst <= self.tolerance
    }
}

/// What a row of a gradient check compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Gradient of a polygon's area by its vertices, against dual numbers through the shoelace formula.
    AreaGradient,
    /// Gradient of a polygon's perimeter by its vertices, against dual numbers through the lengths of its sides.
    PerimeterGradient,
    /// Motion of a vertex with the neighbours of its cell, against dual numbers through the circumcentre.
    VertexMotion,
    /// The sparse Jacobian against central differences of sixth order, at frozen topology.
    JacobianByDifferences,
    /// The sparse Jacobian against dual numbers through the velocities of all cells.
    JacobianByDuals,
    /// Velocity against minus the gradient of the total energy by dual numbers.
    EnergyByDuals,
    /// Velocity against minus the central differences of the energy.
    EnergyByDifferences,
    /// The sum of all velocities against zero, relative to the sum of their magnitudes.
    Momentum,
    /// Velocities after all cells were shifted.
    Translation,
    /// Velocities after single cells were shifted by lattice vectors.
    Wrapping,
    /// Velocities after the tissue was turned: by a quarter in a rectangular box, by a half in a sheared one, by an
    /// arbitrary angle in an open field.
    Rotation,
    /// Velocities after a reflection x → −x, with the coefficients of chiral terms reversed.
    Mirror,
    /// The derivative of the velocities with respect to the parameter of this name, against central differences.
    ParameterDerivative(&'static str),
    /// The derivative of the positions after a short run by the parameter, or the coordinate at the start, of this name, against central differences
    /// of runs.
    RunDerivative(&'static str),
}

impl Quantity {
    /// The largest relative error that passes: 1e-6 where the reference is a central difference in the positions, 1e-10
    /// where it is exact to rounding.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::JacobianByDifferences | Self::EnergyByDifferences | Self::RunDerivative(_) => 1e-6,
            _ => ROUNDING_TOLERANCE,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::AreaGradient => "∂A/∂r_v = dual numbers",
            Self::PerimeterGradient => "∂P/∂r_v = dual numbers",
            Self::VertexMotion => "∂r_v/∂r = dual numbers",
            Self::JacobianByDifferences => "∂v/∂r = central differences",
            Self::JacobianByDuals => "∂v/∂r = whole-system dual numbers",
            Self::EnergyByDuals => "v = −∂E/∂r by dual numbers",
            Self::EnergyByDifferences => "v = −∂E/∂r by central differences",
            Self::Momentum => "Σv = 0",
            Self::Translation => "translation",
            Self::Wrapping => "periodic wrapping",
            Self::Rotation => "rotation",
            Self::Mirror => "mirror",
            Self::RunDerivative(name) => return f.pad(&format!("run: ∂r/∂{name} = central differences")),
            Self::ParameterDerivative(name) => return f.pad(&format!("∂v/∂{name} = central differences")),
        };
        f.pad(text)
    }
}

/// Where an error is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A component of a sum over all cells.
    Total {
        /// The component.
        axis: Axis,
    },
    /// A component of a cell's velocity.
    Cell {
        /// Index of the cell.
        cell: usize,
        /// Component of its velocity.
        axis: Axis,
    },
    /// A component of the gradient at a corner of a cell's polygon.
    Corner {
        /// Index of the cell.
        cell: usize,
        /// Index of the corner within the cell's polygon.
        corner: usize,
        /// The component.
        axis: Axis,
    },
    /// The derivative of a cell's velocity by the position of another cell.
    Entry {
        /// The cell whose velocity it is.
        cell: usize,
        /// Component of that velocity.
        axis: Axis,
        /// The cell that was displaced.
        by: usize,
        /// Direction of the displacement.
        along: Axis,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Total { axis } => format!("sum over cells, {axis}"),
            Self::Cell { cell, axis } => format!("cell {cell}, {axis}"),
            Self::Corner { cell, corner, axis } => format!("cell {cell}, corner {corner}, {axis}"),
            Self::Entry { cell, axis, by, along } => format!("cell {cell}, {axis}, by cell {by}, {along}"),
        };
        f.pad(&text)
    }
}
