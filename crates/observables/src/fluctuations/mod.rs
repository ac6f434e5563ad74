//! Waves of a tissue from its fluctuations: the dynamic structure factor, and the matrix D(q) by which waves relax.
//!
//! A plane wave of small displacements, or of velocities, that obeys `∂_t u = −D(q) u` and is kept going by noise without memory has the covariance
//!
//! ```text
//! C(τ) = ⟨u(t + τ) u(t)†⟩ = exp(−D τ) C(0)          D = −log[C(τ_0 + τ) C(τ_0)⁻¹]/τ
//! ```
//!
//! whatever the noise is like (linear inverse modelling). Errors of localisation without memory are in C(0) only, so that τ_0 > 0 is free of them. Components are
//! along q and a quarter turn ahead; q and −q are as likely, so that averages over both, and D, are real. Without chirality the mirror image is as likely, and all
//! that is off the diagonal vanishes. Complex eigenvalues of D are odd waves.
//!
//! [`fluctuations`] resolves a recording into waves (`course`), whose covariances (`covariance`) tell D (`relaxation`) and whose periodograms tell the spectra
//! (`dynamic_structure`).

mod course;
mod covariance;
mod dynamic_structure;
mod evidence;
mod relaxation;

pub use course::WaveField;
pub use dynamic_structure::{DynamicStructure, StructurePart};
pub use evidence::together;
pub use relaxation::{Relaxation, relaxation_of_waves};

use crate::wave_shells::WaveShells;
use crate::{Error, Plan, Recording};
use course::Courses;
use std::ops::ControlFlow;
use voronudge_geometry::Vector;

/// Frames without which nothing is said.
const FEWEST_FRAMES: usize = 12;

/// Longest wave of a shell over the shortest: waves that relax at rates far apart would not relax by one matrix together.
const NARROW: f64 = 1.12;

/// Wave number, over the inverse mean spacing, up to which waves are long.
const LONG: f64 = 1.0;

/// What is told of stages, steps done and all of them; breaks off what should end.
pub type Tell<'a> = dyn FnMut(&'static str, usize, usize) -> ControlFlow<()> + 'a;

/// How fluctuations are analysed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FluctuationRequest {
    /// What of the cells is resolved into waves; `None` for displacements where cells keep their places, else velocities.
    pub field: Option<WaveField>,
    /// τ_0 in frames; `None` for one frame more than errors of localisation reach.
    pub first_lag: Option<usize>,
    /// τ in frames; `None` for about half a relaxation time of each shell.
    pub lag: Option<usize>,
    /// Largest wave number in units of the inverse mean spacing.
    pub largest: f64,
}

/// What the fluctuations of a recording tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluctuations {
    /// What was resolved into waves.
    pub field: WaveField,
    /// τ_0 in frames.
    pub first_lag: usize,
    /// Time between frames.
    pub interval: f64,
    /// Shells of wave numbers, the longest waves first.
    pub shells: Vec<ShellFluctuations>,
    /// Frequencies and what goes with each shell; none for few frames.
    pub structure: Option<DynamicStructure>,
    /// Moduli over friction, from waves longer than 2π spacings of which the recording is long enough; none without such waves, and none through a window, whose
    /// tapers mix them with shorter ones.
    pub long_waves: Option<LongWaves>,
}

/// A shell of wave numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct ShellFluctuations {
    /// Mean wave number.
    pub wave_number: f64,
    /// The wave vectors, one of each pair ±q.
    pub wave_vectors: Vec<Vector<f64>>,
    /// How waves relax; none where their covariance is not that of any relaxation.
    pub relaxation: Option<Relaxation>,
}

/// `D(q) → q² [[B + μ, Kᵒ], [A − Kᵒ, μ]]/ζ` of long waves: means of the entries over q², weighted by their errors, rows first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LongWaves {
    /// Entries of D over q².
    pub matrix: [[f64; 2]; 2],
    /// Their standard errors.
    pub standard_errors: [[f64; 2]; 2],
    /// Shells that they are means of.
    pub shells: usize,
}

