//! Tissues of cells that differ.

use super::phases::Field;
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size, command};
use std::error::Error;
use voronudge_report::figure::ErrorPoint;

pub(super) const FIGURES: &[Figure] = &[Figure {
    name: "hexatic-spread",
    title: "hexatic order of cells that differ in chirality",
    stated: "the hexatic phase relies on all cells having the same α; as cells differ, it is unlikely to be seen in experiments",
    make: spread,
}];

/// Ψ₆ of tissues at the paper's hexatic points, with chiralities drawn about the same mean.
fn spread(size: Size) -> Result<Made, Box<dyn Error>> {
    let (rest, shares): (_, &[f64]) = size.pick(
        ("--cells 36 --time 1 --replicas 2", &[0.0, 0.5]),
        ("--cells 100 --time 200 --dt 0.001 --replicas 8 --seed 1", &[0.0, 0.1, 0.25, 0.5]),
    );
    let line = format!(
        "phase-diagram --P_0 3.3 3.7 2 --alpha 2 2 1 {rest} --quantities hexatic_order,mean_square_velocity"
    );
    let mut found: Vec<(f64, Vec<String>, Vec<ErrorPoint>)> = Vec::new();
    for &share in shares {
        // A spread of nothing is none.
        let output = command::run(&match share {
            0.0 => line.clone(),
            _ => format!("{line} --cell-spread alpha={share}"),
        })?;
        let of = |name: &str| -> Result<Vec<[f64; 2]>, Box<dyn Error>> {
            Ok(Field::read(&output, name)?.rows().flat_map(|(_, row)| row).collect())
        };
        let (orders, errors) = (of("hexatic_order")?, of("hexatic_order_error")?);
        let speeds = of("mean_square_velocity")?;
        for (k, (([perimeter, order], [_, error]), [_, square])) in
            orders.into_iter().zip(errors).zip(speeds).enumerate()
        {
            if found.len() == k {
                found.push((perimeter, Vec::new(), Vec::new()));
            }
            found[k].1.push(format!("{order:.3} ± {error:.3} (⟨v²⟩ = {square:.2}) at {share}"));
            found[k].2.push(ErrorPoint { at: [share, order], error: [None, Some(error)] });
        }
    }
    let series: Vec<Series> = found
        .iter()
        .map(|(perimeter, _, points)| Series {
            name: format!("P_0 = {perimeter}"),
            drawn: Drawn::JoinedMarks,
            points: points.clone(),
        })
        .collect();
    let labels = ["standard deviation of α, as a share of the mean", "Ψ₆"];
    Ok(Made {
        settings: format!("`voronudge {line}`, and with `--cell-spread alpha=…`; means and standard errors"),
        found: found
            .iter()
            .map(|(perimeter, words, _)| {
                format!(
                    "P₀ = {perimeter}: Ψ₆ is, for standard deviations of α as shares of the mean, {}.",
                    words.join(", ")
                )
            })
            .collect(),
        panels: vec![Panel {
            name: "",
            caption: "Hexatic order against the spread of chirality".into(),
            svg: super::chart("hexatic order", labels, EVEN, &series),
        }],
    })
}
