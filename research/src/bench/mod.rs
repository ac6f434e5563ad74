//! How long hot formulas take for each cell, against the number of cells and of threads, and how much memory.
//!
//! Each kernel, number of cells and number of threads is a process of its own, so that memory can be told and threads set. Beside them the same
//! process times two references, so that what is compared with the record is a ratio, which another machine or a busier hour changes less than a time.

mod kernels;
mod peers;

use crate::Outcome;
use clap::Args;
use kernels::{KERNELS, Kernel, times};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::BLUE;
use voronudge_report::figure::{
    CurveSeries, PointSeries, PointsAndCurves, Stroke, points_and_curves, row_colours,
};
use voronudge_report::markers::Marker;

/// What is timed, and what becomes of it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Numbers of cells.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [100, 1000, 10_000, 100_000, 1_000_000])]
    cells: Vec<usize>,
    /// Numbers of threads.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2])]
    threads: Vec<usize>,
    /// These kernels only; `--list` names them.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    only: Vec<String>,
    /// Name the kernels.
    #[arg(long)]
    list: bool,
    /// Also what else computes tessellations or forces, where this Python has it.
    #[arg(long, value_name = "FILE")]
    python: Option<PathBuf>,
    /// Fail where a time, in units of both references, is more than 1.4 times the recorded one.
    #[arg(long)]
    check: bool,
    /// Put the times into the record, and draw them into the documentation.
    #[arg(long)]
    record: bool,
    /// Write the times as JSON.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// One measurement, in this process.
    #[arg(long, value_names = ["KERNEL", "CELLS"], num_args = 2, hide = true)]
    one: Vec<String>,
}

/// One measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Timing {
    kernel: String,
    cells: usize,
    threads: usize,
    /// ns for each cell and evaluation: the least, and the median.
    least: f64,
    median: f64,
    /// The median in units of two references: a division and a root of a number in the cache, and what cannot be foreseen, a number put into a tree.
    ratio: f64,
    branching_ratio: f64,
    /// Bytes per ns of adding two long arrays into a third.
    bandwidth: f64,
    /// Most memory of the process, tissue included (MB), where the system tells.
    memory: Option<f64>,
}

/// From the root: what is compared with, and a picture of it.
const RECORD: &str = "docs/validation/speed.json";
const PICTURE: &str = "docs/figures/speed.svg";

/// A time may grow by this factor before `--check` fails.
const TOLERANCE: f64 = 1.4;

pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    if let [kernel, cells] = arguments.one.as_slice() {
        println!("{}", serde_json::to_string(&measured(named(kernel)?, cells.parse()?)?)?);
        return Ok(());
    }
    if arguments.list {
        KERNELS.iter().for_each(|kernel| println!("{:14} {}", kernel.name, kernel.meaning));
        return Ok(());
    }
    let chosen: Vec<&Kernel> = match arguments.only.as_slice() {
        [] => KERNELS.iter().collect(),
        only => only.iter().map(|name| named(name)).collect::<Result<_, _>>()?,
    };
    println!(
        "| kernel | cells | threads | ns/cell | median | in divisions | in branches | memory (MB) |\n|---|---|---|---|---|---|---|---|"
    );
    let mut timings = Vec::new();
    for kernel in chosen {
        for &cells in arguments.cells.iter().filter(|&&cells| cells <= kernel.most) {
            for &threads in &arguments.threads {
                let timing = in_process(kernel, cells, threads)?;
                let memory = timing.memory.map_or("?".into(), |memory| format!("{memory:.0}"));
                let Timing { kernel, least, median, ratio, branching_ratio, .. } = &timing;
                println!(
                    "| {kernel} | {cells} | {threads} | {least:.1} | {median:.1} | {ratio:.1} | {branching_ratio:.2} | {memory} |"
                );
                timings.push(timing);
            }
        }
    }
    if let Some(python) = &arguments.python {
        peers::run(python, &arguments.cells)?;
    }
    if let Some(out) = &arguments.out {
        std::fs::write(out, serde_json::to_string_pretty(&timings)? + "\n")?;
    }
    let record = root.join(RECORD);
    let recorded: Vec<Timing> = match record.exists() {
        true => serde_json::from_slice(&std::fs::read(&record)?)?,
        false => Vec::new(),
    };
    if arguments.record {
        let all = renewed(recorded, timings);
        std::fs::write(&record, serde_json::to_string_pretty(&all)? + "\n")?;
        std::fs::write(root.join(PICTURE), drawn(&all))?;
        return Ok(());
    }
    if arguments.check { compare(&timings, &recorded) } else { Ok(()) }
}

