//! A run as files and a summary.

use super::measurements::{Measurements, Spectra};
use super::movie::movie;
use super::page::{cell_box, page};
use super::recorder::Recorder;
use super::report::{Displacement, Exponent, Report, Request, Spread, Structure};
use super::sensitivity::Differentiated;
use super::surroundings::describe;
use crate::arguments::MovieArguments;
use crate::command::drawing::units_of_model;
use crate::failure::Failure;
use crate::reporting::Rendered;
use crate::run::Run;
use ndarray::{Array1, Array3, ArrayView1};
use std::path::Path;
use voronudge_geometry::{PeriodicBox, areas};
use voronudge_io::{Boundary, DataSet, NO_LABEL, OutputDirectory};
use voronudge_model::{CellParameter, stress};
use voronudge_observables::{hexatic_among, shape_indices};
use voronudge_report::Units;
use voronudge_simulate::{Schedule, Simulation, Summary};

/// A run at its end.
pub(super) struct Finished<'a> {
    pub simulation: &'a Simulation,
    pub schedule: Schedule,
    pub summary: Summary,
    pub lyapunov: Option<Exponent>,
    pub differentiated: Option<Differentiated>,
    pub steps_per_second: f64,
}

/// Measures what the frames tell and writes all results.
pub(super) fn finish(
    run: &mut Run,
    mut recorder: Recorder,
    (request, start, units): (Request, PeriodicBox, Units),
    finished: Finished<'_>,
    asked: MovieArguments,
) -> Result<Rendered<Report>, Failure> {
    let Finished { simulation, schedule, summary, lyapunov, differentiated, steps_per_second } = finished;
    if summary.mean_square_velocity.is_some_and(|square| !square.is_finite()) {
        return Err(Failure::new("the squares of the velocities are too large to be numbers")
            .with_hint("give parameters in units in which lengths and times of cells are about 1"));
    }
    let spectra = match request.driving.shear {
        None => Spectra::OfManyFrames,
        Some(_) => Spectra::OfTheEnd,
    };
    let measurements =
        Measurements::new(&mut recorder, &schedule, (&cell_box(simulation, &request)?, spectra))?;
    let [width, height] = request.box_lengths;
    let cell_size = (width * height / request.cells as f64).sqrt();
    let shown = units_of_model(&units, cell_size, request.parameters.K_P);
    let movie = movie(&mut recorder, (&request, start), schedule.frame_interval(), &shown)?;
    let mut results = recorder.results()?;
    asked.write(&mut results, movie.as_ref(), run)?;
    let mut settings = settings(simulation, &request, &schedule, &units);
    describe(&mut settings, &request, start, schedule.frame_interval())?;
    settings.save_settings(&mut results)?;
    write_cells(&mut results, &request)?;
    measurements.write(&mut results)?;
    if let Some(own) = &differentiated {
        own.write(&mut results)?;
    }
    let (tessellation, positions) = (simulation.tessellation(), simulation.positions_with_images());
    let cells = request.cells;
    let hexatic = hexatic_among(tessellation, positions, |cell| cell < cells);
    let farthest = measurements.displacements.last();
    let report = Report {
        run: run.record(None),
        request,
        mean_square_velocity: summary.mean_square_velocity,
        mean_square_velocity_error: summary.mean_square_velocity_error,
        t1_rate: summary.transition_rate,
        hexatic_order: hexatic.order(),
        hexatic_mean_modulus: hexatic.mean_modulus,
        stress: stress(tessellation, positions, simulation.model(), |cell| cell < cells),
        area: Spread::of(&areas(tessellation, positions)[..cells]),
        shape_index: Spread::of(&shape_indices(tessellation, positions)[..cells]),
        displacement: Displacement {
            frames: measurements.displacement_frames,
            longest_lag: farthest.map(|row| row[0]),
            mean_square: farthest.map(|row| row[1]),
        },
        structure: Structure {
            frames: measurements.structure_frames,
            largest_wave_number: measurements.structure.last().map(|shell| shell.wave_number),
            peak: measurements.peak(),
        },
        lyapunov,
        sensitivity: differentiated.as_ref().map_or_else(Vec::new, Differentiated::in_short),
        steps: summary.steps,
        steps_per_second,
    };
    let page = page(&report, &measurements, (simulation, differentiated.as_ref(), movie.as_ref()), &shown)?;
    let error = |error: Option<f64>| error.map_or(String::new(), |error| format!(" ± {error:.1e}"));
    let mut text = format!(
        "{} cells, {} steps, {:.0} steps per second\nmean square velocity over the second half: {}{}\n",
        cells,
        report.steps,
        report.steps_per_second,
        report.mean_square_velocity.map_or("none".into(), |v| format!("{v:.4e}")),
        error(report.mean_square_velocity_error),
    );
    if let Some(exponent) = &report.lyapunov {
        text +=
            &format!("largest Lyapunov exponent: {:.3e}{}\n", exponent.value, error(exponent.standard_error));
    }
    for own in &report.sensitivity {
        text += &format!(
            "derivatives of positions by {}: {:.3e} (root mean square) at the end; {}\n",
            own.by,
            own.root_mean_square,
            own.agreement(report.request.time)
        );
    }
    text += &format!("written to {}, figures in report.html\n", results.path().display());
    Rendered::with_page(results, &report, page, text)
}

