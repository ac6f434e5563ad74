//! What a diagram is asked for.

use crate::arguments::{LARGEST_PARAMETER, Range, Shard, Spreads};
use crate::failure::Failure;
use crate::memory::{OF_A_SIMULATED_CELL, refuse_beyond};
use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use voronudge_model::{Model, Parameters};
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_simulate::{MOST_STEPS, recommended_time_step, seed_of_run};

/// Points along an axis, and runs at each, that nobody means.
const MOST_POINTS: usize = 1000;
/// A range as it is typed.
const EXAMPLE: &str = "3.4 4 13: thirteen values, 0.05 apart";
/// Cells up to which all modes are computed.
const MOST_CELLS_WITH_MODES: usize = 1000;

/// What is measured at each point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[clap(rename_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub(crate) enum Quantity {
    /// Mean square velocity ⟨v²⟩.
    MeanSquareVelocity,
    /// Hexatic order Ψ₆, the modulus of the average of ψ_i.
    HexaticOrder,
    /// Average of the moduli |ψ_i|.
    HexaticModulus,
    /// T1 transitions per cell and time.
    T1Rate,
    /// Mean shape index P_i/√A_i.
    ShapeIndex,
    /// Largest Lyapunov exponent λ; it costs about four times as much as the run itself.
    Lyapunov,
    /// Mean square frequency ⟨ω²⟩ over all modes of the Jacobian, for at most 1000 cells.
    MeanSquareFrequency,
    /// Shear modulus μ of the state at the end; where the tissue flows, it costs many times as much as the run.
    ShearModulus,
    /// Odd shear modulus Kᵒ; all moduli together cost no more than one.
    OddShearModulus,
    /// Bulk modulus B.
    BulkModulus,
    /// Odd bulk modulus A.
    OddBulkModulus,
}

impl Quantity {
    /// Name of its files and of its entry in the report.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeanSquareVelocity => "mean_square_velocity",
            Self::HexaticOrder => "hexatic_order",
            Self::HexaticModulus => "hexatic_modulus",
            Self::T1Rate => "t1_rate",
            Self::ShapeIndex => "shape_index",
            Self::Lyapunov => "lyapunov",
            Self::MeanSquareFrequency => "mean_square_frequency",
            Self::ShearModulus => "shear_modulus",
            Self::OddShearModulus => "odd_shear_modulus",
            Self::BulkModulus => "bulk_modulus",
            Self::OddBulkModulus => "odd_bulk_modulus",
        }
    }

    /// Heading of its map, and label of its colour bar.
    pub fn labels(self) -> [&'static str; 2] {
        match self {
            Self::MeanSquareVelocity => ["mean square velocity", "⟨v²⟩ ((K_P ℓ_0)²)"],
            Self::HexaticOrder => ["hexatic order", "Ψ_6"],
            Self::HexaticModulus => ["hexatic order of neighbourhoods", "⟨|ψ_i|⟩"],
            Self::T1Rate => ["T1 transitions", "T1 transitions per cell and time (K_P)"],
            Self::ShapeIndex => ["shape index", "⟨P_i/√A_i⟩"],
            Self::Lyapunov => ["largest Lyapunov exponent", "λ (K_P)"],
            Self::MeanSquareFrequency => ["mean square frequency", "⟨ω²⟩ (K_P²)"],
            Self::ShearModulus => ["shear modulus", "μ (K_P)"],
            Self::OddShearModulus => ["odd shear modulus", "Kᵒ (K_P)"],
            Self::BulkModulus => ["bulk modulus", "B (K_P)"],
            Self::OddBulkModulus => ["odd bulk modulus", "A (K_P)"],
        }
    }

    /// Whether it is one of the elastic moduli.
    pub fn is_modulus(self) -> bool {
        matches!(self, Self::ShearModulus | Self::OddShearModulus | Self::BulkModulus | Self::OddBulkModulus)
    }

    /// How its values are spread over colours.
    pub fn colours(self) -> (AxisScale, Palette) {
        match self {
            Self::MeanSquareVelocity | Self::MeanSquareFrequency => {
                (AxisScale::Logarithmic, Palette::Sequential)
            }
            Self::Lyapunov | Self::OddShearModulus | Self::OddBulkModulus => {
                (AxisScale::Linear, Palette::Diverging { centre: 0.0 })
            }
            _ => (AxisScale::Linear, Palette::Sequential),
        }
    }
}

