//! What is measured on the frames of a run and on its end.

use super::recorder::Recorder;
use super::report::{Exponent, Peak};
use crate::failure::Failure;
use ndarray::{Array2, ArrayView2};
use voronudge_geometry::PeriodicBox;
use voronudge_io::OutputDirectory;
use voronudge_observables::{
    StructureFactor, mean_square_displacement, mean_square_velocity, structure_factor,
};
use voronudge_simulate::Schedule;
use voronudge_simulate::measure::LyapunovExponent;

/// Frames between which displacements are taken, at most.
const MOST_FRAMES: usize = 200;
/// Displacements that are computed at most, and positions kept for them.
const MOST_DISPLACEMENTS: f64 = 2e9;
const MOST_POSITIONS: usize = 20_000_000;
/// Frames whose structure factors are averaged at most.
const MOST_SPECTRA: usize = 50;
/// Sines that structure factors may cost, some 70 ns each with all that belongs to them.
const MOST_SINES: f64 = 5e7;
/// Wave numbers up to which structure factors are computed, times ℓ₀; neighbours are at about 2π.
const LARGEST_WAVE_NUMBER: f64 = 4.0 * std::f64::consts::PI;

/// Which frames structure factors are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spectra {
    /// Frames of the second half.
    OfManyFrames,
    /// The last frame: in a box that changes each has its own wave vectors.
    OfTheEnd,
}

/// Series over the frames of a run.
pub(super) struct Measurements {
    /// Time and ⟨v²⟩ of each frame.
    pub velocities: Vec<[f64; 2]>,
    /// Lag and mean square displacement.
    pub displacements: Vec<[f64; 2]>,
    /// Frames between which displacements were taken.
    pub displacement_frames: usize,
    /// Means over frames of the second half.
    pub structure: Vec<StructureFactor>,
    /// How many of them.
    pub structure_frames: usize,
}

impl Measurements {
    pub fn new(
        recorder: &mut Recorder,
        schedule: &Schedule,
        (cell_box, spectra): (&PeriodicBox, Spectra),
    ) -> Result<Self, Failure> {
        let (frames, interval) = (schedule.frames, schedule.frame_interval());
        let mut velocities = Vec::with_capacity(frames);
        for frame in 0..frames {
            let square = mean_square_velocity(&recorder.velocities(frame)?);
            velocities.push([(frame + 1) as f64 * interval, square]);
        }
        let cells = recorder.positions(frames - 1)?.len();
        let most = (2.0 * MOST_DISPLACEMENTS / cells as f64).sqrt().min(MOST_FRAMES as f64) as usize;
        let stride = frames.div_ceil(most.min(MOST_POSITIONS / cells).max(2));
        let chosen: Vec<usize> = (0..frames).rev().step_by(stride).collect();
        let kept: Vec<_> =
            chosen.iter().rev().map(|&frame| recorder.positions(frame)).collect::<Result<_, _>>()?;
        let squares = mean_square_displacement(&kept)?;
        let lag = |(k, square): (usize, f64)| [(k * stride) as f64 * interval, square];
        let displacements = squares.into_iter().enumerate().skip(1).map(lag).collect();
        let (structure, structure_frames) = structure(recorder, frames, (cell_box, spectra))?;
        Ok(Self { velocities, displacements, displacement_frames: kept.len(), structure, structure_frames })
    }

    /// The highest shell of the density.
    pub fn peak(&self) -> Option<Peak> {
        let highest = self.structure.iter().max_by(|a, b| a.density.total_cmp(&b.density))?;
        Some(Peak { wave_number: highest.wave_number, value: highest.density })
    }

    pub fn write(&self, out: &mut OutputDirectory) -> Result<(), Failure> {
        out.write_array("mean_square_velocity.npy", pairs(&self.velocities)?)?;
        out.write_array("mean_square_displacement.npy", pairs(&self.displacements)?)?;
        let table = Array2::from_shape_fn((self.structure.len(), 5), |(row, column)| {
            let shell = &self.structure[row];
            match column {
                0 => shell.wave_number,
                1 => shell.wave_vectors as f64,
                2 => shell.density,
                3 => shell.longitudinal,
                _ => shell.transverse,
            }
        });
        out.write_array("structure_factor.npy", table.view())?;
        Ok(())
    }
}

impl From<LyapunovExponent> for Exponent {
    fn from(exponent: LyapunovExponent) -> Self {
        Self { value: exponent.value, standard_error: exponent.standard_error }
    }
}

fn pairs(rows: &[[f64; 2]]) -> Result<ArrayView2<'_, f64>, Failure> {
    ArrayView2::from_shape((rows.len(), 2), rows.as_flattened())
        .map_err(|error| Failure::new(format!("a table of two columns: {error}")))
}

/// Structure factors averaged over frames of the second half. Wave vectors are those of the box, so all frames have the same.
fn structure(
    recorder: &mut Recorder,
    frames: usize,
    (cell_box, spectra): (&PeriodicBox, Spectra),
) -> Result<(Vec<StructureFactor>, usize), Failure> {
    let positions = recorder.positions(frames - 1)?;
    let cells = positions.len() as f64;
    let spacing = (cell_box.area() / cells).sqrt();
    // Wave vectors in half a disc of this radius, each with a sine and a cosine per cell.
    let wave_vectors = |reach: f64| reach * reach * cells / (8.0 * std::f64::consts::PI);
    let affordable = MOST_SINES / cells / wave_vectors(LARGEST_WAVE_NUMBER);
    let reach = LARGEST_WAVE_NUMBER * affordable.min(1.0).sqrt();
    let count = match spectra {
        Spectra::OfManyFrames => frames.div_ceil(2).min(affordable.clamp(1.0, MOST_SPECTRA as f64) as usize),
        Spectra::OfTheEnd => 1,
    };
    let stride = (frames.div_ceil(2) / count).max(1);
    let mut mean: Vec<StructureFactor> = Vec::new();
    for frame in (0..frames).rev().step_by(stride).take(count) {
        let (positions, velocities) = (recorder.positions(frame)?, recorder.velocities(frame)?);
        let shells = structure_factor(&positions, &velocities, cell_box, reach / spacing);
        if mean.is_empty() {
            mean = shells;
            continue;
        }
        for (sum, shell) in mean.iter_mut().zip(shells) {
            sum.density += shell.density;
            sum.longitudinal += shell.longitudinal;
            sum.transverse += shell.transverse;
        }
    }
    for shell in &mut mean {
        for value in [&mut shell.density, &mut shell.longitudinal, &mut shell.transverse] {
            *value /= count as f64;
        }
    }
    Ok((mean, count))
}
