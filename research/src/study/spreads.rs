//! Cells that differ: how often it is told, how large it is said to be, and whether the mean parameters are right.

use super::seeds::{mean, on_one_core_each, quartiles};
use crate::Outcome;
use claims::Noise;
use claims::differing::{Differing, Since};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use voronudge_infer::discover::{Discovery, Search, discover};
use voronudge_infer::{FitParameter, Unkept, infer};
use voronudge_model::CellParameter::{self, AreaElasticity, Chirality, PreferredArea, PreferredPerimeter};

const CELLS: usize = 324;

/// Probability below which a spread is named, for as many as are tried together.
const LEVEL: f64 = 0.05;

const NOISE: Noise = Noise { position: 0.02, velocity: 0.05 };

/// Of cells that settle alike and differ from the first frame on.
const LATELY: &str = "all, 5 % and 25 %, from the frame on";

/// What a fit says of one set.
struct Row {
    /// p of each parameter that was let vary, its spread, and whether its interval covers.
    spreads: Vec<(f64, f64, bool)>,
    /// Whether the intervals of the mean parameters cover, with and without spreads.
    covered: [[bool; 4]; 2],
    /// K_A and K_P over the true ones, and what is left of them where shapes have followed what cells have of their own.
    elasticities: [[f64; 2]; 2],
    seconds: f64,
}

const MEANS: [FitParameter; 4] = [
    FitParameter::AreaElasticity,
    FitParameter::PerimeterElasticity,
    FitParameter::PreferredPerimeter,
    FitParameter::Chirality,
];

/// `searching`: whether the sets are given to the search for what is missing, instead of a fit in which cells differ.
pub fn run(seeds: u64, cells: Option<usize>, only: &[String], searching: bool) -> Outcome {
    let cells = cells.unwrap_or(CELLS);
    if searching {
        println!("| cells differ by | frames | effects named, in so many sets | verdicts | seconds |");
        println!("|---|---|---|---|---|");
    } else {
        head();
    }
    let all = [PreferredPerimeter, Chirality, PreferredArea, AreaElasticity];
    let three = &all[..3];
    let settings: [(&str, &[CellParameter], [f64; 4]); 8] = [
        ("nothing", three, [0.0; 4]),
        ("P_0 2 %", &[PreferredPerimeter], [0.02, 0.0, 0.0, 0.0]),
        ("alpha 10 %", &[Chirality], [0.0, 0.1, 0.0, 0.0]),
        ("A_0 10 %", &[PreferredArea], [0.0, 0.0, 0.1, 0.0]),
        ("K_A 25 %", &[AreaElasticity], [0.0, 0.0, 0.0, 0.25]),
        ("all, 2 % and 10 %", three, [0.02, 0.1, 0.1, 0.0]),
        ("all, 5 % and 25 %", three, [0.05, 0.25, 0.25, 0.0]),
        (LATELY, three, [0.05, 0.25, 0.25, 0.0]),
    ];
    for frames in [1, 6] {
        for (name, varied, sizes) in settings {
            let full = format!("{name}; {frames} frames");
            let since = if name == LATELY { Since::FirstFrame } else { Since::Placement };
            if !only.is_empty() && !only.iter().any(|part| full.contains(part.as_str())) {
                continue;
            }
            let spreads: Vec<(CellParameter, f64)> = all.into_iter().zip(sizes).collect();
            if searching {
                let found = on_one_core_each(seeds, |seed| searched((since, cells, frames, seed), &spreads))?;
                print_found(name, frames, &found);
                continue;
            }
            let rows = on_one_core_each(seeds, |seed| row((since, cells, frames, seed), &spreads, varied))?;
            print(name, varied, frames, &rows, &spreads);
        }
    }
    Ok(())
}

