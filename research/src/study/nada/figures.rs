//! The study as figures.

use super::super::seeds::quartiles;
use super::{Outcomes, Row, Setting};
use crate::Outcome;
use std::path::Path;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::{MethodComparison, MethodSeries, method_comparison};

/// What is drawn: file, title, axis, scale, target, and the quantity.
struct Panel {
    file: &'static str,
    title: &'static str,
    axis: &'static str,
    scale: AxisScale,
    target: Option<(f64, &'static str)>,
    value: fn(&Outcomes, &Row) -> f64,
}

const PANELS: [Panel; 4] = [
    Panel {
        file: "chiral",
        title: "Error of K_P α",
        axis: "error of K_P α (%)",
        scale: AxisScale::Logarithmic,
        target: Some((3.0, "3 %")),
        value: |own, _| 100.0 * own.chiral,
    },
    Panel {
        file: "perimeter",
        title: "Error of P_0",
        axis: "error of P_0 (%)",
        scale: AxisScale::Logarithmic,
        target: None,
        value: |own, _| 100.0 * own.perimeter,
    },
    Panel {
        file: "edges",
        title: "Wrong contacts",
        axis: "wrong Delaunay edges",
        scale: AxisScale::Linear,
        target: None,
        value: |own, _| own.wrong_edges as f64,
    },
    Panel {
        file: "positions",
        title: "Error of the positions",
        axis: "position error (% of ℓ₀)",
        scale: AxisScale::Linear,
        target: None,
        value: |own, _| 100.0 * own.position_error,
    },
];

pub(super) fn write(settings: &[Setting], folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder)?;
    let mut cases: Vec<(usize, f64)> = settings.iter().map(|s| (s.cells, s.noise.velocity)).collect();
    cases.dedup();
    for (cells, velocity) in cases {
        let own: Vec<&Setting> =
            settings.iter().filter(|s| s.cells == cells && s.noise.velocity == velocity).collect();
        for panel in &PANELS {
            let series = |name: &str, method: fn(&Row) -> &Outcomes| MethodSeries {
                name: name.into(),
                points: own
                    .iter()
                    .map(|setting| {
                        let values = setting.rows.iter().map(|row| (panel.value)(method(row), row)).collect();
                        let [low, median, high] = quartiles(values);
                        (100.0 * setting.noise.position, median, [low, high])
                    })
                    .collect(),
            };
            let figure = method_comparison(&MethodComparison {
                title: format!("{}, N = {cells}, σ_v = {} %", panel.title, 100.0 * velocity),
                x_label: "position noise σ_r (% of ℓ₀)".into(),
                y_label: panel.axis.into(),
                y_scale: panel.scale,
                target: panel.target.map(|(value, label)| (value, label.into())),
                methods: vec![
                    series("least squares", |row| &row.naive),
                    series("first-order descent", |row| &row.paper),
                    series("search", |row| &row.ours),
                ],
            });
            let name = format!("nada-{}-{cells}-{}.svg", panel.file, (100.0 * velocity).round());
            std::fs::write(folder.join(name), figure)?;
        }
    }
    Ok(())
}
