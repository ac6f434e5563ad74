//! The result as a report.

use super::avalanches::Found;
use super::nematic::Measured;
use crate::command::recorded::Recorded;
use voronudge_observables::{Curve, Dimensions, Plan};
use voronudge_report::Units;
use voronudge_report::infer_report::{Quantity, RunRecord};
use voronudge_report::observe_report::{ObserveReport, ObservedCurve, ObservedNumber};

pub(super) fn report(
    run: RunRecord,
    units: &Units,
    frames: &[usize],
    (recorded, plan): (&Recorded, &Plan),
    (curves, nematic, avalanches): (&[Curve], &Measured, Option<&Found>),
) -> ObserveReport {
    let unit = |of: Dimensions| units.powers(of.length, of.time);
    let number = |curve: &Curve| ObservedNumber {
        value: curve.value[0],
        standard_error: curve.standard_error[0],
        unit: unit(curve.of.dimensions()),
        count: curve.count[0],
    };
    let function = |curve: &Curve| {
        let (axis, of_axis) = curve.of.axis()?;
        Some(ObservedCurve {
            axis,
            axis_unit: unit(of_axis),
            unit: unit(curve.of.dimensions()),
            at: curve.at.clone(),
            value: curve.value.clone(),
            standard_error: curve.standard_error.clone(),
            count: curve.count.clone(),
        })
    };
    let all = recorded.recording.frames();
    ObserveReport {
        run,
        units: units.clone(),
        frames: frames.to_vec(),
        seen: all.iter().map(|frame| frame.tracks.len()).collect(),
        counted: all.iter().map(|frame| frame.in_view().count()).collect(),
        length_scale: Quantity { value: plan.spacing(), unit: units.length.clone() },
        velocities: recorded.velocities.name(),
        common_motion_removed: recorded.common_motion_removed,
        nematic: nematic.record(units),
        avalanches: avalanches.map(|found| found.record(units)),
        numbers: curves
            .iter()
            .filter(|curve| curve.of.is_number())
            .map(|curve| (curve.of.name(), number(curve)))
            .collect(),
        curves: curves.iter().filter_map(|curve| Some((curve.of.name(), function(curve)?))).collect(),
    }
}
