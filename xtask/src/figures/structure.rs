//! Order and fluctuations of the chaotic liquid.

use super::{Drawn, Figure, Made, Panel, Series, Size};
use rayon::prelude::*;
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::structure_factor;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{ErrorPoint, PhaseMap, phase_map};
use voronudge_simulate::{RandomPlacement, Schedule, Simulation, generator, run};

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

fn fourier(size: Size) -> Result<Made, Box<dyn Error>> {
    let (cells, time, frames) = size.pick((400, 12.0, 4), (10_000, 60.0, 6));
    let parameters = Parameters { preferred_perimeter: 4.0, chirality: 0.2, ..Parameters::default() };
    let mut simulation = tissue(cells, &parameters, 1)?;
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2])?;
    let schedule = Schedule { time, time_step: 0.02, frames };
    let largest = 10.0;
    let mut sums: Vec<[f64; 4]> = Vec::new();
    let mut taken = 0.0;
    run(&mut simulation, &schedule, |event| {
        if let voronudge_simulate::Event::Frame(frame) = event
            && 2 * frame.index >= frames
        {
            let own = frame.simulation;
            let shells = structure_factor(own.positions(), own.velocities(), &cell_box, largest);
            sums.resize(shells.len(), [0.0; 4]);
            for (sum, shell) in sums.iter_mut().zip(&shells) {
                let values = [shell.wave_number, shell.density, shell.longitudinal, shell.transverse];
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
            taken += 1.0;
        }
        ControlFlow::Continue(())
    })?;
    let curve = |which: usize| -> Vec<[f64; 2]> {
        sums.iter().map(|sum| [sum[0] / taken, sum[which] / taken]).collect()
    };
    let (density, longitudinal, transverse) = (curve(1), curve(2), curve(3));
    let peak = |curve: &[[f64; 2]]| {
        curve.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2])
    };
    let slope = |curve: &[[f64; 2]], low: f64, high: f64| {
        let inside: Vec<[f64; 2]> =
            curve.iter().filter(|p| p[0] >= low && p[0] <= high).map(|p| p.map(f64::ln)).collect();
        let count = inside.len() as f64;
        let mean = [0, 1].map(|k| inside.iter().map(|p| p[k]).sum::<f64>() / count);
        let product =
            |a: usize, b: usize| -> f64 { inside.iter().map(|p| (p[a] - mean[a]) * (p[b] - mean[b])).sum() };
        product(0, 1) / product(0, 0)
    };
    let range = [4.0 * std::f64::consts::TAU / (cells as f64).sqrt(), 3.0];
    let slopes = [&longitudinal, &transverse].map(|curve| slope(curve, range[0], range[1]));
    let least = density.first().map_or(f64::NAN, |point| point[1]);
    let joined = |name: &str, points: &[[f64; 2]], drawn: Drawn| Series {
        name: name.into(),
        drawn,
        points: points.iter().map(|&point| ErrorPoint::from(point)).collect(),
    };
    let chart = |title: &str, y: &str, series: Vec<Series>| {
        super::chart(title, ["q ℓ_0", y], [AxisScale::Logarithmic; 2], &series)
    };
    let middle = transverse.iter().find(|point| point[0] >= range[0]).copied().unwrap_or([1.0, 1.0]);
    let guide = [range[0], range[1]].map(|q| [q, 2.0 * middle[1] * q / middle[0]]);
    Ok(Made {
        settings: format!(
            "{cells} cells, P₀ = 4, α = 0.2, K_A = 0.1, t = {time}, Δt = 0.02, seed 1; {taken} frames of the second half"
        ),
        found: vec![
            format!(
                "The density has its peak at q ℓ₀ = {:.1}, that is a wave length of {:.2} ℓ₀, and falls to S = {least:.4} at the \
                 longest waves: nothing large.",
                peak(&density)[0],
                std::f64::consts::TAU / peak(&density)[0]
            ),
            format!(
                "Velocities have their peaks at q ℓ₀ = {:.1} (longitudinal) and {:.1} (transverse); below, between {:.2} and {}, they rise \
                 with exponents {:.2} and {:.2}. The paper's q ℓ₀ ≈ 1 for the peak must be in units of 2π.",
                peak(&longitudinal)[0],
                peak(&transverse)[0],
                range[0],
                range[1],
                slopes[0],
                slopes[1]
            ),
        ],
        panels: vec![
            Panel {
                name: "density",
                caption: "Structure factor of the density".into(),
                svg: chart("density", "S(q)", vec![joined("density", &density, Drawn::JoinedMarks)]),
            },
            Panel {
                name: "velocity",
                caption: "Structure factors of the velocity; the broken line has the exponent 1".into(),
                svg: chart(
                    "velocity",
                    "|v(q)|² / N, (K_P ℓ_0)²",
                    vec![
                        joined("longitudinal", &longitudinal, Drawn::JoinedMarks),
                        joined("transverse", &transverse, Drawn::JoinedMarks),
                        joined("exponent 1", &guide, Drawn::BrokenLine),
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
    let (mut fluctuation, mut difference, mut liquid) = (Vec::new(), Vec::new(), Vec::new());
    for own in found.chunks_exact(starts + 1) {
        let (many, large) = (&own[..starts], own[starts]);
        let mean = many.iter().sum::<f64>() / starts as f64;
        let variance = many.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (starts - 1) as f64;
        fluctuation.push(variance.sqrt() / mean);
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
            "In the liquid (⟨v²⟩ > 0.01, {} of {} points) the standard deviation between starts is {:.0} % of the mean in the middle \
             and at most {:.0} %; four times the cells change the mean by {:.0} % in the middle and by at most {:.0} %. The largest \
             values stand beside the transition.",
            liquid.iter().filter(|liquid| **liquid).count(),
            liquid.len(),
            100.0 * median(&fluctuation),
            100.0 * largest(&fluctuation),
            100.0 * median(&difference),
            100.0 * largest(&difference)
        )],
        panels: vec![
            Panel {
                name: "starts",
                caption: "Standard deviation of ⟨v²⟩ over its mean, between initial conditions".into(),
                svg: map("fluctuations between starts", "standard deviation / mean", &fluctuation),
            },
            Panel {
                name: "sizes",
                caption: "Relative difference of ⟨v²⟩ between the two sizes".into(),
                svg: map("difference between sizes", "relative difference", &difference),
            },
        ],
    })
}
