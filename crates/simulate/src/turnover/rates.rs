//! How often cells are extruded and born, and where.

use super::CellCycle;
use crate::Error;
use serde::{Deserialize, Serialize};

/// A rate that falls with the distance `d_b` from the nearer edge:
///
/// ```text
/// k(d_b) = k₀ exp(−d_b/d)
/// ```
///
/// (Extended Data Fig. m5E). An infinite decay length makes it the same everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EdgeRate {
    /// The rate at the edge `k₀`, per cell and time.
    pub rate: f64,
    /// The decay length `d`.
    pub decay_length: f64,
}

impl EdgeRate {
    /// The rate at a distance from the edge, in 1/time.
    ///
    /// ```
    /// use voronudge_simulate::EdgeRate;
    /// let rate = EdgeRate { rate: 0.33, decay_length: 35.0 };
    /// assert!((rate.at(70.0) - 0.33 * (-2.0f64).exp()).abs() < 1e-15);
    /// ```
    pub fn at(&self, edge_distance: f64) -> f64 {
        self.rate * (-edge_distance / self.decay_length).exp()
    }

    /// The probability of an event in a step `Δt`: `1 − exp(−k Δt)`.
    pub(super) fn probability(&self, edge_distance: f64, time_step: f64) -> f64 {
        -(-self.at(edge_distance) * time_step).exp_m1()
    }

    fn check(&self, [rate, length]: [&'static str; 2]) -> Result<(), Error> {
        if !(self.rate.is_finite() && self.rate >= 0.0) {
            return Err(not_usable(rate, self.rate, "finite and not negative"));
        }
        check_length(length, self.decay_length)
    }
}

/// How many cells are born.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Proliferation {
    /// One for each cell that is extruded, in the same step, as in the paper; where is drawn with the weight `exp(−d_b/d)`. The
    /// number of cells is constant. Between walls it is born in the same half of the channel.
    Replacing {
        /// The decay length `d` of the weight.
        decay_length: f64,
    },
    /// Each cell proliferates at a rate of its own place, whatever is extruded. The number of cells changes.
    Independent(EdgeRate),
}

/// Where a new cell appears.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Injection {
    /// On a vertex of the tessellation, which disturbs its three cells little: the paper's way. With
    /// [`Proliferation::Replacing`] any vertex may be drawn, with [`Proliferation::Independent`] those of the mother.
    Vertex,
    /// At this distance from the centre of a mother, in a random direction: like a division. It makes large velocities just after.
    Division {
        /// Distance from mother to daughter.
        distance: f64,
    },
    /// Cells grow and divide in two at the ends of their cycles, of which a mother has two daughters at equal distances from where she was.
    /// With [`Proliferation::Independent`] phases run at the rate of the place. With [`Proliferation::Replacing`] they run at `exp(−d_b/d)`, for each cell that is
    /// extruded as far as the next division, so that lengths that vary by one draw mothers by that weight.
    Cycle(CellCycle),
}

/// The turnover of cells: who is extruded, who is born, and where, between the steps of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Turnover {
    /// Every cell is extruded at this rate.
    pub extrusion: EdgeRate,
    /// How many are born.
    pub proliferation: Proliferation,
    /// Where they appear.
    pub injection: Injection,
    /// The run ends before there are more cells than this.
    pub most_cells: usize,
    /// Seed of all draws.
    pub seed: u64,
}

impl Turnover {
    /// Decay length of the places of births.
    pub(super) fn proliferation_length(&self) -> f64 {
        match self.proliferation {
            Proliferation::Replacing { decay_length } => decay_length,
            Proliferation::Independent(rate) => rate.decay_length,
        }
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        self.injection.check()?;
        self.extrusion.check(["rate of extrusion", "decay length of extrusion"])?;
        match self.proliferation {
            Proliferation::Replacing { decay_length } => {
                check_length("decay length of proliferation", decay_length)
            }
            Proliferation::Independent(rate) => {
                rate.check(["rate of proliferation", "decay length of proliferation"])
            }
        }
    }
}

impl Injection {
    pub(super) fn check(&self) -> Result<(), Error> {
        match *self {
            Self::Division { distance } if !(distance.is_finite() && distance > 0.0) => {
                Err(not_usable("distance of a daughter from its mother", distance, "positive and finite"))
            }
            Self::Cycle(cycle) => cycle.check(),
            _ => Ok(()),
        }
    }
}

fn check_length(name: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 { Ok(()) } else { Err(not_usable(name, value, "positive")) }
}

pub(super) fn not_usable(name: &'static str, value: f64, required: &'static str) -> Error {
    Error::Turnover { name, value, required }
}
