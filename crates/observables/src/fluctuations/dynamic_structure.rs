//! Spectra of waves: dynamic structure factors.

use super::Tell;
use super::course::{Course, Courses};
use crate::Error;
use crate::wave_shells::WaveShells;
use nalgebra::Complex;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Frames of a segment at most, and without which there are no spectra.
const LONGEST: usize = 128;
const SHORTEST: usize = 8;

/// Pieces of time that errors come from, beside waves, at most. Segments that overlap by half under Hann windows share some 3 % of the scatter of their powers.
const PIECES: usize = 16;

/// What is correlated with what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StructurePart {
    /// `C_LL`, along q.
    Longitudinal,
    /// `C_TT`, across q.
    Transverse,
    /// Real part of `C_LT`, odd under the mirror.
    OddReal,
    /// Imaginary part of `C_LT`, odd under the mirror: over half the sum of `C_LL` and `C_TT` at most 1, where all waves turn one way.
    OddImaginary,
    /// `S`, of the density.
    Density,
}

impl StructurePart {
    /// All, in the order of [`DynamicStructure::parts`].
    pub const ALL: [Self; 5] =
        [Self::Longitudinal, Self::Transverse, Self::OddReal, Self::OddImaginary, Self::Density];
}

/// Dynamic structure factors `C_ab(q, ω) = ∫⟨a(t + τ) b(t)*⟩ exp(iωτ) dτ`, averaged over the waves of a shell, q and −q alike: even in ω but for the imaginary part of
/// `C_LT`, which is odd.
///
/// Means over half overlapping segments with Hann windows (Welch), less the mean of the course.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicStructure {
    /// Angular frequencies, above zero.
    pub frequencies: Vec<f64>,
    /// Frames of a segment, and how many there are.
    pub segment: usize,
    /// Number of segments.
    pub segments: usize,
    /// For each of [`StructurePart::ALL`], for each shell, for each frequency: value and standard error.
    pub parts: [Vec<Vec<[f64; 2]>>; 5],
}

/// Spectra of all shells; none for few frames.
pub(super) fn dynamic_structure(
    courses: &Courses,
    resolved: &WaveShells,
    interval: f64,
    tell: &mut Tell<'_>,
) -> Result<Option<DynamicStructure>, Error> {
    let frames = courses.frames();
    let segment = (frames / 4).clamp(SHORTEST.min(frames), LONGEST) / 2 * 2;
    if segment < SHORTEST {
        return Ok(None);
    }
    let segments = (frames - segment) / (segment / 2) + 1;
    let turns = Turns::new(segment, interval);
    let pieces = segments.min(PIECES);
    let of_shell = |waves: &Vec<usize>| -> [Vec<[f64; 2]>; 5] {
        // Groups are a piece of time of a wave.
        let groups: Vec<Vec<[f64; 5]>> = courses
            .of(waves)
            .par_iter()
            .flat_map_iter(|own| {
                let mut all = vec![(vec![[0.0; 5]; segment / 2], 0.0); pieces];
                for course in *own {
                    let means = Means::of(course);
                    for k in 0..segments {
                        let (sums, count) = &mut all[k * pieces / segments];
                        if turns.add(course, &means, k * segment / 2, sums) {
                            *count += 1.0;
                        }
                    }
                }
                let mean = |(sums, count): (Vec<[f64; 5]>, f64)| -> Option<Vec<[f64; 5]>> {
                    (count > 0.0).then(|| sums.into_iter().map(|own| own.map(|sum| sum / count)).collect())
                };
                all.into_iter().filter_map(mean).collect::<Vec<_>>()
            })
            .collect();
        let part = |part: usize| {
            let at = |frequency: usize| {
                let values = || groups.iter().map(|own| own[frequency][part]);
                let count = groups.len() as f64;
                let mean = values().sum::<f64>() / count;
                let squares = values().map(|value| (value - mean).powi(2)).sum::<f64>();
                [mean, resolved.dependence() * (squares / (count - 1.0) / count).sqrt()]
            };
            (0..segment / 2).map(at).collect()
        };
        std::array::from_fn(part)
    };
    let mut parts: [Vec<Vec<[f64; 2]>>; 5] = Default::default();
    for (done, shell) in resolved.shells.iter().enumerate() {
        if tell("spectra", done, resolved.shells.len()).is_break() {
            return Err(Error::Interrupted);
        }
        for (all, own) in parts.iter_mut().zip(of_shell(&shell.waves)) {
            all.push(own);
        }
    }
    let frequencies = (1..=segment / 2).map(|k| TAU * k as f64 / (segment as f64 * interval)).collect();
    Ok(Some(DynamicStructure { frequencies, segment, segments, parts }))
}

/// Means of a course, of what there is.
struct Means {
    field: [Complex<f64>; 2],
    density: Complex<f64>,
}

impl Means {
    fn of(course: &Course) -> Self {
        let mut field = [Complex::ZERO; 2];
        let mut count = 0.0;
        for pair in course.field.iter().filter(|pair| is_finite(pair)) {
            count += 1.0;
            field[0] += pair[0];
            field[1] += pair[1];
        }
        let density = course.density.iter().sum::<Complex<f64>>() / course.density.len() as f64;
        Self { field: field.map(|sum| sum / count), density }
    }
}

fn is_finite(pair: &[Complex<f64>; 2]) -> bool {
    pair.iter().all(|a| a.re.is_finite() && a.im.is_finite())
}

/// `exp(iωt)` of the frames of a segment, and its window.
struct Turns {
    turns: Vec<Complex<f64>>,
    window: Vec<f64>,
    /// Time between frames over the sum of squares of the window.
    scale: f64,
}

impl Turns {
    fn new(segment: usize, interval: f64) -> Self {
        let angle = |t: usize| TAU * t as f64 / segment as f64;
        let window: Vec<f64> =
            (0..segment).map(|t| 0.5 - 0.5 * (angle(t) + 0.5 * TAU / segment as f64).cos()).collect();
        let scale = interval / window.iter().map(|w| w * w).sum::<f64>();
        Self { turns: (0..segment).map(|t| Complex::cis(angle(t))).collect(), window, scale }
    }

    /// Adds the periodograms of a segment; none if something is missing in it.
    fn add(&self, course: &Course, means: &Means, from: usize, sums: &mut [[f64; 5]]) -> bool {
        let length = self.window.len();
        let field = &course.field[from..from + length];
        if !field.iter().all(is_finite) {
            return false;
        }
        let windowed: Vec<[Complex<f64>; 3]> = (0..length)
            .map(|t| {
                let [along, across] = [0, 1].map(|k| field[t][k] - means.field[k]);
                [along, across, course.density[from + t] - means.density].map(|a| a * self.window[t])
            })
            .collect();
        for (k, sums) in sums.iter_mut().enumerate() {
            let (mut there, mut back) = ([Complex::<f64>::ZERO; 3], [Complex::<f64>::ZERO; 3]);
            for (t, all) in windowed.iter().enumerate() {
                let turn = self.turns[(k + 1) * t % length];
                for part in 0..3 {
                    there[part] += all[part] * turn;
                    back[part] += all[part] * turn.conj();
                }
            }
            // Of −q at ω is the conjugate of q at −ω.
            let odd = (there[0] * there[1].conj() + back[0].conj() * back[1]) * 0.5;
            let power = |part: usize| 0.5 * (there[part].norm_sqr() + back[part].norm_sqr());
            for (sum, value) in sums.iter_mut().zip([power(0), power(1), odd.re, odd.im, power(2)]) {
                *sum += self.scale * value;
            }
        }
        true
    }
}
