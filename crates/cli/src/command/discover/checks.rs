//! Whether movies that the models make are like the measured one.

use super::Asked;
use super::forecasts::Coming;
use super::material::Searched;
use super::onward::{self, Rivals};
use super::sentences::probability;
use crate::command::fit::{Measured, Prepared};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::run::Run;
use clap::Args;
use voronudge_infer::Error;
use voronudge_infer::forecast::{Ahead, Check, Checked, Expected, check};
use voronudge_io::{DataSet, Difference};
use voronudge_observables::Dimensions;
use voronudge_report::Units;
use voronudge_report::discover_report::{ByModel, CheckReport, CheckedQuantity, Simulated};
use voronudge_report::figure::{Trails, trails};
use voronudge_report::page::Figure;

/// Below this share a model does not make such cells.
const REJECTED: f64 = 0.01;

/// How many quantities are named in the sentence.
const NAMED: usize = 3;

#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub(super) struct CheckArguments {
    /// Let each model go on by itself for as long as the movie, so many times [without a number: 199], and compare how cells move, shapes, order and flow with those measured.
    #[arg(long, value_name = "DRAWS", num_args = 0..=1, default_missing_value = "199", value_parser = clap::value_parser!(u64).range(19..=9999), allow_negative_numbers = true)]
    check: Option<u64>,
}

impl CheckArguments {
    /// Refuses what no movie can be made of.
    pub fn possible(
        &self,
        asked: &super::Arguments,
        data: &DataSet,
        difference: Option<Difference>,
    ) -> Result<(), Failure> {
        if self.check.is_none() {
            return Ok(());
        }
        let file = asked.snapshots.data.positions_file();
        if Measured::of_tracks(&asked.snapshots, data, difference)?.flow().is_some() {
            let text = "--check: velocities are on a grid, and no cells are followed";
            return Err(Failure::new(text).with_hint("give tracked cells").at(file.display()));
        }
        if data.frames() < 4 {
            let count = data.frames();
            let frames = if count == 1 { "frame" } else { "frames" };
            let text =
                format!("--check: {count} {frames}, but a comparison with simulations takes four at least");
            return Err(Failure::new(text).with_hint("give a longer movie").at(file.display()));
        }
        Ok(())
    }

    /// Simulated movies of the models of a search against the measured one; none, with a warning, if there is nothing to be compared.
    pub fn compare(
        &self,
        asked: &Asked<'_>,
        (data, units): (&DataSet, &Units),
        (searched, coming): (&Searched, Option<&Coming>),
        run: &mut Run,
        progress: &mut Progress,
    ) -> Result<Option<Compared>, Failure> {
        let Some(draws) = self.check else { return Ok(None) };
        let prepared = &searched.material.prepared;
        let frames = coming.map_or_else(|| prepared.frames.clone(), |coming| coming.frames(prepared, data));
        if frames.len() < 4 {
            run.warn("there is no comparison with simulations: it takes four frames at least");
            return Ok(None);
        }
        let movie = onward::movie(asked, data, prepared, frames.clone(), run)?;
        let rivals = Rivals::new(searched, &movie, run);
        let ahead = Ahead {
            movie: &movie,
            first: 1,
            horizon: 1,
            noise: searched.discovery.after.inference.noise,
            draws: draws as usize,
            seed: searched.search.fit.seed,
        };
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        match check(&ahead, &rivals.models(), &mut observe) {
            Ok(found) => Ok(Some(Compared::new(&found, &frames, (prepared, units)))),
            Err(Error::Interrupted) => Err(prepared.place(Error::Interrupted, &asked.arguments.snapshots)),
            Err(error) => {
                run.warn(format!("there is no comparison with simulations: {error}"));
                Ok(None)
            }
        }
    }
}

/// What came of it.
pub(super) struct Compared {
    pub report: CheckReport,
    /// Where cells went, measured and simulated.
    pub trails: Figure,
}

impl Compared {
    fn new(found: &Check, frames: &[usize], (prepared, units): (&Prepared, &Units)) -> Self {
        let p = by_model(&found.p, |p| *p);
        let quantities: Vec<CheckedQuantity> =
            found.quantities.iter().map(|own| quantity(own, (prepared, units))).collect();
        let report = CheckReport {
            words: words(&p, &quantities),
            frames: frames[found.first..].to_vec(),
            draws: found.draws,
            p,
            quantities,
        };
        Self { report, trails: ways(found, (prepared, units)) }
    }
}

