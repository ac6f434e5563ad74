//! Which forces move the cells of a tissue, and what does the model of them miss?
//!
//! The chiral Voronoi model: each cell is the Voronoi polygon of its centre, forces act on the vertices, and the contraction
//! of the cortex is turned out of the mirror-symmetric direction by the chirality α. This crate simulates it, differentiates
//! it (velocities by positions and parameters, whole runs by either), and infers its parameters from positions and velocities
//! of cells by nudged inference.
//!
//! | module | what | feature |
//! |---|---|---|
//! | [`geometry`] | plane, periodic boxes, fields of view, Voronoi tessellation | |
//! | [`model`] | force terms, effects, velocities, stress, exact sparse Jacobian | |
//! | [`observables`] | motion, shapes, order, contacts, correlations of cells | |
//! | [`segmentation`] | label images, outlines, extrema of fields, links from frame to frame | |
//! | [`theory`] | mean-field theory of the honeycomb in closed form | |
//! | [`simulate`] | integration in time, derivatives of runs, shear, walls, turnover, moduli | `simulate` |
//! | [`spectrum`] | linear modes, distance from a T1 transition | `spectrum` |
//! | [`infer`] | nudged inference, search for effects, forecasts | `infer` |
//! | [`io`] | data sets, tables of tracks, label images, safe output | `io` |
//! | [`program`] | the commands of the command line | `cli` |
//! | [`problem`] | from a data set to what [`infer`] needs, and back to the units of the data | `infer` and `io` |
//!
//! The feature `cli`, on by default, is the program `voronudge` and takes all of them. A library wants
//! `voronudge = { version = "0.1", default-features = false, features = ["simulate"] }` or the like.
//!
//! # Velocities and their derivatives
//!
//! ```
//! use voronudge::model::jacobian;
//! use voronudge::{Domain, Model, Parameters, PeriodicBox, Tessellation, Vector, velocities};
//!
//! let positions: Vec<_> = (0..36)
//!     .map(|i| Vector::new((i % 6) as f64 + 0.3 * (i as f64).sin(), (i / 6) as f64 + 0.3 * (2.0 * i as f64).cos()))
//!     .collect();
//! let tessellation = Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new([6.0, 6.0])?))?;
//! let model = Model::chiral_voronoi(&Parameters { chirality: 0.5, ..Parameters::default() });
//! let v = velocities(&tessellation, &positions, &model);
//! let j = jacobian(&tessellation, &positions, &model); // blocks of ∂v_i/∂r_k, 2 × 2, sparse
//! // Forces between cells sum to zero, and a translation changes no velocity.
//! assert!(v.iter().sum::<Vector<f64>>().norm() < 1e-12);
//! assert!(j.row(7).map(|(_, block)| block[0]).sum::<f64>().abs() < 1e-10);
//! # Ok::<(), voronudge::geometry::Error>(())
//! ```
//!
//! # Examples
//!
//! `cargo run --release --example NAME`, in the folder `examples` of this crate:
//!
//! - `simulate`: speed, shapes and order of a tissue with and without chirality.
//! - `differentiate`: the derivative of a whole run by α, and for how long a difference of two runs follows it.
//! - `infer`: parameters with intervals from data, beside the truth and a fit without nudges.
//! - `discover`: the effect that a model misses, and the error before and after.
//! - `custom_effect`: an effect of one's own, simulated and fitted.
//!
//! Units are those of what is passed in: friction is absorbed, so `K_P` is a rate; y points up.

#[cfg(feature = "cli")]
mod arguments;
#[cfg(feature = "cli")]
mod boundary;
#[cfg(feature = "cli")]
mod browser;
#[cfg(feature = "cli")]
mod command;
#[cfg(feature = "cli")]
mod command_line;
#[cfg(feature = "cli")]
mod configuration;
#[cfg(feature = "cli")]
mod failure;
#[cfg(feature = "cli")]
mod memory;
#[cfg(feature = "cli")]
mod output;
#[cfg(all(feature = "infer", feature = "io"))]
pub mod problem;
#[cfg(feature = "cli")]
pub mod program;
#[cfg(feature = "cli")]
mod progress;
#[cfg(feature = "cli")]
mod rehearsal;
#[cfg(feature = "cli")]
mod reporting;
#[cfg(feature = "cli")]
mod run;
#[cfg(feature = "cli")]
mod terminal;

#[cfg(feature = "infer")]
pub use voronudge_infer as infer;
#[cfg(feature = "io")]
pub use voronudge_io as io;
#[cfg(feature = "simulate")]
pub use voronudge_simulate as simulate;
#[cfg(feature = "spectrum")]
pub use voronudge_spectrum as spectrum;
pub use {
    voronudge_geometry as geometry, voronudge_model as model, voronudge_observables as observables,
    voronudge_segmentation as segmentation, voronudge_theory as theory,
};

pub use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
pub use voronudge_model::{Model, Parameters, velocities};

/// The code of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
