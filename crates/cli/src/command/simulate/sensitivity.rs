//! Derivatives of the run by parameters and starting positions, on request.

use super::report::Sensitive;
use crate::failure::Failure;
use crate::progress::Progress;
use ndarray::{Array3, Array4};
use std::ops::ControlFlow;
use voronudge_io::OutputDirectory;
use voronudge_model::{PARAMETER_NAMES, Parameters};
use voronudge_simulate::{Derivatives, Direction, Schedule, Sensitivity, Simulation, sensitivities};

/// A derivative is of use while it misses the difference of two runs by no more than this share.
pub(super) const AGREES: f64 = 0.1;

/// Numbers that are kept until they are written, at most: 1.6 GB.
const MOST_NUMBERS: f64 = 2e8;

/// What the run is to be differentiated by, by name.
pub(super) struct Asked {
    names: Vec<String>,
    directions: Vec<Direction>,
    /// The run at its start.
    from: Simulation,
}

/// The derivatives of a run.
pub(super) struct Differentiated {
    pub names: Vec<String>,
    pub found: Vec<Sensitivity>,
    /// Time of each frame.
    pub times: Vec<f64>,
}

impl Asked {
    /// What `--sensitivity` asks for of a run that is at its start; `None` if for nothing.
    pub fn of(
        names: &[String],
        parameters: &Parameters<f64>,
        simulation: &Simulation,
        schedule: &Schedule,
    ) -> Result<Option<Self>, Failure> {
        if names.is_empty() {
            return Ok(None);
        }
        let cells = simulation.positions().len();
        let directions = names.iter().map(|name| direction(name, parameters, cells));
        let directions = directions.collect::<Result<Vec<_>, _>>()?;
        if let Some(twice) = (1..names.len()).find(|k| names[..*k].contains(&names[*k])) {
            return Err(Failure::new(format!("--sensitivity names {} twice", names[twice]))
                .with_hint("name each parameter and coordinate once"));
        }
        let numbers = 2.0 * (names.len() * schedule.frames) as f64 * cells as f64;
        if numbers > MOST_NUMBERS {
            return Err(Failure::new(format!("--sensitivity would keep {numbers:.1e} numbers"))
                .with_hint("ask for fewer frames, or for fewer derivatives at a time"));
        }
        Ok(Some(Self { names: names.to_vec(), directions, from: simulation.clone() }))
    }

    /// Runs it once more, with derivatives.
    pub fn differentiate(
        self,
        schedule: &Schedule,
        progress: &mut Progress,
    ) -> Result<Differentiated, Failure> {
        let found =
            sensitivities(&self.from, schedule, &self.directions, |done, total| -> ControlFlow<()> {
                progress.step("derivatives", done as u64, total as u64)
            })?;
        let Some(found) = found else {
            progress.finish();
            return Err(Failure::interrupted_at(
                "interrupted while the run was differentiated; the run is kept",
            )
            .with_hint("the same command with --resume differentiates it again"));
        };
        let times = (1..=schedule.frames).map(|frame| frame as f64 * schedule.frame_interval()).collect();
        Ok(Differentiated { names: self.names, found, times })
    }
}

/// A parameter, or the coordinate of a cell at the start, as in `y17`.
fn direction(name: &str, parameters: &Parameters<f64>, cells: usize) -> Result<Direction, Failure> {
    let coordinate = |axis: usize, prefix: char| {
        let cell = name.strip_prefix(prefix)?.parse::<usize>().ok()?;
        Some((cell, axis))
    };
    match Direction::parameter(name, parameters).or_else(|| {
        let (cell, axis) = coordinate(0, 'x').or_else(|| coordinate(1, 'y'))?;
        (cell < cells).then(|| Direction::position(cell, axis))
    }) {
        Some(direction) => Ok(direction),
        None => Err(Failure::new(format!("--sensitivity: there is nothing called \"{}\"", name.escape_debug()))
            .with_hint(format!(
                "write some of {}, or the coordinate of a cell at the start, from x0, y0 to x{last}, y{last}, separated by commas",
                PARAMETER_NAMES.join(", "),
                last = cells - 1
            ))),
    }
}

impl Differentiated {
    /// In short, at the end of the run.
    pub fn in_short(&self) -> Vec<Sensitive> {
        let of_one = |(name, own): (&String, &Sensitivity)| {
            let end = own.frames.last()?;
            Some(Sensitive {
                by: name.clone(),
                root_mean_square: end.root_mean_square(),
                mean_square_velocity: end.mean_square_velocity,
                stress: end.stress,
                aside: own.aside,
                missed: end.missed,
                agrees_until: own.agreeing(AGREES).checked_sub(1).map(|frame| self.times[frame]),
            })
        };
        self.names.iter().zip(&self.found).filter_map(of_one).collect()
    }

    pub fn write(&self, out: &mut OutputDirectory) -> Result<(), Failure> {
        let (count, frames) = (self.found.len(), self.times.len());
        let at = |direction: usize, frame: usize| -> &Derivatives { &self.found[direction].frames[frame] };
        let cells = self.found.first().map_or(0, |own| own.frames[0].positions.len());
        let places = Array4::from_shape_fn((count, frames, cells, 2), |(k, frame, cell, axis)| {
            at(k, frame).positions[cell][axis]
        });
        out.write_array("position_derivatives.npy", places.view())?;
        let measured = Array3::from_shape_fn((count, frames, 7), |(k, frame, column)| {
            let own = at(k, frame);
            match column {
                0 => self.times[frame],
                1 => own.mean_square_velocity,
                2..6 => own.stress.as_flattened()[column - 2],
                _ => own.missed.unwrap_or(f64::NAN),
            }
        });
        out.write_array("measurement_derivatives.npy", measured.view())?;
        Ok(())
    }
}
