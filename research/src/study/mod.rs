//! Statistical studies: longer than tests, with tables for the documentation.

mod advice;
mod by_label;
mod channel;
mod coverage;
mod discover;
mod doubts;
pub(crate) mod flows;
mod forecast;
mod measured;
mod nada;
mod noise;
mod phases;
mod pinch_relaxation;
pub(crate) mod pinching;
mod recovery;
mod rheology;
mod scene;
mod seeds;
mod spectrum;
mod spreads;
mod transport;
mod wall_rule;

pub(crate) use flows::{parameters, random};
pub(crate) use measured::Program;
pub(crate) use seeds::{Replicas, mean, quartiles};

use crate::Outcome;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Which study, and how large.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Which study.
    #[arg(value_enum)]
    which: Study,
    /// Number of seeds.
    #[arg(long, visible_alias = "sets", default_value_t = 10)]
    seeds: u64,
    /// Only tissues of this many cells (nada, coverage, discover, forecast, spectrum, spreads).
    #[arg(long)]
    cells: Option<usize>,
    /// Folder for figures (nada).
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Only this part (discover).
    #[arg(long, value_enum)]
    part: Option<discover::Part>,
    /// Only settings whose name contains one of these (advice, coverage, discover, rheology, spreads).
    #[arg(long, value_name = "TEXT")]
    only: Vec<String>,
    /// Noise levels are estimated, not given (discover).
    #[arg(long)]
    estimated: bool,
    /// Synthetic data without an effect for each search (discover).
    #[arg(long, value_name = "COUNT")]
    null_sets: Option<usize>,
    #[command(flatten)]
    measured: measured::Arguments,
}

/// The studies there are.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Study {
    /// Parameters recovered from noisy snapshots of a chiral liquid.
    Recovery,
    /// Naive least squares, first-order descent and the search against noise.
    Nada,
    /// Noise levels estimated from one snapshot.
    Noise,
    /// How often intervals cover.
    Coverage,
    /// How often fits are doubted, of data as they should be and of others.
    Doubts,
    /// Mean square frequency of the modes of disordered solids.
    Spectrum,
    /// Missing effects: found where there are none, found where there are some.
    Discover,
    /// Mean square velocities of solids and liquids at two system sizes.
    Velocities,
    /// Largest Lyapunov exponents across the transition.
    Lyapunov,
    /// Chirality from the flow in a channel against the one put in.
    Channel,
    /// Edge currents at torque-free walls.
    Edge,
    /// Edge currents at walls as here and as in the paper.
    WallRule,
    /// Flow across a density gradient.
    Pinching,
    /// What becomes of it in a liquid.
    PinchRelaxation,
    /// What drives the flow along a channel: torques of uniform liquids, and shapes of cells against their age.
    Transport,
    /// The program on data as they are measured.
    Measured,
    /// Cells that differ in a parameter.
    Spreads,
    /// Kinds of cells told by labels.
    ByLabel,
    /// Moduli of fitted tissues: whether their intervals cover.
    Rheology,
    /// What to measure next: foreseen, and done.
    Advice,
    /// What fitted models forecast and simulate, beside the truth.
    Forecast,
}

/// Runs a study.
pub fn run(arguments: &Arguments) -> Outcome {
    match arguments.which {
        Study::Recovery => recovery::run(arguments.seeds),
        Study::Nada => nada::run(arguments.seeds, arguments.cells, arguments.figures.as_deref()),
        Study::Noise => noise::levels(arguments.seeds),
        Study::Coverage => coverage::run(arguments.seeds, arguments.cells, &arguments.only),
        Study::Doubts => doubts::run(arguments.seeds),
        Study::Spectrum => spectrum::run(arguments.seeds, arguments.cells),
        Study::Velocities => phases::velocities(),
        Study::Lyapunov => phases::lyapunov(arguments.seeds),
        Study::Channel => channel::run(arguments.replicas()),
        Study::Edge => flows::edge(arguments.replicas()),
        Study::WallRule => wall_rule::run(arguments.replicas()),
        Study::Pinching => pinching::run(arguments.replicas()),
        Study::PinchRelaxation => pinch_relaxation::run(arguments.replicas()),
        Study::Transport => transport::run(arguments.replicas()),
        Study::Measured => measured::run(&arguments.measured, arguments.seeds, arguments.cells),
        Study::Spreads => {
            let searching = arguments.measured.discover;
            spreads::run(arguments.seeds, arguments.cells, &arguments.only, searching)
        }
        Study::ByLabel => {
            let out = arguments.folder("by-label");
            by_label::run(arguments.seeds, arguments.measured.seed, &arguments.only, &out)
        }
        Study::Rheology => {
            let out = arguments.folder("rheology");
            rheology::run(arguments.seeds, arguments.measured.seed, &arguments.only, &out)
        }
        Study::Forecast => forecast::run(arguments.seeds, arguments.cells),
        Study::Advice => advice::run(arguments.seeds, &arguments.only),
        Study::Discover => discover::run(&arguments.plan()),
    }
}

impl Arguments {
    /// Where a study of the program keeps its sets.
    fn folder(&self, name: &str) -> PathBuf {
        self.measured.folder(name)
    }

    /// How many tissues, and the seed that theirs are made from.
    fn replicas(&self) -> Replicas {
        Replicas { seed: self.measured.seed, count: self.seeds }
    }

    /// The study of the search for missing effects.
    fn plan(&self) -> discover::Plan {
        discover::Plan {
            seeds: self.seeds,
            cells: self.cells.unwrap_or(100),
            part: self.part,
            only: self.only.clone(),
            estimated: self.estimated,
            null_sets: self.null_sets,
            tissues: std::sync::Mutex::default(),
        }
    }
}
