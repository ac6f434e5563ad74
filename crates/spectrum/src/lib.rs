//! Linear modes of the chiral Voronoi model: which small displacements of the cells grow, decay and oscillate.
//!
//! Near a snapshot small displacements u of the cells obey `∂_t u = J u` with the Jacobian `J = ∂v/∂r` at frozen
//! topology, so a mode with the eigenvalue λ behaves as `exp(λ t)`: its real part is the rate of growth, its imaginary part
//! the angular frequency of an odd elastic wave. The theory of the honeycomb writes `∂_t u = −D u`; its decay rates are −λ.
//!
//! - [`LinearProblem`]: the Jacobian of a snapshot, over the cells that may move.
//! - [`modes`]: all eigenvalues, or those a [`Selection`] names, each as a [`Mode`] with what it is like.
//! - [`TransitionDistance`]: how far the snapshot is from the next T1 transition, where J jumps.
//! - [`Honeycomb`]: the exact dispersion on a lattice.
//! - [`Strip`]: rows with ends, at each wave number along them, beside the periodic tissue ([`BlochMatrix`]): winding numbers, the
//!   generalised Brillouin zone, the non-Hermitian skin effect.
//! - [`Localisation`]: where between ends or walls a mode is.
//! - [`LinearProblem::projected`], [`LinearProblem::relaxed`]: D(q) of plane waves of any snapshot.
//!
//! ```
//! use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
//! use voronudge_model::{Model, Parameters};
//! use voronudge_spectrum::{LinearProblem, Request, Selection, modes};
//!
//! let positions: Vec<_> = (0..25)
//!     .map(|i| Vector::new((i % 5) as f64 + 0.3 * (i as f64).sin(), (i / 5) as f64 + 0.3 * (2.0 * i as f64).cos()))
//!     .collect();
//! let domain = Domain::Periodic(PeriodicBox::new([5.0, 5.0])?);
//! let tessellation = Tessellation::new(&positions, domain)?;
//! let model = Model::chiral_voronoi(&Parameters { chirality: 0.5, ..Parameters::default() });
//! let problem = LinearProblem::new(&tessellation, &positions, &model, |_| true)?;
//! let found = modes(&problem, &Request::new(Selection::All), &mut |_, _, _| {})?;
//! assert_eq!(found.modes.len(), 50);
//! // Translations neither grow nor decay.
//! assert!(found.modes.iter().filter(|mode| mode.is_zero(found.tolerance)).count() >= 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bloch;
mod error;
mod gradient;
mod honeycomb;
mod localisation;
mod mode;
mod problem;
mod projection;
mod selection;
mod strip;
mod transition;

pub use bloch::{BlochMatrix, MiddleRoots};
pub use error::Error;
pub use honeycomb::{Arrangement, Honeycomb, bloch_matrix};
pub use localisation::{Localisation, Rows};
pub use mode::{Growth, Mode};
pub use problem::LinearProblem;
pub use selection::{Character, Counts, Modes, Request, Scope, Selection, dense_memory, modes};
pub use strip::{Ends, Strip, StripMode, rows_of_honeycomb};
pub use transition::TransitionDistance;
pub use voronudge_linalg::{Complex64, Progress};
