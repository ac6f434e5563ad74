//! The loss over two parameters at the nudged positions of a fit.

use super::{Figure, Made, Panel, Size, command};
use serde_json::Value;
use std::error::Error;
use voronudge_report::figure::{Landscape, LandscapeAxis, landscape};
use voronudge_segmentation::{Edge, ExtremumKind, ExtremumSearch, extrema};

pub(super) const FIGURES: &[Figure] = &[Figure {
    name: "m0h",
    title: "slices of the loss at nudged positions",
    stated: "once the nudging is done, the nudged positions are fixed, the loss is calculated for varying parameters, and its minimum is \
             taken for the final parameters; slices for measured tissues are shown",
    make: slices,
}];

/// The data set of the figure, from the root.
const DATA: &str = "fixtures/chiral-liquid";

/// Rises that lines are drawn at: over P₀ and α, over K_P and K_P α, and those of 68 % and 95 % of two parameters.
const STEEP: [(f64, &str); 3] = [(100.0, "100"), (1000.0, "1000"), (10_000.0, "10⁴")];
const FLAT: [(f64, &str); 2] = [(10.0, "10"), (100.0, "100")];
const REGIONS: [(f64, &str); 2] = [(2.30, "68 %"), (5.99, "95 %")];

/// A parameter as the figure shows it.
struct Parameter {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
}

const PREFERRED_PERIMETER: Parameter = Parameter { name: "P_0", symbol: "P_0", unit: "ℓ_0" };
const CHIRALITY: Parameter = Parameter { name: "alpha", symbol: "α", unit: "" };
const PERIMETER_ELASTICITY: Parameter = Parameter { name: "K_P", symbol: "K_P", unit: "1/τ" };
const CHIRAL_COEFFICIENT: Parameter = Parameter { name: "K_P_alpha", symbol: "K_P α", unit: "1/τ" };

/// In these pairs velocities at fixed positions are linear, and the loss a quadratic.
const PAIRS: [[Parameter; 2]; 2] =
    [[PREFERRED_PERIMETER, CHIRALITY], [PERIMETER_ELASTICITY, CHIRAL_COEFFICIENT]];

/// Both slices over a pair of parameters.
struct Slices<'a> {
    pair: &'a [Parameter; 2],
    values: [Vec<f64>; 2],
    fixed: Vec<f64>,
    refitted: Vec<f64>,
    fit: [f64; 2],
    truth: [f64; 2],
}

impl<'a> Slices<'a> {
    fn read(
        pair: &'a [Parameter; 2],
        told: &Value,
        report: &Value,
        truth: &Value,
    ) -> Result<Self, Box<dyn Error>> {
        let known = |name: &str| match name {
            "K_P_alpha" => truth["K_P"].as_f64().zip(truth["alpha"].as_f64()).map(|(k, alpha)| k * alpha),
            name => truth[name].as_f64(),
        };
        let number = |value: Option<f64>| value.ok_or("a number of the fit is missing");
        let [x, y] = pair;
        Ok(Self {
            pair,
            values: serde_json::from_value(told["values"].clone())?,
            fixed: serde_json::from_value::<Vec<Vec<f64>>>(told["fixed"].clone())?.concat(),
            refitted: serde_json::from_value::<Vec<Vec<f64>>>(told["refitted"].clone())?.concat(),
            fit: [
                number(report["parameters"][x.name]["value"].as_f64())?,
                number(report["parameters"][y.name]["value"].as_f64())?,
            ],
            truth: [number(known(x.name))?, number(known(y.name))?],
        })
    }

    /// Where the slice at fixed nudges is least, between the points of the grid.
    fn minimum(&self) -> Result<[f64; 2], Box<dyn Error>> {
        let search = ExtremumSearch {
            kind: ExtremumKind::Minimum,
            smoothing: 0.0,
            prominence: 0.0,
            distance: 0.0,
            edge: Edge::Open,
        };
        let found = extrema(&self.fixed, self.values.each_ref().map(Vec::len), &search)?;
        let place = found.first().ok_or("the slice is least at its edge")?.position;
        let value = |values: &[f64], pixel: f64| {
            let step = (values[values.len() - 1] - values[0]) / (values.len() - 1) as f64;
            values[0] + (pixel - 0.5) * step
        };
        Ok([value(&self.values[0], place.x), value(&self.values[1], place.y)])
    }

