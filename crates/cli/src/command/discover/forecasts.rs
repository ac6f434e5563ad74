//! What the cells do next, said before and compared with what they did.

use super::Asked;
use super::material::Searched;
use super::onward::{self, Rivals};
use crate::command::fit::measured::{frames, measured};
use crate::command::fit::{SnapshotArguments, with_location};
use crate::failure::Failure;
use crate::problem::{Measured, Problem};
use crate::progress::Progress;
use crate::run::Run;
use clap::Args;
use voronudge_infer::Error;
use voronudge_infer::forecast::{Ahead, Forecast, Forecasts, Skill, WithError, forecast};
use voronudge_io::{DataSet, Difference, FrameSelection};
use voronudge_report::Units;
use voronudge_report::discover_report::{ForecastReport, Forecasters, Gain};
use voronudge_report::infer_report::Quantity;
use voronudge_report::numbers::significant;

/// Runs with noise.
const DRAWS: usize = 8;

/// Frames that a fit takes at least, where some are left to be forecast, and of tracks at most.
const FEWEST_FITTED: usize = 3;
const MOST_FITTED: usize = 6;

#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub(super) struct ForecastArguments {
    /// Forecast the cells up to H frames ahead (1 to 100), from frames that no fit has seen, and compare with what
    /// they did. Unless --frames says otherwise, only the first half of the frames is then fitted, of tracks at most
    /// 6 frames.
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u64).range(1..=100), allow_negative_numbers = true)]
    forecast: Option<u64>,
}

/// What is to be forecast.
pub(super) struct Coming {
    /// Frames ahead that were asked for, and that there are.
    asked: usize,
    horizon: usize,
    /// First frame of the data that no fit sees.
    first: usize,
}

impl ForecastArguments {
    /// Leaves frames out of the fit, if forecasts are asked for.
    pub fn leave(
        &self,
        snapshots: &mut SnapshotArguments,
        data: &DataSet,
        difference: Option<Difference>,
    ) -> Result<Option<Coming>, Failure> {
        let Some(horizon) = self.forecast else { return Ok(None) };
        let file = snapshots.data.positions_file();
        let refused = |what: String, hint: &str| {
            Failure::new(format!("--forecast: {what}")).with_hint(hint).at(file.display())
        };
        let measured = measured(snapshots, data, difference)?;
        if measured.flow().is_some() {
            return Err(refused(
                "velocities are on a grid, and no cells are followed".into(),
                "give tracked cells",
            ));
        }
        let all = frames(&measured, snapshots, data)?;
        if snapshots.frames.is_none() {
            let most = if matches!(measured, Measured::Tracks(_)) { MOST_FITTED } else { all.len() };
            let fitted = all.len().div_ceil(2).min(most).max(FEWEST_FITTED).min(all.len());
            let list: Vec<String> = all[..fitted].iter().map(ToString::to_string).collect();
            snapshots.frames = Some(list.join(",").parse::<FrameSelection>()?);
        }
        let last = frames(&measured, snapshots, data)?.last().copied().unwrap_or(0);
        // A central difference has seen the frame after.
        let first = last + if difference == Some(Difference::Central) { 2 } else { 1 };
        if first + 1 >= data.frames() {
            let hint = "give fewer frames to the fit with --frames, or a longer movie";
            let left = data.frames().saturating_sub(first);
            let found = format!(
                "{left} of the frames come after those of the fit, but a forecast takes two: one to start from, and one to be told"
            );
            return Err(refused(found, hint));
        }
        let asked = horizon as usize;
        Ok(Some(Coming { asked, horizon: asked.min(data.frames() - 1 - first), first }))
    }
}

impl Coming {
    /// Forecasts by the models of a search; none, with a warning, if there is nothing to be forecast.
    pub fn forecast(
        &self,
        asked: &Asked<'_>,
        (data, units): (&DataSet, &Units),
        searched: &Searched,
        run: &mut Run,
        progress: &mut Progress,
    ) -> Result<Option<ForecastReport>, Failure> {
        let prepared = &searched.prepared;
        if self.horizon < self.asked {
            run.warn(format!(
                "of {} frames ahead {} can be told: the movie ends there",
                self.asked, self.horizon
            ));
        }
        let frames = self.frames(prepared, data);
        let Some(first) = frames.iter().position(|frame| *frame >= self.first) else { return Ok(None) };
        let movie = onward::movie(asked, data, prepared, frames.clone(), run)?;
        let rivals = Rivals::new(searched, &movie, run);
        let ahead = Ahead {
            movie: &movie,
            first,
            horizon: self.horizon,
            noise: searched.discovery.after.inference.noise,
            draws: DRAWS,
            seed: searched.search.fit.seed,
        };
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        match forecast(&ahead, &rivals.models(), &mut observe) {
            Ok(found) => Ok(Some(self.report(&found, rivals.count(), &frames, (data, prepared, units)))),
            Err(Error::Interrupted) => {
                Err(with_location(prepared, Error::Interrupted, &asked.arguments.snapshots))
            }
            Err(error) => {
                run.warn(format!("there is no forecast: {error}"));
                Ok(None)
            }
        }
    }

