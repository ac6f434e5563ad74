//! Forecasts and simulations by models that were fitted, beside those by the model that moved the cells.
//!
//! Tissues that crawl are filmed as `claims::measured` films them. Models without and with a polarity are fitted to the first half of the frames; they and
//! the true one say what comes in the other half, and simulate the whole movie.

use super::seeds::mean;
use super::seeds::{on_cores, quartiles};
use crate::Outcome;
use claims::measured::{Class, MeasuredSet};
use nalgebra::Vector2;
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox};
use voronudge_infer::forecast::{Ahead, Forecast, Forecaster, check, forecast};
use voronudge_infer::{
    Activity, Constraints, CrossValidation, Drift, FitParameter, KnownNoise, Movie, Polarity, Request,
    infer_tracks,
};
use voronudge_model::Structure;

/// How the tissues are filmed.
const CLASS: &str = "active-long";
/// The first frames, which are fitted.
const FITTED: usize = 6;
/// Frames ahead.
const HORIZONS: [usize; 3] = [1, 2, 4];
/// Simulated movies of each model.
const DRAWS: usize = 199;
/// Noisy runs of a forecast.
const RUNS: usize = 8;
/// Share of movies below which a model does not make such cells.
const REJECTED: f64 = 0.01;
/// Without polarity, with it, the truth.
const MODELS: [&str; 3] = ["without polarity", "with polarity", "truth"];

/// What came of a tissue: by model, skills with errors at the horizons and the share of simulated movies that are as unusual.
struct Judged {
    skill: [[[f64; 2]; HORIZONS.len()]; MODELS.len()],
    p: [f64; MODELS.len()],
}

pub fn run(seeds: u64, cells: Option<usize>) -> Outcome {
    let cores = std::thread::available_parallelism()?.get();
    let horizons = HORIZONS.map(|h| h.to_string()).join(", ");
    println!(
        "| tissue | skill {horizons} frames ahead: {} | p of its movie: {} |",
        MODELS.join(" | "),
        MODELS.join(" | ")
    );
    println!("|{}", "---|".repeat(1 + 2 * MODELS.len()));
    let all = on_cores(cores, seeds, |seed| {
        let own = judge(seed, cells.unwrap_or(100))?;
        let skills =
            own.skill.map(|all| all.map(|[skill, error]| format!("{skill:.3} ± {error:.3}")).join(", "));
        println!("| {seed} | {} | {} |", skills.join(" | "), own.p.map(|p| format!("{p:.3}")).join(" | "));
        Ok(own)
    })?;
    println!(
        "\n| frames ahead | mean skill: {} | with polarity as good as the truth | without it | with less without (mean ± its error) | truth less with |",
        MODELS.join(" | ")
    );
    println!("|{}", "---|".repeat(5 + MODELS.len()));
    for (h, horizon) in HORIZONS.iter().enumerate() {
        let skill = |own: &Judged, model: usize| own.skill[model][h];
        let over = |of: &dyn Fn(&Judged) -> f64| mean(&all.iter().map(of).collect::<Vec<_>>());
        let means = [0, 1, 2].map(|model| format!("{:.3}", over(&|own| skill(own, model)[0]).0));
        // Within a standard error of the truth's.
        let as_good = |model: usize| {
            let good = |own: &&Judged| skill(own, model)[0] >= skill(own, 2)[0] - skill(own, 2)[1];
            format!("{} of {}", all.iter().filter(good).count(), all.len())
        };
        let less = |a: usize, b: usize| {
            let (mean, error) = over(&|own| skill(own, a)[0] - skill(own, b)[0]);
            format!("{mean:.3} ± {error:.3}")
        };
        println!(
            "| {horizon} | {} | {} | {} | {} | {} |",
            means.join(" | "),
            as_good(1),
            as_good(0),
            less(1, 0),
            less(2, 1)
        );
    }
    println!(
        "\n| model | p < {REJECTED} | quartiles of p | largest distance from uniform | of 5 % of uniform sets it is more than |"
    );
    println!("|---|---|---|---|---|");
    for (model, name) in MODELS.iter().enumerate() {
        let mut p: Vec<f64> = all.iter().map(|own| own.p[model]).collect();
        p.sort_by(f64::total_cmp);
        let below = p.iter().filter(|p| **p < REJECTED).count();
        let [low, middle, high] = quartiles(p.clone());
        println!(
            "| {name} | {below} of {} | {low:.2}, {middle:.2}, {high:.2} | {:.3} | {:.3} |",
            p.len(),
            distance_from_uniform(&p),
            // Kolmogorov's, for many.
            1.358 / (p.len() as f64).sqrt()
        );
    }
    Ok(())
}