#[derive(Debug, Args)]
#[allow(non_snake_case, reason = "the field's symbols are the names of the flags")]
pub(crate) struct GridArguments {
    /// Preferred perimeters, in ℓ_0: first, last, number of values.
    #[arg(long = "P_0", num_args = 3, value_names = ["FROM", "TO", "COUNT"], default_values_t = [3.0, 4.2, 16.0], allow_negative_numbers = true)]
    P_0: Vec<f64>,
    /// Chiralities: first, last, number of values.
    #[arg(long = "alpha", num_args = 3, value_names = ["FROM", "TO", "COUNT"], default_values_t = [0.0, 3.0, 16.0], allow_negative_numbers = true)]
    alpha: Vec<f64>,
    /// Quantities to measure, separated by commas.
    #[arg(long, value_enum, value_name = "QUANTITY,…", value_delimiter = ',', default_values_t = [Quantity::MeanSquareVelocity, Quantity::HexaticOrder, Quantity::HexaticModulus, Quantity::T1Rate, Quantity::ShapeIndex])]
    quantities: Vec<Quantity>,
    /// Number of runs at each point, each from different random positions.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    replicas: usize,
    /// Number of cells in each run, in a square box.
    #[arg(long, default_value_t = 100, allow_negative_numbers = true)]
    cells: usize,
    /// Duration of each run, in 1/K_P. The second half is measured.
    #[arg(long, default_value_t = 100.0, allow_negative_numbers = true)]
    time: f64,
    /// Time step, in 1/K_P [default: at each point the one recommended there, 0.01/max(1, |α|)].
    #[arg(long, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// Area elasticity, in K_P/ℓ_0².
    #[arg(long = "K_A", default_value_t = 0.1, allow_negative_numbers = true)]
    K_A: f64,
    /// Smallest distance between random starting positions, in ℓ_0.
    #[arg(long, value_name = "DISTANCE", default_value_t = 0.7, allow_negative_numbers = true)]
    least_distance: f64,
}

/// Everything that the numbers of a diagram depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Request {
    pub version: String,
    #[serde(rename = "P_0")]
    pub preferred_perimeters: Range,
    #[serde(rename = "alpha")]
    pub chiralities: Range,
    pub quantities: Vec<Quantity>,
    pub replicas: usize,
    pub cells: usize,
    pub time: f64,
    pub dt: Option<f64>,
    #[serde(rename = "K_A")]
    pub area_elasticity: f64,
    pub least_distance: f64,
    #[serde(default, rename = "cell_spread", skip_serializing_if = "Spreads::is_empty")]
    pub spreads: Spreads,
    pub seed: u64,
}

/// One run: a point of the grid, row by row along P_0, and which of the runs there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Job {
    pub point: usize,
    pub replica: usize,
}

