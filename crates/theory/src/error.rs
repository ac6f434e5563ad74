use thiserror::Error;

/// Why there is no mean-field theory for what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter is infinite or not a number.
    #[error("{name} is {value}, not a finite number")]
    Parameter {
        /// Symbol of the parameter.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// The perimeter elasticity sets the unit of time and must be positive.
    #[error("K_P is {value}, not a positive number")]
    PerimeterElasticity {
        /// What was given.
        value: f64,
    },
    /// A wave vector has a component that is infinite or not a number.
    #[error("the wave vector ({x}, {y}) is not finite", x = q[0], y = q[1])]
    WaveVector {
        /// What was given.
        q: [f64; 2],
    },
    /// A number of a channel that cannot be.
    #[error("the {name} is {value}")]
    Channel {
        /// What it is.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// Densities, pressures and torques that make no equation of state.
    #[error("an equation of state cannot have {reason}")]
    EquationOfState {
        /// What it has.
        reason: &'static str,
    },
    /// A grid too coarse to have a face inside.
    #[error("{cells} grid cells from the edge to the middle, but at least 2 are needed")]
    Grid {
        /// What was given.
        cells: usize,
    },
}