/// Resolves a recording into waves and tells how they fluctuate. Frames are evenly spaced in time.
///
/// Standard errors are by leaving out one stretch of time of one wave at a time; the estimates are corrected for what this tells of their bias, which is that of
/// taking out the mean of a course that is not much longer than its relaxation time.
///
/// # Errors
/// [`Error::TooFewFrames`], [`Error::UnevenFrames`], [`Error::NoWaves`], [`Error::NothingMoves`], [`Error::LongLags`]; [`Error::Interrupted`] when `tell`, which hears of
/// stages, steps done and all of them, says so.
pub fn fluctuations(
    recording: &Recording,
    plan: &Plan,
    request: &FluctuationRequest,
    tell: &mut Tell<'_>,
) -> Result<Fluctuations, Error> {
    let frames = recording.frames();
    if frames.len() < FEWEST_FRAMES {
        return Err(Error::TooFewFrames { found: frames.len(), required: FEWEST_FRAMES });
    }
    let interval = plan.interval;
    let uneven =
        frames.windows(2).position(|pair| ((pair[1].time - pair[0].time) / interval - 1.0).abs() > 1e-6);
    if let Some(frame) = uneven {
        return Err(Error::UnevenFrames { frame });
    }
    let domain = frames[0].tessellation.domain();
    let same = frames.iter().all(|frame| frame.tessellation.domain() == domain);
    let resolved = WaveShells::of(&frames[0], plan, request.largest / plan.spacing)
        .filter(|_| same)
        .ok_or(Error::NoWaves)?
        .narrowed(NARROW);
    let field = match request.field {
        Some(field) => field,
        None => WaveField::suited_to(recording, plan),
    };
    let courses = Courses::new(recording, &resolved, field, tell)?;
    let first_lag = request.first_lag.unwrap_or(field.reach_of_errors(recording) + 1);
    let longest = first_lag + 2 * request.lag.unwrap_or(1);
    if 3 * longest > frames.len() {
        return Err(Error::LongLags { longest, frames: frames.len() });
    }
    let mut shells = Vec::new();
    for (done, shell) in resolved.shells.iter().enumerate() {
        if tell("relaxation", done, resolved.shells.len()).is_break() {
            return Err(Error::Interrupted);
        }
        let lags = (first_lag, request.lag);
        shells.push(ShellFluctuations {
            wave_number: shell.wave_number,
            wave_vectors: shell.waves.iter().map(|wave| resolved.waves[*wave]).collect(),
            relaxation: relaxation::relaxation(
                &courses.of(&shell.waves),
                lags,
                interval,
                resolved.dependence(),
            ),
        });
    }
    let structure = dynamic_structure::dynamic_structure(&courses, &resolved, interval, tell)?;
    // Tapers mix long waves with those that relax faster.
    let long_waves = resolved.window.is_none().then(|| long_waves(&shells, LONG / plan.spacing)).flatten();
    Ok(Fluctuations { field, first_lag, interval, shells, structure, long_waves })
}

/// Weighted means of D/q² over long waves.
fn long_waves(shells: &[ShellFluctuations], longest: f64) -> Option<LongWaves> {
    let long: Vec<(f64, &Relaxation)> = shells
        .iter()
        .filter(|shell| shell.wave_number <= longest)
        .filter_map(|shell| Some((shell.wave_number.powi(2), shell.relaxation.as_ref()?)))
        .filter(|(_, own)| {
            own.is_reliable() && own.standard_errors.iter().flatten().all(|error| error.is_finite())
        })
        .collect();
    if long.is_empty() {
        return None;
    }
    let (mut matrix, mut standard_errors) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (square, relaxation) in &long {
            let weight = (square / relaxation.standard_errors[i][j]).powi(2);
            sum += weight * relaxation.matrix[i][j] / square;
            weights += weight;
        }
        matrix[i][j] = sum / weights;
        standard_errors[i][j] = 1.0 / weights.sqrt();
    }
    Some(LongWaves { matrix, standard_errors, shells: long.len() })
}
