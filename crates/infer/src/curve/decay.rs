//! Exponential decay from both edges of a channel.

use super::{RISE_95, crossing, least};

/// A value of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayPoint {
    /// Distance from the edge.
    pub distance: f64,
    /// The value there.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// What a profile looks like beyond the middle of the channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecayShape {
    /// The same: `C + A [exp(−d/λ) + exp(−(W − d)/λ)]`, as a density.
    Even,
    /// The opposite: `A [exp(−d/λ) − exp(−(W − d)/λ)]`, as a velocity.
    Odd,
}

/// The curve that fits a profile best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayFit {
    /// Decay length λ.
    pub length: f64,
    /// Its 95 % interval, where `χ²` is within 3.84 of the least (times `χ²` per degree of freedom, if that is above one); an end
    /// that was not found is `None`.
    pub length_interval: [Option<f64>; 2],
    /// Amplitude `A`.
    pub amplitude: f64,
    /// Its standard error.
    pub amplitude_error: f64,
    /// Background `C`, zero for an odd profile.
    pub background: f64,
    /// `χ²` per degree of freedom.
    pub reduced_chi_square: f64,
}

/// Decay lengths tried first, between the spacing of the points and ten times the width.
const TRIALS: usize = 200;

/// Fits the decay from both edges of a channel of a width by weighted least squares.
///
/// For each length the amplitude and the background follow from linear equations; the length with the least `χ²` is searched.
/// Errors of neighbouring points are taken as independent. `None` if there are not more points than parameters, if an error is not
/// positive, or if no length between the spacing of the points and ten times the width is best.
///
/// ```
/// use voronudge_infer::{DecayPoint, DecayShape, fit_decay};
/// let points: Vec<_> = (0..20)
///     .map(|i| 0.25 + 0.5 * f64::from(i))
///     .map(|d| DecayPoint { distance: d, value: 3.0 * ((-d / 1.4f64).exp() - (-(20.0 - d) / 1.4f64).exp()), error: 0.01 })
///     .collect();
/// let fit = fit_decay(&points, 20.0, DecayShape::Odd).unwrap();
/// assert!((fit.length - 1.4).abs() < 1e-5 && (fit.amplitude - 3.0).abs() < 1e-5);
/// ```
pub fn fit_decay(points: &[DecayPoint], width: f64, shape: DecayShape) -> Option<DecayFit> {
    let parameters = match shape {
        DecayShape::Even => 3,
        DecayShape::Odd => 2,
    };
    let usable = |point: &DecayPoint| point.value.is_finite() && point.error.is_finite() && point.error > 0.0;
    if points.len() <= parameters || !points.iter().all(usable) {
        return None;
    }
    let distances = points.iter().map(|point| point.distance);
    let (nearest, farthest) =
        (distances.clone().fold(f64::INFINITY, f64::min), distances.fold(0.0, f64::max));
    let shortest = (farthest - nearest) / (points.len() - 1) as f64;
    let [low, high] = [shortest.ln(), (10.0 * width).ln()];
    let at = |length: f64| Linear::solve(points, width, shape, length);
    let chi_square = |logarithm: f64| at(logarithm.exp()).chi_square;
    let step = (high - low) / TRIALS as f64;
    let best = (0..=TRIALS)
        .min_by(|&a, &b| chi_square(low + step * a as f64).total_cmp(&chi_square(low + step * b as f64)))?;
    if best == 0 || best == TRIALS {
        return None;
    }
    let middle = low + step * best as f64;
    let logarithm = least(&chi_square, [middle - step, middle + step]);
    let (length, found) = (logarithm.exp(), at(logarithm.exp()));
    let reduced = found.chi_square / (points.len() - parameters) as f64;
    let scale = reduced.max(1.0);
    let limit = found.chi_square + RISE_95 * scale;
    let length_interval = [low, high].map(|end| {
        (chi_square(end) > limit).then(|| crossing(|x| chi_square(x) - limit, logarithm, end).exp())
    });
    // The amplitude at its best for each length moves with the length, and varies besides.
    let slope = (at(length * 1.001).amplitude - at(length / 1.001).amplitude) / (length * 0.002);
    let curvature = {
        let by = 1e-3 * length;
        (at(length + by).chi_square - 2.0 * found.chi_square + at(length - by).chi_square) / (by * by)
    };
    let variance = found.amplitude_variance + slope * slope * 2.0 / curvature.max(f64::MIN_POSITIVE);
    Some(DecayFit {
        length,
        length_interval,
        amplitude: found.amplitude,
        amplitude_error: (scale * variance).sqrt(),
        background: found.background,
        reduced_chi_square: reduced,
    })
}

