//! Density and velocity in Fourier space, averaged over frames: in a periodic box by its own waves, in an open field of view through tapers.
//!
//! In the open plane waves are seen through a rectangle W of area |W| in which every cell would have been seen. The sharp edge of a window scatters more than the
//! tissue; smooth tapers do not, and what the mean density scatters is known and taken off (directly debiased multitaper estimate, sine tapers):
//!
//! ```text
//! S(q) = (1/4) Σ_{a,b ∈ {1,2}} |Σ_i t_ab(r_i) exp(−iq·r_i) − ρ T_ab(q)|² / ρ
//! t_ab = (2/√|W|) sin(π a x/L_x) sin(π b y/L_y),    T_ab its Fourier transform
//! ```
//!
//! Velocities, less their mean, are weighted alike, over the sum of the squared weights. The waves are those with an even number of periods in the window.

use crate::structure_factor::{Scatterer, amplitudes, wave_vectors};
use crate::window::Window;
use crate::{Curve, Frame, Plan, Quantity, Recording};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use voronudge_geometry::{Domain, PeriodicBox, Vector};

/// Tapers along each axis, and all of them.
const ALONG: usize = 2;
const TAPERS: usize = ALONG * ALONG;

/// Periods of a window by which the waves differ that are measured.
const RESOLUTION: f64 = 2.0;

/// Variance of a mean over waves in a window, over that of independent ones: tapers let white noise at a wave and at the next along an axis share
/// `½ Σ_ab |∫ t_a t_b exp(−4πix/L) dx|² = 0.162` of their power.
const SHARED: f64 = 1.325 * 1.325;

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
    let (cell_box, window) = match last.tessellation.domain() {
        Domain::Periodic(cell_box) => (cell_box, None),
        Domain::Open => {
            (PeriodicBox::new(plan.window?.lengths.map(|length| length / RESOLUTION)).ok()?, plan.window)
        }
    };
    let waves = wave_vectors(&cell_box, plan.largest);
    let of_frame = |frame: &&Frame| -> Vec<[f64; 3]> {
        match &window {
            Some(window) => through(frame, window, &waves),
            None => of_box(frame, &waves),
        }
    };
    let powers: Vec<Vec<[f64; 3]>> = frames.par_iter().map(of_frame).collect();
    let [width, height] = cell_box.lengths();
    let shell = TAU / width.max(height);
    let mut shells: Vec<Vec<usize>> = vec![Vec::new(); (plan.largest / shell) as usize + 1];
    for (wave, q) in waves.iter().enumerate() {
        shells[(q.norm() / shell - 0.5).max(0.0) as usize].push(wave);
    }
    shells.retain(|own| !own.is_empty());
    let at: Vec<f64> = shells
        .iter()
        .map(|own| own.iter().map(|wave| waves[*wave].norm()).sum::<f64>() / own.len() as f64)
        .collect();
    // Waves are independent of each other, frames are not: of each wave first the mean over frames.
    let of_wave = |wave: usize, k: usize| {
        let all: Vec<f64> =
            powers.iter().map(|frame| frame[wave][k]).filter(|power| power.is_finite()).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    let quantities = [Quantity::Density, Quantity::Compression, Quantity::Vortices];
    let curve = |k: usize| {
        let samples: Vec<Vec<f64>> =
            shells.iter().map(|own| own.iter().map(|wave| of_wave(*wave, k)).collect()).collect();
        let value: Vec<f64> = samples.iter().map(|own| own.iter().sum::<f64>() / own.len() as f64).collect();
        let shared = if window.is_some() { SHARED.sqrt() } else { 1.0 };
        let standard_error = errors(&samples, &value).into_iter().map(|error| shared * error).collect();
        let count = shells.iter().map(Vec::len).collect();
        Curve { of: quantities[k], at: at.clone(), value, standard_error, count }
    };
    (!shells.is_empty()).then(|| [curve(0), curve(1), curve(2)])
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
    let height = 2.0 / window.area().sqrt();
    let mut cells: Vec<Scatterer<TAPERS>> = Vec::new();
    for (r, v) in frame.positions.iter().zip(&frame.velocities) {
        let place = r - frame.stage;
        let Some([x, y]) = window.share(place) else { continue };
        let weight = |k: usize| {
            let (a, b) = tones(k);
            height * (PI * a * x).sin() * (PI * b * y).sin()
        };
        cells.push(Scatterer {
            place: place - window.corner,
            velocity: *v,
            weights: std::array::from_fn(weight),
        });
    }
    let moving: Vec<Vector<f64>> = cells.iter().filter_map(|cell| cell.velocity).collect();
    let common = moving.iter().sum::<Vector<f64>>() / moving.len().max(1) as f64;
    cells.iter_mut().filter_map(|cell| cell.velocity.as_mut()).for_each(|v| *v -= common);
    let per_area = cells.len() as f64 / window.area();
    // Where the cells happen to be, tapers see more or less of their motion.
    let weights: [f64; TAPERS] = std::array::from_fn(|k| {
        let own = cells.iter().filter(|cell| cell.velocity.is_some()).map(|cell| cell.weights[k].powi(2));
        own.sum::<f64>() * (1.0 - 1.0 / moving.len() as f64)
    });
    let of_wave = |q: &Vector<f64>| {
        let all = amplitudes(&cells, *q);
        let mut powers = [0.0; 3];
        for (k, [density, along, across]) in all.iter().enumerate() {
            let (a, b) = tones(k);
            let [[c, s], [d, t]] = [tone(a, q.x, window.lengths[0]), tone(b, q.y, window.lengths[1])];
            let mean = Vector::new(c * d - s * t, c * t + s * d) * (height * per_area);
            powers[0] += (density - mean).norm_squared() / per_area;
            powers[1] += along.norm_squared() / weights[k];
            powers[2] += across.norm_squared() / weights[k];
        }
        powers.map(|power| power / TAPERS as f64)
    };
    waves.iter().map(of_wave).collect()
}

/// Half waves of a taper along both axes.
fn tones(taper: usize) -> (f64, f64) {
    ((1 + taper % ALONG) as f64, (1 + taper / ALONG) as f64)
}

/// `∫ sin(π a x/L) exp(−iqx) dx` from 0 to L where qL is a multiple of 2π, as [real, imaginary].
fn tone(half_waves: f64, q: f64, length: f64) -> [f64; 2] {
    let k = PI * half_waves / length;
    if (k - q.abs()).abs() < 1e-6 * k {
        return [0.0, -0.5 * length * q.signum()];
    }
    let odd = if half_waves as u64 % 2 == 1 { 2.0 } else { 0.0 };
    [k * odd / (k * k - q * q), 0.0]
}
