//! Profiles, landscapes and the bootstrap in the units of the data, for the report and for figures.

use super::questions::Answers;
use crate::command::fit::units::{symbol, unit};
use std::collections::BTreeMap;
use voronudge_infer::{Bootstrap, FitParameter, Inference, Landscape, Profile, Scale};
use voronudge_report::figure::{self, BootstrapHistogram, LandscapeAxis, ProfileCurve};
use voronudge_report::infer_report::{BootstrapResult, LandscapeResult, ProfileResult};
use voronudge_report::{Uncertainty, Units};

/// Rises of −2 log likelihood that bound 68 % and 95 % of two parameters.
const CONTOURS: [(f64, &str); 2] = [(2.30, "68 %"), (5.99, "95 %")];

/// A profile for the report.
pub(super) fn profile(profile: &Profile, scale: &Scale) -> ProfileResult {
    let factor = scale.factor(profile.quantity);
    ProfileResult {
        parameter: profile.quantity.name().into(),
        values: profile.points.iter().map(|point| point.0 * factor).collect(),
        rise: profile.points.iter().map(|point| point.1).collect(),
        interval: profile.interval.map(|end| end.map(|end| end * factor)),
    }
}

/// A landscape for the report.
pub(super) fn landscape(landscape: &Landscape, scale: &Scale) -> LandscapeResult {
    let rows = |heights: &[f64]| heights.chunks(landscape.values[0].len()).map(<[f64]>::to_vec).collect();
    LandscapeResult {
        parameters: landscape.quantities.map(|quantity| quantity.name().into()),
        values: values(landscape, scale),
        fixed: rows(&landscape.fixed),
        refitted: rows(&landscape.refitted),
    }
}

fn values(landscape: &Landscape, scale: &Scale) -> [Vec<f64>; 2] {
    [0, 1].map(|axis| {
        let factor = scale.factor(landscape.quantities[axis]);
        landscape.values[axis].iter().map(|value| value * factor).collect()
    })
}

/// The parameters that were fitted.
fn free(result: &Inference) -> impl Iterator<Item = FitParameter> + '_ {
    FitParameter::ALL.into_iter().filter(|quantity| result.parameters.get(*quantity).standard_error > 0.0)
}

/// The bootstrap for the report.
pub(super) fn bootstrap(bootstrap: &Bootstrap, result: &Inference, scale: &Scale) -> BootstrapResult {
    let named = |quantity: FitParameter| quantity.name().to_owned();
    BootstrapResult {
        replicates: bootstrap.replicates.len(),
        failed: bootstrap.failed,
        intervals: free(result)
            .map(|q| (named(q), bootstrap.interval(q).map(|ends| ends.map(|end| end * scale.factor(q)))))
            .collect(),
        standard_deviations: free(result)
            .map(|q| (named(q), standard_deviation(&bootstrap.values(q)) * scale.factor(q)))
            .collect::<BTreeMap<_, _>>(),
    }
}

fn standard_deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt()
}

/// The answers as figures show them.
pub(super) fn figures(answers: &Answers, result: &Inference, scale: &Scale, units: &Units) -> Uncertainty {
    let best = |quantity: FitParameter| result.parameters.get(quantity).value * scale.factor(quantity);
    let error =
        |quantity: FitParameter| result.parameters.get(quantity).standard_error * scale.factor(quantity);
    let curve = |of: &Profile| {
        let told = profile(of, scale);
        ProfileCurve {
            parameter: symbol(of.quantity).into(),
            unit: unit(of.quantity, units),
            points: told.values.into_iter().zip(told.rise).collect(),
            quadratic: Some((best(of.quantity), error(of.quantity))),
            interval: told.interval,
            best: best(of.quantity),
        }
    };
    let slices = |of: &Landscape| {
        let [x, y] = of.quantities;
        let [along_x, along_y] = values(of, scale);
        let axis = |quantity: FitParameter, values: &[f64]| LandscapeAxis {
            label: symbol(quantity).into(),
            unit: unit(quantity, units),
            values: values.to_vec(),
        };
        [("nudges fixed", &of.fixed), ("everything fitted again", &of.refitted)].map(|(title, rise)| {
            figure::Landscape {
                title: title.into(),
                x: axis(x, &along_x),
                y: axis(y, &along_y),
                rise: rise.clone(),
                best: [best(x), best(y)],
                truth: None,
                contours: CONTOURS.map(|(rise, label)| (rise, label.to_owned())).into(),
            }
        })
    };
    let histogram = |bootstrap: &Bootstrap, quantity: FitParameter| {
        let factor = scale.factor(quantity);
        BootstrapHistogram {
            parameter: symbol(quantity).into(),
            unit: unit(quantity, units),
            estimates: bootstrap.values(quantity).into_iter().map(|value| value * factor).collect(),
            estimate: best(quantity),
            fitted: match result.parameters.get(quantity).interval {
                [Some(low), Some(high)] => Some([low * factor, high * factor]),
                _ => None,
            },
            percentile: bootstrap.interval(quantity).map(|ends| ends.map(|end| end * factor)),
        }
    };
    Uncertainty {
        profiles: answers.profiles.iter().map(curve).collect(),
        bootstrap: answers
            .bootstrap
            .iter()
            .flat_map(|bootstrap| free(result).map(|quantity| histogram(bootstrap, quantity)))
            .collect(),
        landscapes: answers.landscapes.iter().map(slices).collect(),
    }
}
