//! All measurements of a recording.

use crate::{Curve, Plan, Quantity, Recording, contacts, motion, pairs, shape, spectra};

/// Measures all that can be measured: what needs velocities only if there are some, what needs frames that follow each other only if there are several. In the
/// order of [`Quantity::ALL`].
///
/// Only cells count that [`Frame::counted`](crate::Frame) says; structure factors are of all cells in a periodic box or in the largest upright rectangle in which
/// every cell would have been seen. Positions are as measured: errors of localisation add `4σ_r²` to each mean square displacement, make contacts flicker and
/// let velocities from one frame to the next forget each other.
pub fn observe(recording: &Recording, plan: &Plan) -> Vec<Curve> {
    let mut all = shape::configuration(recording, plan);
    let [flow, order, density] = pairs::correlations(recording, plan);
    all.extend([order, density]);
    let structure = spectra::structure(recording, plan).into_iter().flatten();
    if recording.has_velocities() {
        all.extend([motion::speed(recording, plan), flow]);
        all.extend(structure);
    } else {
        all.extend(structure.filter(|curve| curve.of == Quantity::Density));
    }
    if recording.frames().len() > 1 {
        all.push(motion::displacement(recording, plan));
        all.extend(contacts::exchange(recording, plan));
        if recording.has_velocities() {
            all.push(motion::memory(recording, plan));
        }
    }
    all.retain(|curve| curve.value.iter().any(|value| value.is_finite()));
    all.sort_by_key(|curve| curve.of);
    all
}

/// The autocorrelation and the correlation of the velocities alone.
pub fn correlations(recording: &Recording, plan: &Plan) -> Vec<Curve> {
    let [flow, ..] = pairs::correlations(recording, plan);
    let mut all = vec![flow, motion::memory(recording, plan)];
    all.retain(|curve| curve.value.iter().any(|value| value.is_finite()));
    all
}
