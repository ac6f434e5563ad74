//! What is asked beyond the fit: profiles, landscapes, the bootstrap.

use crate::arguments::Shard;
use crate::command::fit::quantity;
use crate::command::replicates::Kept;
use crate::failure::Failure;
use crate::problem::Problem;
use crate::progress::Progress;
use clap::Args;
use voronudge_infer::{
    Bootstrap, CoefficientSpace, Constraints, Error, FitParameter, Inference, Landscape, Profile, bootstrap,
    landscape, profile,
};

/// Fewest replicates of which the central 95 % can be told, and more than anybody needs.
const REPLICATES: [usize; 2] = [40, 10_000];

#[derive(Debug, Args)]
#[command(next_help_heading = "Uncertainty")]
pub(super) struct UncertaintyArguments {
    /// Fit this many synthetic data sets with the noise of this fit: 40 to 10000, or 0 for none.
    #[arg(long, value_name = "N", default_value = "0", value_parser = replicates, allow_negative_numbers = true)]
    bootstrap: usize,
    /// Profile likelihood: hold this parameter at several values and fit everything else again. NAME as for --fix.
    /// May be repeated.
    #[arg(long, value_name = "NAME", value_parser = quantity)]
    profile: Vec<FitParameter>,
    /// Compute the objective over two parameters: `--landscape P_0,alpha`. May be repeated.
    #[arg(long, value_name = "NAME,NAME", value_parser = two_quantities)]
    landscape: Vec<[FitParameter; 2]>,
    /// Number of values of each parameter in profiles and landscapes, 5 to 101.
    #[arg(long, value_name = "N", default_value_t = 15, allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(5..=101))]
    points: u64,
}

/// The answers, in the units of the fit.
pub(super) struct Answers {
    pub profiles: Vec<Profile>,
    pub landscapes: Vec<Landscape>,
    pub bootstrap: Option<Bootstrap>,
}

fn replicates(text: &str) -> Result<usize, String> {
    let [fewest, most] = REPLICATES;
    match text.parse() {
        Ok(count) if count == 0 || (fewest..=most).contains(&count) => Ok(count),
        Ok(_) => Err(format!("a bootstrap takes {fewest} to {most} replicates, or 0 for none")),
        Err(_) => Err(format!("{text} is not a number of replicates")),
    }
}

fn two_quantities(text: &str) -> Result<[FitParameter; 2], String> {
    let (x, y) = text.split_once(',').ok_or("write NAME,NAME, for example P_0,alpha")?;
    let [x, y] = [quantity(x.trim())?, quantity(y.trim())?];
    if x == y { Err(format!("{} is named twice", x.name())) } else { Ok([x, y]) }
}

/// Whether a quantity can still vary in a space: whether it differs between two of its points.
fn varies(space: &CoefficientSpace, quantity: FitParameter) -> bool {
    let at = |step: f64| -> f64 {
        let free: Vec<f64> = (0..space.dimension()).map(|k| 1.3 + step * (k as f64 + 0.7)).collect();
        quantity.of(space.coefficients(&free).as_slice())
    };
    let (one, other) = (at(0.37), at(0.91));
    (one - other).abs() > 1e-9 * one.abs()
}

impl UncertaintyArguments {
    /// Refuses questions that constraints leave no room for, before the fit.
    pub fn check(&self, constraints: &Constraints, shard: Option<Shard>) -> Result<(), Failure> {
        if shard.is_some() && self.bootstrap == 0 {
            return Err(Failure::new("--shard shares the replicates of --bootstrap, but none are asked for")
                .with_hint("leave out --shard, or add --bootstrap N"));
        }
        let space = CoefficientSpace::new(constraints)?;
        let refuse = |place: &str, held: FitParameter| {
            Err(Failure::new(format!("{place}: {} is held", held.name()))
                .with_hint("leave it free, or ask about another parameter"))
        };
        for (index, asked) in self.profile.iter().enumerate() {
            if self.profile[..index].contains(asked) {
                return Err(Failure::new(format!("--profile: {} is given twice", asked.name()))
                    .with_hint("give each parameter at most once"));
            }
            if !varies(&space, *asked) {
                return refuse("--profile", *asked);
            }
        }
        for [x, y] in &self.landscape {
            let place = format!("--landscape {},{}", x.name(), y.name());
            if !varies(&space, *x) {
                return refuse(&place, *x);
            }
            if !varies(&space.hold(*x, 0.37)?, *y) {
                let text = format!("{place}: with what is held, each of the two determines the other");
                return Err(Failure::new(text).with_hint("ask for two parameters that vary independently"));
            }
        }
        Ok(())
    }

    /// Whether anything is asked.
    pub fn is_asked(&self) -> bool {
        self.bootstrap > 0 || !self.profile.is_empty() || !self.landscape.is_empty()
    }

    /// Asks a finished fit.
    pub fn ask(
        &self,
        prepared: &Problem,
        result: &Inference,
        kept: &mut Kept,
        progress: &mut Progress,
    ) -> Result<Answers, Error> {
        let (frames, request, points) = (&prepared.observations, &prepared.request, self.points as usize);
        // First what is kept and shared.
        let bootstrap = match self.bootstrap {
            0 => None,
            count => {
                Some(bootstrap(frames, request, result, count, kept, &mut |state| progress.tell(state))?)
            }
        };
        let mut profiles = Vec::new();
        for quantity in &self.profile {
            let stage = format!("profile {}", quantity.name());
            profiles.push(profile(frames, request, result, *quantity, points, &mut |state| {
                progress.step(&stage, state.step.0, state.step.1)
            })?);
        }
        let mut landscapes = Vec::new();
        for pair in &self.landscape {
            let stage = format!("landscape {},{}", pair[0].name(), pair[1].name());
            landscapes.push(landscape(frames, request, result, *pair, points, &mut |state| {
                progress.step(&stage, state.step.0, state.step.1)
            })?);
        }
        Ok(Answers { profiles, landscapes, bootstrap })
    }
}
