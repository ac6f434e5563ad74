//! Where the cells begin.

use crate::boundary::domain_at;
use crate::failure::Failure;
use crate::memory::{OF_A_SIMULATED_CELL, refuse_beyond};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_io::{Snapshot, Source};
use voronudge_simulate::{RandomPlacement, generator, honeycomb, sort_in_space};

/// Where to begin.
#[derive(Debug, Args)]
pub(crate) struct StartArguments {
    /// Number of cells [default: 100].
    #[arg(long, allow_negative_numbers = true)]
    cells: Option<usize>,
    /// Sides of the periodic box [default: unit area per cell; a square, or the box of a regular honeycomb].
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], allow_negative_numbers = true)]
    box_lengths: Option<Vec<f64>>,
    /// Starting positions: `random`, `honeycomb`, or a data set, whose last frame is used.
    #[arg(long, value_name = "random|honeycomb|DATASET", default_value = "random")]
    start: PathBuf,
    /// Smallest distance between random starting positions, in mean cell spacings.
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.7, allow_negative_numbers = true)]
    least_distance: f64,
}

impl StartArguments {
    /// Whether positions depend on the seed.
    pub fn is_random(&self) -> bool {
        self.start == Path::new("random")
    }

    /// The data set that it is read from, if it is one.
    pub fn file(&self) -> Option<&Path> {
        (!matches!(self.start.to_str(), Some("random" | "honeycomb"))).then_some(self.start.as_path())
    }

    /// The start as given.
    pub fn name(&self) -> String {
        self.start.display().to_string()
    }
}

/// Starting positions and their box.
pub(crate) struct Start {
    pub positions: Vec<Vector<f64>>,
    pub cell_box: PeriodicBox,
    pub origin: Origin,
    pub length_unit: String,
    pub time_unit: String,
    /// Labels of the cells (N), if the data set has some.
    pub labels: Option<Vec<Option<i64>>>,
}

/// Where the starting positions come from.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Origin {
    /// Random positions.
    Random {
        /// Least distance between the positions, in mean spacings.
        least_distance: f64,
    },
    /// A honeycomb lattice.
    Honeycomb,
    /// The last frame of a data set.
    Data {
        /// SHA-256 checksums of its files.
        sha256: Vec<String>,
        /// Index of this frame, zero-based.
        frame: usize,
    },
}

/// Cells times frames that are recorded: 16 GB of positions and velocities.
const LARGEST_RUN: usize = 500_000_000;

impl Start {
    /// The starting positions, for a run that keeps a number of frames.
    pub fn of(arguments: &StartArguments, seed: u64, frames: usize) -> Result<Self, Failure> {
        match arguments.start.to_str() {
            Some("random") => random(arguments, seed, frames),
            Some("honeycomb") => lattice(arguments, frames),
            _ => from_data(arguments, frames, arguments.start.clone()),
        }
    }
}

fn own_units(positions: Vec<Vector<f64>>, cell_box: PeriodicBox, origin: Origin) -> Start {
    let [length_unit, time_unit] = ["length", "time"].map(String::from);
    Start { positions, cell_box, origin, length_unit, time_unit, labels: None }
}

fn cells(arguments: &StartArguments, frames: usize) -> Result<usize, Failure> {
    match arguments.cells {
        Some(0) => Err(Failure::new("--cells is 0, but at least one cell is needed")
            .with_hint("leave --cells out for 100 cells")),
        cells => {
            let cells = cells.unwrap_or(100);
            check_size(&format!("--cells {cells}"), cells, frames).map(|()| cells)
        }
    }
}

fn check_size(named: &str, cells: usize, frames: usize) -> Result<(), Failure> {
    if cells.checked_mul(frames.max(1)).is_none_or(|kept| kept > LARGEST_RUN) {
        return Err(Failure::new(format!(
            "--frames {frames} of {named} are more positions than the {LARGEST_RUN} that can be kept"
        ))
        .with_hint("keep fewer frames, or run fewer cells"));
    }
    refuse_beyond(named, cells, OF_A_SIMULATED_CELL)
}

fn random(arguments: &StartArguments, seed: u64, frames: usize) -> Result<Start, Failure> {
    let cells = cells(arguments, frames)?;
    let cell_box = match arguments.box_lengths.as_deref() {
        Some(&[x, y]) => PeriodicBox::new([x, y])?,
        _ => PeriodicBox::new([(cells as f64).sqrt(); 2])?,
    };
    let least_distance = arguments.least_distance;
    let placement = RandomPlacement { cells, cell_box, least_distance };
    let mut positions = placement.draw(&mut generator(seed))?;
    sort_in_space(&mut positions, &cell_box);
    Ok(own_units(positions, cell_box, Origin::Random { least_distance }))
}

fn lattice(arguments: &StartArguments, frames: usize) -> Result<Start, Failure> {
    let (mut positions, mut cell_box) = honeycomb(cells(arguments, frames)?)?;
    if let Some(&[x, y]) = arguments.box_lengths.as_deref() {
        let [width, height] = cell_box.lengths();
        cell_box = PeriodicBox::new([x, y])?;
        positions.iter_mut().for_each(|r| *r = Vector::new(r.x * x / width, r.y * y / height));
    }
    Ok(own_units(positions, cell_box, Origin::Honeycomb))
}

fn from_data(arguments: &StartArguments, frames: usize, folder: PathBuf) -> Result<Start, Failure> {
    let place = folder.display().to_string();
    if arguments.cells.is_some() || arguments.box_lengths.is_some() {
        return Err(Failure::new(format!("--start {place} has its own cells and box"))
            .with_hint("leave --cells and --box out"));
    }
    let data = Source { folder: Some(folder), ..Source::default() }.load()?;
    let frame = data.frames() - 1;
    let Domain::Periodic(cell_box) = domain_at(&data, frame)? else {
        return Err(Failure::new("an open field of view cannot be simulated")
            .at(place)
            .with_hint("give a data set with a periodic box"));
    };
    check_size(&format!("{} cells", data.cells()), data.cells(), frames)?;
    let snapshot = Snapshot::new(&data, frame);
    if snapshot.positions.len() != data.cells() {
        return Err(Failure::new(format!("cells are absent in its last frame, {frame}"))
            .at(place)
            .with_hint("give a data set in which all cells are present"));
    }
    let sha256 = data.inputs.iter().map(|input| input.sha256.clone()).collect();
    Ok(Start {
        labels: data.labels_of(&snapshot, frame),
        positions: snapshot.positions,
        cell_box,
        origin: Origin::Data { sha256, frame },
        length_unit: data.length_unit,
        time_unit: data.time_unit,
    })
}
