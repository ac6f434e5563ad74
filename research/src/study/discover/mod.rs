//! The search for missing effects: how often it finds one that is not there, and how often one that is.

mod added;
mod found;
mod null;
mod outside;
mod power;
mod table;

use super::seeds::on_one_core_each;
use crate::Outcome;
use added::Sample;
use claims::{Noise, Tissue};
use clap::ValueEnum;
use found::Found;
use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Mutex;
use std::time::Instant;
use voronudge_infer::KnownNoise;

/// What of the search is studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Data that lack nothing.
    Null,
    /// One effect.
    Power,
    /// Something that no effect describes.
    Outside,
    /// Effects that look like others.
    Aliases,
    /// Two effects.
    Pairs,
}

/// How large the study is.
#[derive(Debug)]
pub struct Plan {
    pub seeds: u64,
    pub cells: usize,
    /// All parts if none is named.
    pub part: Option<Part>,
    /// Settings whose name contains one of these; all if there are none.
    pub only: Vec<String>,
    /// Whether the noise levels are estimated instead of given.
    pub estimated: bool,
    /// Synthetic data without an effect for each search; as many as the search takes by itself if none.
    pub null_sets: Option<usize>,
    /// The tissues made so far, by seed: settings share them.
    pub tissues: Mutex<BTreeMap<u64, Tissue>>,
}

/// Position noise that a search is told where there is none: springs need some.
const LEAST_POSITION_NOISE: f64 = 1e-3;

impl Part {
    fn run(self, plan: &Plan) -> Outcome {
        match self {
            Self::Null => null::run(plan),
            Self::Power => power::single(plan),
            Self::Outside => outside::run(plan),
            Self::Aliases => power::aliases(plan),
            Self::Pairs => power::pairs(plan),
        }
    }
}

/// Runs the parts asked for.
pub fn run(plan: &Plan) -> Outcome {
    let parts = Part::value_variants().iter().filter(|own| plan.part.is_none_or(|only| only == **own));
    parts.copied().try_for_each(|part| part.run(plan))
}

impl Plan {
    /// Whether a setting of this name is asked for.
    fn includes(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|part| name.contains(part.as_str()))
    }

    /// What the tables of a part have in common.
    fn describe(&self) -> String {
        let noise = if self.estimated { "estimated" } else { "given" };
        format!("{} cells, {} seeds, noise {noise}", self.cells, self.seeds)
    }

    /// The tissue of a seed.
    fn tissue(&self, seed: u64) -> Result<Tissue, Box<dyn Error>> {
        let known = |tissues: &BTreeMap<u64, Tissue>| tissues.get(&seed).cloned();
        if let Some(tissue) = self.tissues.lock().ok().and_then(|tissues| known(&tissues)) {
            return Ok(tissue);
        }
        let tissue = Tissue::new(self.cells, seed)?;
        if let Ok(mut tissues) = self.tissues.lock() {
            tissues.insert(seed, tissue.clone());
        }
        Ok(tissue)
    }

    /// What a search is told of the noise.
    fn told(&self, noise: Noise) -> KnownNoise {
        if self.estimated {
            KnownNoise::default()
        } else {
            Noise { position: noise.position.max(LEAST_POSITION_NOISE), ..noise }.known()
        }
    }

    /// Searches a data set of each seed, made from the seed of a tissue and that of what is drawn for it, and tells of those that a setting calls failures.
    fn search(
        &self,
        name: &str,
        noise: Noise,
        sample: impl Fn(u64, u64) -> Result<Sample, Box<dyn Error>> + Sync,
        failed: impl Fn(&Found) -> bool,
    ) -> Result<Vec<Found>, Box<dyn Error>> {
        let begun = Instant::now();
        let found = on_one_core_each(self.seeds, |seed| {
            let searched = sample(seed, drawn(name, seed))
                .and_then(|sample| Found::search(&sample, self.told(noise), self.null_sets, seed));
            searched.map_err(|error| format!("{name}, seed {seed}: {error}").into())
        })?;
        for found in found.iter().filter(|found| failed(found)) {
            eprintln!("{name}: {found}");
        }
        eprintln!("{name}: {} sets, {:.0} s", found.len(), begun.elapsed().as_secs_f64());
        Ok(found)
    }
}

/// A seed for the noise in a setting: settings share tissues, but nothing else that is random.
fn drawn(name: &str, seed: u64) -> u64 {
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = name.bytes().chain(seed.to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, mix);
    // Small enough to be added to.
    hash >> 8
}
