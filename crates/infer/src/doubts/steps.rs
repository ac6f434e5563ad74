//! Are velocities differences of positions over too long a time?
//!
//! A difference is the average of the velocity over the interval, and forces change as cells move. Measured on liquids
//! (central differences, 200 to 300 cells): a mean step of .05 ℓ₀ between frames shifts K_P α by −1 to −3 %, .15 ℓ₀ by −11 to
//! −23 %.

use crate::Observation;

/// Root mean square step between frames, in ℓ₀, above which differences bias the parameters by more than their errors.
const LONGEST: f64 = 0.05;

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
