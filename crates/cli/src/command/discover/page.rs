//! The result of `discover` as a page with figures.

use super::report::Found;
use crate::command::fit::{spreads, views};
use crate::failure::Failure;
use crate::problem::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::diagnostics::{Bin, Cause, Correlation as Measured, Diagnostics};
use voronudge_infer::discover::{Discovery, Selected};
use voronudge_io::DataSet;
use voronudge_report::figure::{
    Correlation, CorrelationFunction, CorrelationPoint, FlowMap, Outlier, PartialPoint, PartialRegression,
    Suspicion,
};
use voronudge_report::movie::CellMovie;
use voronudge_report::page::Page;
use voronudge_report::{BeforeAfter, DiscoverFigures, DiscoverPage, DiscoverReport, FrameView};

pub(super) fn page(
    title: &str,
    found: &Found<'_>,
    discovery: &Discovery,
    report: &DiscoverReport,
    movie: Option<CellMovie>,
) -> Result<Page, Failure> {
    let prepared = found.prepared;
    let drawn = views::drawn(prepared);
    let fits = BeforeAfter { before: &discovery.before.inference, after: &discovery.after.inference };
    let frames: Vec<BeforeAfter<FrameView>> = drawn
        .iter()
        .map(|&index| BeforeAfter {
            before: views::frame_view(prepared, fits.before, index),
            after: views::frame_view(prepared, fits.after, index),
        })
        .collect();
    let flows: Vec<BeforeAfter<FlowMap<'_>>> = drawn
        .iter()
        .zip(&frames)
        .filter_map(|(&index, frames)| {
            Some(BeforeAfter {
                before: views::flow_map(prepared, fits.before, index, &frames.before)?,
                after: views::flow_map(prepared, fits.after, index, &frames.after)?,
            })
        })
        .collect();
    let figures = DiscoverFigures {
        movie,
        correlations: correlations(discovery),
        regressions: discovery
            .selected
            .iter()
            .filter(|selected| !selected.partial.is_empty())
            .map(|selected| regression(selected, prepared))
            .collect(),
        trails: found.compared.as_ref().map(|compared| compared.trails.clone()),
        spreads: spreads::views(prepared, fits.after, &drawn),
        outliers: drawn
            .iter()
            .map(|&index| outliers(prepared, &discovery.after.diagnostics, index))
            .collect(),
    };
    let page = DiscoverPage { title, report, frames: &frames, flows: &flows, figures: &figures };
    Ok(page.page()?)
}

/// The cells of all frames, with their residuals before and after.
pub(super) fn movie(prepared: &Problem, discovery: &Discovery, data: &DataSet) -> Option<CellMovie> {
    let movie = views::movie(prepared, &discovery.before.inference, data)?;
    if discovery.selected.is_empty() {
        return Some(movie);
    }
    let after = views::movie_frames(prepared, &discovery.after.inference, data);
    Some(movie.with_residuals(["residual before", "residual after"], after))
}

/// The correlation functions of the residual.
fn correlations(discovery: &Discovery) -> Vec<CorrelationFunction> {
    type Part = fn(&Bin) -> Measured;
    let points = |diagnostics: &Diagnostics, part: Part| -> Vec<CorrelationPoint> {
        let bins = diagnostics.correlations.bins.iter();
        bins.map(|bin| {
            let Measured { value, standard_error } = part(bin);
            CorrelationPoint { distance: bin.distance, value, standard_error }
        })
        .collect()
    };
    let parts: [(Correlation, Part); 3] = [
        (Correlation::Longitudinal, |bin| bin.longitudinal),
        (Correlation::Transverse, |bin| bin.transverse),
        (Correlation::Chiral, |bin| bin.chiral),
    ];
    if discovery.before.diagnostics.correlations.bins.is_empty() {
        return Vec::new();
    }
    let after = |part: Part| match discovery.selected.is_empty() {
        true => Vec::new(),
        false => points(&discovery.after.diagnostics, part),
    };
    parts
        .map(|(correlation, part)| CorrelationFunction {
            correlation,
            points: BeforeAfter { before: points(&discovery.before.diagnostics, part), after: after(part) },
        })
        .into()
}

/// What an effect predicts beyond the other terms, and what they leave.
fn regression(selected: &Selected, prepared: &Problem) -> PartialRegression {
    let velocity = |v: Vector<f64>| [v.x, v.y].map(|part| part * prepared.scale.velocity());
    let (mut product, mut square) = (0.0, 0.0);
    for [predicted, residual] in &selected.partial {
        product += predicted.dot(residual);
        square += predicted.norm_squared();
    }
    let slope = product / square;
    let scatter: f64 = selected
        .partial
        .iter()
        .map(|[predicted, residual]| (residual - slope * predicted).norm_squared())
        .sum();
    let freedom = (2.0 * selected.partial.len() as f64 - 1.0).max(1.0);
    let half = 1.96 * (scatter / freedom / square).sqrt();
    PartialRegression {
        effect: selected.effect.id.into(),
        points: selected
            .partial
            .iter()
            .map(|[predicted, residual]| PartialPoint {
                predicted: velocity(*predicted),
                residual: velocity(*residual),
            })
            .collect(),
        slope,
        slope_ci95: half.is_finite().then_some([slope - half, slope + half]),
    }
}

/// Suspicious cells of one frame; none where velocities are on a grid.
fn outliers(prepared: &Problem, diagnostics: &Diagnostics, index: usize) -> Vec<Outlier> {
    if prepared.velocities.flow().is_some() {
        return Vec::new();
    }
    let cells: Vec<usize> = prepared.observations[index].targets().map(|(cell, _)| cell).collect();
    let mut found: Vec<Outlier> = Vec::new();
    for outlier in diagnostics.outliers.iter().filter(|outlier| outlier.frame == index) {
        let (suspicion, residuals) = match outlier.cause {
            Cause::Merged => (Suspicion::Merged, vec![outlier.index]),
            Cause::Split { with } => (Suspicion::Split, vec![outlier.index, with]),
            Cause::MisTracked => (Suspicion::MisTracked, vec![outlier.index]),
            Cause::Unknown => continue,
        };
        for cell in residuals.into_iter().filter_map(|residual| cells.get(residual).copied()) {
            if !found.iter().any(|known| known.cell == cell) {
                found.push(Outlier { cell, suspicion });
            }
        }
    }
    found
}
