//! What moves cells besides the model: shear of the box, self-propulsion, noise.

use crate::Error;
use crate::headings::Headings;
use crate::scaled::times;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use voronudge_geometry::{Scalar, Vector};

/// Cells that share a stream of random numbers.
pub(crate) const CHUNK: usize = 1024;

/// Simple shear of the periodic box (Lees–Edwards): the image one box above is displaced by `γ(t) L_y` along x.
///
/// Cells are carried along by the affine flow `γ̇ y x̂`, with `y` unwrapped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum Shear {
    /// `γ = strain` from the start: the starting positions are sheared too.
    Step {
        /// The strain γ.
        strain: f64,
    },
    /// `γ = rate · t`
    Steady {
        /// The strain rate γ̇, in 1/time.
        rate: f64,
    },
    /// `γ = amplitude · sin(angular_frequency · t)`
    Oscillatory {
        /// The largest strain.
        amplitude: f64,
        /// The angular frequency ω, in 1/time.
        angular_frequency: f64,
    },
    /// `γ̇ = ±rate`, positive in the first half of each period: `γ` goes from 0 to `rate · period/2` and back, a triangle wave.
    SquareWave {
        /// The strain rate of the first half, in 1/time.
        rate: f64,
        /// The period, in units of time.
        period: f64,
    },
}

impl Shear {
    /// The strain γ at a time.
    pub fn strain(&self, time: f64) -> f64 {
        match *self {
            Self::Step { strain } => strain,
            Self::Steady { rate } => rate * time,
            Self::Oscillatory { amplitude, angular_frequency } => {
                amplitude * (angular_frequency * time).sin()
            }
            Self::SquareWave { rate, period } => {
                let phase = (time / period).rem_euclid(1.0);
                rate * period * phase.min(1.0 - phase)
            }
        }
    }

    /// The strain rate γ̇ at a time, in 1/time.
    ///
    /// ```
    /// use voronudge_simulate::Shear;
    /// let shear = Shear::Oscillatory { amplitude: 0.1, angular_frequency: 2.0 };
    /// let slope = (shear.strain(0.3 + 1e-6) - shear.strain(0.3 - 1e-6)) / 2e-6;
    /// assert!((shear.rate(0.3) - slope).abs() < 1e-9);
    /// ```
    pub fn rate(&self, time: f64) -> f64 {
        match *self {
            Self::Step { .. } => 0.0,
            Self::Steady { rate } => rate,
            Self::Oscillatory { amplitude, angular_frequency } => {
                amplitude * angular_frequency * (angular_frequency * time).cos()
            }
            Self::SquareWave { rate, period } => {
                if (time / period).rem_euclid(1.0) < 0.5 {
                    rate
                } else {
                    -rate
                }
            }
        }
    }
}

/// Motion that the model does not have. The default is none.
///
/// ```text
/// dr_i = (v_i(r) + γ̇ y_i x̂ + v₀ (cos θ_i, sin θ_i)) dt + √(2D) dW_i
/// dθ_i = (J/6) Σ_j sin(θ_j − θ_i) dt + t_i·(b n_i + κ F_i)/v₀ dt + √(2D_r) dW′_i        over the neighbours j
/// ```
///
/// with t_i = (−sin θ_i, cos θ_i), the velocity F_i that the model gives, and n_i away from the contacts
/// ([`away_from_contacts`](voronudge_model::effect::away_from_contacts)). Where speeds are free, the polarity p in place of v₀ (cos θ, sin θ) is a process of Ornstein and Uhlenbeck,
///
/// ```text
/// dp_i = [−D_r p_i + (J/6) Σ_j (p_j − p_i) + b n_i + κ F_i] dt + v₀ √D_r dW′_i
/// ```
///
/// with the root mean square v₀ if nothing turns it.
///
/// Noise is additive and is put in at the end of each step: of weak order one in `Δt`, without a step-size bias of its own
/// (Euler–Maruyama for the noise, the chosen method for the rest). Its numbers come from the seed, the step and the cell,
/// whatever the number of threads.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Driving {
    /// Shear of the box.
    pub shear: Option<Shear>,
    /// Speed of self-propulsion `v₀`, in length/time.
    pub speed: f64,
    /// Rotational diffusion `D_r` of the directions of self-propulsion, in 1/time.
    pub rotational_diffusion: f64,
    /// Rate `J` at which a cell with six neighbours turns towards the mean direction of these, in 1/time.
    #[serde(default)]
    pub alignment: f64,
    /// Contact inhibition `b`: how fast a polarity turns away from the contacts, in length/time².
    #[serde(default)]
    pub contact_inhibition: f64,
    /// Rate `κ` at which a polarity turns towards the velocity that the model gives, in 1/time.
    #[serde(default)]
    pub velocity_alignment: f64,
    /// Whether the speed of self-propulsion fluctuates as its direction does, with the root mean square `v₀`.
    #[serde(default)]
    pub free_speed: bool,
    /// Translational diffusion `D`, in length²/time.
    pub diffusion: f64,
    /// Seed of noise and of the first directions.
    pub seed: u64,
}

