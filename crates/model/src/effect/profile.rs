//! How a parameter may change across the tissue.

use crate::Axis;
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, Elementary, PeriodicBox, Vector};

/// Sine or cosine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Odd about the origin.
    Sine,
    /// Even about the origin.
    Cosine,
}

/// A plane wave about the origin of the environment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Wave vector `q`, a reciprocal lattice vector of the box.
    pub wavevector: Vector<f64>,
    /// Phase.
    pub phase: Phase,
}

impl Default for Wave {
    fn default() -> Self {
        Self { wavevector: Vector::new(1.0, 0.0), phase: Phase::Sine }
    }
}

impl Wave {
    /// `sin(q·x)` or `cos(q·x)`.
    pub fn at<S: Elementary>(&self, x: Vector<S>) -> S {
        let angle = x.x * self.wavevector.x + x.y * self.wavevector.y;
        match self.phase {
            Phase::Sine => angle.sine(),
            Phase::Cosine => angle.cosine(),
        }
    }

    /// The waves along the two reciprocal lattice vectors of a box.
    fn first(cell_box: PeriodicBox) -> [Vector<f64>; 2] {
        let ([x, y], offset) = (cell_box.lengths(), cell_box.offset());
        [Vector::new(TAU / x, -TAU * offset / (x * y)), Vector::new(0.0, TAU / y)]
    }

    /// Both phases of the waves along the two reciprocal lattice vectors of a box, their sum and their difference.
    pub fn lowest(cell_box: PeriodicBox) -> Vec<Self> {
        let [a, b] = Self::first(cell_box);
        Self::phases(&[a, b, a + b, a - b])
    }

    fn phases(wavevectors: &[Vector<f64>]) -> Vec<Self> {
        let phases = [Phase::Sine, Phase::Cosine];
        wavevectors.iter().flat_map(|&wavevector| phases.map(|phase| Self { wavevector, phase })).collect()
    }
}

/// A scalar field over position with the unit of length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Profile {
    /// A coordinate relative to the origin.
    Linear(Axis),
    /// `sin(q·x)/|q|` or `cos(q·x)/|q|`.
    Periodic(Wave),
}

impl Default for Profile {
    fn default() -> Self {
        Self::Periodic(Wave::default())
    }
}

impl Profile {
    /// Its value at a position relative to the origin.
    pub fn at<S: Elementary>(&self, x: Vector<S>) -> S {
        match self {
            Self::Linear(axis) => x[axis.index()],
            Self::Periodic(wave) => wave.at(x) * (1.0 / wave.wavevector.norm()),
        }
    }

    /// The profiles of a parameter that changes across the tissue: ramps along both axes in an open field; in a box,
    /// where a ramp is not periodic, the lowest waves along both axes.
    pub fn ramps(domain: Domain) -> impl Iterator<Item = Self> {
        let profiles = match domain {
            Domain::Open => Axis::BOTH.map(Self::Linear).to_vec(),
            Domain::Periodic(cell_box) => {
                Wave::phases(&Wave::first(cell_box)).into_iter().map(Self::Periodic).collect()
            }
        };
        profiles.into_iter()
    }
}
