//! Channels with turnover, in cell sizes and units of 1/K_P, with the rates of the paper.

use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_infer::{Intercept, Line, LinePoint, straight_line};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::measure::ChannelProfile;
use voronudge_simulate::{
    ChannelSchedule, EdgeRate, Injection, LivingTissue, Proliferation, RandomPlacement, Simulation, Turnover,
    generator, recommended_time_step, run_channel,
};
use voronudge_theory::MeanField;

/// 0.33/h over 0.43/h.
pub const EXTRUSION_RATE: f64 = 0.33 / 0.43;
/// 35 µm and 6.25 µm over 25 µm.
pub const DECAY_LENGTHS: [f64; 2] = [1.4, 0.25];
/// Beyond the layer where cells are born.
pub const BIRTH_LAYER: f64 = 3.0 * DECAY_LENGTHS[1];

/// Time before the averages.
pub const RELAXATION: f64 = 10.0;

/// A channel to simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Width and length.
    pub lengths: [f64; 2],
    /// `P_0/ℓ_0`
    pub preferred_perimeter: f64,
    /// `α`
    pub chirality: f64,
    /// Time of the averages, after [`RELAXATION`].
    pub time: f64,
}

impl Case {
    /// The model, with K_P = 1.
    pub fn parameters(&self) -> Parameters<f64> {
        Parameters {
            area_elasticity: 0.0,
            perimeter_elasticity: 1.0,
            preferred_perimeter: self.preferred_perimeter,
            preferred_area: 1.0,
            chirality: self.chirality,
        }
    }

    /// Simulates it and averages over both halves, in bins of a quarter of a cell.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn folded_profile(&self, seed: u64) -> Result<ChannelProfile, Box<dyn Error>> {
        self.observed(seed, recommended_time_step(&self.parameters(), 1.0), |_| {})
    }

    /// The same with a time step of one's own, and the tissue after each step.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn observed(
        &self,
        seed: u64,
        time_step: f64,
        mut observe: impl FnMut(&LivingTissue),
    ) -> Result<ChannelProfile, Box<dyn Error>> {
        let cell_box = PeriodicBox::new(self.lengths)?;
        let positions =
            RandomPlacement::new(cell_box.area().round() as usize, cell_box).draw(&mut generator(seed))?;
        let model = Model::chiral_voronoi(&self.parameters());
        let simulation = Simulation::new(positions, Domain::Periodic(cell_box), model)?;
        let [extrusion, proliferation] = DECAY_LENGTHS;
        let turnover = Turnover {
            extrusion: EdgeRate { rate: EXTRUSION_RATE, decay_length: extrusion },
            proliferation: Proliferation::Replacing { decay_length: proliferation },
            injection: Injection::Vertex,
            most_cells: usize::MAX,
            seed,
        };
        let mut tissue = LivingTissue::new(simulation, turnover)?;
        let schedule = ChannelSchedule {
            relaxation: RELAXATION,
            time: self.time,
            time_step,
            samples: 32,
            bins: 2 * (2.0 * self.lengths[0]).round() as usize,
        };
        let run = run_channel(&mut tissue, &schedule, |tissue, _, _| {
            observe(tissue);
            ControlFlow::Continue(())
        })?;
        Ok(run.recorder.folded_profile())
    }

    /// The chirality that a slope v_y/v_x implies.
    ///
    /// # Errors
    /// If the theory has none at these parameters.
    pub fn chirality_of_flow(&self, slope: f64) -> Result<f64, Box<dyn Error>> {
        let parameters = voronudge_theory::Parameters {
            preferred_perimeter: self.preferred_perimeter,
            ..voronudge_theory::Parameters::default()
        };
        MeanField::new(parameters)?
            .chirality_of_flow(slope)
            .ok_or_else(|| "no resistance to compression".into())
    }
}

/// The line through (v_x, v_y) and the origin, from a distance of the edge on.
///
/// # Errors
/// If the points tell no slope.
pub fn line(profile: &ChannelProfile, from: f64) -> Result<Line, Box<dyn Error>> {
    let [v_x, v_y] = &profile.velocity;
    let points = profile.centres.iter().zip(v_x.iter().zip(v_y)).filter(|(d, _)| **d >= from);
    let points: Vec<LinePoint> = points
        .map(|(_, (x, y))| LinePoint {
            x: x.value,
            y: y.value,
            errors: x.error.zip(y.error).map(|(x, y)| [x, y]),
        })
        .collect();
    straight_line(&points, Intercept::Zero).ok_or_else(|| "no slope".into())
}