    /// Rises at the point of the grid nearest to the truth: nudges fixed, everything fitted again.
    fn at_truth(&self) -> [f64; 2] {
        let nearest = |values: &[f64], at: f64| {
            let distance = |k: &usize| (values[*k] - at).abs();
            (0..values.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let [column, row] = [0, 1].map(|axis| nearest(&self.values[axis], self.truth[axis]));
        [&self.fixed, &self.refitted].map(|rise| rise[row * self.values[0].len() + column])
    }

    fn picture(&self, title: &str, rise: &[f64], contours: &[(f64, &str)]) -> String {
        let axis = |k: usize| LandscapeAxis {
            label: self.pair[k].symbol.into(),
            unit: self.pair[k].unit.into(),
            values: self.values[k].clone(),
        };
        landscape(&Landscape {
            title: title.into(),
            x: axis(0),
            y: axis(1),
            rise: rise.to_vec(),
            best: self.fit,
            truth: Some(self.truth),
            contours: contours.iter().map(|&(rise, label)| (rise, label.to_owned())).collect(),
        })
    }
}

fn slices(size: Size) -> Result<Made, Box<dyn Error>> {
    let asked = PAIRS.each_ref().map(|[x, y]| format!("--landscape {},{}", x.name, y.name)).join(" ");
    let points = size.pick(5, 41);
    let output = command::run(&format!("infer {DATA} --fix K_A=0.1 {asked} --points {points}"))?;
    let report = output.report()?;
    let truth: Value =
        serde_json::from_str(&std::fs::read_to_string(crate::root().join(DATA).join("truth.json"))?)?;
    let of = |k: usize| Slices::read(&PAIRS[k], &report["landscapes"][k], &report, &truth);
    let [shape, stiffness] = [of(0)?, of(1)?];
    let (mut sentences, mut farthest) = (Vec::new(), 0.0_f64);
    for slices in [&shape, &stiffness] {
        let minimum = slices.minimum()?;
        for (axis, parameter) in slices.pair.iter().enumerate() {
            let told = &report["parameters"][parameter.name]["ci95"];
            let [low, high] = [0, 1].map(|end| told[end].as_f64().unwrap_or(f64::NAN));
            farthest = farthest.max((minimum[axis] - slices.fit[axis]).abs() / (high - low));
            sentences.push(format!(
                "{} = {:.3} ({:.3}, {low:.2} to {high:.2}; {:.1})",
                plain(parameter.symbol),
                minimum[axis],
                slices.fit[axis],
                slices.truth[axis]
            ));
        }
    }
    let [steep, shallow] = shape.at_truth();
    Ok(Made {
        settings: format!(
            "{}: one of the bundled simulated snapshots, 100 cells with errors of 5 % of ℓ₀ in positions and 2 % in velocities, \
             seed {}; the paper's measured data are not public",
            output.typed, truth["seed"]
        ),
        found: vec![
            format!("The slices are least at (in brackets the fit, its 95 % interval; the truth) {}.", sentences.join(", ")),
            format!(
                "The minimum is the fit, to {} of the intervals, before what curvature does to estimates is taken off them: parameters and nudges are fitted together, so nothing is left to gain.",
                share(farthest)
            ),
            format!(
                "The rise beside the truth in P₀ and α is {steep:.0} with nudges fixed and {shallow:.1} with everything fitted again: \
                 the width of the paper's slices is not the error of the parameters."
            ),
        ],
        panels: vec![
            Panel {
                name: "shape",
                caption: "P₀ and α at the nudged positions, K_P as fitted: the fit (cross), which is the minimum, and the truth (circle)".into(),
                svg: shape.picture("loss at nudged positions", &shape.fixed, &STEEP),
            },
            Panel {
                name: "stiffness",
                caption: "K_P and K_P α at the nudged positions, P₀ as fitted".into(),
                svg: stiffness.picture("loss at nudged positions", &stiffness.fixed, &FLAT),
            },
            Panel {
                name: "refitted",
                caption: "For comparison, P₀ and α with K_P and the nudges fitted again at every point: the regions of 68 % and 95 %".into(),
                svg: shape.picture("everything fitted again", &shape.refitted, &REGIONS),
            },
        ],
    })
}

/// A symbol in running text.
fn plain(symbol: &str) -> String {
    symbol.replace("P_0", "P₀")
}

/// A small share, rounded up to a power of ten.
fn share(of: f64) -> String {
    format!("{:.0e}", 10f64.powf(of.max(1e-12).log10().ceil()))
}