/// The largest difference between the distribution of some ascending numbers and the uniform one.
fn distance_from_uniform(ascending: &[f64]) -> f64 {
    let count = ascending.len() as f64;
    let beside = |(k, p): (usize, &f64)| (p - k as f64 / count).abs().max(((k + 1) as f64 / count - p).abs());
    ascending.iter().enumerate().map(beside).fold(0.0, f64::max)
}

fn judge(seed: u64, cells: usize) -> Result<Judged, Box<dyn Error>> {
    let set = Class::named(CLASS).ok_or("no such class")?.measure(seed, Some(cells))?;
    let movie = movie(&set, set.positions.dim().0)?;
    let truth = |name: &str| set.truth.parameters.get(name).copied().ok_or("no such parameter");
    let elasticity = truth("K_A")?;
    let structure = Structure::base(1.0);
    let request = Request {
        noise: KnownNoise::default(),
        cross_validation: CrossValidation::Skipped,
        structure: structure.clone(),
        ..Request::new(Constraints::fixed([(FitParameter::AreaElasticity, elasticity)]))
    };
    let beginning = self::movie(&set, FITTED)?;
    let fit = |activity| {
        let request = Request { activity, ..request.clone() };
        infer_tracks(&beginning, &request, &mut |_| ControlFlow::Continue(()))
    };
    let (without, with) = (fit(Activity::None)?, fit(Activity::Polarity)?);
    let fitted = with.1.polarity.clone().ok_or("no polarity")?;
    let polarity = Polarity { speed: truth("v_0")?, rate: truth("D_r")?, ..fitted };
    let mut moving = with.1.clone();
    moving.polarity = Some(polarity);
    let true_coefficients = [elasticity, truth("K_P")? * truth("P_0")?, truth("K_P")?, truth("K_P_alpha")?];
    let model =
        |coefficients, tracked| Forecaster { structure: &structure, coefficients, tracked: Some(tracked) };
    let models = [
        model(without.0.coefficients.as_slice(), &without.1),
        model(with.0.coefficients.as_slice(), &with.1),
        model(&true_coefficients, &moving),
    ];
    let ahead = Ahead {
        movie: &movie,
        first: FITTED,
        horizon: HORIZONS[HORIZONS.len() - 1],
        noise: with.0.noise,
        draws: RUNS,
        seed,
    };
    let said = forecast(&ahead, &models, &mut |_| ControlFlow::Continue(()))?;
    let ahead = Ahead { first: 1, horizon: 1, draws: DRAWS, ..ahead };
    let checked = check(&ahead, &models, &mut |_| ControlFlow::Continue(()))?;
    let skill_of = |model: usize| -> Result<_, Box<dyn Error>> {
        let own = said.skills.iter().find(|skill| skill.of == Forecast::Model(model));
        let own = &own.ok_or("a model without a skill")?.position;
        Ok(HORIZONS.map(|horizon| own[horizon - 1]))
    };
    Ok(Judged {
        skill: [skill_of(0)?, skill_of(1)?, skill_of(2)?],
        p: [checked.p[0], checked.p[1], checked.p[2]],
    })
}

/// The first frames of a set.
fn movie(set: &MeasuredSet, frames: usize) -> Result<Movie, Box<dyn Error>> {
    let places = |frame: usize| {
        let cells = set.positions.index_axis(ndarray::Axis(0), frame);
        let place =
            |cell: ndarray::ArrayView1<'_, f64>| (!cell[0].is_nan()).then(|| Vector2::new(cell[0], cell[1]));
        cells.outer_iter().map(place).collect()
    };
    let frames: Vec<Vec<_>> = (0..frames).map(places).collect();
    let times = (0..frames.len()).map(|frame| frame as f64 * set.interval).collect();
    let side = set.cell_box.ok_or("not a whole tissue")?;
    let domain = Domain::Periodic(PeriodicBox::new([side; 2])?);
    Ok(Movie::new(times, &frames, domain, FieldOfView::default(), Drift::None)?)
}
