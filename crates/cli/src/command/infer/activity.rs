//! Cells that crawl: what a fit says of their polarity.

use crate::command::fit::outcome;
use crate::failure::Failure;
use crate::problem::{Problem, Tracks};
use voronudge_infer::{Drive, FitParameter, Inference, Polarity, Tracked};
use voronudge_io::DataSet;
use voronudge_report::infer_report::{ActivityReport, Parameter};

/// Frames below which nothing goes on.
const FEWEST_FRAMES: usize = 3;

/// Refuses data in which no polarity could show.
pub(super) fn check(movie: Option<&Tracks>) -> Result<(), Failure> {
    let problem = match movie.map(|tracks| tracks.movie.frames()) {
        None => "--active is for tracks, and velocities are given or derived".to_owned(),
        Some(frames) if frames < FEWEST_FRAMES => {
            format!("--active takes tracks of three frames or more, and there are {frames} frames")
        }
        Some(_) => return Ok(()),
    };
    let hint =
        "a polarity shows in motions that go on: give positions of three frames or more, without velocities";
    Err(Failure::new(problem).with_hint(hint))
}

/// What to mind of a K_P that was fitted where a polarity shows.
pub(super) fn caution(result: &Inference, tracked: &Tracked) -> Option<&'static str> {
    let shows = tracked.polarity.as_ref()?.rate_interval.is_some();
    let fitted = result.parameters.get(FitParameter::PerimeterElasticity).standard_error > 0.0;
    (shows && fitted).then_some(
        "K_P of cells that crawl comes out too small, and alpha too large: by some 5 to 10 % in tissues that flow, by a quarter \
         to a half in solid ones, beyond the interval. Quote K_P_alpha, P_0 and v_0, which suffer less",
    )
}

/// The polarity of the cells, in the units of the data.
pub(super) fn report(data: &DataSet, prepared: &Problem, tracked: &Tracked) -> Option<ActivityReport> {
    let Polarity { speed, speed_interval, rate, rate_interval, correlation, alignment, .. } =
        tracked.polarity.as_ref()?;
    let [inhibited, along] =
        tracked.polarity.as_ref().map_or([None; 2], |own| [own.contact_inhibition, own.velocity_alignment]);
    let (units, scale) = (outcome::units(data), &prepared.scale);
    let parameter = |value: f64, ends: Option<[f64; 2]>, factor: f64, unit: String, words: &str| Parameter {
        value: value * factor,
        ci95: ends.map(|ends| ends.map(|end| end * factor)),
        fixed: false,
        unit,
        words: words.into(),
    };
    Some(ActivityReport {
        v_0: parameter(
            *speed,
            Some(*speed_interval),
            scale.velocity(),
            units.powers(1, -1),
            "v_0 is the root mean square of the velocities that the cells have of themselves",
        ),
        D_r: parameter(
            *rate,
            *rate_interval,
            1.0 / scale.time,
            units.powers(0, -1),
            "D_r is the rate at which cells forget the direction of their polarity",
        ),
        J: alignment.map(|own| {
            parameter(
                own.rate,
                // Without a polarity nothing aligns.
                rate_interval.map(|_| own.interval),
                1.0 / scale.time,
                units.powers(0, -1),
                "J is the rate at which a cell takes on the mean polarity of its neighbours",
            )
        }),
        evidence_of_alignment: alignment.map(|own| own.evidence),
        b: inhibited.map(|Drive { value, interval, .. }| {
            parameter(
                value,
                rate_interval.map(|_| interval),
                scale.velocity() / scale.time,
                units.powers(1, -2),
                "b is how fast the polarity of a cell turns away from its contacts",
            )
        }),
        evidence_of_contact_inhibition: inhibited.map(|own| own.evidence),
        kappa: along.map(|Drive { value, interval, .. }| {
            parameter(
                value,
                rate_interval.map(|_| interval),
                1.0 / scale.time,
                units.powers(0, -1),
                "kappa is the rate at which the polarity of a cell turns towards the velocity that the forces give it",
            )
        }),
        evidence_of_velocity_alignment: along.map(|own| own.evidence),
        correlation: *correlation,
    })
}
