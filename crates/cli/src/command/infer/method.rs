//! How the objective is made small.

use crate::command::fit::SearchArguments;
use crate::failure::Failure;
use clap::{Args, ValueEnum};
use voronudge_infer::{Loss, Method};

/// Steps of a descent, which needs many more than a search.
const DESCENT_STEPS: u64 = 2000;

#[derive(Debug, Args)]
#[command(next_help_heading = "Fit")]
pub(super) struct MethodArguments {
    /// How the objective is minimised: by the program's own search, or by the first-order descent of the paper.
    #[arg(long, value_enum, default_value_t = Optimiser::Search)]
    method: Optimiser,
    /// Loss that `--method descent` minimises [default: norms].
    #[arg(long, value_enum)]
    loss: Option<DescendedLoss>,
    #[command(flatten)]
    search: SearchArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Optimiser {
    /// Levenberg–Marquardt with continuation and flips of contacts.
    Search,
    /// Gradient descent, for comparison.
    Descent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DescendedLoss {
    /// Sum of the norms of residuals and nudges, as printed in the paper.
    Norms,
    /// Sum of their squares, the likelihood.
    Squares,
}

impl MethodArguments {
    /// Whether the paper's optimiser is asked for.
    pub fn is_descent(&self) -> bool {
        self.method == Optimiser::Descent
    }

    /// How the objective is made small.
    pub fn method(&self) -> Result<Method, Failure> {
        let refuse = |option: &str, method: &str, other: &str| {
            Err(Failure::new(format!("{option} is for --method {method}, but the method is {other}"))
                .with_hint(format!("leave out {option}, or give --method {method}")))
        };
        match self.method {
            Optimiser::Search if self.loss.is_some() => refuse("--loss", "descent", "search"),
            Optimiser::Search => Ok(self.search.method()),
            Optimiser::Descent if self.search.starts.is_some() => refuse("--starts", "search", "descent"),
            Optimiser::Descent => Ok(Method::Descent {
                max_steps: self.search.max_steps.unwrap_or(DESCENT_STEPS),
                loss: match self.loss {
                    None | Some(DescendedLoss::Norms) => Loss::Norms,
                    Some(DescendedLoss::Squares) => Loss::Squares,
                },
            }),
        }
    }
}
