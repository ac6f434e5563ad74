//! Tissues of cells that differ.

use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size, command};
use crate::study::{Replicas, mean};
use ndarray::Array1;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use voronudge_io::OutputDirectory;
use voronudge_report::figure::ErrorPoint;
use voronudge_simulate::generator;

pub(super) const FIGURES: &[Figure] = &[Figure {
    name: "hexatic-spread",
    title: "hexatic order of cells that differ in chirality",
    stated: "the hexatic phase relies on all cells having the same α; as cells differ, it is unlikely to be seen in experiments",
    make: spread,
}];

/// Ψ₆ of tissues at the paper's hexatic points, with chiralities drawn about the same mean.
fn spread(size: Size) -> Result<Made, Box<dyn Error>> {
    let (cells, rest, count, spreads): (_, _, _, &[f64]) = size.pick(
        (36, "--time 1 --dt 0.004", 2, &[0.0, 1.0]),
        (100, "--time 200 --dt 0.001", 8, &[0.0, 0.2, 0.5, 1.0, 2.0]),
    );
    let alpha = 2.0;
    let (mut series, mut found) = (Vec::new(), Vec::new());
    let folder = tempfile::tempdir()?;
    for preferred in [3.3, 3.7] {
        let mut orders = Vec::new();
        let mut speeds = Vec::new();
        for &spread in spreads {
            let (mut own, mut squares) = (Vec::new(), Vec::new());
            for seed in (Replicas { seed: 1, count }).seeds() {
                let mut random = generator(seed);
                let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
                let values = Array1::from_shape_simple_fn(cells, || alpha + spread * draw());
                let mut out = OutputDirectory::create(folder.path())?;
                out.write_array("alpha.npy", values.view())?;
                out.commit()?;
                let file = folder.path().join("alpha.npy");
                let output = command::run(&format!(
                    "simulate --cells {cells} --P_0 {preferred} --cell-parameter alpha={} {rest} --seed {seed}",
                    file.display()
                ))?;
                let report = output.report()?;
                let number = |name: &str| report[name].as_f64().unwrap_or(f64::NAN);
                own.push(number("hexatic_order"));
                squares.push(number("mean_square_velocity"));
            }
            orders.push((spread, mean(&own)));
            speeds.push(squares.iter().filter(|square| **square > 1e-12).count());
        }
        let words = orders.iter().zip(&speeds).map(|((spread, (value, error)), moving)| {
            format!("{value:.2} ± {error:.2} ({moving} of {count} flow) at {spread}")
        });
        found.push(format!(
            "P₀ = {preferred}: Ψ₆ is, for standard deviations of α, {}.",
            words.collect::<Vec<_>>().join(", ")
        ));
        let point = |(spread, (value, error)): (f64, (f64, f64))| ErrorPoint {
            at: [spread, value],
            error: [None, Some(error)],
        };
        series.push(Series {
            name: format!("P_0 = {preferred}"),
            drawn: Drawn::JoinedMarks,
            points: orders.into_iter().map(point).collect(),
        });
    }
    let labels = ["standard deviation of α (mean 2)", "Ψ₆"];
    Ok(Made {
        settings: format!(
            "`voronudge simulate --cells {cells} --P_0 … --cell-parameter alpha=FILE {rest}`, α of each cell drawn from a normal distribution of mean {alpha}, {count} \
             tissues each, means and standard errors"
        ),
        found,
        panels: vec![Panel {
            name: "",
            caption: "Hexatic order against the spread of chirality".into(),
            svg: super::chart("hexatic order", labels, EVEN, &series),
        }],
    })
}
