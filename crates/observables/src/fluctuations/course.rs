//! Courses of plane waves: what a recording is resolved into.

use super::Tell;
use crate::structure_factor::{Scatterer, amplitudes};
use crate::tapers::{TAPERS, of_constant, still, weights};
use crate::wave_shells::WaveShells;
use crate::window::Window;
use crate::{Error, Frame, Plan, Recording};
use nalgebra::Complex;
use rayon::prelude::*;
use voronudge_geometry::Vector;

/// Share of the frames in which a cell is seen without which it has no place.
const SEEN: f64 = 0.75;

/// Root mean square displacement about the places, in mean spacings, up to which cells keep them.
const KEPT: f64 = 0.3;

/// Frames that are resolved at once.
const CHUNK: usize = 32;

/// What of the cells is resolved into waves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaveField {
    /// `u(q) = Σ_i u_i exp(−iq·R_i)/√N`: displacements from the mean places R_i.
    Displacements,
    /// `j(q) = Σ_i v_i exp(−iq·r_i)/√N`: velocities where the cells are.
    Velocities,
}

impl WaveField {
    /// Displacements if most cells are seen nearly always and keep their places.
    pub(crate) fn suited_to(recording: &Recording, plan: &Plan) -> Self {
        let places = places(recording);
        let (mut squares, mut found, mut all) = (0.0, 0, 0);
        for frame in recording.frames() {
            for (track, r) in frame.tracks.iter().zip(&frame.positions) {
                all += 1;
                if let Some(place) = places[*track] {
                    squares += (r - frame.stage - place).norm_squared();
                    found += 1;
                }
            }
        }
        let kept = squares <= (KEPT * plan.spacing).powi(2) * f64::from(found);
        if kept && f64::from(found) > SEEN * f64::from(all) { Self::Displacements } else { Self::Velocities }
    }

    /// Lags in frames over which errors of localisation without memory correlate.
    pub(crate) fn reach_of_errors(self, recording: &Recording) -> usize {
        match self {
            Self::Displacements => 0,
            // Displacements until the next frame share a position with those before.
            Self::Velocities => usize::from(recording.velocities_are_displacements()),
        }
    }
}

/// The course of a wave, or of what one taper shows of it. Amplitudes along q and a quarter turn ahead, one pair for each frame; NaN where nothing moves.
#[derive(Debug, Clone)]
pub(crate) struct Course {
    pub field: Vec<[Complex<f64>; 2]>,
    /// `Σ_i exp(−iq·r_i)/√N`
    pub density: Vec<Complex<f64>>,
}

/// Those of all waves.
pub(crate) struct Courses {
    /// Tapers that show a wave.
    tapers: usize,
    all: Vec<Course>,
}

impl Courses {
    pub fn new(
        recording: &Recording,
        resolved: &WaveShells,
        field: WaveField,
        tell: &mut Tell<'_>,
    ) -> Result<Self, Error> {
        let places = match field {
            WaveField::Displacements => Some(places(recording)),
            WaveField::Velocities => None,
        };
        let waves = &resolved.waves;
        let of_frame = |frame: &Frame| match &resolved.window {
            Some(window) => through(frame, window, waves, places.as_deref()),
            None => of_box(frame, waves, places.as_deref()),
        };
        let frames = recording.frames();
        let mut rows: Vec<Vec<[Complex<f64>; 3]>> = Vec::with_capacity(frames.len());
        for some in frames.chunks(CHUNK) {
            if tell("waves", rows.len(), frames.len()).is_break() {
                return Err(Error::Interrupted);
            }
            rows.par_extend(some.par_iter().map(of_frame));
        }
        let tapers = if resolved.window.is_some() { TAPERS } else { 1 };
        let course = |k: usize| Course {
            field: rows.iter().map(|row| [row[k][1], row[k][2]]).collect(),
            density: rows.iter().map(|row| row[k][0]).collect(),
        };
        let all: Vec<Course> = (0..tapers * waves.len()).map(course).collect();
        let moves = |course: &Course| course.field.iter().flatten().any(|a| a.norm_sqr() > 0.0);
        if !all.iter().any(moves) {
            return Err(Error::NothingMoves);
        }
        Ok(Self { tapers, all })
    }

