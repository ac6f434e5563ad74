//! Flow across an artificial density gradient.

use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size};
use crate::study::Replicas;
use crate::study::pinching::{
    BOX_CHIRALITIES, Ratio, Snapshots, over_parameters, over_waves, ratios, tell_over_parameters,
    tell_over_waves,
};
use std::error::Error;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::ErrorPoint;

pub(super) const FIGURES: &[Figure] = &[Figure {
    name: "m4d",
    title: "flow across an artificial density gradient",
    stated: "v_y/v_x follows α/(3 − aP₀/ℓ₀), up to the sign, for 0.4 ≤ α ≤ 3.2 and 3 ≤ P₀ ≤ 4, in solids and liquids",
    make: pinching,
}];

fn pinching(size: Size) -> Result<Made, Box<dyn Error>> {
    let snapshots = size.pick(Snapshots { settle: 0.1, apart: 0.05, count: 2 }, Snapshots::USUAL);
    let replicas = Replicas { seed: 1, count: size.pick(2, 4) };
    let (mut points, mut liquids) = (over_parameters(), over_waves());
    if size == Size::Quick {
        points.iter_mut().chain(&mut liquids).for_each(|point| point.cells = 100);
        liquids.truncate(2);
    }
    let (rows, waves) = (ratios(&points, replicas, snapshots)?, ratios(&liquids, replicas, snapshots)?);
    tell_over_parameters(&rows);
    tell_over_waves(&waves);
    let shares = |rows: &[&Ratio]| {
        let shares = rows.iter().map(|row| row.simulated.0 / row.formulas[1]);
        let [low, high] = shares.fold([f64::INFINITY, 0.0f64], |[low, high], x| [low.min(x), high.max(x)]);
        format!("{low:.2} to {high:.2}")
    };
    let mut found = Vec::new();
    let mut series: Vec<Series> = (rows
        .chunk_by(|a, b| a.of.preferred_perimeter == b.of.preferred_perimeter))
    .map(|own| {
        let perimeter = own[0].of.preferred_perimeter;
        found.push(format!("{} of it at P₀ = {perimeter}", shares(&own.iter().collect::<Vec<_>>())));
        let points = own.iter().map(|row| ErrorPoint {
            at: [row.formulas[1], row.simulated.0],
            error: [None, Some(row.simulated.1)],
        });
        Series { name: format!("P_0 = {perimeter}"), drawn: Drawn::Marks, points: points.collect() }
    })
    .collect();
    let most = rows.iter().map(|row| row.formulas[1]).fold(0.0, f64::max);
    series.push(Series {
        name: "v_y/v_x = α/(3 − aP_0)".into(),
        drawn: Drawn::BrokenLine,
        points: vec![[0.0, 0.0].into(), [most, most].into()],
    });
    let by_formula =
        super::chart("flow across a density gradient", ["formula, with K_A", "v_y/v_x"], EVEN, &series);
    let mut boxes: Vec<usize> = waves.iter().map(|row| row.of.cells).collect();
    boxes.sort_unstable();
    boxes.dedup();
    let (mut told, mut series) = (Vec::new(), Vec::new());
    for cells in boxes {
        let own: Vec<&Ratio> = waves.iter().filter(|row| row.of.cells == cells).collect();
        let width = (cells as f64).sqrt();
        let single = own.iter().filter(|row| row.waves == 1);
        let words: Vec<String> = single
            .map(|row| {
                let [share, error] = [row.simulated.0, row.simulated.1].map(|x| x / row.formulas[1]);
                format!("{share:.2} ± {error:.2} (α = {})", row.of.chirality)
            })
            .collect();
        told.push(format!("{} for one wave in a box of {width}", words.join(", ")));
        for chirality in BOX_CHIRALITIES {
            let own = own.iter().filter(|row| row.of.chirality == chirality);
            let points: Vec<ErrorPoint> = own
                .map(|row| ErrorPoint {
                    at: [row.wave_number, row.simulated.0 / row.formulas[1]],
                    error: [None, Some(row.simulated.1 / row.formulas[1])],
                })
                .collect();
            if !points.is_empty() {
                let name = format!("α = {chirality}, box {width}");
                series.push(Series { name, drawn: Drawn::JoinedMarks, points });
            }
        }
    }
    let labels = ["q ℓ_0", "v_y/v_x over the formula"];
    let scales = [AxisScale::Logarithmic, AxisScale::Linear];
    let by_wave = super::chart("the same against the wave number", labels, scales, &series);
    Ok(Made {
        settings: format!(
            "400 cells, K_A = 0.1, {} tissues, {} snapshots of each from t = {} on; the liquid also with 100 and 1600 cells and up to four \
             waves; `cargo xtask study pinching --seeds {}` prints all, see [flows](validation/flows.md)",
            replicas.count, snapshots.count, snapshots.settle, replicas.count
        ),
        found: vec![
            format!("With K_A = 0.1 in the formula, simulated snapshots have {}.", found.join(", ")),
            format!("At P₀ = 4 the share is {}.", told.join("; ")),
        ],
        panels: vec![
            Panel { name: "", caption: "Ratio of velocities against the formula".into(), svg: by_formula },
            Panel {
                name: "waves",
                caption: "The liquid, P₀ = 4: ratio of velocities over the formula against the wave number"
                    .into(),
                svg: by_wave,
            },
        ],
    })
}
