//! Figures, HTML pages and report files from results.
//!
//! This crate knows plain numbers only: no model, no fit, no files. The command line fills
//! [`FrameView`] and [`InferReport`], [`DiscoverReport`] or [`SpectrumReport`] and gets back text:
//!
//! - [`figure`]: one function per figure, each a stand-alone SVG. Charts stand on [`chart::Chart`]
//!   (axes, ticks, grid), pictures of the tissue on [`map::Map`] (equal aspect, scale bar).
//! - [`page`]: self-contained HTML pages, made of sections and blocks; `templates/page.html` writes them all.
//! - [`movie`]: cells of many frames, for the player of a page and as an animated image.
//! - [`infer_report`], [`discover_report`], [`spectrum_report`] and their like: what `report.json` holds, described by [`schema_of`].
//!
//! ```
//! use voronudge_report::figure::{ErrorBar, Emphasis, error_bars};
//! let bar = ErrorBar {
//!     label: "cross-validated".into(), nmse: 0.31, standard_error: Some(0.02), emphasis: Emphasis::Main,
//! };
//! let svg = error_bars(&[bar]);
//! assert!(svg.starts_with("<svg") && svg.contains("0.31 ± 0.02"));
//! ```

pub mod arrows;
mod before_after;
pub mod channel_report;
pub mod chart;
pub mod colour;
pub mod colour_bar;
pub mod contour;
pub mod discover_report;
pub mod equation_of_state_report;
mod error;
pub mod figure;
pub mod histogram;
pub mod infer_report;
pub mod key;
mod many_cells;
pub mod map;
pub mod markers;
mod model_parameters;
pub mod moduli_report;
pub mod movie;
pub mod numbers;
pub mod observe_report;
pub mod page;
pub mod phase_diffusion_report;
pub mod phase_report;
pub mod rheology_report;
mod schema;
mod series;
pub mod shape_report;
pub mod spectrum_report;
pub mod svg;
pub mod units;
mod view;
pub mod waves_report;

pub use before_after::BeforeAfter;
pub use channel_report::{ChannelReport, ChiralityReport};
pub use discover_report::DiscoverReport;
pub use equation_of_state_report::EquationOfStateReport;
pub use error::ReportError;
pub use infer_report::InferReport;
pub use model_parameters::ModelParameters;
pub use moduli_report::ModuliReport;
pub use page::{DiscoverFigures, DiscoverPage, InferPage, SpreadView, Uncertainty};
pub use phase_diffusion_report::PhaseDiffusionReport;
pub use phase_report::PhaseReport;
pub use rheology_report::RheologyReport;
pub use schema::schema_of;
pub use shape_report::{FieldReport, ShapeReport};
pub use spectrum_report::SpectrumReport;
pub use units::Units;
pub use view::{CellStatus, CellView, ChangedEdges, FrameView, Segment};
pub use waves_report::WavesReport;
