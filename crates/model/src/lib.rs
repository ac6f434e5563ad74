//! The chiral Voronoi model of a tissue: a sum of force terms, each a one-ring element.
//!
//! ```text
//! E   = Σ_i [ K_A/2 (A_i − A_0)² − K_P P_0 P_i + K_P/2 P_i² ]
//! f_v = −∂E/∂r_v + α ẑ × ∂E_C/∂r_v                   force on a Voronoi vertex
//! v_i = Σ_{v∋i} f_v · ∂r_v/∂r_i                       velocity of a cell centre
//! ```
//!
//! The contribution of one cell depends on the cell and its ring of neighbours only, acts on them only, and sums to
//! zero. The velocity field is therefore assembled from elements, and so are the stress and the exact sparse Jacobian.
//! Velocities are linear in the coefficients of the terms.
//!
//! ```
//! use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
//! use voronudge_model::{Model, Parameters, velocities};
//!
//! let positions: Vec<_> = (0..36)
//!     .map(|i| Vector::new((i % 6) as f64 + 0.3 * (i as f64).sin(), (i / 6) as f64 + 0.3 * (2.0 * i as f64).cos()))
//!     .collect();
//! let domain = Domain::Periodic(PeriodicBox::new([6.0, 6.0])?);
//! let tessellation = Tessellation::new(&positions, domain)?;
//! let model = Model::chiral_voronoi(&Parameters { chirality: 0.5, ..Parameters::default() });
//! let v = velocities(&tessellation, &positions, &model);
//! let momentum: Vector<f64> = v.iter().sum();
//! assert!(momentum.norm() < 1e-12);
//! # Ok::<(), voronudge_geometry::Error>(())
//! ```

mod assembly;
mod axis;
mod block_matrix;
mod cell_element;
mod cell_parameters;
mod chunk;
pub mod effect;
mod element;
mod element_blocks;
mod element_jacobian;
mod element_lanes;
mod environment;
pub mod gradient_check;
mod has_velocity;
mod jacobian;
mod mirrored_jacobian;
mod mirrors;
mod parameters;
mod products;
mod response;
mod ring_jacobian;
mod row_assembly;
mod stress;
mod structure;
mod term;
mod term_jacobian;
mod tiles;
mod transition;
mod velocities;

pub use assembly::{HalfEdgeForces, VelocityAssembly, columns};
pub use axis::Axis;
pub use block_matrix::BlockMatrix;
pub use cell_element::{CellElement, RingForces, Site};
pub use cell_parameters::{CellDerivatives, CellFactors, CellParameter, cell_derivatives};
pub use effect::{Column, Effect, EffectError};
pub use element::VertexForces;
pub use environment::{Environment, EnvironmentError, VectorMap};
pub use jacobian::jacobian;
pub use mirrored_jacobian::jacobian_with_images;
pub use mirrors::signs_of;
pub use parameters::{PARAMETER_NAMES, Parameters, parameter_derivatives};
pub use products::{jvp, vjp};
pub use response::{Exactness, Flow, FlowResponse, Linearisation, Response, Rows, Stage};
pub use row_assembly::{RowAssembly, assemble};
pub use stress::{cell_stresses, stress};
pub use structure::{Evaluation, Model, Structure, WeightedResponse, WeightedTerm, base_terms};
pub use term::{
    Adhesion, AreaElasticity, Contractility, CorticalChirality, ForceTerm, ModulatedTerm, Parity, Reach,
    RingTerm, ShapeTerm, Term,
};
pub use term_jacobian::JacobianBuilder;
pub use transition::{Exchange, JumpSlopes};
pub use velocities::velocities;
