//! Mean-field theory of the chiral Voronoi model: what a honeycomb of regular hexagons does, in closed form.
//!
//! Nothing here uses the simulated model. The formulas are derived from the equation of motion by hand, in
//! `docs/mean-field.md` of the repository, and every constant is computed from the geometry of the hexagon: a yardstick
//! for everything that is computed numerically elsewhere.
//!
//! **Units.** The mean area of a cell is 1. For cells of mean area `ℓ_0²` give `P_0/ℓ_0`, `K_A ℓ_0²` and `q ℓ_0`; matrices
//! and rates are then as they are, and moduli and stresses are in units of `ℓ_0²` times the unit of rates. Friction is
//! absorbed, so `K_P` is a rate and everything is proportional to it at fixed `K_A/K_P`: with `K_P = 1` times are in
//! units of `1/K_P`. The preferred area `A_0` is a gauge and appears nowhere.
//!
//! **Conventions.** `ẑ × (a, b) = (−b, a)` with y up; small displacements obey `∂_t u = −D(q) u`; stresses have the
//! force index first.
//!
//! ```
//! use voronudge_theory::{MeanField, Orientation, Parameters, Phase, hexagon_perimeter};
//!
//! let theory = MeanField::new(Parameters { preferred_perimeter: 3.5, chirality: 0.2, ..Parameters::default() })?;
//! assert_eq!(theory.phase(), Phase::OddElasticSolid);
//!
//! // The first mode to become unstable, at the middle of an edge of the Brillouin zone: 8 K_P s [2 ± √(1 − 3 (α/s)²)].
//! let [mode, _] = theory.decay_rates(theory.critical_wave_vector(Orientation::NeighbourAlongY), Orientation::NeighbourAlongY)?;
//! let s = 1.0 - 3.5 / hexagon_perimeter();
//! assert!((mode.real - 16.0 * s).abs() < 1e-12 && mode.imaginary > 0.0);
//! # Ok::<(), voronudge_theory::Error>(())
//! ```

mod channel;
mod continuum;
mod dynamical_matrix;
mod edge;
mod equation_of_state;
mod error;
mod johnson_segalman;
mod lattice;
mod parameters;
mod phase_diffusion;
mod spectrum;
mod stability;
mod viscoelastic;

pub use channel::{ChannelEvolution, ChannelMedium, ChannelTurnover};
pub use continuum::Moduli;
pub use edge::EdgeRow;
pub use equation_of_state::EquationOfState;
pub use error::Error;
pub use johnson_segalman::{JohnsonSegalman, SteadyShear};
pub use lattice::{Orientation, PathPoint, SymmetryPoint, hexagon_perimeter, hexagon_side, symmetry_path};
pub use parameters::{MeanField, Parameters};
pub use phase_diffusion::PhaseDiffusivities;
pub use spectrum::Eigenvalue;
pub use stability::{Mode, Phase};
pub use viscoelastic::{Arrangement, EvenOdd, ShearResponse, ViscoelasticMedium};
