//! What a channel is asked to be, in the units of its preset or of the user.

use super::cycle::CycleArguments;
use crate::arguments::{ParameterArguments, positive};
use crate::command::drawing::units_of_model;
use crate::command::equation_of_state::{self, MeasuredEquation};
use crate::failure::Failure;
use crate::memory::{OF_A_SIMULATED_CELL, refuse_beyond};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use voronudge_geometry::PeriodicBox;
use voronudge_model::Parameters;
use voronudge_report::Units;
use voronudge_report::numbers::significant;
use voronudge_simulate::{
    CellCycle, ChannelSchedule, EdgeRate, Injection, Proliferation, Turnover, Walls, recommended_time_step,
};

#[derive(Debug, Args)]
#[command(next_help_heading = "Channel")]
pub(super) struct ChannelArguments {
    /// Use values of the paper as defaults; `ht1080` is in µm and hours.
    #[arg(long, value_enum)]
    preset: Option<Preset>,
    /// Width of the channel, along x [default: 20 cell sizes].
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    width: Option<f64>,
    /// Length of the channel, along y [default: 20 cell sizes].
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    length: Option<f64>,
    /// Put torque-free walls at both edges [default: none, the box is periodic].
    #[arg(long, value_enum)]
    walls: Option<WallsName>,
    /// Cell size ℓ₀, the square root of the initial mean area [default: 1].
    #[arg(long, value_name = "SIZE", allow_negative_numbers = true)]
    cell_size: Option<f64>,
    /// Name of the unit of length, for display [default: `length`].
    #[arg(long, value_name = "UNIT")]
    length_unit: Option<String>,
    /// Name of the unit of time, for display [default: `time`].
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,
    /// Extrusion rate at the edge, per cell and time [default: 0.77 K_P].
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    extrusion_rate: Option<f64>,
    /// Decay length of the extrusion rate away from the edge; `inf` for the same rate everywhere [default: 1.4 cell
    /// sizes].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    extrusion_length: Option<f64>,
    /// Decay length of proliferation away from the edge [default: 0.25 cell sizes].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    proliferation_length: Option<f64>,
    /// Proliferation rate at the edge, per cell and time, independent of extrusion; the number of cells then changes
    /// [default: one birth for each extrusion].
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    proliferation_rate: Option<f64>,
    /// Where new cells appear.
    #[arg(long, value_enum, default_value_t = InjectionName::Vertex)]
    injection: InjectionName,
    /// Distance between the two cells after a division [default: with --injection division 0.2 cell sizes, with
    /// --injection cycle the distance between the centroids of the mother's halves].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    division_distance: Option<f64>,
    #[command(flatten)]
    cycle: CycleArguments,
    /// Stop the run before there are more cells than this [default: four times the initial number].
    #[arg(long, value_name = "CELLS", allow_negative_numbers = true)]
    most_cells: Option<usize>,
    /// Time before averaging begins [default: 20/K_P].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    relaxation: Option<f64>,
    /// Averaging time [default: 150/K_P].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    time: Option<f64>,
    /// Largest time step [default: the one recommended for the parameters].
    #[arg(long, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// Number of equal intervals of the averaging time whose scatter gives the errors; fewer than 16 give none.
    #[arg(long, default_value_t = 32, allow_negative_numbers = true)]
    samples: usize,
    /// Also predict the flow from an equation of state: a folder written by `equation-of-state` for a tissue with
    /// these parameters.
    #[arg(long, value_name = "DIR")]
    equation_of_state: Option<PathBuf>,
    /// Number of bins across the channel, an even number [default: four per cell size].
    #[arg(long, allow_negative_numbers = true)]
    bins: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// HT1080: ℓ₀ = 25 µm, K_P = 0.43/h, P₀ = 4.0 ℓ₀, α = 2.9, K_A = 0, extrusion 0.33/h over 35 µm, proliferation over 6.25 µm.
    Ht1080,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum WallsName {
    /// At the left and right edges, as in `simulate`; a channel has open ends.
    X,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum InjectionName {
    /// On a vertex of the tessellation.
    Vertex,
    /// Beside a mother cell.
    Division,
    /// Where a mother divides: cells grow over a cycle and divide in two at its end.
    Cycle,
}

/// A checked request.
pub(super) struct ChannelRequest {
    /// Units as they are shown.
    pub units: Units,
    /// Units as data sets name them.
    pub named: Units,
    pub cell_size: f64,
    pub cell_box: PeriodicBox,
    pub walls: Option<Walls>,
    pub cells: usize,
    pub parameters: Parameters<f64>,
    pub turnover: Turnover,
    pub cycle: Option<CellCycle>,
    pub schedule: ChannelSchedule,
    pub division_distance: f64,
    pub equation: Option<MeasuredEquation>,
    pub title: String,
}

/// Bins across a channel, and pieces of time, that nobody means.
const MOST_BINS: usize = 100_000;

/// Cells times steps beyond which a run is surely a mistake: weeks.
const LARGEST_RUN: f64 = 1e13;

impl ChannelArguments {
    /// What is read beside parameters.
    pub fn equation_of_state(&self) -> Option<&Path> {
        self.equation_of_state.as_deref()
    }

    pub fn resolve(&self, parameters: &ParameterArguments, seed: u64) -> Result<ChannelRequest, Failure> {
        let ht1080 = self.preset == Some(Preset::Ht1080);
        if self.samples == 0 {
            return Err(Failure::new("--samples is 0, but averages need at least one")
                .with_hint("leave --samples out for 32; errors need 16"));
        }
        let cell_size = positive("--cell-size", self.cell_size.unwrap_or(if ht1080 { 25.0 } else { 1.0 }))?;
        let defaults = if ht1080 {
            // P₀ and A₀ follow the cell size.
            Parameters {
                area_elasticity: 0.0,
                perimeter_elasticity: 0.43,
                preferred_perimeter: 4.0 * cell_size,
                preferred_area: cell_size * cell_size,
                chirality: 2.9,
            }
        } else {
            Parameters::default()
        };
        let parameters = parameters.resolve_over(defaults)?;
        if parameters.perimeter_elasticity <= 0.0 {
            return Err(Failure::new(format!(
                "K_P is {}, but a channel needs a tissue that resists",
                parameters.perimeter_elasticity
            ))
            .with_hint("give --K_P above zero"));
        }
        let unit_time = 1.0 / parameters.perimeter_elasticity;
        let width = positive("--width", self.width.unwrap_or(20.0 * cell_size))?;
        let length = positive("--length", self.length.unwrap_or(20.0 * cell_size))?;
        let cells = (width * length / (cell_size * cell_size)).round();
        if !(4.0..=1e7).contains(&cells) {
            return Err(Failure::new(format!("a channel of {width} × {length} holds {cells} cells of size {cell_size}"))
                .with_hint("give --width and --length that hold at least four cells, and the --cell-size in the same unit"));
        }
        let rate = |given: Option<f64>, of_preset: f64, per_unit: f64| {
            given.unwrap_or(if ht1080 { of_preset } else { per_unit / unit_time })
        };
        let decay = |given: Option<f64>, of_preset: f64, in_cells: f64| {
            given.unwrap_or(if ht1080 { of_preset } else { in_cells * cell_size })
        };
        let proliferation_length = decay(self.proliferation_length, 6.25, 0.25);
        let division_distance = self.division_distance.unwrap_or(0.2 * cell_size);
        let cycle = self.cycle.resolve(self.injection == InjectionName::Cycle, self.division_distance)?;
        let turnover = Turnover {
            extrusion: EdgeRate {
                rate: rate(self.extrusion_rate, 0.33, 0.77),
                decay_length: decay(self.extrusion_length, 35.0, 1.4),
            },
            proliferation: match self.proliferation_rate {
                None => Proliferation::Replacing { decay_length: proliferation_length },
                Some(rate) => {
                    Proliferation::Independent(EdgeRate { rate, decay_length: proliferation_length })
                }
            },
            injection: match (self.injection, cycle) {
                (_, Some(cycle)) => Injection::Cycle(cycle),
                (InjectionName::Division, _) => Injection::Division { distance: division_distance },
                _ => Injection::Vertex,
            },
            most_cells: self.most_cells.unwrap_or(4 * cells as usize),
            seed,
        };
        let advised = recommended_time_step(&parameters, cell_size);
        let schedule = ChannelSchedule {
            relaxation: self.relaxation.unwrap_or(20.0 * unit_time),
            time: self.time.unwrap_or(150.0 * unit_time),
            time_step: self.dt.unwrap_or(advised),
            samples: self.samples,
            bins: self.bins.unwrap_or(2 * (2.0 * width / cell_size).round().max(1.0) as usize),
        };
        if schedule.bins > MOST_BINS || schedule.samples > MOST_BINS {
            return Err(Failure::new(format!(
                "{} bins and {} samples, but {MOST_BINS} are the most of each",
                schedule.bins, schedule.samples
            ))
            .with_hint("leave --bins and --samples out for the defaults"));
        }
        refuse_beyond(format!("{cells} cells"), cells as usize, OF_A_SIMULATED_CELL)?;
        let ([relaxation, per_sample], _) = schedule.steps()?;
        if (relaxation as f64 + per_sample as f64 * self.samples as f64) * cells > LARGEST_RUN {
            return Err(Failure::new("the run would take weeks").with_hint("shorten --time, or enlarge --dt"));
        }
        let unit = |given: &Option<String>, of_preset: &str, own: &str| {
            given.clone().unwrap_or_else(|| if ht1080 { of_preset } else { own }.to_owned())
        };
        let equation = (self.equation_of_state.as_deref())
            .map(|path| equation_of_state::read(path, &parameters, cell_size))
            .transpose()?;
        if equation.is_some() && self.proliferation_rate.is_some() {
            return Err(Failure::new(
                "--equation-of-state with --proliferation-rate: there is no steady state to predict",
            )
            .with_hint("leave one of them out"));
        }
        let named = Units {
            length: unit(&self.length_unit, "um", "length"),
            time: unit(&self.time_unit, "h", "time"),
        };
        Ok(ChannelRequest {
            units: units_of_model(&named, cell_size, parameters.perimeter_elasticity),
            named,
            cell_size,
            cell_box: PeriodicBox::new([width, length])?,
            walls: self.walls.map(|WallsName::X| Walls::X),
            cells: cells as usize,
            parameters,
            turnover,
            cycle,
            schedule,
            division_distance,
            equation,
            title: if ht1080 { "channel of HT1080 cells".into() } else { "channel".into() },
        })
    }
}

impl ChannelRequest {
    /// Whether the time step is above what is advised.
    pub fn doubtful_step(&self) -> Option<String> {
        let (step, advised) =
            (self.schedule.time_step, recommended_time_step(&self.parameters, self.cell_size));
        (step > 1.0001 * advised).then(|| {
            format!(
                "the time step {step} is above the {} advised for these parameters; velocities can come out wrong by tens of per cent",
                significant(advised, 2)
            )
        })
    }

    /// Decay length of the places of births.
    pub fn proliferation_length(&self) -> f64 {
        match self.turnover.proliferation {
            Proliferation::Replacing { decay_length } => decay_length,
            Proliferation::Independent(rate) => rate.decay_length,
        }
    }
}
