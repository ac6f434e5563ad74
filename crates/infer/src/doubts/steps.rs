//! Are velocities differences of positions over too long a time, or tracks too seldom seen?
//!
//! A difference is the average of the velocity over the interval, and forces change as cells move. Measured on liquids
//! (central differences, 200 to 300 cells): a mean step of .05 ℓ₀ between frames shifts K_P α by −1 to −3 %, .15 ℓ₀ by −11 to
//! −23 %.

use crate::Observation;
use crate::median::median;
use voronudge_geometry::Vector;

/// Root mean square step between frames, in ℓ₀, above which differences bias the parameters by more than their errors.
const LONGEST: f64 = 0.05;

/// How many times as fast as they get on cells may move along their paths. Where they move faster a fit of tracks can end anywhere.
const MOST_TURNS: f64 = 2.0;

/// How many times as fast as they get on from frame to frame cells move, where that is too fast: medians of the speeds at the beginning of
/// each motion and of those over the whole of it.
pub(crate) fn turning(motions: impl Iterator<Item = [Vector<f64>; 2]>) -> Option<f64> {
    let (mut along, mut over): (Vec<f64>, Vec<f64>) =
        motions.map(|[along, over]| (along.norm(), over.norm())).unzip();
    let ratio = median(&mut along)? / median(&mut over)?;
    (ratio > MOST_TURNS).then_some(ratio)
}

/// The root mean square step in ℓ₀ of cells whose velocities are differences of positions this time apart, where it is too
/// long.
pub(super) fn long_steps(frames: &[Observation], frame_interval: f64) -> Option<f64> {
    let (sum, count) = frames
        .iter()
        .flat_map(Observation::explainable)
        .fold((0.0, 0usize), |(sum, count), v| (sum + v.norm_squared(), count + 1));
    let step = frame_interval * (sum / count.max(1) as f64).sqrt();
    (step > LONGEST).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells on circles of which they run through an angle from frame to frame: the chord of an arc is shorter by sin(φ/2)/(φ/2).
    #[test]
    fn cells_that_turn_around_between_frames_are_told() {
        let ratio = |angle: f64| {
            let cell = |k: usize| {
                let begin = k as f64;
                let at = |t: f64| Vector::new((begin + t).cos(), (begin + t).sin());
                [Vector::new(-begin.sin(), begin.cos()), (at(angle) - at(0.0)) / angle]
            };
            turning((0..50).map(cell))
        };
        assert_eq!(ratio(2.0), None);
        let found = ratio(5.0).unwrap();
        assert!((found - 2.5 / 2.5_f64.sin()).abs() < 1e-9, "{found}");
    }
}
