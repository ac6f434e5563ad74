//! Intervals of spreads by the profile of the restricted likelihood, and whether there are any.

use super::fitting::{Fitting, Linearised, State};
use super::gram::Gram;
use super::levels::{SMALLEST, Variances};
use crate::Error;
use crate::estimates::CHI_SQUARED_95;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Factor between the spreads at which an end is looked for.
const FACTOR: f64 = 1.3;

/// Largest relative spread.
const LARGEST: f64 = 5.0;

/// Steps towards an end within its bracket.
const STEPS: usize = 3;

/// A 95 % interval of a share `S/c`, given that for the c at hand and the relative standard error of c: on a logarithmic scale both add in
/// squares. There is no upper end where c may be nought.
pub(super) fn of_share(value: f64, interval: [Option<f64>; 2], relative_error: f64) -> [Option<f64>; 2] {
    let of_coefficient = CHI_SQUARED_95.sqrt() * relative_error;
    let wider = |end: f64| (end / value).ln().hypot(of_coefficient);
    let [low, high] = interval;
    let low = low.map(|low| if low > 0.0 { value * (-wider(low)).exp() } else { low });
    let high = high.filter(|_| of_coefficient < 1.0);
    [low, high.map(|high| if value > 0.0 { value * wider(high).exp() } else { high })]
}

/// The probability of so large a fall of −2 log L if cells do not differ. Half of the time there is none at all, because a variance at its bound
/// cannot fall below it.
pub(crate) fn probability(fall: f64) -> f64 {
    if fall > 0.0 { 0.5 * ChiSquared::new(1.0).map_or(f64::NAN, |chi| chi.sf(fall)) } else { 1.0 }
}

/// What the likelihood says of one spread.
pub(super) struct Profile {
    pub interval: [Option<f64>; 2],
    pub p: f64,
}

impl Fitting<'_> {
    /// Interval and p of each spread.
    pub fn profiles(&self, state: &State, linearised: &Linearised) -> Result<Vec<Profile>, Error> {
        let grams = self.grams(state, linearised, state.levels.spring().ln())?;
        let (_, best, least) = self.over_springs(&grams, linearised.left, &state.variances, None)?;
        let of = |parameter: usize| {
            let interval = self.interval(&grams, linearised.left, &best, least, parameter)?;
            Ok(Profile { interval, p: self.p_value(state, linearised, least, parameter)? })
        };
        (0..self.layout.parameters.len()).map(of).collect()
    }

    fn interval(
        &self,
        grams: &[Gram; 3],
        left: f64,
        best: &Variances,
        least: f64,
        parameter: usize,
    ) -> Result<[Option<f64>; 2], Error> {
        let rise = |spread: f64| -> Result<f64, Error> {
            let mut at = best.clone();
            at.of_cells[parameter] = (spread > 0.0).then(|| 2.0 * spread.ln());
            Ok(self.over_springs(grams, left, &at, Some(parameter))?.2 - least - CHI_SQUARED_95)
        };
        let value = best.of_cells[parameter].map_or(0.0, |own| (0.5 * own).exp());
        let lower = match value > 0.0 && rise(0.0)? > 0.0 {
            false => 0.0,
            true => {
                let mut inside = (value, -CHI_SQUARED_95);
                let mut outside = value / FACTOR;
                let mut beyond = rise(outside)?;
                while outside > SMALLEST && beyond < 0.0 {
                    inside = (outside, beyond);
                    outside /= FACTOR;
                    beyond = rise(outside)?;
                }
                end(&rise, (outside, beyond), inside)?
            }
        };
        let mut inside = (value, -CHI_SQUARED_95);
        let mut outside = FACTOR * value.max(5.0 * SMALLEST);
        let mut beyond = rise(outside)?;
        while beyond < 0.0 {
            if outside > LARGEST {
                return Ok([Some(lower), None]);
            }
            inside = (outside, beyond);
            outside *= FACTOR;
            beyond = rise(outside)?;
        }
        Ok([Some(lower), Some(end(&rise, (outside, beyond), inside)?)])
    }

    /// The probability of so low a −2 log L, `least`, if there is no such spread.
    fn p_value(
        &self,
        state: &State,
        linearised: &Linearised,
        least: f64,
        parameter: usize,
    ) -> Result<f64, Error> {
        let mut without = state.variances.clone();
        without.of_cells[parameter] = None;
        let criterion = self.criterion(state, linearised, &without)?;
        Ok(probability(criterion - least))
    }
}

/// Where the rise changes its sign between a spread outside and one inside, by false positions; never further inside.
fn end(
    rise: &impl Fn(f64) -> Result<f64, Error>,
    mut outside: (f64, f64),
    mut inside: (f64, f64),
) -> Result<f64, Error> {
    for _ in 0..STEPS {
        if outside.1 <= 0.0 {
            break;
        }
        // The rise is nearly a parabola.
        let depth = |at: (f64, f64)| (at.1 + CHI_SQUARED_95).max(0.0).sqrt();
        let share = (CHI_SQUARED_95.sqrt() - depth(inside)) / (depth(outside) - depth(inside));
        let middle = inside.0 + share.clamp(0.05, 0.95) * (outside.0 - inside.0);
        let there = rise(middle)?;
        match there > 0.0 {
            true => outside = (middle, there),
            false => inside = (middle, there),
        }
        if there.abs() < 0.1 {
            return Ok(middle);
        }
    }
    Ok(outside.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_known_no_better_than_what_it_is_a_share_of() {
        let own = [Some(0.08), Some(0.125)];
        let known = of_share(0.1, own, 0.0);
        assert!(known.iter().zip(own).all(|(a, b)| (a.unwrap() - b.unwrap()).abs() < 1e-12));
        let [low, high] = of_share(0.1, own, 0.2);
        let expected = (1.25_f64.ln().powi(2) + 3.841_458_8 * 0.04).sqrt().exp();
        assert!(
            (high.unwrap() / 0.1 - expected).abs() < 1e-6 && (0.1 / low.unwrap() - expected).abs() < 1e-6
        );
        assert_eq!(of_share(0.1, own, 0.6)[1], None);
        assert_eq!(of_share(0.0, [Some(0.0), Some(0.03)], 0.1), [Some(0.0), Some(0.03)]);
    }
}
