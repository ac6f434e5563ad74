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

/// What came out, in words, and a picture of the first protocol.
pub(super) fn protocols(size: Size) -> Result<(String, Panel), Box<dyn Error>> {
    let seeds = size.pick(2, 4);
    let quick = size.pick(" --length 100 --relaxation 2 --time 6 --samples 4", "");
    // The paper's step, 0.02/K_P, and the one that is advised.
    let cases: &[(f64, &str)] = size.pick(
        &[(150.0, "0.0465")],
        &[(500.0, "0.008"), (500.0, "0.0465"), (200.0, "0.008"), (200.0, "0.0465")],
    );
    let (mut told, mut series, mut chiralities) = (Vec::new(), Vec::new(), Vec::new());
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
    Ok((found, Panel { name: "normalised", caption, svg }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_has_its_length() {
        let distances: Vec<f64> = (0..40).map(|k| 12.5 + 25.0 * f64::from(k)).collect();
        let decay: Vec<f64> = distances.iter().map(|d| 3.0 + 2.0 * (-d / 44.0).exp()).collect();
        let profile = Profile { distances, values: [decay.clone(), decay.clone(), decay] };
        assert!((profile.length(0) / 44.0 - 1.0).abs() < 1e-3, "{}", profile.length(0));
    }
}
