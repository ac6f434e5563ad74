//! Smooth tapers of a window.
//!
//! In the open plane waves are seen through a rectangle W of area |W| in which every cell would have been seen. The sharp edge of a window scatters more than the
//! tissue; smooth tapers do not, and what the mean density scatters is known and taken off (directly debiased multitaper estimate, sine tapers):
//!
//! ```text
//! S(q) = (1/4) Σ_{a,b ∈ {1,2}} |Σ_i t_ab(r_i) exp(−iq·r_i) − ρ T_ab(q)|² / ρ
//! t_ab = (2/√|W|) sin(π a x/L_x) sin(π b y/L_y),    T_ab its Fourier transform
//! ```

use crate::structure_factor::Scatterer;
use crate::window::Window;
use std::f64::consts::PI;
use voronudge_geometry::Vector;

/// Tapers along each axis, and all of them.
const ALONG: usize = 2;
pub(crate) const TAPERS: usize = ALONG * ALONG;

/// Periods of a window by which the waves differ that are measured.
pub(crate) const RESOLUTION: f64 = 2.0;

/// Variance of a mean over waves in a window, over that of independent ones: tapers let white noise at a wave and at the next along an axis share
/// `½ Σ_ab |∫ t_a t_b exp(−4πix/L) dx|² = 0.162` of their power.
pub(crate) const SHARED: f64 = 1.325 * 1.325;

/// `t_ab` at a place given by its shares of width and height.
pub(crate) fn weights(window: &Window, [x, y]: [f64; 2]) -> [f64; TAPERS] {
    let weight = |k: usize| {
        let (a, b) = tones(k);
        height(window) * (PI * a * x).sin() * (PI * b * y).sin()
    };
    std::array::from_fn(weight)
}

/// `T_ab(q)`, as (real, imaginary), for waves with whole numbers of periods in the window, from its corner.
pub(crate) fn of_constant(window: &Window, taper: usize, q: Vector<f64>) -> Vector<f64> {
    let (a, b) = tones(taper);
    let [[c, s], [d, t]] = [tone(a, q.x, window.lengths[0]), tone(b, q.y, window.lengths[1])];
    Vector::new(c * d - s * t, c * t + s * d) * height(window)
}

/// Takes the mean velocity out of those that move, and returns the sum of their squared weights: where the cells happen to be, tapers see more or less of
/// their motion.
pub(crate) fn still(cells: &mut [Scatterer<TAPERS>]) -> [f64; TAPERS] {
    let moving: Vec<Vector<f64>> = cells.iter().filter_map(|cell| cell.velocity).collect();
    let common = moving.iter().sum::<Vector<f64>>() / moving.len().max(1) as f64;
    cells.iter_mut().filter_map(|cell| cell.velocity.as_mut()).for_each(|v| *v -= common);
    std::array::from_fn(|k| {
        let own = cells.iter().filter(|cell| cell.velocity.is_some()).map(|cell| cell.weights[k].powi(2));
        own.sum::<f64>() * (1.0 - 1.0 / moving.len() as f64)
    })
}

/// Largest weight.
fn height(window: &Window) -> f64 {
    2.0 / window.area().sqrt()
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
