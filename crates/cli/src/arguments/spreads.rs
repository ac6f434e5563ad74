//! Cells that differ by chance: parameters drawn from distributions.

use super::cells::{KNOWN, OwnParameters, Values, named, of_model};
use crate::failure::Failure;
use clap::Args;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use voronudge_model::{CellParameter, Parameters};
use voronudge_report::phase_report::CellSpread;
use voronudge_simulate::{Distribution, Generator, generator, seed_of_run};

/// Spreads that nobody means.
const LARGEST_SPREAD: f64 = 100.0;
/// What tells the random numbers of parameters from those of runs.
const OF_CELLS: u64 = u64::MAX;

/// Parameters of cells that a command makes.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cells that differ")]
pub(crate) struct SpreadArguments {
    /// Let cells differ at random in a parameter: `alpha=0.3` gives a standard deviation over cells of 0.3 times the
    /// mean. NAME is K_A, P_0, A_0 or alpha. May be repeated.
    #[arg(long, value_name = "NAME=SHARE", allow_hyphen_values = true)]
    cell_spread: Vec<String>,
    /// Distribution of the values for --cell-spread: normal, log-normal or two-types (as many cells below the mean as
    /// above it).
    #[arg(long, value_name = "DISTRIBUTION", default_value = "normal", value_parser = distribution)]
    cell_distribution: Distribution,
}

fn distribution(name: &str) -> Result<Distribution, String> {
    Distribution::from_name(name)
        .ok_or_else(|| format!("there are {}", Distribution::ALL.map(Distribution::name).join(", ")))
}

/// By how much cells differ, by name of the parameter, and how.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Spreads {
    /// Standard deviation of each parameter over cells as a share of its mean.
    shares: BTreeMap<String, f64>,
    /// How values are distributed.
    distribution: Distribution,
}

impl SpreadArguments {
    /// The spreads as typed: of parameters that are known, each once.
    pub fn resolve(&self) -> Result<Spreads, Failure> {
        let mut shares = BTreeMap::new();
        for text in &self.cell_spread {
            let (parameter, share) = named("--cell-spread", text)?;
            let fault = |message: String| Failure::new(format!("--cell-spread {text}: {message}"));
            let share = share.trim().parse().ok().filter(|share| (0.0..=LARGEST_SPREAD).contains(share));
            let share = share.ok_or_else(|| {
                fault(format!("the spread is no number from 0 to {LARGEST_SPREAD}"))
                    .with_hint("write for example alpha=0.3")
            })?;
            if shares.insert(parameter.name().to_owned(), share).is_some() {
                return Err(fault("the parameter is given twice".into()).with_hint("give one spread for it"));
            }
        }
        Ok(Spreads { shares, distribution: self.cell_distribution })
    }
}

impl Spreads {
    /// Whether all cells are alike.
    pub fn is_empty(&self) -> bool {
        self.shares.is_empty()
    }

    /// For the report, unless all cells are alike.
    pub fn record(&self) -> Option<CellSpread> {
        let record = || CellSpread { shares: self.shares.clone(), distribution: self.distribution.name() };
        (!self.is_empty()).then(record)
    }

    /// Spreads of parameters that are nought, of which any share is nothing.
    pub fn idle(&self, parameters: &Parameters<f64>) -> Option<String> {
        let of = |name: &String| Some(*of_model(&mut { *parameters }, CellParameter::from_name(name)?));
        let idle = self.shares.keys().find(|name| of(name) == Some(0.0))?;
        Some(format!("{idle} is 0, and so is any share of it: cells do not differ in {idle}"))
    }

    /// Parameters for so many cells. Those of the model stay, as the means over them.
    pub fn draw(
        &self,
        cells: usize,
        seed: u64,
        parameters: &mut Parameters<f64>,
    ) -> Result<OwnParameters, Failure> {
        let mut own = OwnParameters::default();
        for (name, &share) in &self.shares {
            let fault = |message: &str| Failure::new(format!("--cell-spread {name}={share}: {message}"));
            let parameter = CellParameter::from_name(name).ok_or_else(|| {
                fault("there is no such parameter of a cell").with_hint(format!("write {KNOWN}"))
            })?;
            // Types are the same cells, whatever they differ in.
            let stream = if self.has_types() { 0 } else { parameter as u64 };
            let multiples = self.distribution.draw(share, cells, &mut random(seed, stream));
            if parameter != CellParameter::Chirality && multiples.iter().any(|own| *own <= 0.0) {
                return Err(fault("some cells would have none of it, or less")
                    .with_hint("take a smaller spread, or --cell-distribution log-normal"));
            }
            let mean = *of_model(parameters, parameter);
            let values = multiples.iter().map(|own| own * mean).collect();
            own.add(parameter, Values::OfCells(values), (cells, None), parameters)?;
        }
        Ok(own)
    }

    fn has_types(&self) -> bool {
        self.distribution == Distribution::TwoTypes && !self.is_empty()
    }

    /// Labels of the cells of [`draw`](Self::draw) if there are two types: 0 below the mean and 1 above.
    pub fn labels(&self, cells: usize, seed: u64) -> Option<Vec<Option<i64>>> {
        let of = |multiple: &f64| Some(i64::from(*multiple > 1.0));
        self.has_types()
            .then(|| self.distribution.draw(1.0, cells, &mut random(seed, 0)).iter().map(of).collect())
    }
}

fn random(seed: u64, stream: u64) -> Generator {
    generator(seed_of_run(seed, OF_CELLS, stream))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spreads(typed: &[&str], cell_distribution: Distribution) -> Result<Spreads, Failure> {
        let cell_spread = typed.iter().map(|text| (*text).to_owned()).collect();
        SpreadArguments { cell_spread, cell_distribution }.resolve()
    }

    #[test]
    fn spreads_keep_the_mean_and_types_are_the_same_cells() {
        let mut parameters = Parameters { chirality: 0.5, ..Parameters::default() };
        let both = spreads(&["alpha=0.6", "P_0=0.05"], Distribution::TwoTypes).unwrap();
        let own = both.draw(50, 3, &mut parameters).unwrap().values(50, None);
        assert!(
            (parameters.chirality - 0.5).abs() < 1e-12
                && (parameters.preferred_perimeter - 4.0).abs() < 1e-12
        );
        let labels = both.labels(50, 3).unwrap();
        for ((alpha, perimeter), label) in own.0["alpha"].iter().zip(&own.0["P_0"]).zip(labels) {
            assert_eq!([*alpha > 0.5, *perimeter > 4.0], [label == Some(1); 2]);
        }
        let normal = spreads(&["alpha=0.6", "P_0=0.6"], Distribution::Normal).unwrap();
        assert!(normal.labels(50, 3).is_none());
        assert!(normal.draw(50, 3, &mut parameters).unwrap_err().to_string().contains("log-normal"));
        assert!(normal.idle(&Parameters::default()).unwrap().contains("alpha"));
        for fault in
            [&["alpha=-1"][..], &["alpha=nan"], &["alpha"], &["K_P=0.1"], &["alpha=0.1", "alpha=0.2"]]
        {
            assert!(spreads(fault, Distribution::Normal).is_err(), "{fault:?}");
        }
    }
}
