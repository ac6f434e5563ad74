//! Order and fluctuations of the chaotic liquid.

use super::{Drawn, Figure, Made, Panel, Series, Size};
use crate::study::mean;
use rayon::prelude::*;
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::structure_factor;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{ErrorPoint, PhaseMap, phase_map};
use voronudge_simulate::{RandomPlacement, Schedule, Simulation, generator, run, seed_of_replica};

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "s-m2ab",
        title: "density and velocity of the liquid in Fourier space",
        stated: "no structure at large scales in density or velocity at P₀ = 4, α = 0.2; the only peak is at the scale of a cell; an \
                 exponent of 1 is drawn beside the velocities",
        make: fourier,
    },
    Figure {
        name: "s-m2cd",
        title: "the mean square velocity for ten starts and for two sizes",
        stated: "relative fluctuations between ten initial conditions, and the difference between W = 10 and 20, are negligible in the \
                 liquid; in the solid the velocity vanishes and the ratios mean nothing",
        make: starts_and_sizes,
    },
];

fn tissue(
    cells: usize,
    parameters: &Parameters<f64>,
    seed: u64,
) -> Result<Simulation, voronudge_simulate::Error> {
    let lengths = [(cells as f64).sqrt(); 2];
    let cell_box = PeriodicBox::new(lengths)
        .map_err(|source| voronudge_simulate::Error::Tessellation { time: 0.0, source })?;
    let start = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed))?;
    Simulation::new(start, Domain::Periodic(cell_box), Model::chiral_voronoi(parameters))
}

/// Structure factors by wave number: the wave number, of density, and of longitudinal and transverse velocity.
type Shells = Vec<[f64; 4]>;

/// Structure factors of one run averaged over the frames in each window of time.
fn windows(
    cells: usize,
    parameters: &Parameters<f64>,
    seed: u64,
    (frames, interval): (usize, f64),
    windows: &[[f64; 2]],
) -> Result<Vec<Shells>, Box<dyn Error>> {
    let mut simulation = tissue(cells, parameters, seed)?;
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
    let schedule = Schedule { time: interval * frames as f64, time_step: 0.02, frames };
    let mut sums: Vec<(Shells, f64)> = vec![(Vec::new(), 0.0); windows.len()];
    run(&mut simulation, &schedule, |event| {
        if let voronudge_simulate::Event::Frame(frame) = event {
            let own = frame.simulation;
            let within = |window: &[f64; 2]| own.time() > window[0] && own.time() <= window[1] + 1e-9;
            if windows.iter().any(within) {
                let shells = structure_factor(own.positions(), own.velocities(), &cell_box, LARGEST);
                for ((sum, taken), _) in sums.iter_mut().zip(windows).filter(|(_, window)| within(window)) {
                    sum.resize(shells.len(), [0.0; 4]);
                    for (sum, shell) in sum.iter_mut().zip(&shells) {
                        let values = [shell.wave_number, shell.density, shell.longitudinal, shell.transverse];
                        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                    }
                    *taken += 1.0;
                }
            }
        }
        ControlFlow::Continue(())
    })?;
    let mean = |(sum, taken): (Shells, f64)| sum.iter().map(|row| row.map(|value| value / taken)).collect();
    Ok(sums.into_iter().map(mean).collect())
}

/// Exponent of a structure factor between two wave numbers, by least squares of logarithms.
fn exponent(shells: &Shells, which: usize, [low, high]: [f64; 2]) -> f64 {
    let inside: Vec<[f64; 2]> = (shells.iter().filter(|row| row[0] >= low && row[0] <= high))
        .map(|row| [row[0].ln(), row[which].ln()])
        .collect();
    let count = inside.len() as f64;
    let mean = [0, 1].map(|k| inside.iter().map(|p| p[k]).sum::<f64>() / count);
    let product =
        |a: usize, b: usize| -> f64 { inside.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum() };
    product(0, 1) / product(0, 0)
}

/// Largest wave number of structure factors.
const LARGEST: f64 = 10.0;

