//! Data sets as a microscope delivers them, of tissues whose truth is known.
//!
//! A film of a tissue is made by accurate integration of the model. Each step of the measurement then works on plain
//! positions and velocities: what point of a cell is seen, which cells are seen, where, and under which name. Nothing of
//! it is shared with the fits: polygons are made by cutting half planes, flow by counting pixels.
//!
//! [`CLASSES`] are the kinds of data of the study; [`Class::measure`] makes a set of one.

mod class;
mod detection;
mod film;
mod flow;
mod polygon;
mod truth;
mod writing;

pub use class::{CLASSES, Class, EFFECTS, Flaws, Lack, Motion, Point, Recipe, View};
pub use flow::Window;
pub use truth::{Hidden, Kind, Truth};
pub use writing::Written;

use crate::Noise;
use detection::{Detection, Detector};
use film::{Film, Form};
use ndarray::{Array2, Array3};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;
use std::error::Error;
use voronudge_geometry::Vector;
use voronudge_model::Parameters;
use voronudge_simulate::Driving;

/// Width of the strip of tissue around an open field of view that is not seen, in ℓ₀.
const UNSEEN: f64 = 4.0;
/// Numbers of cells of the sets, in turn.
const CELLS: [usize; 4] = [225, 256, 289, 324];
/// σ_v of the sets, of the root mean square velocity.
const VELOCITY_NOISE: f64 = 0.05;

/// What a user would have, and the truth. Lengths are in ℓ₀ of the whole tissue, times in 1/K_P.
#[derive(Debug, Clone)]
pub struct MeasuredSet {
    /// Positions (frames, tracks, 2), NaN where a track has no detection.
    pub positions: Array3<f64>,
    /// What is known of the motion besides.
    pub velocities: Velocities,
    /// Side of the periodic box; none for an open field of view.
    pub cell_box: Option<f64>,
    /// Time between frames.
    pub interval: f64,
    /// What nobody tells the user.
    pub truth: Truth,
}

/// Measured velocities.
#[derive(Debug, Clone)]
pub enum Velocities {
    /// None: there are only tracks.
    None,
    /// Of each detection, of the shape of the positions.
    OfCells(Array3<f64>),
    /// On a grid: coordinates of its columns and rows, and velocities (rows, columns, 2).
    OnGrid(Vec<f64>, Array3<f64>),
}

