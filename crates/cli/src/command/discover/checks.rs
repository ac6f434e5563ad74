//! Whether movies that the models make are like the measured one.

use super::Asked;
use super::forecasts::Coming;
use super::material::Searched;
use super::onward::{self, Rivals};
use super::phrases::probability;
use crate::command::fit::measured::measured;
use crate::command::fit::with_location;
use crate::failure::Failure;
use crate::problem::Problem;
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

/// At most this share, and a model does not make such cells; up to the next it is in doubt.
const REJECTED: f64 = 0.01;
const DOUBTED: f64 = 0.05;

/// Movies from which on a share can be so small.
const FEWEST: usize = 99;

/// How many quantities are named in the sentence.
const NAMED: usize = 3;

#[derive(Debug, Args)]
#[command(next_help_heading = "Search")]
pub(super) struct CheckArguments {
    /// Run each model on its own for as long as the movie, and compare how cells move, shapes, order and flow with
    /// those measured. DRAWS is the number of runs, 19 to 9999 [without a number: 199].
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
        if measured(&asked.snapshots, data, difference)?.flow().is_some() {
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
        let prepared = &searched.prepared;
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
            Err(Error::Interrupted) => {
                Err(with_location(prepared, Error::Interrupted, &asked.arguments.snapshots))
            }
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
    fn new(found: &Check, frames: &[usize], (prepared, units): (&Problem, &Units)) -> Self {
        let p = by_model(&found.p, |p| *p);
        let quantities: Vec<CheckedQuantity> =
            found.quantities.iter().map(|own| quantity(own, (prepared, units))).collect();
        let report = CheckReport {
            words: words(&p, &quantities, found.draws),
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
fn quantity(own: &Checked, (prepared, units): (&Problem, &Units)) -> CheckedQuantity {
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
fn words(p: &ByModel<f64>, quantities: &[CheckedQuantity], draws: usize) -> String {
    let told = |name: &str, p: f64, of: &dyn Fn(&CheckedQuantity) -> f64| {
        let all: Vec<(&str, f64)> = quantities.iter().map(|own| (own.words, of(own))).collect();
        capital(&sentence(name, p, draws, &all))
    };
    let base = told("the base model", p.base, &|own| own.simulated.base.p);
    let extended = p.extended.map(|p| {
        told("the model with effects", p, &|own| own.simulated.extended.as_ref().map_or(1.0, |own| own.p))
    });
    std::iter::once(base).chain(extended).collect::<Vec<_>>().join(" ")
}

/// Whether a model makes such cells, by its p among so many simulated movies and that of each quantity.
fn sentence(name: &str, p: f64, draws: usize, all: &[(&str, f64)]) -> String {
    let p_in_words = probability(p);
    let below = |level: f64| {
        let mut unusual: Vec<&(&str, f64)> = all.iter().filter(|(_, own)| *own <= level).collect();
        unusual.sort_by(|a, b| a.1.total_cmp(&b.1));
        let names: Vec<&str> = unusual.iter().take(NAMED).map(|(words, _)| *words).collect();
        match (names.is_empty(), unusual.len().saturating_sub(NAMED)) {
            (true, _) => String::new(),
            (false, 0) => format!(": {}", names.join(", ")),
            (false, more) => format!(": {} and {more} more", names.join(", ")),
        }
    };
    if p <= REJECTED {
        return format!("{name} does not make such cells (p {p_in_words}){}.", below(REJECTED));
    }
    if p > DOUBTED {
        return format!(
            "nothing that was compared tells movies of {name} from the measured one (p {p_in_words})."
        );
    }
    let few = match draws < FEWEST {
        true => format!("; {draws} movies are too few to say more, which takes {FEWEST}"),
        false => String::new(),
    };
    format!("whether {name} makes such cells is in doubt (p {p_in_words}{few}){}.", below(DOUBTED))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The ways of the cells, measured and in one movie of each model.
fn ways(found: &Check, (prepared, units): (&Problem, &Units)) -> Figure {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_claims_no_more_than_the_movies_tell() {
        let all =
            [("speeds", 0.4), ("shapes", 0.01), ("order", 0.02), ("flow", 0.03), ("displacements", 0.05)];
        let own = |p: f64, draws: usize| sentence("the base model", p, draws, &all);
        assert_eq!(own(0.01, 199), "the base model does not make such cells (p 0.010): shapes.");
        assert_eq!(
            own(0.02, 99),
            "whether the base model makes such cells is in doubt (p 0.020): shapes, order, flow and 1 more."
        );
        assert_eq!(
            own(0.05, 19),
            "whether the base model makes such cells is in doubt (p 0.050; 19 movies are too few to say more, which takes 99): shapes, order, flow and 1 more."
        );
        assert!(own(0.3, 19).starts_with("nothing that was compared tells"));
        let least_p = |draws: usize| 1.0 / (draws + 1) as f64;
        assert!(least_p(FEWEST) <= REJECTED && least_p(FEWEST - 1) > REJECTED);
    }
}