fn by_model<T, R>(all: &[T], of: impl Fn(&T) -> R) -> ByModel<R> {
    ByModel { base: of(&all[0]), extended: all.get(1).map(of) }
}

/// One quantity in the units of the data.
fn quantity(own: &Checked, (prepared, units): (&Prepared, &Units)) -> CheckedQuantity {
    let scale = prepared.scale;
    let of = own.measured.of;
    let times = |all: &[f64], dimensions: Dimensions| -> Vec<f64> {
        let factor = dimensions.factor(scale.length, scale.time);
        all.iter().map(|value| value * factor).collect()
    };
    let unit = |dimensions: Dimensions| units.powers(dimensions.length, dimensions.time);
    let (axis, of_axis) = of.axis().unwrap_or(("", Dimensions { length: 0, time: 0 }));
    let simulated = |model: &Expected| {
        let [low, median, high] = [0, 1, 2].map(|k| times(&model.quantiles[k], of.dimensions()));
        Simulated { p: model.p, low, median, high }
    };
    CheckedQuantity {
        name: of.name(),
        words: of.words(),
        axis,
        axis_unit: unit(of_axis),
        unit: unit(of.dimensions()),
        at: times(&own.measured.at, of_axis),
        measured: times(&own.measured.value, of.dimensions()),
        simulated: by_model(&own.models, simulated),
    }
}

/// What the comparison comes to.
fn words(p: &ByModel<f64>, quantities: &[CheckedQuantity]) -> String {
    let told = |name: &str, p: f64, of: &dyn Fn(&CheckedQuantity) -> f64| {
        if p > REJECTED {
            return format!(
                "Movies that {name} makes are like the measured one in all that was compared (p {}).",
                probability(p)
            );
        }
        let mut unusual: Vec<&CheckedQuantity> =
            quantities.iter().filter(|own| of(own) <= REJECTED).collect();
        unusual.sort_by(|a, b| of(a).total_cmp(&of(b)));
        let names: Vec<&str> = unusual.iter().take(NAMED).map(|own| own.words).collect();
        let more = unusual.len().saturating_sub(NAMED);
        let others = if more > 0 { format!(" and {more} more") } else { String::new() };
        let where_ = if names.is_empty() { String::new() } else { format!(": {}{others}", names.join(", ")) };
        format!("{name} does not make such cells (p {}){where_}.", probability(p))
    };
    let base = told("the base model", p.base, &|own| own.simulated.base.p);
    let extended = p.extended.map(|p| {
        told("the model with effects", p, &|own| own.simulated.extended.as_ref().map_or(1.0, |own| own.p))
    });
    let sentences: Vec<String> = std::iter::once(base).chain(extended).map(|text| capital(&text)).collect();
    sentences.join(" ")
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The ways of the cells, measured and in one movie of each model.
fn ways(found: &Check, (prepared, units): (&Prepared, &Units)) -> Figure {
    let length = prepared.scale.length;
    let of_movie = |places: &Vec<Vec<Option<voronudge_geometry::Vector<f64>>>>| -> Vec<Vec<[f64; 2]>> {
        let tracks = places.first().map_or(0, Vec::len);
        let way = |track: usize| {
            places.iter().filter_map(|frame| frame[track].map(|r| [r.x * length, r.y * length])).collect()
        };
        (0..tracks).map(way).filter(|way: &Vec<[f64; 2]>| way.len() > 1).collect()
    };
    let all: Vec<Vec<Vec<[f64; 2]>>> = found.places.iter().map(of_movie).collect();
    let labels = ["measured", "base model", "with effects"];
    let panels: Vec<Trails<'_>> =
        labels.iter().zip(&all).map(|(label, ways)| Trails { label, ways }).collect();
    Figure::new(
        trails("ways of the cells", &panels, &units.length),
        "Ways of the cells from the first frame compared to the last, as measured and in one simulated movie of each model; a dot where each ends.",
    )
}
