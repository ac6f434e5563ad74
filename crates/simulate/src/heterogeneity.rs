//! Parameters of single cells, drawn at random.

use crate::Generator;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_distr::StandardNormal;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a parameter is distributed over cells, as multiples of its mean.
///
/// ```
/// use voronudge_simulate::{Distribution, generator};
/// let alpha = Distribution::TwoTypes.draw(1.0, 4, &mut generator(1));
/// let mut sorted = alpha.clone();
/// sorted.sort_by(f64::total_cmp);
/// assert_eq!(sorted, [0.0, 0.0, 2.0, 2.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Distribution {
    /// Normal.
    #[default]
    Normal,
    /// Log-normal: no cell has a multiple of another sign.
    LogNormal,
    /// Two kinds of cells, as many of each as there can be, in random places: one below the mean and one above it.
    TwoTypes,
}

impl Distribution {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Normal, Self::LogNormal, Self::TwoTypes];

    /// Name in arguments and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::LogNormal => "log-normal",
            Self::TwoTypes => "two-types",
        }
    }

    /// The distribution of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|own| own.name() == name)
    }

    /// Multiples (N) whose mean over these very cells is one, and whose standard deviation is `spread`, so that tissues differ in nothing
    /// else; of the log-normal distribution it is so on average over tissues.
    pub fn draw(self, spread: f64, cells: usize, rng: &mut Generator) -> Vec<f64> {
        match self {
            Self::Normal => {
                let own: Vec<f64> = (0..cells).map(|_| rng.sample(StandardNormal)).collect();
                let mean = mean(&own);
                let deviation = (own.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / cells as f64).sqrt();
                let scale = if deviation > 0.0 { spread / deviation } else { 0.0 };
                own.iter().map(|x| 1.0 + scale * (x - mean)).collect()
            }
            Self::LogNormal => {
                let of_logarithm = spread.powi(2).ln_1p().sqrt();
                let own: Vec<f64> =
                    (0..cells).map(|_| (of_logarithm * rng.sample::<f64, _>(StandardNormal)).exp()).collect();
                let mean = mean(&own);
                own.iter().map(|x| x / mean).collect()
            }
            Self::TwoTypes => {
                let below = cells / 2;
                let above = cells - below;
                let ratio = (below as f64 / above as f64).sqrt();
                let (low, high) = match below {
                    0 => (1.0, 1.0),
                    _ => (1.0 - spread / ratio, 1.0 + spread * ratio),
                };
                let mut own: Vec<f64> =
                    (0..cells).map(|cell| if cell < below { low } else { high }).collect();
                own.shuffle(rng);
                own
            }
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