impl Class {
    /// Makes the set of a seed, of as many cells as the study takes for it, or another number of them.
    ///
    /// Classes share the tissue of a seed. Parameters are drawn with it: P₀ from 3.8 to 4, α from 0.3 to 3 evenly in its
    /// logarithm, σ_r from 1 to 2 %. Of crawling cells: P₀ from 3.6 to 4, α from 0.3 to 1.2, v₀ from 0.3 to 1, D_r from
    /// 0.1 to 1 evenly in its logarithm, σ_r 2 %.
    ///
    /// # Errors
    /// Those of the simulation.
    pub fn measure(&self, seed: u64, cells: Option<usize>) -> Result<MeasuredSet, Box<dyn Error>> {
        let mut drawn = Pcg64::seed_from_u64(3000 + seed);
        let parameters = Parameters {
            area_elasticity: 0.1,
            perimeter_elasticity: 1.0,
            preferred_perimeter: drawn.random_range(3.8..4.0),
            preferred_area: 1.0,
            chirality: 0.3 * 10f64.powf(drawn.random_range(0.0..1.0)),
        };
        let noise = Noise { position: drawn.random_range(0.01..0.02), velocity: VELOCITY_NOISE };
        let mut driving = Driving { seed, ..Driving::default() };
        let (parameters, noise) = match self.recipe.crawls {
            true => {
                driving.speed = drawn.random_range(0.3..1.0);
                driving.rotational_diffusion = 0.1 * 10f64.powf(drawn.random_range(0.0..1.0));
                let preferred_perimeter = drawn.random_range(3.6..4.0);
                let chirality = drawn.random_range(0.3..1.2);
                let noise = Noise { position: 0.02, ..noise };
                (Parameters { preferred_perimeter, chirality, ..parameters }, noise)
            }
            false => (parameters, noise),
        };
        let seen = cells.unwrap_or(CELLS[seed as usize % CELLS.len()]);
        let side = (seen as f64).sqrt().round();
        let (origin, whole) = match self.recipe.view {
            View::Whole => (0.0, side),
            View::Window => (UNSEEN, side + 2.0 * UNSEEN),
        };
        let added = match self.recipe.lack {
            Lack::Nothing => None,
            Lack::Effect => Some((EFFECTS[seed as usize % EFFECTS.len()], Form::InABox)),
            Lack::Ramp => Some(("p0_gradient", Form::InAnOpenField { unseen: origin })),
        };
        let effect = added.map(|(effect, _)| effect);
        let film = Film::new(whole, &parameters, driving, added, self.recipe.motion)?;
        let mut rng = Pcg64::seed_from_u64(self.stream(seed));
        let seen_from = Vector::new(origin, origin);
        let mut detector = Detector::new(&film, &self.recipe, noise, &mut rng)?;
        let is_in_view = |point: Vector<f64>| match self.recipe.view {
            View::Whole => true,
            View::Window => (point - seen_from).iter().all(|x| (0.0..side).contains(x)),
        };
        let frames: Vec<Vec<Detection>> =
            (0..film.frames.len()).map(|frame| detector.look(frame, is_in_view)).collect();
        let (positions, velocities) = arrays(&frames, seen_from);
        let (hidden, doubled) = (detector.hidden, detector.doubled);
        let hidden = hidden.into_iter().map(|hidden| hidden.from(seen_from)).collect();
        let velocities = match self.recipe.motion {
            Motion::Tracks { .. } => Velocities::None,
            Motion::Velocities => Velocities::OfCells(velocities),
            Motion::Flow(window) => {
                let flow = flow::measure(&film, window, noise.velocity, &mut rng)?;
                Velocities::OnGrid(flow.coordinates, flow.velocities)
            }
        };
        let truth = Truth {
            class: self.name.into(),
            seed,
            parameters: named(&parameters, &driving),
            effect: effect.or(self.recipe.crawls.then_some("polarity")).map(String::from),
            noise: [noise.position, noise.velocity],
            mean_step: film.mean_step,
            field_of_view: [0.0, 0.0, side, side],
            hidden,
            doubled,
        };
        let cell_box = matches!(self.recipe.view, View::Whole).then_some(side);
        Ok(MeasuredSet { positions, velocities, cell_box, interval: film.interval, truth })
    }

    /// A seed for what is random in the measurement, so that classes share tissues and no errors.
    fn stream(&self, seed: u64) -> u64 {
        let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        self.name.bytes().chain(seed.to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, mix)
    }
}

fn named(parameters: &Parameters<f64>, driving: &Driving) -> BTreeMap<String, f64> {
    let k_p_alpha = parameters.perimeter_elasticity * parameters.chirality;
    let values = [
        ("K_A", parameters.area_elasticity),
        ("K_P", parameters.perimeter_elasticity),
        ("P_0", parameters.preferred_perimeter),
        ("alpha", parameters.chirality),
        ("K_P_alpha", k_p_alpha),
        ("v_0", driving.speed),
        ("D_r", driving.rotational_diffusion),
    ];
    values.map(|(name, value)| (name.to_owned(), value)).into()
}

/// Detections as (frames, tracks, 2), with places seen from a corner.
fn arrays(frames: &[Vec<Detection>], corner: Vector<f64>) -> (Array3<f64>, Array3<f64>) {
    let tracks = frames.iter().flatten().map(|detection| detection.track + 1).max().unwrap_or(0);
    let mut positions = Array3::from_elem((frames.len(), tracks, 2), f64::NAN);
    let mut velocities = positions.clone();
    for (frame, detections) in frames.iter().enumerate() {
        for detection in detections {
            for axis in 0..2 {
                positions[[frame, detection.track, axis]] = detection.position[axis] - corner[axis];
                velocities[[frame, detection.track, axis]] = detection.velocity[axis];
            }
        }
    }
    (positions, velocities)
}

/// Positions or velocities of one frame.
fn first_frame(array: &Array3<f64>) -> Array2<f64> {
    array.index_axis(ndarray::Axis(0), 0).to_owned()
}
