//! The figures and sentences that say how well the parameters are known.

use serde::Serialize;

use super::Figure;
use super::directions::{Directions, directions};
use crate::figure::{
    BootstrapHistogram, Landscape, ParameterRow, ProfileCurve, bootstrap_histogram, landscape,
    parameter_intervals, profile,
};
use crate::infer_report::{InferReport, Parameter};

/// What was asked beyond the fit, as figures show it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Uncertainty {
    /// Profile likelihoods.
    pub profiles: Vec<ProfileCurve>,
    /// Bootstrap estimates, one histogram for each parameter.
    pub bootstrap: Vec<BootstrapHistogram>,
    /// Slices with the nudges fixed, and with everything fitted again.
    pub landscapes: Vec<[Landscape; 2]>,
}

/// The section of the page.
#[derive(Serialize)]
pub(super) struct Known {
    intervals: Figure,
    parameters: Vec<String>,
    directions: Directions,
    profiles: Vec<Figure>,
    bootstrap: Vec<Figure>,
    landscapes: Vec<Figure>,
}

impl Known {
    /// The figures and sentences of a report.
    pub(super) fn new(report: &InferReport, rows: &[ParameterRow], figures: &Uncertainty) -> Self {
        let p = &report.parameters;
        let free = |parameter: &&Parameter| !parameter.fixed;
        let sentences = [&p.K_P_alpha, &p.P_0, &p.alpha, &p.K_P, &p.K_A].into_iter().filter(free);
        Self {
            intervals: Figure::new(
                parameter_intervals(rows),
                "Each parameter on its own axis; the dashed upright line is zero. An arrow head says that \
                 the interval is not bounded there, a thick upright line that the estimate stopped at a \
                 bound.",
            ),
            parameters: sentences.map(|parameter| printed(&parameter.words)).collect(),
            directions: directions(&report.identifiability),
            profiles: figures.profiles.iter().map(profile_figure).collect(),
            bootstrap: figures.bootstrap.iter().map(bootstrap_figure).collect(),
            landscapes: figures.landscapes.iter().flatten().map(landscape_figure).collect(),
        }
    }
}

/// A sentence with the symbols of the page.
pub(super) fn printed(words: &str) -> String {
    words.replace("alpha", "α")
}

fn profile_figure(curve: &ProfileCurve) -> Figure {
    Figure::new(profile(curve), &format!("profile of {}", curve.parameter))
}

fn bootstrap_figure(histogram: &BootstrapHistogram) -> Figure {
    let caption = format!("bootstrap estimates of {}", histogram.parameter);
    Figure::new(bootstrap_histogram(histogram), &caption)
}

fn landscape_figure(slice: &Landscape) -> Figure {
    let [x, y] = [&slice.x, &slice.y].map(|axis| &axis.label);
    Figure::new(landscape(slice), &format!("{x} and {y}, {}", slice.title))
}
