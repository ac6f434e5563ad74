//! How cells were measured: what a report says of it.

use crate::problem::Problem;
use crate::run::Run;
use voronudge_infer::{Determined, FitParameter, Measurement};
use voronudge_report::infer_report::{self as told, MeasurementSource, PositionKind};
use voronudge_report::numbers::significant;

/// A rise of −2 log likelihood that one unknown exceeds by chance in 5 % of cases.
const NOTABLE: f64 = 3.84;

/// Says where what was found needs a word of caution.
pub(crate) fn caution(prepared: &Problem, run: &mut Run) {
    let Measurement { rivals, width, .. } = &prepared.measurement;
    let Some((best, others)) = rivals.split_first() else { return };
    for other in others.iter().filter(|other| other.rise < NOTABLE) {
        let off = (other.chiral_coefficient / best.chiral_coefficient - 1.0).abs();
        run.warn(format!(
                "the data do not tell whether windows are {} or {}; K_P alpha differs by {} % between the two: declare window in \
                 dataset.toml if it is known",
                super::flow::name(best.window.kind),
                super::flow::name(other.window.kind),
                significant(100.0 * off, 2)
            ));
    }
    if let Some(Determined { value, interval: Some([low, high]) }) = width
        && high - low > *value
    {
        run.warn(
                "the width of the windows is hardly determined by the data; declare window_width in dataset.toml if it is known",
            );
    }
}
/// What the report says of the positions.
pub(super) fn positions(prepared: &Problem) -> told::MeasuredPositions {
    let share = prepared.measurement.share;
    told::MeasuredPositions {
        are: match share.value {
            0.0 => PositionKind::Sites,
            1.0 => PositionKind::Centroids,
            _ => PositionKind::Between,
        },
        share: share.value,
        ci95: share.interval,
        source: match (prepared.known.share, share.interval) {
            (Some(_), _) => MeasurementSource::Declared,
            (None, Some(_)) => MeasurementSource::Estimated,
            (None, None) => MeasurementSource::Assumed,
        },
        own_errors: prepared.own_errors.is_some(),
    }
}

/// What the report says of the windows of a flow field.
pub(super) fn window(prepared: &Problem) -> Option<told::MeasuredWindow> {
    let Measurement { rivals, width, .. } = &prepared.measurement;
    let (length, grid) = (prepared.scale.length, super::flow::described(prepared.velocities.flow()?));
    let rate = prepared.scale.factor(FitParameter::ChiralCoefficient);
    let tried = rivals.iter().map(|rival| told::TriedWindow {
        kind: super::flow::told(rival.window.kind),
        width: rival.window.width * length,
        rise: rival.rise,
        chiral_coefficient: rival.chiral_coefficient * rate,
    });
    Some(told::MeasuredWindow {
        kind: grid.window,
        width: grid.width,
        ci95: width.and_then(|width| width.interval).map(|ends| ends.map(|end| end * length)),
        declared: prepared.known.kind.is_some() && prepared.known.width.is_some(),
        tried: tried.collect(),
    })
}