fn fourier(size: Size) -> Result<Made, Box<dyn Error>> {
    let (cells, runs, interval, spans): (_, _, _, &[[f64; 2]]) = size.pick(
        (144, 2, 1.0, &[[2.0, 4.0], [4.0, 8.0]]),
        (2500, 4, 5.0, &[[30.0, 60.0], [100.0, 200.0], [200.0, 400.0]]),
    );
    let parameters = Parameters { preferred_perimeter: 4.0, chirality: 0.2, ..Parameters::default() };
    let last = spans.last().map_or(0.0, |span| span[1]);
    let frames = (last / interval).round() as usize;
    let all: Vec<Vec<Shells>> = (0..runs)
        .into_par_iter()
        .map(|replica| {
            let seed = seed_of_replica(1, replica);
            windows(cells, &parameters, seed, (frames, interval), spans).map_err(|error| error.to_string())
        })
        .collect::<Result<_, _>>()?;
    let late = spans.len() - 1;
    let over_runs = |of: &dyn Fn(&Vec<Shells>) -> f64| mean(&all.iter().map(of).collect::<Vec<_>>());
    let curve = |window: usize, which: usize| -> Vec<ErrorPoint> {
        (0..all[0][window].len())
            .map(|row| {
                let (value, error) = over_runs(&|own| own[window][row][which]);
                ErrorPoint { at: [all[0][window][row][0], value], error: [None, Some(error)] }
            })
            .collect()
    };
    let peak = |points: &[ErrorPoint]| {
        points.iter().max_by(|a, b| a.at[1].total_cmp(&b.at[1])).map_or(f64::NAN, |point| point.at[0])
    };
    let [density, longitudinal, transverse] = [1, 2, 3].map(|which| curve(late, which));
    let shortest = std::f64::consts::TAU / (cells as f64).sqrt();
    let (long, middle) = ([0.99 * shortest, 5.0 * shortest], [2.0 * shortest, 3.0]);
    let words = |(value, error): (f64, f64)| format!("{value:.2} ± {error:.2}");
    let grows = |which: usize, range: [f64; 2]| words(over_runs(&|own| exponent(&own[late], which, range)));
    let at_rest = |window: usize| {
        let at = |k: usize| {
            let (value, error) = over_runs(&|own| own[window][k][1]);
            format!("{value:.4} ± {error:.4}")
        };
        // The second shell is √2 times the first.
        format!("{} and {} at t = {} to {}", at(0), at(2), spans[window][0], spans[window][1])
    };
    let waves = [0, 2].map(|k| all[0][late][k][0]);
    let joined = |name: String, points: Vec<ErrorPoint>| Series { name, drawn: Drawn::JoinedMarks, points };
    let guide = |name: &str, points: &[ErrorPoint], [low, high]: [f64; 2], exponent: f64, factor: f64| {
        let from = points.first().map_or(1.0, |point| point.at[1] / point.at[0].powf(exponent));
        let points = [low, high].map(|q| [q, factor * from * q.powf(exponent)].into()).to_vec();
        Series { name: name.into(), drawn: Drawn::BrokenLine, points }
    };
    let chart = |title: &str, y: &str, series: Vec<Series>| {
        super::chart(title, ["q ℓ_0", y], [AxisScale::Logarithmic; 2], &series)
    };
    let of_time = (0..spans.len())
        .map(|window| joined(format!("t = {} to {}", spans[window][0], spans[window][1]), curve(window, 1)));
    let settings = format!(
        "{cells} cells, P₀ = 4, α = 0.2, K_A = 0.1, Δt = 0.02, {runs} random starts (seed 1), frames {interval} apart until t = {last}; \
         errors are standard errors over starts"
    );
    let spread = format!(
        "The density has its peak at q ℓ₀ = {:.1}, a wave length of {:.2} ℓ₀. S at the long waves q ℓ₀ = {:.3} and {:.3} is {}: random \
         starts take that long to relax. Then S grows as q to the power {} between {:.2} and {:.2}: the liquid is hyperuniform as far as waves of {:.0} ℓ₀ tell.",
        peak(&density),
        std::f64::consts::TAU / peak(&density),
        waves[0],
        waves[1],
        (0..spans.len()).map(at_rest).collect::<Vec<_>>().join(", "),
        grows(1, long),
        long[0],
        long[1],
        (cells as f64).sqrt()
    );
    let velocity = format!(
        "Velocities have their peaks at q ℓ₀ = {:.1} (longitudinal) and {:.1} (transverse); below, between {:.2} and {}, they rise with \
         exponents {} and {}. The paper's q ℓ₀ ≈ 1 for the peak must be in units of 2π.",
        peak(&longitudinal),
        peak(&transverse),
        middle[0],
        middle[1],
        grows(2, middle),
        grows(3, middle)
    );
    let density_chart =
        of_time.chain([guide("exponent 2", &density, [long[0], 1.0], 2.0, 1.0)]).collect::<Vec<_>>();
    let line = guide("exponent 1", &transverse, middle, 1.0, 4.0);
    Ok(Made {
        settings,
        found: vec![spread, velocity],
        panels: vec![
            Panel {
                name: "density",
                caption: "Structure factor of the density while random starts relax; the broken line has the exponent 2".into(),
                svg: chart("density", "S(q)", density_chart),
            },
            Panel {
                name: "velocity",
                caption: "Structure factors of the velocity; the broken line has the exponent 1".into(),
                svg: chart(
                    "velocity",
                    "|v(q)|² / N, (K_P ℓ_0)²",
                    vec![
                        joined("longitudinal".into(), longitudinal),
                        joined("transverse".into(), transverse),
                        line,
                    ],
                ),
            },
        ],
    })
}

