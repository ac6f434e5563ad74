//! Density and velocity in Fourier space, averaged over frames: in a periodic box by its own waves, in an open field of view through tapers.
//!
//! Through tapers directly debiased (`tapers`); velocities, less their mean, are weighted alike, over the sum of the squared weights.

use crate::structure_factor::{Scatterer, amplitudes};
use crate::tapers::{TAPERS, of_constant, still, weights};
use crate::wave_shells::WaveShells;
use crate::window::Window;
use crate::{Curve, Frame, Plan, Quantity, Recording};
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// Deviations of waves from the mean of their shell that tell how they scatter, at least.
const SCATTERED: usize = 12;

/// Structure factors of density, compression and vortices; none if there is no window to see waves through.
pub(crate) fn structure(recording: &Recording, plan: &Plan) -> Option<[Curve; 3]> {
    let last = recording.frames().last()?;
    let frames: Vec<&Frame> = plan
        .stills
        .iter()
        .map(|frame| &recording.frames()[*frame])
        // The waves of a box that changes are others in each frame.
        .filter(|frame| frame.tessellation.domain() == last.tessellation.domain())
        .collect();
    let resolved = WaveShells::of(last, plan, plan.largest)?;
    let WaveShells { waves, shells, window } = &resolved;
    let of_frame = |frame: &&Frame| -> Vec<[f64; 3]> {
        match window {
            Some(window) => through(frame, window, waves),
            None => of_box(frame, waves),
        }
    };
    let powers: Vec<Vec<[f64; 3]>> = frames.par_iter().map(of_frame).collect();
    let at: Vec<f64> = shells.iter().map(|shell| shell.wave_number).collect();
    // Waves are independent of each other, frames are not: of each wave first the mean over frames.
    let of_wave = |wave: usize, k: usize| {
        let all: Vec<f64> =
            powers.iter().map(|frame| frame[wave][k]).filter(|power| power.is_finite()).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    let quantities = [Quantity::Density, Quantity::Compression, Quantity::Vortices];
    let curve = |k: usize| {
        let samples: Vec<Vec<f64>> =
            shells.iter().map(|own| own.waves.iter().map(|wave| of_wave(*wave, k)).collect()).collect();
        let value: Vec<f64> = samples.iter().map(|own| own.iter().sum::<f64>() / own.len() as f64).collect();
        let standard_error =
            errors(&samples, &value).into_iter().map(|error| resolved.dependence() * error).collect();
        let count = shells.iter().map(|shell| shell.waves.len()).collect();
        Curve { of: quantities[k], at: at.clone(), value, standard_error, count }
    };
    Some([curve(0), curve(1), curve(2)])
}

/// Standard errors of the means of shells. Powers of single waves scatter by a multiple of their mean that changes slowly from shell to shell: of a shell with few
/// waves it is told by those around.
fn errors(samples: &[Vec<f64>], means: &[f64]) -> Vec<f64> {
    let deviations: Vec<(f64, usize)> = samples
        .iter()
        .zip(means)
        .map(|(own, mean)| {
            let squares = own.iter().map(|power| (power / mean - 1.0).powi(2)).sum::<f64>();
            (squares, own.len() - 1)
        })
        .collect();
    let of_shell = |shell: usize| {
        let around = |reach: usize| {
            let own = &deviations[shell.saturating_sub(reach)..(shell + reach + 1).min(deviations.len())];
            own.iter().fold((0.0, 0), |(squares, count), one| (squares + one.0, count + one.1))
        };
        let (squares, count) = (0..deviations.len())
            .map(around)
            .find(|(_, count)| *count >= SCATTERED)
            .unwrap_or_else(|| around(deviations.len()));
        means[shell] * (squares / count as f64 / samples[shell].len() as f64).sqrt()
    };
    (0..samples.len()).map(of_shell).collect()
}

/// All cells of a periodic box.
fn of_box(frame: &Frame, waves: &[Vector<f64>]) -> Vec<[f64; 3]> {
    let cells: Vec<Scatterer<1>> = frame
        .positions
        .iter()
        .zip(&frame.velocities)
        .map(|(r, v)| Scatterer { place: *r, velocity: *v, weights: [1.0] })
        .collect();
    let moving = cells.iter().filter(|cell| cell.velocity.is_some()).count() as f64;
    let of_wave = |q: &Vector<f64>| {
        let [[density, along, across]] = amplitudes(&cells, *q);
        [
            density.norm_squared() / cells.len() as f64,
            along.norm_squared() / moving,
            across.norm_squared() / moving,
        ]
    };
    waves.iter().map(of_wave).collect()
}

/// The cells in a window, through tapers.
fn through(frame: &Frame, window: &Window, waves: &[Vector<f64>]) -> Vec<[f64; 3]> {
    let mut cells: Vec<Scatterer<TAPERS>> = Vec::new();
    for (r, v) in frame.positions.iter().zip(&frame.velocities) {
        let place = r - frame.stage;
        let Some(share) = window.share(place) else { continue };
        cells.push(Scatterer { place: place - window.corner, velocity: *v, weights: weights(window, share) });
    }
    let masses = still(&mut cells);
    let per_area = cells.len() as f64 / window.area();
    let of_wave = |q: &Vector<f64>| {
        let all = amplitudes(&cells, *q);
        let mut powers = [0.0; 3];
        for (k, [density, along, across]) in all.iter().enumerate() {
            powers[0] += (density - of_constant(window, k, *q) * per_area).norm_squared() / per_area;
            powers[1] += along.norm_squared() / masses[k];
            powers[2] += across.norm_squared() / masses[k];
        }
        powers.map(|power| power / TAPERS as f64)
    };
    waves.iter().map(of_wave).collect()
}
