//! Profile likelihood of one parameter.

use super::Point;
use crate::estimates::CHI_SQUARED_95;
use crate::search::Watch;
use crate::{Error, FitParameter, Inference, Observation, Progress, Request};
use std::ops::ControlFlow;

/// How −2 log likelihood rises when one parameter is held away from its estimate and everything else is fitted again.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The parameter.
    pub quantity: FitParameter,
    /// Values, ascending, and the rise above the least of all.
    pub points: Vec<(f64, f64)>,
    /// Where the rise crosses 3.84; `None` where it does not within the range.
    pub interval: [Option<f64>; 2],
}

/// The profile of a parameter at so many values around a fit's estimate, the noise levels kept.
///
/// # Errors
/// [`Error::Constraint`] if the parameter is held; [`Error::Interrupted`].
pub fn profile(
    frames: &[Observation],
    request: &Request,
    result: &Inference,
    quantity: FitParameter,
    points: usize,
    observe: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
) -> Result<Profile, Error> {
    let point = Point::new(frames, request, result)?;
    let values = point.range(quantity, points)?;
    let mut watch = Watch { observe };
    let heights =
        watch.each("profile", &values, point.level(), |value| point.refitted(&[(quantity, *value)]))?;
    let best = point.result.objective / point.result.excess();
    let least = heights.iter().copied().fold(best, f64::min);
    let mut curve: Vec<(f64, f64)> = values.into_iter().zip(heights.iter().map(|h| h - least)).collect();
    curve.push((quantity.of(result.coefficients.as_slice()), best - least));
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    curve.dedup_by(|a, b| a.0 == b.0);
    Ok(Profile { quantity, interval: crossings(&curve), points: curve })
}

/// Where a curve crosses the 95 % threshold on either side of its least point, between its points by the square root.
fn crossings(curve: &[(f64, f64)]) -> [Option<f64>; 2] {
    let least = (0..curve.len()).min_by(|a, b| curve[*a].1.total_cmp(&curve[*b].1)).unwrap_or(0);
    let crossing = |inside: (f64, f64), outside: (f64, f64)| {
        let (a, b, t) = (inside.1.max(0.0).sqrt(), outside.1.max(0.0).sqrt(), CHI_SQUARED_95.sqrt());
        inside.0 + (outside.0 - inside.0) * (t - a) / (b - a)
    };
    let beyond = |index: &usize| curve[*index].1 > CHI_SQUARED_95;
    let below = (0..least).rev().find(beyond).map(|index| crossing(curve[index + 1], curve[index]));
    let above = (least + 1..curve.len()).find(beyond).map(|index| crossing(curve[index - 1], curve[index]));
    [below, above]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_crosses_where_it_should() {
        let curve: Vec<(f64, f64)> =
            (-10..=4).map(|k| (f64::from(k), (f64::from(k) / 2.0).powi(2))).collect();
        let [below, above] = crossings(&curve);
        assert!((below.unwrap() + 2.0 * 1.959_963_985).abs() < 1e-6);
        assert!((above.unwrap() - 2.0 * 1.959_963_985).abs() < 1e-6);
        assert_eq!(crossings(&curve[8..13]), [None, None]);
    }
}