/// `⟨v²⟩` over the second half of a run.
fn mean_square_velocity(
    cells: usize,
    parameters: &Parameters<f64>,
    time: f64,
    seed: u64,
) -> Result<f64, voronudge_simulate::Error> {
    let mut simulation = tissue(cells, parameters, seed)?;
    let schedule = Schedule { time, time_step: 0.02, frames: 1 };
    let summary = run(&mut simulation, &schedule, |_| ControlFlow::Continue(()))?;
    Ok(summary.mean_square_velocity.unwrap_or(f64::NAN))
}

fn starts_and_sizes(size: Size) -> Result<Made, Box<dyn Error>> {
    let (columns, rows, starts, time, cells) = size.pick((2, 2, 2, 4.0, 36), (7, 6, 10, 100.0, 100));
    let spread = |low: f64, high: f64, count: usize| -> Vec<f64> {
        (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
    };
    let (perimeters, chiralities) = (spread(3.4, 4.0, columns), spread(0.0, 1.0, rows));
    let points: Vec<Parameters<f64>> = chiralities
        .iter()
        .flat_map(|&chirality| perimeters.iter().map(move |&p| (chirality, p)))
        .map(|(chirality, preferred_perimeter)| Parameters {
            chirality,
            preferred_perimeter,
            ..Parameters::default()
        })
        .collect();
    // Each run on one thread, many at a time.
    let runs: Vec<(usize, usize)> =
        (0..points.len()).flat_map(|point| (0..starts + 1).map(move |start| (point, start))).collect();
    let found = runs
        .into_par_iter()
        .map(|(point, start)| {
            let cells = if start == starts { 4 * cells } else { cells };
            mean_square_velocity(cells, &points[point], time, 100 + start as u64)
        })
        .collect::<Result<Vec<f64>, _>>()?;
    let (mut fluctuation, mut ratio) = (Vec::new(), Vec::new());
    let (mut difference, mut liquid) = (Vec::new(), Vec::new());
    for own in found.chunks_exact(starts + 1) {
        let (many, large) = (&own[..starts], own[starts]);
        let mean = many.iter().sum::<f64>() / starts as f64;
        let variance = many.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (starts - 1) as f64;
        fluctuation.push(variance.sqrt() / mean);
        ratio.push(variance / mean);
        difference.push((large - mean).abs() / mean);
        liquid.push(mean > 1e-2);
    }
    let largest = |values: &[f64]| {
        values.iter().zip(&liquid).filter(|(_, liquid)| **liquid).map(|(value, _)| *value).fold(0.0, f64::max)
    };
    let median = |values: &[f64]| {
        let mut own: Vec<f64> =
            values.iter().zip(&liquid).filter(|(_, liquid)| **liquid).map(|(value, _)| *value).collect();
        own.sort_by(f64::total_cmp);
        own.get(own.len() / 2).copied().unwrap_or(f64::NAN)
    };
    let map = |title: &str, label: &str, values: &[f64]| {
        phase_map(&PhaseMap {
            title,
            label,
            x: ("P_0 / ℓ_0", &perimeters),
            y: ("α", &chiralities),
            values,
            scale: AxisScale::Logarithmic,
            palette: Palette::Sequential,
            lines: &[],
        })
    };
    Ok(Made {
        settings: format!(
            "{columns} × {rows} points, {starts} starts of {cells} cells and one of {}, t = {time}, Δt = 0.02, seeds from 100",
            4 * cells
        ),
        found: vec![format!(
            "In the liquid (⟨v²⟩ > 0.01, {} of {} points) the paper's ratio, variance over mean, which has a unit, is {:.1e} (K_P ℓ₀)² in \
             the middle and at most {:.1e}; the standard deviation is {:.0} % of the mean in the middle and at most {:.0} %. Four times the cells change the mean by {:.0} % in the middle and by at most {:.0} %. The largest \
             relative values stand beside the transition.",
            liquid.iter().filter(|liquid| **liquid).count(),
            liquid.len(),
            median(&ratio),
            largest(&ratio),
            100.0 * median(&fluctuation),
            100.0 * largest(&fluctuation),
            100.0 * median(&difference),
            100.0 * largest(&difference)
        )],
        panels: vec![
            Panel {
                name: "starts",
                caption: "Variance of ⟨v²⟩ between initial conditions over its mean, as in the paper".into(),
                svg: map("fluctuations between starts", "variance / mean, (K_P ℓ_0)^2", &ratio),
            },
            Panel {
                name: "sizes",
                caption: "Relative difference of ⟨v²⟩ between the two sizes".into(),
                svg: map("difference between sizes", "relative difference", &difference),
            },
        ],
    })
}
