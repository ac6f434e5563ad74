//! What is searched for, and how.

use crate::arguments::{Shard, effect};
use crate::failure::Failure;
use clap::Args;
use voronudge_infer::discover::Search;
use voronudge_model::Effect;

#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub(super) struct SearchOptions {
    /// Consider only these effects: `--effects persistence,drift`. The ids are listed in docs/effects.md [default:
    /// all].
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    effects: Vec<String>,
    /// Do not consider these effects.
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    without: Vec<String>,
    /// Significance level, between 0 and 1: the probability that an effect is found in data in which nothing is
    /// missing.
    #[arg(long, value_name = "P", default_value_t = 0.05, value_parser = level, allow_negative_numbers = true)]
    level: f64,
    /// Number of synthetic data sets without an effect that are fitted before an effect is accepted, 0 to 10000
    /// [default: 20 if an effect is in doubt and there are at most 1000 velocities, else 0].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=10_000), allow_negative_numbers = true)]
    pub null_sets: Option<u64>,
    /// Largest number of effects to add, 1 to 16.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=16), allow_negative_numbers = true)]
    most_effects: u64,
}

fn level(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("{text} is not a number"))?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err(format!("{text} is not between 0 and 1")) }
}

/// The effects of some ids.
fn named(option: &str, ids: &[String]) -> Result<Vec<&'static Effect>, Failure> {
    ids.iter().map(|id| effect(id.trim()).map_err(|failure| failure.at(option))).collect()
}

impl SearchOptions {
    /// The candidates: those asked for, or all, less those not wanted.
    pub fn candidates(&self) -> Result<Vec<&'static Effect>, Failure> {
        let wanted = named("--effects", &self.effects)?;
        let unwanted = named("--without", &self.without)?;
        let is_in =
            |list: &[&'static Effect], effect: &Effect| list.iter().any(|other| other.id == effect.id);
        let candidates: Vec<&'static Effect> = Effect::all()
            .iter()
            .filter(|effect| wanted.is_empty() || is_in(&wanted, effect))
            .filter(|effect| !is_in(&unwanted, effect))
            .collect();
        if candidates.is_empty() {
            return Err(Failure::new("no candidate is left")
                .with_hint("name more under --effects, or fewer under --without"));
        }
        Ok(candidates)
    }

    /// Refuses to share nothing.
    pub fn check(&self, shard: Option<Shard>) -> Result<(), Failure> {
        if shard.is_none() || self.null_sets != Some(0) {
            return Ok(());
        }
        Err(Failure::new("--shard shares null sets, but --null-sets is 0")
            .with_hint("leave out --shard, or give --null-sets a number"))
    }

    /// The search for `candidates`, otherwise as usual.
    pub fn search(&self, candidates: Vec<&'static Effect>, usual: Search) -> Search {
        Search {
            candidates,
            level: self.level,
            null_sets: self.null_sets.map(|sets| sets as usize),
            most_effects: self.most_effects as usize,
            ..usual
        }
    }
}