impl DecayFit {
    /// The fitted curve at a distance from the edge.
    pub fn at(&self, distance: f64, width: f64, shape: DecayShape) -> f64 {
        self.background + self.amplitude * decay(distance, width, shape, self.length)
    }
}

/// What is best for one length.
struct Linear {
    amplitude: f64,
    amplitude_variance: f64,
    background: f64,
    chi_square: f64,
}

impl Linear {
    fn solve(points: &[DecayPoint], width: f64, shape: DecayShape, length: f64) -> Self {
        let [mut ff, mut f1, mut one, mut fy, mut y1] = [0.0; 5];
        for point in points {
            let (f, weight) = (decay(point.distance, width, shape, length), point.error.powi(-2));
            ff += weight * f * f;
            f1 += weight * f;
            one += weight;
            fy += weight * f * point.value;
            y1 += weight * point.value;
        }
        let (amplitude, amplitude_variance, background) = match shape {
            DecayShape::Odd => (fy / ff, 1.0 / ff, 0.0),
            DecayShape::Even => {
                let determinant = ff * one - f1 * f1;
                ((fy * one - y1 * f1) / determinant, one / determinant, (ff * y1 - f1 * fy) / determinant)
            }
        };
        let residual = |point: &DecayPoint| {
            let fitted = background + amplitude * decay(point.distance, width, shape, length);
            ((point.value - fitted) / point.error).powi(2)
        };
        let chi_square: f64 = points.iter().map(residual).sum();
        let chi_square = if chi_square.is_finite() { chi_square } else { f64::INFINITY };
        Self { amplitude, amplitude_variance, background, chi_square }
    }
}

fn decay(distance: f64, width: f64, shape: DecayShape, length: f64) -> f64 {
    let (near, far) = ((-distance / length).exp(), (-(width - distance) / length).exp());
    match shape {
        DecayShape::Even => near + far,
        DecayShape::Odd => near - far,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;

    fn noisy(seed: u64, shape: DecayShape) -> Vec<DecayPoint> {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(seed);
        let truth = |d: f64| match shape {
            DecayShape::Even => 1.0 + 0.5 * decay(d, 10.0, shape, 1.4),
            DecayShape::Odd => 0.5 * decay(d, 10.0, shape, 1.4),
        };
        let distances = (1..10).map(|i| 0.5 * f64::from(i));
        let value = |d| DecayPoint {
            distance: d,
            value: truth(d) + 0.02 * rng.sample::<f64, _>(StandardNormal),
            error: 0.02,
        };
        distances.map(value).collect()
    }

    /// Of 200 intervals of 95 %, 190 ± 3 hold the truth if they are what they say; 180 is more than three deviations below.
    #[test]
    fn intervals_hold_the_length_and_the_amplitude() {
        for shape in [DecayShape::Even, DecayShape::Odd] {
            let fits: Vec<_> =
                (0..200).filter_map(|seed| fit_decay(&noisy(seed, shape), 10.0, shape)).collect();
            let inside = |fit: &&DecayFit| {
                let [low, high] = fit.length_interval;
                low.is_none_or(|low| low < 1.4) && high.is_none_or(|high| high > 1.4)
            };
            let near = |fit: &&DecayFit| (fit.amplitude - 0.5).abs() < 2.0 * fit.amplitude_error;
            let counts = [fits.len(), fits.iter().filter(inside).count(), fits.iter().filter(near).count()];
            assert!(counts.iter().all(|&count| count >= 180), "{shape:?}: {counts:?}");
        }
    }

    #[test]
    fn too_few_points_and_flat_profiles_have_no_length() {
        let point = |distance: f64| DecayPoint { distance, value: 1.0, error: 0.1 };
        assert_eq!(fit_decay(&[point(1.0), point(2.0)], 10.0, DecayShape::Odd), None);
        let flat: Vec<_> = (1..10).map(|i| point(0.5 * f64::from(i))).collect();
        assert_eq!(fit_decay(&flat, 10.0, DecayShape::Odd).map(|fit| fit.length_interval[1]), None);
        let unknown = [DecayPoint { error: 0.0, ..point(1.0) }; 5];
        assert_eq!(fit_decay(&unknown, 10.0, DecayShape::Odd), None);
    }
}