fn head() {
    println!(
        "| cells differ by | let vary | frames | named | median s/truth (quartiles) | s covers | means cover | without spreads | K_A, K_P over the truth | foreseen | seconds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
}

/// What is found to be missing in one set.
fn searched(
    (since, cells, frames, seed): (Since, usize, usize, u64),
    spreads: &[(CellParameter, f64)],
) -> Result<(Discovery, f64), Box<dyn std::error::Error>> {
    let tissue = Differing::since(since, cells, seed, frames, spreads)?;
    let measured = tissue.measured(NOISE, seed)?;
    let begun = std::time::Instant::now();
    let found = discover(&measured, &Search::new(tissue.request(&[])), &mut Unkept, &mut |_| {
        ControlFlow::Continue(())
    })?;
    Ok((found, begun.elapsed().as_secs_f64()))
}

/// Effects and verdicts with the number of sets in which they were found.
fn print_found(name: &str, frames: usize, all: &[(Discovery, f64)]) {
    let (mut effects, mut verdicts) = (BTreeMap::new(), BTreeMap::new());
    for (found, _) in all {
        found.selected.iter().for_each(|own| *effects.entry(own.effect.id).or_insert(0) += 1);
        *verdicts.entry(format!("{:?}", found.verdict)).or_insert(0) += 1;
    }
    let told = |(what, count): (String, i32)| format!("{what} {count}");
    let effects: Vec<String> =
        effects.into_iter().map(|(id, count)| told((format!("`{id}`"), count))).collect();
    let verdicts: Vec<String> = verdicts.into_iter().map(told).collect();
    let [_, seconds, _] = quartiles(all.iter().map(|(_, seconds)| *seconds).collect());
    println!(
        "| {name} | {frames} | {} | {} of {} | {seconds:.0} |",
        effects.join(", "),
        verdicts.join(", "),
        all.len()
    );
}

fn row(
    (since, cells, frames, seed): (Since, usize, usize, u64),
    spreads: &[(CellParameter, f64)],
    varied: &[CellParameter],
) -> Result<Row, Box<dyn std::error::Error>> {
    let tissue = Differing::since(since, cells, seed, frames, spreads)?;
    let measured = tissue.measured(NOISE, seed)?;
    let begun = std::time::Instant::now();
    let fit = infer(&measured, &tissue.request(varied), &mut |_| ControlFlow::Continue(()))?;
    let seconds = begun.elapsed().as_secs_f64();
    let alike = infer(&measured, &tissue.request(&[]), &mut |_| ControlFlow::Continue(()))?;
    let covered = [&fit, &alike].map(|fit| MEANS.map(|q| fit.parameters.get(q).covers(tissue.truth(q))));
    let of = |found: &voronudge_infer::Spread| {
        let truth = tissue.spread(found.parameter);
        let [low, high] = found.interval;
        let covers = low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high);
        (found.p, found.value, covers)
    };
    let elasticity = |q: FitParameter| fit.parameters.get(q).value / tissue.truth(q);
    let elasticities = [[MEANS[0], MEANS[1]].map(elasticity), tissue.left_of_elasticities()?];
    Ok(Row { spreads: fit.spreads.iter().map(of).collect(), covered, elasticities, seconds })
}

fn print(
    name: &str,
    varied: &[CellParameter],
    frames: usize,
    rows: &[Row],
    spreads: &[(CellParameter, f64)],
) {
    let count = rows.len();
    let each = |tell: &dyn Fn(usize) -> String| (0..varied.len()).map(tell).collect::<Vec<_>>().join(", ");
    let named = each(&|k| {
        let named = rows.iter().filter(|row| row.spreads[k].0 * (varied.len() as f64) < LEVEL).count();
        format!("{} {named}/{count}", varied[k].name())
    });
    let sizes = each(&|k| {
        let truth = spreads.iter().find(|(own, _)| *own == varied[k]).map_or(0.0, |(_, size)| *size);
        let unit = if truth > 0.0 { truth } else { 1.0 };
        let [low, median, high] = quartiles(rows.iter().map(|row| row.spreads[k].1 / unit).collect());
        format!("{median:.3} ({low:.3}–{high:.3})")
    });
    let covers = each(&|k| format!("{}/{count}", rows.iter().filter(|row| row.spreads[k].2).count()));
    let means = |which: usize| {
        let own = |k: usize| rows.iter().filter(|row| row.covered[which][k]).count().to_string();
        format!("{} of {count}", (0..MEANS.len()).map(own).collect::<Vec<_>>().join(", "))
    };
    let elasticities = |which: usize| {
        let one = |k: usize| {
            let all: Vec<f64> = rows.iter().map(|row| row.elasticities[which][k]).collect();
            let (mean, error) = mean(&all);
            format!("{mean:.2} ± {error:.2}")
        };
        format!("{}, {}", one(0), one(1))
    };
    let [_, seconds, _] = quartiles(rows.iter().map(|row| row.seconds).collect());
    println!(
        "| {name} | {} | {frames} | {named} | {sizes} | {covers} | {} | {} | {} | {} | {seconds:.0} |",
        varied.iter().map(|own| own.name()).collect::<Vec<_>>().join(", "),
        means(0),
        means(1),
        elasticities(0),
        elasticities(1)
    );
}
