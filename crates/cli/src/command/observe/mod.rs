//! `voronudge observe`: what can be measured on the cells of a data set, whatever moves them.

mod avalanches;
mod curves;
mod nematic;
mod page;
mod report;

use crate::arguments::CommonArguments;
use crate::command::recorded::{RecordingArguments, Velocities};
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use avalanches::AvalancheArguments;
use clap::Args;
use ndarray::Array2;
use nematic::NematicArguments;
use voronudge_io::DataSet;
use voronudge_observables::{Exchange, Plan, exchange_statistics, exchanges, observe};
use voronudge_report::Units;
use voronudge_report::observe_report::ObserveReport;

/// Measures the cells of a data set, observed or simulated: how they move, who is next to whom, shapes, order,
/// correlations and structure factors.
///
/// Fields of view may be open, and tracks may have gaps. Writes report.json, report.html and an array of shape
/// (points, 4) for each function.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recording: RecordingArguments,
    #[command(flatten)]
    nematic: NematicArguments,
    #[command(flatten)]
    avalanches: AvalancheArguments,
    #[command(flatten)]
    common: CommonArguments,
}

impl Reporting for Arguments {
    const NAME: &'static str = "observe";
    type Report = ObserveReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        self.recording.check()?;
        self.avalanches.check()?;
        let model = self.nematic.model()?;
        let data = self.recording.data.load()?;
        let place = self.recording.location();
        let frames = self.recording.frames(&data)?;
        let inputs = data.inputs.iter().map(AsRef::as_ref).chain(self.nematic.parameters_file());
        let out = self.common.reserve(inputs)?;
        let recorded = self.recording.record(&data, &frames)?;
        let plan = Plan::of(&recorded.recording).map_err(|error| Failure::from(error).at(&place))?;
        let all = exchanges(&recorded.recording);
        let avalanches = self.avalanches.measure(&recorded, (&plan, &all), model.as_ref(), self.common.seed);
        let nematic = self.nematic.measure(&recorded, &plan, model)?;
        let mut out = out.begin()?;
        if recorded.velocities == Velocities::None {
            run.warn("there are neither velocities nor several frames: nothing is said of motion");
        }
        let mut curves = observe(&recorded.recording, &plan);
        if frames.len() > 1 {
            out.write_array("t1.npy", rows(&all, &data, &frames).view())?;
            curves.extend(exchange_statistics(&recorded.recording, &plan, &all));
        }
        if let Some(found) = &avalanches {
            found.write(&mut out, &data, &frames)?;
            curves.extend(found.avalanches.curves.iter().cloned());
        }
        curves.extend(nematic.nematic.curves.iter().cloned());
        nematic.write(&mut out, &data, &frames)?;
        curves.sort_by_key(|curve| curve.of);
        for curve in curves.iter().filter(|curve| !curve.of.is_number()) {
            let table = Array2::from_shape_fn((curve.at.len(), 4), |(row, column)| match column {
                0 => curve.at[row],
                1 => curve.value[row],
                2 => curve.standard_error[row],
                _ => curve.count[row] as f64,
            });
            out.write_array(&format!("{}.npy", curve.of.name()), table.view())?;
        }
        let units = Units { length: data.length_unit.clone(), time: data.time_unit.clone() };
        let report = report::report(
            run.record(Some(&data)),
            &units,
            &frames,
            (&recorded, &plan),
            (&curves, &nematic, avalanches.as_ref()),
        );
        let title = self.recording.title();
        let page = page::page(
            &title,
            &report,
            &recorded.recording,
            (&curves, &nematic, avalanches.as_ref()),
            &units,
        );
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}

/// (transitions, 9): frame, x, y, directions of the contact lost and of the one made in the axes of the data, and the numbers of the cells of both.
fn rows(all: &[Exchange], data: &DataSet, frames: &[usize]) -> Array2<f64> {
    let flip = data.y_sign();
    Array2::from_shape_fn((all.len(), 9), |(row, column)| {
        let own = &all[row];
        match column {
            0 => frames[own.frame] as f64,
            1 => own.position.x,
            2 => flip * own.position.y,
            3 => flip * own.lost_direction,
            4 => flip * own.made_direction,
            5 | 6 => own.lost[column - 5] as f64,
            _ => own.made[column - 7] as f64,
        }
    })
}
