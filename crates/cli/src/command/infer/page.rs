//! The result of `infer` as a page with figures.

use super::Arguments;
use super::answers;
use super::questions::Answers;
use crate::command::fit::units::symbol;
use crate::command::fit::{spreads, views};
use crate::failure::Failure;
use crate::problem::{Measured, Problem};
use voronudge_geometry::Domain;
use voronudge_infer::{FitParameter, Inference};
use voronudge_io::{DataSet, Difference};
use voronudge_report::figure::FlowMap;
use voronudge_report::infer_report::{InferReport, MeanRemoved};
use voronudge_report::movie::CellMovie;
use voronudge_report::numbers::{as_given, significant};
use voronudge_report::page::Page;
use voronudge_report::{FrameView, InferPage};

pub(super) fn page(
    arguments: &Arguments,
    data: &DataSet,
    (prepared, result): (&Problem, &Inference),
    report: &InferReport,
    answers: &Answers,
    movie: Option<&CellMovie>,
) -> Result<Page, Failure> {
    let drawn = views::drawn(prepared);
    let frames: Vec<FrameView> =
        drawn.iter().map(|&index| views::frame_view(prepared, result, index)).collect();
    let flows: Vec<FlowMap<'_>> = drawn
        .iter()
        .zip(&frames)
        .filter_map(|(&index, frame)| views::flow_map(prepared, result, index, frame))
        .collect();
    let page = InferPage {
        title: &arguments.snapshots.title(),
        summary: &paragraphs(data, prepared, report),
        report,
        frames: &frames,
        movie,
        flows: &flows,
        spreads: &spreads::views(prepared, result, &drawn),
        uncertainty: &answers::figures(answers, result, &prepared.scale, &report.units),
    };
    Ok(page.page()?)
}

fn paragraphs(data: &DataSet, prepared: &Problem, report: &InferReport) -> Vec<String> {
    let source = match &prepared.velocities {
        Measured::Given(_) => "Velocities were given".to_owned(),
        Measured::Tracks(_) => format!(
            "No velocities were given: the tracks of the cells, {} {} from frame to frame, were fitted themselves, and the velocities \
             shown are means up to the next frame",
            significant(data.frame_interval, 4),
            data.time_unit
        ),
        Measured::Flow(_) => "Velocities were measured on a grid, and stand for averages over cells".into(),
        Measured::Derived(_, difference) => format!(
            "Velocities are {} differences of tracked positions, {} {} apart",
            match difference {
                Difference::Central => "central",
                Difference::Forward => "forward",
                Difference::Backward => "backward",
            },
            significant(data.frame_interval, 4),
            data.time_unit
        ),
    };
    let mean = match report.nmse.mean_removed {
        MeanRemoved::None => "no mean was removed",
        _ => "the median velocity of each frame was removed, because drift of the stage shows as one",
    };
    let boundary = match prepared.observations.first().map(|o| o.tessellation.domain()) {
        Some(Domain::Periodic(_)) => "The box is periodic.",
        _ => {
            "The field of view is open: only cells count whose polygon and whose neighbours' polygons no cell outside it could \
             change, and that are not at a hole."
        }
    };
    let mut paragraphs = vec![format!("{source}; {mean}. {boundary}")];
    if let Some(degree) = report.nmse.background {
        paragraphs.push(format!(
            "A smooth background, polynomials of the position up to degree {degree} in each frame, is no concern of the model: \
             errors are shares of what is left of the velocities without it."
        ));
    }
    paragraphs.extend(beforehand(report));
    if prepared.velocities.derived().is_some() {
        paragraphs.push(
            "Differences of positions average out what is faster than the interval. This biases K_A and K_P first, and the \
             intervals below do not contain it: compare with frames that are closer in time, where there are any."
                .into(),
        );
    }
    paragraphs
}

/// What the constraints were, in a sentence, if there were bounds or priors.
fn beforehand(report: &InferReport) -> Option<String> {
    let printed = |name: &str| FitParameter::from_name(name).map_or("", symbol);
    let bounds =
        report.constraints.bounds.iter().map(|(name, [low, high])| match (printed(name), low, high) {
            (name, low, high) if high.is_infinite() => format!("{name} at least {}", as_given(*low)),
            (name, low, high) if low.is_infinite() => format!("{name} at most {}", as_given(*high)),
            (name, low, high) => format!("{name} between {} and {}", as_given(*low), as_given(*high)),
        });
    let priors = report.constraints.priors.iter().map(|(name, prior)| {
        let name = printed(name);
        format!("{name} {} ± {}", as_given(prior.mean), as_given(prior.standard_deviation))
    });
    let all: Vec<String> = bounds.chain(priors).collect();
    (!all.is_empty()).then(|| format!("Known beforehand: {}.", all.join("; ")))
}
