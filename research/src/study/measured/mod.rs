//! The program on data as they are measured: errors, coverage of the intervals, and whether it says where it is wrong.

mod count;
mod figure;
mod hiding;
mod latent;
mod program;
mod record;
mod summary;
#[cfg(test)]
mod tests;
mod trial;

use super::seeds::on_cores;
use crate::Outcome;
use claims::measured::{CLASSES, Class};
use clap::Args;
pub(crate) use program::Program;
use record::Records;
use std::path::PathBuf;

/// How the study of data as they are measured is made.
#[derive(Debug, Args)]
#[command(next_help_heading = "Study of data as they are measured")]
#[group(id = "measured")]
pub struct Arguments {
    /// Classes of data, by name.
    #[arg(long, value_delimiter = ',', value_parser = class)]
    classes: Vec<Class>,
    /// Seed of the first set; of channel, edge, pinching, pinch-relaxation and transport, the seed that those of their tissues are made from.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Fits at the same time, each on one thread.
    #[arg(long)]
    jobs: Option<usize>,
    /// Folder for the sets, the fits and `records.jsonl`.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Take the sets that are in `records.jsonl` for done.
    #[arg(long)]
    resume: bool,
    /// Options of `voronudge infer` and `voronudge discover`.
    #[arg(long, default_value = "--fix K_A=0.1", allow_hyphen_values = true)]
    flags: String,
    /// The program to try, instead of the one beside this.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Also search for missing effects, of which there are none; of spreads, search instead of fits in which cells differ.
    #[arg(long)]
    pub discover: bool,
    /// Hide this share of the detections of `--data`, and see which are found again.
    #[arg(long, value_name = "SHARE", requires = "data", value_parser = share)]
    hidden: Option<f64>,
    /// A measured data set.
    #[arg(long, value_name = "DATASET", requires = "hidden")]
    data: Option<PathBuf>,
    /// First frame of it that is used.
    #[arg(long, default_value_t = 0)]
    first_frame: usize,
    /// Frames of it that are used: a movie, or a single one with its velocities by central differences.
    #[arg(long, default_value_t = 6)]
    movie: usize,
}

impl Arguments {
    /// The folder for sets, in that of builds if none is given.
    pub fn folder(&self, name: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| crate::root().join("target").join(name))
    }
}

fn class(name: &str) -> Result<Class, String> {
    let known = || CLASSES.map(|class| class.name).join(", ");
    Class::named(name).ok_or_else(|| format!("there are {}", known()))
}

/// A percentage, or a number between 0 and 1.
fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    let share = unit * number.trim().parse::<f64>().map_err(|error| error.to_string())?;
    if (0.0..1.0).contains(&share) { Ok(share) } else { Err("a share lies between 0 and 1".into()) }
}

/// Runs the study on sets of every class, or hides detections of a measured one.
pub fn run(arguments: &Arguments, sets: u64, cells: Option<usize>) -> Outcome {
    let program = Program::new(arguments.program.clone(), &arguments.flags)?;
    let folder = arguments.folder("measured");
    if let (Some(share), Some(data)) = (arguments.hidden, &arguments.data) {
        let movie = hiding::Movie::read(data, arguments.first_frame, arguments.movie)?;
        return hiding::run(&program, &movie, share, arguments.seed..arguments.seed + sets, &folder);
    }
    let classes = if arguments.classes.is_empty() { CLASSES.to_vec() } else { arguments.classes.clone() };
    let records = Records::open(&folder, arguments.resume)?;
    let count = classes.len() as u64;
    let cores = std::thread::available_parallelism()?.get();
    // Seed after seed, so that a study that is stopped has as many sets of every class.
    on_cores(arguments.jobs.unwrap_or(cores), sets * count, |task| {
        let (class, seed) = (&classes[(task % count) as usize], arguments.seed + task / count);
        if records.has(class.name, seed, &program, arguments.discover) {
            return Ok(());
        }
        let folder = folder.join(format!("{}-{seed}", class.name));
        let record = trial::run(class, seed, cells, &program, arguments.discover, &folder)?;
        eprintln!("{record}");
        records.add(record)
    })?;
    let seeds = arguments.seed..arguments.seed + sets;
    let tables: Vec<_> = classes
        .iter()
        .map(|class| summary::Summary::of(class, &records.of(class.name, seeds.clone(), &program)))
        .collect();
    summary::print(&tables);
    std::fs::write(folder.join("measured.svg"), figure::draw(&tables))?;
    Ok(())
}