    /// The courses of each of some waves.
    pub fn of(&self, waves: &[usize]) -> Vec<&[Course]> {
        waves.iter().map(|wave| &self.all[wave * self.tapers..(wave + 1) * self.tapers]).collect()
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.all.first().map_or(0, |course| course.density.len())
    }
}

/// Mean places beside the stage of the cells that are seen in most frames.
fn places(recording: &Recording) -> Vec<Option<Vector<f64>>> {
    let mut sums = vec![(Vector::zeros(), 0usize); recording.tracks()];
    for frame in recording.frames() {
        for (track, r) in frame.tracks.iter().zip(&frame.positions) {
            sums[*track].0 += r - frame.stage;
            sums[*track].1 += 1;
        }
    }
    let fewest = SEEN * recording.frames().len() as f64;
    sums.into_iter().map(|(sum, seen)| (seen as f64 >= fewest).then(|| sum / seen as f64)).collect()
}

/// For each cell of a frame where its wave is counted from, and what is resolved.
fn moving<'a>(
    frame: &'a Frame,
    places: Option<&'a [Option<Vector<f64>>]>,
) -> impl Iterator<Item = (Vector<f64>, Option<Vector<f64>>)> + 'a {
    frame.tracks.iter().zip(&frame.positions).zip(&frame.velocities).filter_map(move |((track, r), v)| {
        let r = r - frame.stage;
        match places {
            Some(places) => places[*track].map(|place| (place, Some(r - place))),
            None => Some((r, *v)),
        }
    })
}

fn complex(v: Vector<f64>) -> Complex<f64> {
    Complex::new(v.x, v.y)
}

/// Amplitudes of density and field in a periodic box, for each wave.
fn of_box(
    frame: &Frame,
    waves: &[Vector<f64>],
    places: Option<&[Option<Vector<f64>>]>,
) -> Vec<[Complex<f64>; 3]> {
    let cells: Vec<Scatterer<1>> = moving(frame, places)
        .map(|(place, velocity)| Scatterer { place, velocity, weights: [1.0] })
        .collect();
    let there: Vec<Scatterer<1>> = (frame.positions.iter())
        .map(|r| Scatterer { place: r - frame.stage, velocity: None, weights: [1.0] })
        .collect();
    let count = cells.iter().filter(|cell| cell.velocity.is_some()).count() as f64;
    let of_wave = |q: &Vector<f64>| {
        let [[own, along, across]] = amplitudes(&cells, *q);
        let density = if places.is_some() { amplitudes(&there, *q)[0][0] } else { own };
        let root = count.sqrt();
        [complex(density) / (there.len() as f64).sqrt(), complex(along) / root, complex(across) / root]
    };
    waves.iter().map(of_wave).collect()
}

/// The same through the tapers of a window, for each wave those of all tapers.
fn through(
    frame: &Frame,
    window: &Window,
    waves: &[Vector<f64>],
    places: Option<&[Option<Vector<f64>>]>,
) -> Vec<[Complex<f64>; 3]> {
    let seen = |(place, velocity): (Vector<f64>, Option<Vector<f64>>)| {
        let share = window.share(place)?;
        Some(Scatterer { place: place - window.corner, velocity, weights: weights(window, share) })
    };
    let mut cells: Vec<Scatterer<TAPERS>> = moving(frame, places).filter_map(seen).collect();
    let masses = still(&mut cells);
    let there: Vec<Scatterer<TAPERS>> =
        frame.positions.iter().filter_map(|r| seen((r - frame.stage, None))).collect();
    let per_area = there.len() as f64 / window.area();
    let of_wave = |q: &Vector<f64>| {
        let own = amplitudes(&cells, *q);
        let density = amplitudes(&there, *q);
        let of_taper = |k: usize| {
            let [_, along, across] = own[k];
            let less = density[k][0] - of_constant(window, k, *q) * per_area;
            let root = masses[k].sqrt();
            [complex(less) / per_area.sqrt(), complex(along) / root, complex(across) / root]
        };
        std::array::from_fn::<_, TAPERS, _>(of_taper)
    };
    waves.iter().flat_map(of_wave).collect()
}
