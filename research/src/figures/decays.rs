//! Decay lengths across the channel as the paper takes them from its experiments.

use super::{Drawn, EVEN, Panel, Series, Size, command};
use crate::study::mean;
use serde::Deserialize;
use std::error::Error;
use voronudge_report::figure::ErrorPoint;

/// Width of the paper's bins (µm), the first of them at the edge.
const BIN: f64 = 25.0;

/// A row of `folded_profile.csv`.
#[derive(Deserialize)]
struct Strip {
    x: f64,
    density: f64,
    v_x: f64,
    v_y: f64,
}

/// Profiles in the paper's bins: of the density, of v_x and of v_y.
struct Profile {
    distances: Vec<f64>,
    values: [Vec<f64>; 3],
}

impl Profile {
    /// From `folded_profile.csv`, whose strips are narrower.
    fn read(path: &std::path::Path) -> Result<Self, Box<dyn Error>> {
        let mut sums: Vec<[f64; 5]> = Vec::new();
        for row in csv::Reader::from_path(path)?.deserialize() {
            let Strip { x, density, v_x, v_y } = row?;
            let bin = (x / BIN) as usize;
            if sums.len() <= bin {
                sums.resize(bin + 1, [0.0; 5]);
            }
            for (sum, value) in sums[bin].iter_mut().zip([1.0, x, density, v_x, v_y]) {
                *sum += value;
            }
        }
        let of = |k: usize| sums.iter().map(|sum| sum[k] / sum[0]).collect::<Vec<_>>();
        Ok(Self { distances: of(1), values: [of(2), of(3), of(4)] })
    }

    /// Each quantity from its least value, 0, to its largest, 1.
    fn normalised(&self, which: usize) -> Vec<f64> {
        let values = &self.values[which];
        let [low, high] =
            [f64::min, f64::max].map(|of| values.iter().copied().reduce(of).unwrap_or(f64::NAN));
        values.iter().map(|value| (value - low) / (high - low)).collect()
    }

    /// λ of C exp(−d/λ) by least squares.
    fn length(&self, which: usize) -> f64 {
        let values = self.normalised(which);
        let misfit = |length: f64| {
            let shape: Vec<f64> = self.distances.iter().map(|d| (-d / length).exp()).collect();
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            product(&values, &values) - product(&values, &shape).powi(2) / product(&shape, &shape)
        };
        // Steps of 1 ‰ from 2 µm to 0.9 mm.
        let lengths = (0..6100).map(|k| 2.0 * 1.001f64.powi(k));
        lengths.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b))).unwrap_or(f64::NAN)
    }
}

impl Profile {
    /// The axis along which the flow compresses cells most, between each two bins: distance from the edge, and the angle from the direction across the
    /// channel towards that along it (degrees).
    fn compressive_axis(&self) -> Vec<[f64; 2]> {
        let [_, v_x, v_y] = &self.values;
        let between = |k: usize| {
            let across = self.distances[k + 1] - self.distances[k];
            let [stretch, shear] = [v_x, v_y].map(|v| (v[k + 1] - v[k]) / across);
            // The traceless strain rate is ½ [[a, b], [b, −a]]; it stretches along ½ atan2(b, a), and compresses a quarter turn from there.
            let angle = 0.5 * (-shear).atan2(-stretch);
            [0.5 * (self.distances[k] + self.distances[k + 1]), angle.to_degrees()]
        };
        (0..self.distances.len().saturating_sub(1)).map(between).collect()
    }
}

