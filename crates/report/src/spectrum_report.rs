//! `report.json` of the command `spectrum`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are
//! written as `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use crate::ModelParameters;
use crate::infer_report::RunRecord;
use crate::units::Units;

/// Everything `spectrum` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectrumReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless; rates and angular frequencies are in 1/time.
    pub units: Units,
    /// Which modes were asked for.
    pub selection: SelectionRecord,
    /// Parameters as used, by the names of the interface, in units of the data.
    pub parameters: ModelParameters,
    /// Values of parameters in which cells differ, by name, one for each cell of the data; of types by the labels in the first frame.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub cell_parameters: BTreeMap<&'static str, Vec<f64>>,
    /// Effects beyond the base model with their coefficients.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub effects: BTreeMap<String, Vec<f64>>,
    /// The mean-field theory at these parameters; `null` with effects or where K_P is not positive.
    pub mean_field: Option<MeanFieldRecord>,
    /// The spectrum of each frame.
    #[schemars(length(min = 1))]
    pub frames: Vec<FrameSpectrum>,
    /// The comparison on a lattice; `null` where it was not asked for.
    pub lattice: Option<LatticeRecord>,
    /// The modes of a strip of the lattice, with `--ends`; `null` otherwise.
    pub strip: Option<StripRecord>,
}

/// Which modes were asked for.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "modes", rename_all = "snake_case")]
pub enum SelectionRecord {
    /// All.
    All,
    /// Those that grow fastest.
    Largest {
        /// How many modes.
        count: usize,
    },
    /// Those nearest to a point.
    Near {
        /// Real and imaginary part of the point.
        shift: [f64; 2],
        /// How many modes.
        count: usize,
    },
    /// Those of a band of frequencies.
    Band {
        /// Ends of the band of angular frequencies.
        frequencies: [f64; 2],
        /// How many modes were looked at.
        count: usize,
    },
}

/// What the theory of the honeycomb says.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeanFieldRecord {
    /// Its phase.
    #[schemars(extend("enum" = ["solid", "odd_elastic_solid", "unstable"]))]
    pub phase: &'static str,
    /// The P_0 at which the honeycomb becomes unstable, in units of length.
    pub stability_limit: f64,
    /// The |α| beyond which the mode at q* oscillates.
    pub exceptional_chirality: f64,
    /// ⟨ω²⟩ over the modes of the honeycomb, in 1/time².
    pub mean_square_frequency: f64,
}

/// The spectrum of one frame.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FrameSpectrum {
    /// Index of the frame, zero-based.
    pub frame: usize,
    /// Cells present.
    pub present: usize,
    /// Cells that may move in the modes.
    pub counted: usize,
    /// The cell size ℓ₀, ℓ₀² = mean area.
    pub length_scale: f64,
    /// Modes found.
    pub modes: usize,
    /// Those that decay.
    pub decaying: usize,
    /// Those that grow.
    pub growing: usize,
    /// Those that neither grow nor decay, but oscillate.
    pub neutral: usize,
    /// Those whose rate and frequency are zero.
    pub zero: usize,
    /// Those that oscillate, whatever else they do.
    pub oscillating: usize,
    /// Rates up to this count as zero: 1e-10 of the largest row sum of J.
    #[schemars(range(min = 0.0))]
    pub tolerance: f64,
    /// ⟨ω²⟩ = (1/2n) Σ (Im λ)² over all modes, in 1/time²; `null` if only some were computed.
    #[schemars(range(min = 0.0))]
    pub mean_square_frequency: Option<f64>,
    /// The same in units of K_P².
    #[schemars(range(min = 0.0))]
    pub mean_square_frequency_over_k_p: Option<f64>,
    /// The mode that grows fastest or decays slowest, other than translations.
    pub largest_growth: Option<ModeRecord>,
    /// The mode with the highest frequency.
    pub fastest_oscillation: Option<ModeRecord>,
    /// The mode with the largest condition number.
    pub exceptional: Option<ModeRecord>,
    /// Real and imaginary part at which the matrix was factorised; `null` if all modes were computed.
    pub shift: Option<[f64; 2]>,
    /// Distance from there up to which nothing should be missing; `null` where that is not told.
    pub reach: Option<f64>,
    /// Largest ‖J u − λ u‖/‖J‖ of the modes that were searched for; `null` if all were computed.
    pub largest_residual: Option<f64>,
    /// How near the snapshot is to a T1 transition; `null` where that cannot be told.
    pub transition: Option<TransitionRecord>,
    /// Where between walls the modes are; `null` without walls or vectors.
    pub walls: Option<WallsRecord>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModeRecord {
    /// Row in `eigenvalues.npy`.
    pub index: usize,
    /// Rate of growth, in 1/time.
    pub rate: f64,
    /// Angular frequency, in 1/time.
    pub frequency: f64,
    /// Share of the cells that take part; `null` without vectors, and so below.
    #[schemars(range(min = 0.0))]
    pub participation: Option<f64>,
    /// Share of the divergence in the gradients.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub longitudinal: Option<f64>,
    /// Condition number.
    pub condition: Option<f64>,
    /// Overlap with the mode whose value is nearest.
    pub overlap: Option<f64>,
}

