//! Where the cells begin.

use super::Arguments;
use crate::failure::Failure;
use crate::snapshot::{Snapshot, domain};
use serde::Serialize;
use std::path::PathBuf;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_io::Source;
use voronudge_simulate::{RandomPlacement, generator, honeycomb, sort_in_space};

/// Starting positions and their box.
pub(super) struct Start {
    pub positions: Vec<Vector<f64>>,
    pub cell_box: PeriodicBox,
    pub origin: Origin,
    pub length_unit: String,
    pub time_unit: String,
}

/// Where the positions come from, as the report tells it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Origin {
    Random { least_distance: f64 },
    Honeycomb,
    Data { sha256: Vec<String>, frame: usize },
}

/// Cells times frames that are recorded: 16 GB of positions and velocities.
const LARGEST_RUN: usize = 500_000_000;

impl Start {
    pub fn of(arguments: &Arguments) -> Result<Self, Failure> {
        match arguments.start.as_str() {
            "random" => random(arguments),
            "honeycomb" => lattice(arguments),
            folder => from_data(arguments, PathBuf::from(folder)),
        }
    }
}

fn own_units(positions: Vec<Vector<f64>>, cell_box: PeriodicBox, origin: Origin) -> Start {
    Start { positions, cell_box, origin, length_unit: "length".into(), time_unit: "time".into() }
}

fn cells(arguments: &Arguments) -> Result<usize, Failure> {
    match arguments.cells {
        Some(0) => Err(Failure::new("--cells is 0, but at least one cell is needed")
            .with_hint("leave --cells out for 100 cells")),
        cells => {
            let cells = cells.unwrap_or(100);
            check_size(&format!("--cells {cells}"), cells, arguments.frames).map(|()| cells)
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
    Ok(())
}

fn random(arguments: &Arguments) -> Result<Start, Failure> {
    let cells = cells(arguments)?;
    let cell_box = match arguments.box_lengths.as_deref() {
        Some(&[x, y]) => PeriodicBox::new([x, y])?,
        _ => PeriodicBox::new([(cells as f64).sqrt(); 2])?,
    };
    let least_distance = arguments.least_distance;
    let placement = RandomPlacement { cells, cell_box, least_distance };
    let mut positions = placement.draw(&mut generator(arguments.common.seed))?;
    sort_in_space(&mut positions, &cell_box);
    Ok(own_units(positions, cell_box, Origin::Random { least_distance }))
}

fn lattice(arguments: &Arguments) -> Result<Start, Failure> {
    let (mut positions, mut cell_box) = honeycomb(cells(arguments)?)?;
    if let Some(&[x, y]) = arguments.box_lengths.as_deref() {
        let [width, height] = cell_box.lengths();
        cell_box = PeriodicBox::new([x, y])?;
        positions.iter_mut().for_each(|r| *r = Vector::new(r.x * x / width, r.y * y / height));
    }
    Ok(own_units(positions, cell_box, Origin::Honeycomb))
}

fn from_data(arguments: &Arguments, folder: PathBuf) -> Result<Start, Failure> {
    let place = folder.display().to_string();
    if arguments.cells.is_some() || arguments.box_lengths.is_some() {
        return Err(Failure::new(format!("--start {place} has its own cells and box"))
            .with_hint("leave --cells and --box out"));
    }
    let data = Source { folder: Some(folder), ..Source::default() }.load()?;
    let Domain::Periodic(cell_box) = domain(&data)? else {
        return Err(Failure::new("an open field of view cannot be simulated")
            .at(place)
            .with_hint("give a data set with a periodic box"));
    };
    check_size(&format!("{} cells", data.cells()), data.cells(), arguments.frames)?;
    let frame = data.frames() - 1;
    let snapshot = Snapshot::new(&data, frame);
    if snapshot.positions.len() != data.cells() {
        return Err(Failure::new(format!("cells are absent in its last frame, {frame}"))
            .at(place)
            .with_hint("give a data set in which all cells are present"));
    }
    let sha256 = data.inputs.iter().map(|input| input.sha256.clone()).collect();
    Ok(Start {
        positions: snapshot.positions,
        cell_box,
        origin: Origin::Data { sha256, frame },
        length_unit: data.length_unit,
        time_unit: data.time_unit,
    })
}