/// What came out, in words, a picture of the first protocol, and one of the axis of compression in it.
pub(super) fn protocols(size: Size) -> Result<(Vec<String>, [Panel; 2]), Box<dyn Error>> {
    let seeds = size.pick(2, 4);
    let quick = size.pick(" --length 100 --relaxation 2 --time 6 --samples 4", "");
    // The paper's step, 0.02/K_P, and the one that is advised.
    let cases: &[(f64, &str)] = size.pick(
        &[(150.0, "0.0465")],
        &[(500.0, "0.008"), (500.0, "0.0465"), (200.0, "0.008"), (200.0, "0.0465")],
    );
    let (mut told, mut series, mut chiralities, mut axes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for &(width, step) in cases {
        let profiles = (1..=seeds)
            .map(|seed| {
                // Strips of a quarter of a cell.
                let bins = (width / 6.25) as usize;
                let run = command::run(&format!(
                    "channel --preset ht1080 --width {width} --bins {bins} --dt {step} --seed {seed}{quick}"
                ))?;
                let alpha = run.report()?["chirality_from_flow"]["alpha"].as_f64();
                Ok((Profile::read(&run.path().join("folded_profile.csv"))?, alpha.unwrap_or(f64::NAN)))
            })
            .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
        let (profiles, alpha): (Vec<Profile>, Vec<f64>) = profiles.into_iter().unzip();
        let lengths = [0, 1, 2].map(|which| {
            let (value, error) =
                mean(&profiles.iter().map(|profile| profile.length(which)).collect::<Vec<_>>());
            format!("{value:.0} ± {error:.0}")
        });
        let [rho, v_x, v_y] = lengths;
        told.push(format!("ρ {rho}, v_x {v_x}, v_y {v_y} µm (W = {width} µm, Δt = {step} h)"));
        if series.is_empty() {
            chiralities = alpha;
            let all: Vec<_> = profiles.iter().map(Profile::compressive_axis).collect();
            axes = (0..all[0].len())
                .map(|k| {
                    let (angle, error) = mean(&all.iter().map(|own| own[k][1]).collect::<Vec<_>>());
                    ErrorPoint { at: [all[0][k][0], angle], error: [None, Some(error)] }
                })
                .collect();
            for (which, name) in ["ρ", "v_x", "v_y"].into_iter().enumerate() {
                let normalised: Vec<Vec<f64>> =
                    profiles.iter().map(|profile| profile.normalised(which)).collect();
                let point = |(k, &at): (usize, &f64)| {
                    let (value, error) = mean(&normalised.iter().map(|own| own[k]).collect::<Vec<_>>());
                    ErrorPoint { at: [at, value], error: [None, Some(error)] }
                };
                series.push(Series {
                    name: name.into(),
                    drawn: Drawn::JoinedMarks,
                    points: profiles[0].distances.iter().enumerate().map(point).collect(),
                });
            }
        }
    }
    let found = format!(
        "By the paper's estimator (bins of 25 µm, each profile from 0 to 1, C exp(−d/λ)) λ is, over {seeds} runs (`--dt …`, seeds from 1): {}. \
         α of the slope v_y/v_x in those of W = {} µm and Δt = {} h is {} (put in: 2.9).",
        told.join("; "),
        cases[0].0,
        cases[0].1,
        chiralities.iter().map(|alpha| format!("{alpha:.2}")).collect::<Vec<_>>().join(", ")
    );
    let svg = super::chart(
        "profiles from 0 to 1",
        ["distance from the edge (µm)", "(Y − min)/(max − min)"],
        EVEN,
        &series,
    );
    let caption = format!(
        "Profiles in the paper's bins, each from 0 to 1, W = {} µm; bars are standard errors over runs",
        cases[0].0
    );
    let near = |point: &ErrorPoint| {
        let [distance, angle] = point.at;
        format!("{angle:.0} ± {:.0}° at {distance:.0} µm", point.error[1].unwrap_or(f64::NAN))
    };
    let tilt = format!(
        "In the same runs the axis of compression, along which the paper thinks that defects align, is turned from the direction across the channel by {} \
         (½ arctan of the theory's v_y/v_x is 28°; the paper measures defects at 16 to 24°). Cells here have no nematic interaction, and defects were not looked for.",
        axes.iter().take(4).map(near).collect::<Vec<_>>().join(", ")
    );
    let series = [Series { name: String::new(), drawn: Drawn::JoinedMarks, points: axes }];
    let labels = ["distance from the edge (µm)", "axis of compression (degrees)"];
    let axis = Panel {
        name: "axis",
        caption: "Angle of the axis of compression from the direction across the channel; bars are standard errors over runs".into(),
        svg: super::chart("axis of compression", labels, EVEN, &series),
    };
    Ok((vec![found, tilt], [Panel { name: "normalised", caption, svg }, axis]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocities towards the middle that fall with the distance compress across the channel; those along it turn the axis.
    #[test]
    fn the_axis_of_compression_of_an_even_flow() {
        let distances = vec![10.0, 20.0, 30.0];
        let falling = |slope: f64| distances.iter().map(|d| 5.0 - slope * d).collect::<Vec<_>>();
        let straight =
            Profile { distances: distances.clone(), values: [falling(0.0), falling(0.1), falling(0.0)] };
        assert!(straight.compressive_axis().iter().all(|own| own[1].abs() < 1e-9));
        let turned =
            Profile { distances: distances.clone(), values: [falling(0.0), falling(0.1), falling(0.1)] };
        let axes = turned.compressive_axis();
        assert!(axes.len() == 2 && axes.iter().all(|own| (own[1] - 22.5).abs() < 1e-9), "{axes:?}");
    }

    #[test]
    fn an_exponential_has_its_length() {
        let distances: Vec<f64> = (0..40).map(|k| 12.5 + 25.0 * f64::from(k)).collect();
        let decay: Vec<f64> = distances.iter().map(|d| 3.0 + 2.0 * (-d / 44.0).exp()).collect();
        let profile = Profile { distances, values: [decay.clone(), decay.clone(), decay] };
        assert!((profile.length(0) / 44.0 - 1.0).abs() < 1e-3, "{}", profile.length(0));
    }
}