impl Request {
    pub fn new(typed: &GridArguments, spreads: Spreads, seed: u64) -> Result<Self, Failure> {
        let positive = |name: &str, value: f64, hint: &str| {
            if value.is_finite() && value > 0.0 {
                return Ok(());
            }
            Err(Failure::new(format!("--{name} is {value}, but it must be positive and finite"))
                .with_hint(hint))
        };
        positive("time", typed.time, "100 is enough for most points; near the transition take more")?;
        if let Some(dt) = typed.dt {
            positive("dt", dt, "leave --dt out for the step that is advised at each point")?;
        }
        for (name, count, most) in
            [("replicas", typed.replicas, MOST_POINTS), ("cells", typed.cells, usize::MAX)]
        {
            if count == 0 || count > most {
                return Err(Failure::new(format!("--{name} is {count}, but it must be 1 or more"))
                    .with_hint(format!("leave --{name} out for the default")));
            }
        }
        for (name, value) in [("K_A", typed.K_A), ("least-distance", typed.least_distance)] {
            if !(0.0..=LARGEST_PARAMETER).contains(&value) {
                return Err(Failure::new(format!(
                    "--{name} is {value}, but it must be 0 to {LARGEST_PARAMETER:e}"
                ))
                .with_hint(format!("leave --{name} out for the default")));
            }
        }
        let threads = rayon::current_num_threads();
        refuse_beyond(
            format!("{threads} runs of {} cells at a time", typed.cells),
            typed.cells.saturating_mul(threads),
            OF_A_SIMULATED_CELL,
        )?;
        let mut quantities = typed.quantities.clone();
        quantities.sort();
        quantities.dedup();
        if quantities.contains(&Quantity::MeanSquareFrequency) && typed.cells > MOST_CELLS_WITH_MODES {
            return Err(Failure::new(format!(
                "mean_square_frequency needs all modes of {} cells, but {MOST_CELLS_WITH_MODES} are the most",
                typed.cells
            ))
            .with_hint("ask for fewer cells, or leave mean_square_frequency out"));
        }
        let request = Self {
            version: env!("CARGO_PKG_VERSION").into(),
            preferred_perimeters: Range::new("P_0", &typed.P_0, EXAMPLE)?,
            chiralities: Range::new("alpha", &typed.alpha, EXAMPLE)?,
            quantities,
            replicas: typed.replicas,
            cells: typed.cells,
            time: typed.time,
            dt: typed.dt,
            area_elasticity: typed.K_A,
            least_distance: typed.least_distance,
            spreads,
            seed,
        };
        request.check()?;
        Ok(request)
    }

    /// Whether the grid can be meant; also asked of one that was read from a file.
    pub fn check(&self) -> Result<(), Failure> {
        let counts = [self.preferred_perimeters.count, self.chiralities.count, self.replicas, self.cells];
        if counts.contains(&0) || counts[..3].iter().any(|count| *count > MOST_POINTS) {
            return Err(Failure::new(format!(
                "a diagram of {} × {} points with {} runs of {} cells",
                counts[0], counts[1], counts[2], counts[3]
            ))
            .with_hint(format!("take 1 to {MOST_POINTS} of each, and one cell or more")));
        }
        let steps = |point: usize| self.time / self.time_step(point);
        match (0..self.points()).map(steps).find(|steps| !(1.0..=MOST_STEPS).contains(steps)) {
            Some(steps) => {
                let fault = voronudge_simulate::Error::TooManySteps { steps, limit: MOST_STEPS };
                Err(Failure::from(fault))
            }
            None => Ok(()),
        }
    }

    pub fn points(&self) -> usize {
        self.preferred_perimeters.count * self.chiralities.count
    }

    /// All runs of a shard, in order.
    pub fn jobs(&self, shard: Shard) -> Vec<Job> {
        let all = (0..self.points())
            .flat_map(|point| (0..self.replicas).map(move |replica| Job { point, replica }));
        all.enumerate().filter(|(index, _)| shard.has(*index)).map(|(_, job)| job).collect()
    }

    /// The model at a point, with K_P and the mean area as units.
    pub fn parameters(&self, point: usize) -> Parameters<f64> {
        let (row, column) =
            (point / self.preferred_perimeters.count, point % self.preferred_perimeters.count);
        Parameters {
            area_elasticity: self.area_elasticity,
            preferred_perimeter: self.preferred_perimeters.values()[column],
            chirality: self.chiralities.values()[row],
            ..Parameters::default()
        }
    }

    /// The model of a run, whose cells may differ.
    pub fn model(&self, job: Job) -> Result<Model<f64>, Failure> {
        let mut parameters = self.parameters(job.point);
        let own = self.spreads.draw(self.cells, self.seed(job), &mut parameters)?;
        own.model(&parameters, self.cells, None)
    }

    /// The time step at a point.
    pub fn time_step(&self, point: usize) -> f64 {
        self.dt.unwrap_or_else(|| recommended_time_step(&self.parameters(point), 1.0)).min(self.time)
    }

    /// Points at which the step is larger than advised.
    pub fn coarse_points(&self) -> usize {
        let advised = |point: usize| recommended_time_step(&self.parameters(point), 1.0) * (1.0 + 1e-9);
        (0..self.points()).filter(|&point| self.time_step(point) > advised(point)).count()
    }

    pub fn seed(&self, job: Job) -> u64 {
        seed_of_run(self.seed, job.point as u64, job.replica as u64)
    }
}