fn named(name: &str) -> Result<&'static Kernel, String> {
    let found = KERNELS.iter().find(|kernel| kernel.name == name);
    found.ok_or_else(|| format!("there is no kernel {name}; `cargo xtask bench --list` names them"))
}

/// The same program, for one measurement.
fn in_process(kernel: &Kernel, cells: usize, threads: usize) -> Result<Timing, Box<dyn Error>> {
    let output = Command::new(std::env::current_exe()?)
        .args(["bench", "--one", kernel.name, &cells.to_string()])
        .env("RAYON_NUM_THREADS", threads.to_string())
        .output()?;
    if !output.status.success() {
        return Err(
            format!("{} of {cells} cells: {}", kernel.name, String::from_utf8_lossy(&output.stderr)).into()
        );
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn measured(kernel: &Kernel, cells: usize) -> Result<Timing, Box<dyn Error>> {
    // Before anything else, while the processor is as it will be; what takes memory of its own comes after it was told.
    let (reference, branching) = (kernels::reference()?, kernels::branching_reference()?);
    let [least, median] = times((kernel.prepare)(cells)?)?;
    let memory = peak_memory();
    let bandwidth = kernels::bandwidth()?;
    let each = |time: std::time::Duration| time.as_secs_f64() * 1e9 / (cells * kernel.evaluations) as f64;
    Ok(Timing {
        kernel: kernel.name.into(),
        cells,
        threads: rayon::current_num_threads(),
        least: each(least),
        median: each(median),
        ratio: each(median) / reference,
        branching_ratio: each(median) / branching,
        bandwidth,
        memory,
    })
}

/// What Linux says of this process.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}

impl Timing {
    /// By which factor more time is taken, in units of the reference that is kinder.
    fn slower_than(&self, then: &Self) -> f64 {
        (self.ratio / then.ratio).min(self.branching_ratio / then.branching_ratio)
    }

    /// Whether the same was timed.
    fn is_of_same(&self, other: &Self) -> bool {
        (&self.kernel, self.cells, self.threads) == (&other.kernel, other.cells, other.threads)
    }
}

/// A record in which some measurements stand in the place of what they repeat.
fn renewed(mut record: Vec<Timing>, timings: Vec<Timing>) -> Vec<Timing> {
    for timing in timings {
        match record.iter_mut().find(|then| then.is_of_same(&timing)) {
            Some(then) => *then = timing,
            None => record.push(timing),
        }
    }
    record
}

/// Fails where something became slower by more than what machines and hours differ.
fn compare(timings: &[Timing], record: &[Timing]) -> Outcome {
    let mut slower = Vec::new();
    for now in timings {
        if let Some(then) = record.iter().find(|then| then.is_of_same(now))
            && let factor = now.slower_than(then)
            && factor > TOLERANCE
        {
            slower
                .push(format!("{} of {} cells, {} threads: {factor:.2}", now.kernel, now.cells, now.threads));
        }
    }
    if slower.is_empty() { Ok(()) } else { Err(format!("times the record:\n{}", slower.join("\n")).into()) }
}

/// Time for each cell against the number of cells, one thread.
fn drawn(timings: &[Timing]) -> String {
    let mut kernels: BTreeMap<&str, Vec<[f64; 2]>> = BTreeMap::new();
    for timing in timings.iter().filter(|timing| timing.threads == 1) {
        kernels.entry(&timing.kernel).or_default().push([timing.cells as f64, timing.median]);
    }
    let colours = row_colours(kernels.len());
    let colour = |place: usize| colours.get(place).map_or(BLUE, String::as_str);
    let markers = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];
    let series: Vec<_> = (kernels.iter().enumerate())
        .map(|(place, (label, points))| PointSeries {
            label,
            colour: colour(place),
            marker: markers[place % 4],
            points: points.iter().map(|&point| point.into()).collect(),
        })
        .collect();
    let curves: Vec<_> = (kernels.values().enumerate())
        .map(|(place, points)| CurveSeries {
            label: "",
            colour: colour(place),
            stroke: Stroke::Solid,
            points: points.clone(),
        })
        .collect();
    points_and_curves(&PointsAndCurves {
        title: "Time for each cell against the number of cells, one thread",
        labels: ["cells", "time per cell (ns)"],
        scales: [AxisScale::Logarithmic; 2],
        series: &series,
        curves: &curves,
    })
}