    /// From the first frame of the fit to the last of all.
    pub fn frames(&self, prepared: &Problem, data: &DataSet) -> Vec<usize> {
        let fitted = prepared.frames.iter().copied().filter(|frame| *frame < self.first);
        fitted.chain(self.first..data.frames()).collect()
    }

    fn report(
        &self,
        found: &Forecasts,
        models: usize,
        frames: &[usize],
        (data, prepared, units): (&DataSet, &Problem, &Units),
    ) -> ForecastReport {
        let gains = |all: &[WithError]| -> Vec<Gain> { all.iter().copied().map(Gain::from).collect() };
        let lengths =
            |all: &[f64]| -> Vec<f64> { all.iter().map(|own| own * prepared.scale.length).collect() };
        let skill = by_name(found, models, |own| gains(&own.position));
        ForecastReport {
            words: words(&skill, found.gain.first().copied()),
            starts: found.starts.iter().map(|start| frames[*start]).collect(),
            horizons: (1..=self.horizon).collect(),
            interval: Quantity { value: data.frame_interval, unit: units.time.clone() },
            scored: found.scored.clone(),
            skill,
            velocity_skill: by_name(found, models, |own| gains(&own.velocity)),
            gain: (models > 1).then(|| gains(&found.gain)),
            best_possible: found.best_possible.clone(),
            error: by_name(found, models, |own| lengths(&own.error)),
            expected_error: by_name(found, models, |own| lengths(&own.expected_error)),
            unit: units.length.clone(),
        }
    }
}

/// What the forecasts of one frame come to.
fn words(skill: &Forecasters<Gain>, gain: Option<WithError>) -> String {
    let first =
        |all: &[Gain]| all.first().copied().map_or([f64::NAN; 2], |own| [own.value, own.standard_error]);
    let told = |[value, error]: [f64; 2]| match error.is_finite() {
        true => format!("{} ± {}", significant(value, 2), significant(error, 1)),
        false => significant(value, 2),
    };
    let (base, extended) = (first(&skill.base), skill.extended.as_deref().map(first));
    let models = match extended {
        Some(own) => {
            format!(
                "the model with effects has a skill of {}, the base model one of {}",
                told(own),
                told(base)
            )
        }
        None => format!("the model has a skill of {}", told(base)),
    };
    let last = extended.unwrap_or(base);
    let baselines = [
        ("a regression on earlier velocities", &skill.regression),
        ("to keep the velocity", &skill.constant_velocity),
    ];
    let known =
        baselines.map(|(name, own)| (name, first(own))).into_iter().filter(|(_, own)| own[0].is_finite());
    let best = known.max_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    let beside = best.map_or(String::new(), |(name, own)| {
        let verdict = match own[0] - last[0] {
            more if more > own[1].max(last[1]) => {
                ", which is better: something goes on from frame to frame that the model lacks"
            }
            less if less < -own[1].max(last[1]) => ", which is worse",
            _ => ", which is as good",
        };
        format!("; {name} has {}{verdict}", told(own))
    });
    let proven = match gain {
        Some([value, error]) if error.is_nan() || value <= 2.0 * error => {
            " The effects do not improve forecasts beyond chance."
        }
        _ => "",
    };
    format!("One frame ahead, from frames that no fit has seen, {models}{beside}.{proven}")
}

fn by_name<T>(found: &Forecasts, models: usize, of: impl Fn(&Skill) -> Vec<T>) -> Forecasters<T> {
    let own = |who: Forecast| found.skills.iter().find(|skill| skill.of == who).map(&of).unwrap_or_default();
    Forecasters {
        base: own(Forecast::Model(0)),
        extended: (models > 1).then(|| own(Forecast::Model(1))),
        no_motion: own(Forecast::NoMotion),
        constant_velocity: own(Forecast::ConstantVelocity),
        regression: own(Forecast::Regression),
    }
}
