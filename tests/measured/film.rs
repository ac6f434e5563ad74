//! A tissue in motion: what is there to be measured.

use super::Motion;
use std::error::Error;
use std::sync::Arc;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Column, Effect, Environment, Model, Parameters};
use voronudge_simulate::{Driving, RandomPlacement, Simulation, generator, recommended_time_step};

/// Time before the first frame, in 1/K_P.
const SETTLING: f64 = 10.0;
/// Time between the onset of an effect and the first frame, in 1/K_P.
const SETTLING_OF_EFFECT: f64 = 1.0;
/// Root mean square velocity of each coefficient of an effect, of that of the tissue without it.
const SHARE: f64 = 0.15;
/// Steps of the integration between frames are this much finer than those recommended, at least.
const FINER: f64 = 4.0;
/// Steps of the integration between two frames, at least.
const STEPS: f64 = 20.0;

/// Frames of a periodic tissue with a mean cell area of one.
pub(super) struct Film {
    /// The box.
    pub cell_box: PeriodicBox,
    /// Time between frames.
    pub interval: f64,
    /// Mean distance that a cell moves from the first frame to the second; 0 of a single frame.
    pub mean_step: f64,
    /// The frames.
    pub frames: Vec<Frame>,
}

/// Which form an effect has that depends on where a cell is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Form {
    /// Waves, which a box of this size allows.
    InABox,
    /// Ramps about the middle of the box, with a jump at its border; of the size that is asked for in cells farther from the border than `unseen`.
    InAnOpenField { unseen: f64 },
}

/// Sites, within the box, and their velocities.
pub(super) struct Frame {
    pub sites: Vec<Vector<f64>>,
    pub velocities: Vec<Vector<f64>>,
}

impl Film {
    /// A square tissue of this side, as many frames of it as the motion asks for.
    pub fn new(
        side: f64,
        parameters: &Parameters<f64>,
        driving: Driving,
        effect: Option<(&str, Form)>,
        motion: Motion,
    ) -> Result<Self, Box<dyn Error>> {
        let cell_box = PeriodicBox::new([side; 2])?;
        let cells = (side * side).round() as usize;
        let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(1000 + driving.seed))?;
        let model = Model::chiral_voronoi(parameters);
        let mut simulation =
            Simulation::new(start, Domain::Periodic(cell_box), model)?.with_driving(driving)?;
        let recommended = recommended_time_step(parameters, 1.0);
        for _ in 0..(SETTLING / recommended).ceil() as usize {
            simulation.step(recommended)?;
        }
        if let Some(effect) = effect {
            simulation = with_effect(&simulation, cell_box, effect)?;
            for _ in 0..(SETTLING_OF_EFFECT / recommended).ceil() as usize {
                simulation.step(recommended)?;
            }
        }
        let frame = |simulation: &Simulation| Frame {
            sites: simulation.positions().iter().map(|site| cell_box.wrap(*site)).collect(),
            velocities: simulation.velocities().to_vec(),
        };
        let mut film = Self { cell_box, interval: 1.0, mean_step: 0.0, frames: vec![frame(&simulation)] };
        let Motion::Tracks { frames, step } = motion else {
            return Ok(film);
        };
        let before = simulation.positions().to_vec();
        let moved = |simulation: &Simulation| mean_norm(before.iter().zip(simulation.positions()));
        let speed = simulation.velocities().iter().map(Vector::norm).sum::<f64>() / cells as f64;
        let time_step = (recommended / FINER).min(step / speed / STEPS);
        let mut steps = 0;
        while moved(&simulation) < step {
            simulation.step(time_step)?;
            steps += 1;
        }
        film.interval = f64::from(steps) * time_step;
        film.mean_step = moved(&simulation);
        film.frames.push(frame(&simulation));
        while film.frames.len() < frames {
            for _ in 0..steps {
                simulation.step(time_step)?;
            }
            film.frames.push(frame(&simulation));
        }
        Ok(film)
    }
}

/// The tissue with an effect of so large a share of its velocities.
fn with_effect(
    before: &Simulation,
    cell_box: PeriodicBox,
    (effect, form): (&str, Form),
) -> Result<Simulation, Box<dyn Error>> {
    let effect = Effect::from_id(effect).ok_or("no such effect")?;
    let domain = Domain::Periodic(cell_box);
    let mut positions = before.positions().to_vec();
    let mut model = before.model().clone();
    let lengths = Vector::from(cell_box.lengths());
    let (columns, unseen) = match form {
        Form::InABox => (effect.columns(&model.environment, domain)?, 0.0),
        Form::InAnOpenField { unseen } => {
            positions.iter_mut().for_each(|site| *site = cell_box.wrap(*site));
            model.environment = Arc::new(Environment::default().about(lengths / 2.0));
            (effect.columns(&model.environment, Domain::Open)?, unseen)
        }
    };
    let is_seen = |site: &Vector<f64>| {
        let beyond = lengths.map(|length| length - unseen);
        unseen == 0.0 || (site.min() >= unseen && site.x < beyond.x && site.y < beyond.y)
    };
    for column in columns {
        let Column::Term(term) = column else { return Err("not a term".into()) };
        let lone = Model { environment: model.environment.clone(), ..Model::single(term) };
        let alone = Simulation::new(positions.clone(), domain, lone)?;
        let moves = positions.iter().zip(alone.velocities()).filter(|(site, _)| is_seen(site));
        let size = root_mean_square(&moves.map(|(_, velocity)| *velocity).collect::<Vec<_>>());
        model = model.with(column, SHARE * root_mean_square(before.velocities()) / size);
    }
    Ok(Simulation::new(positions, domain, model)?)
}

fn mean_norm<'a>(pairs: impl ExactSizeIterator<Item = (&'a Vector<f64>, &'a Vector<f64>)>) -> f64 {
    let count = pairs.len() as f64;
    pairs.map(|(a, b)| (b - a).norm()).sum::<f64>() / count
}

/// Root mean square of vectors.
pub(super) fn root_mean_square(vectors: &[Vector<f64>]) -> f64 {
    (vectors.iter().map(Vector::norm_squared).sum::<f64>() / vectors.len() as f64).sqrt()
}
