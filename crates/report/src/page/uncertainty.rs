//! The figures and sentences that say how well the parameters are known.

use super::directions::directions;
use super::words::printed;
use super::{Block, Figure, Section};
use crate::figure::{
    BootstrapHistogram, Landscape, ParameterRow, ProfileCurve, bootstrap_histogram, landscape,
    parameter_intervals, profile,
};
use crate::infer_report::{BootstrapResult, InferReport, Parameter};

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
pub(super) fn known(report: &InferReport, rows: &[ParameterRow], figures: &Uncertainty) -> Section {
    let p = &report.parameters;
    let free = |parameter: &&Parameter| !parameter.fixed;
    let free = [&p.K_P_alpha, &p.P_0, &p.alpha, &p.K_P, &p.K_A].into_iter().filter(free);
    let sentences = Block::list(free.map(|parameter| printed(&parameter.words)));
    let intervals = Figure::new(
        parameter_intervals(rows),
        "Each parameter on its own axis; the dashed upright line is zero. An arrow head says that \
         the interval is not bounded there, a thick upright line that the estimate stopped at a \
         bound.",
    );
    let is_finding = report.verdict.kind.is_finding();
    Section::new("How well is it known")
        .with_all(is_finding.then_some(sentences))
        .with(Block::group(if is_finding { "single" } else { "single void" }, [intervals]))
        .with(Block::heading("What the data determine"))
        .with_all(determined(report))
        .with_part(
            "Profiles",
            "The parameter is held at each value and everything else fitted again. Where the curve is no parabola, believe the profile rather than the table above.",
            Block::pairs(figures.profiles.iter().map(profile_figure)),
        )
        .with_part(
            "Landscapes",
            "Left as a picture of the loss is usually drawn, with the nudges as they were fitted. Right what matters for the uncertainty: nudges and all other parameters \
             follow. The lines bound 68 % and 95 %.",
            Block::pairs(figures.landscapes.iter().flatten().map(landscape_figure)),
        )
        .with_part(
            "Bootstrap",
            &report.bootstrap.as_ref().map(bootstrapped).unwrap_or_default(),
            Block::group("figures three", figures.bootstrap.iter().map(bootstrap_figure)),
        )
}

fn determined(report: &InferReport) -> Vec<Block> {
    if report.identifiability.is_empty() {
        return vec![Block::paragraph("No parameter was fitted.")];
    }
    let how = "Directions in the space of the fitted coefficients, best determined first. A small eigenvalue means that the data hardly notice a change of the parameters in \
               that direction, so these parameters can be traded for each other. In units of the cell size; K_P P_0 is counted in units of 3.72, the outline of a regular \
               hexagon.";
    vec![Block::paragraph(how), directions(&report.identifiability)]
}

fn bootstrapped(own: &BootstrapResult) -> String {
    let failed = match own.failed {
        0 => String::new(),
        count => format!(", {count} more could not be"),
    };
    format!(
        "{} synthetic data sets were fitted{failed}: cells at the nudged positions that move as the fit predicts, with noise. Estimates that lie to one side of the \
         upright line mean that the fit is biased.",
        own.replicates
    )
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
