//! From the residual to an effect that the model lacks.
//!
//! 1. The base model is fitted, nudges and noise levels included.
//! 2. Every candidate is scored against what it leaves (`lineup`), and the best is compared with what chance makes of the
//!    best of so many (`chance`).
//! 3. The best is added and everything is fitted again, as long as something is better than chance and worth its
//!    coefficients (`steps`), and velocities held out become more probable (`growth`).
//! 4. What was added is put to the test: each effect beside all others (`beside_others`), synthetic data without an
//!    effect that are searched like the data (`null_data`), and what could stand in its place (`classes`).
//! 5. What is left decides on the verdict (`verdict`).

mod beside_others;
mod candidate;
mod chance;
mod classes;
mod crawling;
mod discovery;
mod evidence;
mod growth;
mod heterogeneity;
mod lineup;
mod measurement;
mod null_data;
mod prospects;
mod ranking;
mod resilience;
mod result;
mod scatter;
mod search;
mod steps;
mod tested;
#[cfg(test)]
mod tests;
mod transfer;
mod verdict;

pub use discovery::{discover, discover_in_tracks};
pub(crate) use measurement::measurement_scores;
pub use result::{
    Budget, Described, Discovery, Fate, Fitted, HeldOut, HeldOutUnit, NullSets, Ranked, Selected, Verdict,
};
pub use search::{Observer, Search};
pub use transfer::{Absent, Transfer};