/// Writes the labels of the cells and the parameters in which they differ; those of an earlier run go.
fn write_cells(results: &mut OutputDirectory, request: &Request) -> Result<(), Failure> {
    match &request.labels {
        Some(labels) => {
            let labels: Array1<i64> = labels.iter().map(|label| label.unwrap_or(NO_LABEL)).collect();
            results.write_integers("labels.npy", labels.view())?;
        }
        None => results.withdraw("labels.npy")?,
    }
    for parameter in CellParameter::ALL {
        let name = format!("cell_{}.npy", parameter.name());
        match request.of_cells.0.get(parameter.name()) {
            Some(own) => results.write_array(&name, ArrayView1::from(own))?,
            None => results.withdraw(&name)?,
        }
    }
    Ok(())
}

/// Name of the folder with the frames of a run that failed.
const PARTIAL: &str = "partial";

/// Keeps the frames of a run that cannot come to its end as a data set of their own, and says so.
pub(super) fn keep_partial(
    mut recorder: Recorder,
    (request, start, units): (Request, PeriodicBox, Units),
    (simulation, schedule): (&Simulation, &Schedule),
    (out, failure): (&Path, Failure),
) -> Result<Failure, Failure> {
    let frames = recorder.frames();
    if frames == 0 {
        recorder.discard()?;
        return Ok(failure);
    }
    let place = out.join(PARTIAL);
    let mut results = OutputDirectory::create(&place)?;
    recorder.write_so_far(&mut results)?;
    write_cells(&mut results, &request)?;
    let mut settings = settings(simulation, &request, schedule, &units);
    let interval = schedule.frame_interval();
    describe(&mut settings, &Request { frames, ..request }, start, interval)?;
    settings.save_settings(&mut results)?;
    results.commit()?;
    recorder.discard()?;
    let place = place.display();
    let hint = match failure.hint() {
        Some(hint) => format!("{hint}; --start {place} goes on from the last of these frames"),
        None => format!("--start {place} goes on from the last of these frames"),
    };
    Ok(Failure::new(format!("{}; the {frames} frames before that are kept in {place}", failure.message()))
        .with_hint(hint))
}

/// The data set without its frames, which are written as the run goes on.
fn settings(simulation: &Simulation, request: &Request, schedule: &Schedule, units: &Units) -> DataSet {
    let cells = simulation.positions().len();
    let positions =
        Array3::from_shape_fn((1, cells, 2), |(_, cell, axis)| simulation.positions()[cell][axis]);
    DataSet {
        frame_interval: schedule.frame_interval(),
        length_unit: units.length.clone(),
        time_unit: units.time.clone(),
        unwrapped: true,
        ..DataSet::new(positions, Boundary::Periodic { lengths: request.box_lengths })
    }
}
