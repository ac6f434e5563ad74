//! How long is searched for the minimum.

use clap::Args;
use voronudge_infer::Method;

#[derive(Debug, Args)]
#[command(next_help_heading = "Fit")]
pub(crate) struct SearchArguments {
    /// Number of starts of the search, 1 to 64. More starts find a lower minimum if there is one [default: 1].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=64))]
    pub starts: Option<u64>,
    /// Largest number of steps of the optimiser at each stage [default: 60; 2000 for a descent].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub max_steps: Option<u64>,
}

impl SearchArguments {
    /// The program's own search.
    pub fn method(&self) -> Method {
        match Method::default() {
            Method::Search { max_steps, starts } => Method::Search {
                max_steps: self.max_steps.unwrap_or(max_steps),
                starts: self.starts.map_or(starts, |starts| starts as usize),
            },
            other => other,
        }
    }
}