impl Driving {
    pub(crate) fn check(&self) -> Result<(), Error> {
        let amounts = [
            ("speed of self-propulsion", self.speed),
            ("rotational diffusion", self.rotational_diffusion),
            ("alignment", self.alignment),
            ("contact inhibition", self.contact_inhibition),
            ("velocity alignment", self.velocity_alignment),
            ("translational diffusion", self.diffusion),
        ];
        for (name, value) in amounts {
            if !(value.is_finite() && value >= 0.0) {
                return Err(Error::Driving { name, value });
            }
        }
        Ok(())
    }

    /// Adds the streaming of the shear and the self-propulsion to velocities.
    pub(crate) fn add_to<S: Scalar>(
        &self,
        velocities: &mut [Vector<S>],
        positions: &[Vector<S>],
        headings: &Headings<S>,
        time: f64,
    ) {
        let rate = self.shear.map_or(0.0, |shear| shear.rate(time));
        if rate != 0.0 {
            let rows = velocities.par_iter_mut().zip(positions).with_min_len(CHUNK);
            rows.for_each(|(v, r)| v.x += r.y * rate);
        }
        if self.speed != 0.0 {
            let rows = velocities.par_iter_mut().enumerate().with_min_len(CHUNK);
            rows.for_each(|(cell, v)| *v += times(headings.of(cell), self.speed));
        }
    }

    /// Whether something beside the neighbours and noise turns polarities.
    pub(crate) fn drives(&self) -> bool {
        self.speed > 0.0 && (self.contact_inhibition > 0.0 || self.velocity_alignment > 0.0)
    }

    /// Whether there is noise.
    pub(crate) fn shakes(&self) -> bool {
        self.diffusion > 0.0 || self.rotational_diffusion > 0.0
    }

    /// Adds the noise of one step to the positions.
    pub(crate) fn shake<S: Scalar>(&self, positions: &mut [Vector<S>], step: u64, time_step: f64) {
        if self.diffusion == 0.0 {
            return;
        }
        let size = (2.0 * self.diffusion * time_step).sqrt();
        positions.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, positions)| {
            let mut rng = stream(self.seed, step, 2 * chunk as u64);
            for r in positions {
                let (x, y): (f64, f64) = (rng.sample(StandardNormal), rng.sample(StandardNormal));
                *r += Vector::new(S::constant(x * size), S::constant(y * size));
            }
        });
    }
}

/// The random numbers of one chunk of cells in one step.
///
/// The three numbers are mixed into a seed (the finaliser of SplitMix64, Steele et al. 2014). Generators that differ by the
/// increment of their recurrence alone would repeat themselves from step to step.
pub(crate) fn stream(seed: u64, step: u64, chunk: u64) -> Pcg64 {
    Pcg64::seed_from_u64([seed, step, chunk].into_iter().fold(0, |key, number| mixed(key ^ number)))
}

fn mixed(number: u64) -> u64 {
    let z = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ z >> 31
}
