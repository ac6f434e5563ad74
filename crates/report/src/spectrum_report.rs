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
    /// Which modes were requested.
    pub selection: SelectionRecord,
    /// Parameters of the model as used, in units of the data.
    pub parameters: ModelParameters,
    /// Values of the parameters in which cells differ, by name, one for each cell of the data; where they depend on labels, by the labels in the first frame.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub cell_parameters: BTreeMap<&'static str, Vec<f64>>,
    /// Coefficients of the effects beyond the base model, by name of the effect.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub effects: BTreeMap<String, Vec<f64>>,
    /// Mean-field theory at these parameters; `null` with effects, where cells differ, or where K_P is not positive.
    pub mean_field: Option<MeanFieldRecord>,
    /// Spectrum of each frame.
    #[schemars(length(min = 1))]
    pub frames: Vec<FrameSpectrum>,
    /// Comparison with the theory on a lattice; `null` where it was not requested.
    pub lattice: Option<LatticeRecord>,
    /// Modes of a strip of the lattice, with `--ends`; `null` otherwise.
    pub strip: Option<StripRecord>,
}

/// Which modes were requested.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "modes", rename_all = "snake_case")]
pub enum SelectionRecord {
    /// All modes.
    All,
    /// The modes that grow fastest.
    Largest {
        /// Number of modes requested.
        count: usize,
    },
    /// The modes nearest to a point of the complex plane.
    Near {
        /// Real and imaginary part of this point, in 1/time.
        shift: [f64; 2],
        /// Number of modes requested.
        count: usize,
    },
    /// The modes with an angular frequency in a band.
    Band {
        /// Ends of the band of angular frequencies, in 1/time.
        frequencies: [f64; 2],
        /// Number of modes examined.
        count: usize,
    },
}

/// Results of the mean-field theory of the honeycomb.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MeanFieldRecord {
    /// Phase of the honeycomb.
    #[schemars(extend("enum" = ["solid", "odd_elastic_solid", "unstable"]))]
    pub phase: &'static str,
    /// Preferred perimeter P_0 at which the honeycomb becomes unstable, in units of length.
    pub stability_limit: f64,
    /// Value of |α| beyond which the mode at q* oscillates.
    pub exceptional_chirality: f64,
    /// ⟨ω²⟩ over the modes of the honeycomb, in 1/time².
    pub mean_square_frequency: f64,
}

/// The spectrum of one frame.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FrameSpectrum {
    /// Index of the frame, zero-based.
    pub frame: usize,
    /// Number of cells present.
    pub present: usize,
    /// Number of cells that may move in the modes.
    pub counted: usize,
    /// Cell size ℓ₀, in units of length; ℓ₀² is the mean area.
    pub length_scale: f64,
    /// Number of modes found.
    pub modes: usize,
    /// Number of modes that decay.
    pub decaying: usize,
    /// Number of modes that grow.
    pub growing: usize,
    /// Number of modes that oscillate but neither grow nor decay.
    pub neutral: usize,
    /// Number of modes whose rate and frequency are both zero.
    pub zero: usize,
    /// Number of modes that oscillate, whether or not they grow or decay.
    pub oscillating: usize,
    /// Rates up to this value count as zero, in 1/time: 1e-10 of the largest row sum of J.
    #[schemars(range(min = 0.0))]
    pub tolerance: f64,
    /// ⟨ω²⟩ = (1/2n) Σ (Im λ)² over all modes, in 1/time²; `null` if only some were computed.
    #[schemars(range(min = 0.0))]
    pub mean_square_frequency: Option<f64>,
    /// `mean_square_frequency` in units of K_P²; `null` also where K_P is zero.
    #[schemars(range(min = 0.0))]
    pub mean_square_frequency_over_k_p: Option<f64>,
    /// The mode that grows fastest or decays most slowly, other than translations.
    pub largest_growth: Option<ModeRecord>,
    /// The mode with the highest frequency.
    pub fastest_oscillation: Option<ModeRecord>,
    /// The mode with the largest condition number.
    pub exceptional: Option<ModeRecord>,
    /// Real and imaginary part of the point at which the matrix was factorised, in 1/time; `null` if all modes were computed.
    pub shift: Option<[f64; 2]>,
    /// Distance from `shift` up to which no mode should be missing, in 1/time; `null` where it is not known.
    pub reach: Option<f64>,
    /// Largest residual ‖J u − λ u‖/‖J‖ of the modes that were searched for; `null` if all modes were computed.
    pub largest_residual: Option<f64>,
    /// How near the snapshot is to a T1 transition; `null` where that cannot be determined.
    pub transition: Option<TransitionRecord>,
    /// Where the modes are between the walls; `null` without walls or without eigenvectors.
    pub walls: Option<WallsRecord>,
}