/// How near a snapshot is to a T1 transition.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TransitionRecord {
    /// Length of the shortest side.
    pub shortest_side: f64,
    /// The cells that share it, as the file numbers them.
    pub cells: [usize; 2],
    /// Least distance of a fourth cell from the circle through three.
    pub smallest_gap: f64,
    /// Sides shorter than a hundredth of ℓ₀.
    pub short_sides: usize,
    /// All sides.
    pub sides: usize,
}

/// The exact Jacobian of a honeycomb against the theory.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LatticeRecord {
    /// Cells in a row and rows.
    pub size: [usize; 2],
    /// Points on the path Γ–K–M–Γ.
    pub points: usize,
    /// Largest difference of the dynamical matrices, relative to the largest entry on the path; `null` with effects.
    pub largest_difference: Option<f64>,
}

/// Where between walls the modes are.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WallsRecord {
    /// Which sides of the box are walls.
    #[schemars(extend("enum" = ["x", "both"]))]
    pub sides: &'static str,
    /// Share of the cells within two rows of a wall.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub cells: f64,
    /// Mean over the modes of their share of |u|² there.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub mean_share: f64,
    /// Modes that have more than half of their |u|² there.
    pub mostly: usize,
}

/// The modes of a strip of the honeycomb at one wave number along it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StripRecord {
    /// What is at the ends.
    #[schemars(extend("enum" = ["periodic", "held", "walls"]))]
    pub ends: &'static str,
    /// Rows.
    pub rows: usize,
    /// Rows that move.
    pub moving_rows: usize,
    /// Mean distance of the rows that move.
    pub spacing: f64,
    /// Period along the rows.
    pub period: f64,
    /// Largest speed of a cell after coming to rest between walls.
    #[schemars(range(min = 0.0))]
    pub speed: f64,
    /// Wave numbers in the files.
    pub wave_numbers: usize,
    /// The largest rate of growth at any of them, and the wave number (1/length).
    pub fastest: [f64; 2],
    /// The wave number of what follows (1/length).
    pub wave_number: f64,
    /// Modes at it.
    pub modes: usize,
    /// Modes that grow by more than a factor e towards the left end.
    pub left: usize,
    /// Modes that do so towards the right end.
    pub right: usize,
    /// Modes of an edge.
    pub of_edges: usize,
    /// Modes around whose value the spectrum of the periodic tissue winds.
    pub winding: usize,
    /// Largest rate of growth across the strip of modes that are not of an edge (1/length), if it is more than a factor e; the shortest localisation length is its inverse. `null` otherwise.
    pub largest_growth: Option<f64>,
    /// Root mean square difference of the growth from that of the generalised Brillouin zone, over the root mean square of the latter; `null` where there is none.
    pub difference_from_zone: Option<f64>,
}