/// One mode.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ModeRecord {
    /// Row of the mode in `eigenvalues.npy`.
    pub index: usize,
    /// Growth rate, in 1/time.
    pub rate: f64,
    /// Angular frequency, in 1/time.
    pub frequency: f64,
    /// Share of the cells that take part; `null` without eigenvectors, as are the fields below.
    #[schemars(range(min = 0.0))]
    pub participation: Option<f64>,
    /// Share of the divergence in the squared gradients of the mode: 1 for a longitudinal, 0 for a transverse mode.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub longitudinal: Option<f64>,
    /// Condition number of the eigenvalue.
    pub condition: Option<f64>,
    /// Overlap with the mode whose eigenvalue is nearest, among those with another eigenvalue.
    pub overlap: Option<f64>,
}

/// How near a snapshot is to a T1 transition.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TransitionRecord {
    /// Length of the shortest side of a polygon, in units of length.
    pub shortest_side: f64,
    /// The two cells that share this side, numbered as in the file.
    pub cells: [usize; 2],
    /// Smallest distance of a fourth cell from the circle through three cells, in units of length.
    pub smallest_gap: f64,
    /// Number of sides shorter than a hundredth of ℓ₀.
    pub short_sides: usize,
    /// Number of all sides.
    pub sides: usize,
}

/// Exact Jacobian of a honeycomb compared with the theory.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LatticeRecord {
    /// Number of cells in a row, and number of rows.
    pub size: [usize; 2],
    /// Number of points on the path Γ–K–M–Γ.
    pub points: usize,
    /// Largest difference between the dynamical matrices of model and theory, relative to the largest entry on the path; `null` with effects.
    pub largest_difference: Option<f64>,
}

/// Where the modes are between the walls.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WallsRecord {
    /// Which sides of the box are walls: left and right (`x`), or all four (`both`).
    #[schemars(extend("enum" = ["x", "both"]))]
    pub sides: &'static str,
    /// Share of the cells that are within two rows of a wall.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub cells: f64,
    /// Share of |u|² within two rows of a wall, averaged over the modes.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub mean_share: f64,
    /// Number of modes that have more than half of their |u|² within two rows of a wall.
    pub mostly: usize,
}

/// The modes of a strip of the honeycomb at one wave number along its rows.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct StripRecord {
    /// What terminates the strip.
    #[schemars(extend("enum" = ["periodic", "held", "walls"]))]
    pub ends: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// Number of rows that move.
    pub moving_rows: usize,
    /// Mean distance between neighbouring rows that move, in units of length.
    pub spacing: f64,
    /// Period along the rows, in units of length.
    pub period: f64,
    /// Largest speed of a cell after the tissue came to rest between walls, in units of velocity.
    #[schemars(range(min = 0.0))]
    pub speed: f64,
    /// Number of wave numbers in the files.
    pub wave_numbers: usize,
    /// Largest growth rate at any wave number (1/time), and that wave number (1/length).
    pub fastest: [f64; 2],
    /// Wave number along the rows to which the fields below refer (1/length).
    pub wave_number: f64,
    /// Number of modes at this wave number.
    pub modes: usize,
    /// Number of modes that grow by more than a factor e towards the left end.
    pub left: usize,
    /// Number of modes that grow by more than a factor e towards the right end.
    pub right: usize,
    /// Number of edge modes.
    pub of_edges: usize,
    /// Number of modes around whose eigenvalue the spectrum of the periodic tissue winds.
    pub winding: usize,
    /// Largest spatial growth rate across the strip of a mode that is not an edge mode (1/length); its inverse is the shortest localisation length. `null` if
    /// no such mode grows by more than a factor e.
    pub largest_growth: Option<f64>,
    /// Root mean square difference of the spatial growth rates from those of the generalised Brillouin zone, relative to the root mean square of the latter;
    /// `null` where there is nothing to compare.
    pub difference_from_zone: Option<f64>,
}
