//! Phases over preferred perimeter and chirality.

use super::command::{self, Output};
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size};
use crate::study::mean;
use ndarray::{ArrayD, Axis};
use std::error::Error;
use voronudge_io::read_reals;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{ErrorPoint, LineStyle, MapLine, PhaseMap, phase_map};
use voronudge_simulate::collapse::critical_perimeter;
use voronudge_theory::{MeanField, Orientation, Parameters, hexagon_perimeter};

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "m1a",
        title: "phases of the honeycomb in mean-field theory",
        stated: "a stable solid below P₀ = P_MF and an unstable phase above it; a line of exceptional points, where odd waves begin",
        make: mean_field,
    },
    Figure {
        name: "2a-m1dg",
        title: "mean square velocity and hexatic order",
        stated: "velocities vanish in the solid and set in at P₀* = 3.81 − |α|; at α = 0 solid and liquid are both at rest; solids of \
                 strong chirality are hexatic (Ψ₆ > 0.7), with hexatic liquids beside them",
        make: velocities,
    },
    Figure {
        name: "m1e",
        title: "scaling of the velocity about the transition",
        stated: "⟨v²⟩ collapses on one function of |α|/|ΔP₀|^φ with φ = 4 and β = 3",
        make: collapse,
    },
    Figure {
        name: "m1f",
        title: "the largest Lyapunov exponent",
        stated: "λ is negative in the solid, positive in the chiral liquid (chaos), and approaches zero in the liquid at α = 0",
        make: lyapunov,
    },
    Figure {
        name: "m1c",
        title: "frequencies of the modes",
        stated: "odd waves set in at a line defined by ⟨ω²⟩ = 40",
        make: frequencies,
    },
    Figure {
        name: "m1h",
        title: "tissues of four phases",
        stated: "hexatic solid, hexatic liquid, disordered solid, disordered liquid",
        make: phases,
    },
];

/// A quantity of a phase diagram, and its axes.
pub(super) struct Field {
    pub preferred_perimeters: Vec<f64>,
    pub chiralities: Vec<f64>,
    values: ArrayD<f64>,
}

impl Field {
    pub fn read(output: &Output, name: &str) -> Result<Self, Box<dyn Error>> {
        let read = |name: &str| read_reals(&output.path().join(format!("{name}.npy")));
        let axis =
            |name: &str| -> Result<Vec<f64>, Box<dyn Error>> { Ok(read(name)?.iter().copied().collect()) };
        Ok(Self { preferred_perimeters: axis("P_0")?, chiralities: axis("alpha")?, values: read(name)? })
    }

    /// `(P_0, value)` for each chirality.
    pub fn rows(&self) -> impl Iterator<Item = (f64, Vec<[f64; 2]>)> {
        let row = |row: ndarray::ArrayViewD<'_, f64>| -> Vec<[f64; 2]> {
            self.preferred_perimeters.iter().zip(row.iter()).map(|(&p, &value)| [p, value]).collect()
        };
        self.chiralities.iter().zip(self.values.axis_iter(Axis(0)).map(row)).map(|(&alpha, row)| (alpha, row))
    }
}

/// Where a row first rises above a level, by linear interpolation of `transform`ed values.
fn crossing(row: &[[f64; 2]], level: f64, transform: fn(f64) -> f64) -> Option<f64> {
    row.windows(2).find(|pair| pair[0][1] <= level && pair[1][1] > level).map(|pair| {
        let [a, b, t] = [transform(pair[0][1]), transform(pair[1][1]), transform(level)];
        pair[0][0] + (pair[1][0] - pair[0][0]) * (t - a) / (b - a)
    })
}

fn mean_field(_: Size) -> Result<Made, Box<dyn Error>> {
    let spread = |low: f64, high: f64, count: usize| -> Vec<f64> {
        (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
    };
    let (perimeters, chiralities) = (spread(3.0, 4.2, 49), spread(0.0, 0.4, 41));
    let mut values = Vec::new();
    for &chirality in &chiralities {
        for &preferred_perimeter in &perimeters {
            let theory =
                MeanField::new(Parameters { preferred_perimeter, chirality, ..Parameters::default() })?;
            let q = theory.critical_wave_vector(Orientation::NeighbourAlongY);
            let rates = theory.decay_rates(q, Orientation::NeighbourAlongY)?;
            values.push(rates[0].imaginary.abs());
        }
    }
    let limit = hexagon_perimeter();
    let exceptional = |&p: &f64| -> Result<[f64; 2], Box<dyn Error>> {
        let theory = MeanField::new(Parameters { preferred_perimeter: p, ..Parameters::default() })?;
        Ok([p, theory.exceptional_chirality()])
    };
    let lines = [
        MapLine {
            label: "limit of stability P_{MF}".into(),
            points: vec![[limit, 0.0], [limit, 0.4]],
            style: LineStyle::Solid,
        },
        MapLine {
            label: "exceptional line".into(),
            points: perimeters.iter().map(exceptional).collect::<Result<_, _>>()?,
            style: LineStyle::Dashed,
        },
    ];
    let svg = phase_map(&PhaseMap {
        title: "frequency of the critical mode",
        label: "|ω| of the mode at q* (K_P)",
        x: ("P_0 / ℓ_0", &perimeters),
        y: ("α", &chiralities),
        values: &values,
        scale: AxisScale::Linear,
        palette: Palette::Sequential,
        lines: &lines,
    });
    Ok(Made {
        settings: "closed form, K_A = 0".into(),
        found: vec![format!(
            "The mode at q* is stable below P_MF = {limit:.4} for every α and oscillates above |α| = |P_MF − P₀|/(√3 P_MF), the dashed \
             line: as the paper prints them."
        )],
        panels: vec![Panel { name: "", caption: "Frequency of the critical mode".into(), svg }],
    })
}

fn velocities(size: Size) -> Result<Made, Box<dyn Error>> {
    let output = command::run(size.pick(
        "phase-diagram --P_0 3 4.2 3 --alpha 0 1 2 --cells 36 --time 4 --dt 0.02",
        "phase-diagram --P_0 3 4.2 16 --alpha 0 3 16",
    ))?;
    let fine = command::run(size.pick(
        "phase-diagram --P_0 3.4 4 3 --alpha 0.05 0.2 2 --cells 36 --time 4 --quantities mean_square_velocity",
        "phase-diagram --P_0 3.4 4 13 --alpha 0.05 0.3 6 --time 300 --dt 0.02 --quantities mean_square_velocity",
    ))?;
    let onsets: Vec<String> = Field::read(&fine, "mean_square_velocity")?
        .rows()
        .filter_map(|(alpha, row)| {
            let onset = crossing(&row, 1e-3, |v| v.max(1e-12).ln())?;
            Some(format!("{onset:.2} at α = {alpha} (line: {:.2})", critical_perimeter(alpha)))
        })
        .collect();
    let order = Field::read(&output, "hexatic_order")?;
    let hexatic = order.values.iter().filter(|value| **value > 0.7).count();
    let speeds = Field::read(&output, "mean_square_velocity")?;
    let both = order.values.iter().zip(&speeds.values);
    let solid = both.filter(|(order, speed)| **order > 0.7 && **speed < 1e-6).count();
    let largest = order.values.iter().copied().fold(0.0, f64::max);
    Ok(Made {
        settings: format!("{} and {}", output.typed, fine.typed),
        found: vec![
            format!("⟨v²⟩ rises above 10⁻³ at P₀ = {}.", onsets.join(", ")),
            format!(
                "{hexatic} of {} points have Ψ₆ > 0.7, {solid} of them at rest (⟨v²⟩ < 10⁻⁶); the largest is {largest:.2}.",
                order.values.len()
            ),
        ],
        panels: vec![
            output.panel("velocity", "Mean square velocity in the steady state", "mean square velocity")?,
            output.panel("order", "Hexatic order Ψ₆", "hexatic order")?,
            fine.panel(
                "onset",
                "Mean square velocity near the transition, small chirality",
                "mean square velocity",
            )?,
        ],
    })
}

fn collapse(size: Size) -> Result<Made, Box<dyn Error>> {
    let (small, large) = size.pick(
        (
            "--P_0 3.6 4.2 4 --alpha 0.04 0.2 3 --cells 36 --time 20",
            "--P_0 3.6 4.2 4 --alpha 0.04 0.2 3 --cells 49 --time 10",
        ),
        (
            "--P_0 3.5 4.3 17 --alpha 0.04 0.2 5 --time 200 --dt 0.02",
            "--P_0 3.5 4.3 9 --alpha 0.05 0.2 4 --cells 10000 --time 200 --dt 0.02",
        ),
    );
    let (mut found, mut panels, mut typed) = (Vec::new(), Vec::new(), Vec::new());
    for (name, cells, settings) in
        [("", "100 cells", small), ("large", "10⁴ cells, as in the paper (W = 100 ℓ₀)", large)]
    {
        let output = command::run(&format!("phase-diagram {settings} --quantities mean_square_velocity"))?;
        let report = output.report()?;
        let record = &report["collapse"];
        let number = |value: &serde_json::Value| value.as_f64().map_or("–".into(), |x| format!("{x:.2}"));
        let exponent = |name: &str| {
            let own = &record["fitted"][name];
            let [value, low, high] = [&own["value"], &own["interval"][0], &own["interval"][1]].map(number);
            format!("{value} ({low} to {high})")
        };
        found.push(if record.is_null() {
            format!("{cells}: no collapse: {}.", report["no_collapse"].as_str().unwrap_or("too few points"))
        } else {
            format!(
                "{cells}: the fitted exponents are β = {} and φ = {} (95 % intervals over chiralities drawn again). The scatter about one curve is {} with \
                 them and {} with the paper's.",
                exponent("beta"),
                exponent("phi"),
                number(&record["fitted"]["scatter"]),
                number(&record["given"]["scatter"])
            )
        });
        let title = if record.is_null() { "mean square velocity" } else { "collapse" };
        panels.push(output.panel(name, &format!("Scaled mean square velocities of {cells}"), title)?);
        typed.push(output.typed);
    }
    Ok(Made { settings: typed.join(" and "), found, panels })
}

/// Curves over P_0, one for each chirality, with errors where they are given, and what a theory says of them.
pub(super) fn over_perimeter(
    title: &str,
    label: &str,
    field: &Field,
    errors: Option<&Field>,
    theory: Vec<Series>,
) -> String {
    let series = |(row, (alpha, points)): (usize, (f64, Vec<[f64; 2]>))| Series {
        name: format!("α = {alpha}"),
        drawn: Drawn::JoinedMarks,
        points: (points.into_iter().enumerate())
            .map(|(column, at)| ErrorPoint {
                at,
                error: [None, errors.map(|errors| errors.values[[row, column]])],
            })
            .collect(),
    };
    let all: Vec<Series> = theory.into_iter().chain(field.rows().enumerate().map(series)).collect();
    super::chart(title, ["P_0 / ℓ_0", label], EVEN, &all)
}

fn lyapunov(size: Size) -> Result<Made, Box<dyn Error>> {
    let output = command::run(size.pick(
        "phase-diagram --P_0 3.2 4 2 --alpha 0 1 2 --cells 36 --time 4 --quantities lyapunov",
        "phase-diagram --P_0 3.3 4.1 9 --alpha 0 0.4 5 --time 100 --dt 0.02 --quantities lyapunov",
    ))?;
    let field = Field::read(&output, "lyapunov")?;
    let found: Vec<String> = field
        .rows()
        .map(|(alpha, row)| {
            let last = row.last().map_or(f64::NAN, |point| point[1]);
            let sign = crossing(&row, 0.0, |x| x);
            let place =
                sign.map_or("does not change sign".into(), |at| format!("changes sign at P₀ = {at:.2}"));
            format!("at α = {alpha} it {place} and ends at {last:.3}")
        })
        .collect();
    Ok(Made {
        settings: output.typed.clone(),
        found: vec![format!("λ/K_P: {}.", found.join("; "))],
        panels: vec![Panel {
            name: "",
            caption: "Largest Lyapunov exponent against preferred perimeter".into(),
            svg: over_perimeter("largest Lyapunov exponent", "λ / K_P", &field, None, Vec::new()),
        }],
    })
}

fn frequencies(size: Size) -> Result<Made, Box<dyn Error>> {
    let output = command::run(size.pick(
        "phase-diagram --P_0 3 3.6 2 --alpha 0.2 1 2 --cells 36 --time 4 --quantities mean_square_frequency",
        "phase-diagram --P_0 3 3.7 8 --alpha 0 1.2 13 --cells 64 --time 60 --dt 0.02 --quantities mean_square_frequency",
    ))?;
    let small = command::run(size.pick(
        "phase-diagram --P_0 3 3.6 2 --alpha 0.1 0.2 2 --cells 36 --time 4 --quantities mean_square_frequency",
        "phase-diagram --P_0 3 3.7 8 --alpha 0.02 0.16 8 --cells 100 --replicas 4 --time 60 --dt 0.02 --quantities mean_square_frequency",
    ))?;
    // Where a level is crossed as α grows, at each P_0, and the exceptional line there.
    let crossed = |output: &Output, level: f64| -> Result<Vec<[f64; 3]>, Box<dyn Error>> {
        let field = Field::read(output, "mean_square_frequency")?;
        let mut found = Vec::new();
        for (k, &p) in field.preferred_perimeters.iter().enumerate() {
            let column: Vec<[f64; 2]> =
                field.rows().filter_map(|(alpha, row)| Some([alpha, row.get(k)?[1]])).collect();
            let theory = MeanField::new(Parameters { preferred_perimeter: p, ..Parameters::default() })?;
            found.extend(crossing(&column, level, |x| x).map(|at| [p, at, theory.exceptional_chirality()]));
        }
        Ok(found)
    };
    let high: Vec<String> =
        crossed(&output, 40.0)?.iter().map(|[p, alpha, _]| format!("{alpha:.2} at P₀ = {p}")).collect();
    let low: Vec<String> = (crossed(&small, 0.2)?.iter())
        .map(|[p, alpha, theory]| format!("{alpha:.3} at P₀ = {p} ({theory:.3})"))
        .collect();
    Ok(Made {
        settings: format!("{} and {}", output.typed, small.typed),
        found: vec![
            format!(
                "⟨ω²⟩ = 40 is crossed at α = {}: at nearly the same chirality for every P₀, while the exceptional line of the theory falls \
                 to zero at P_MF.",
                high.join(", ")
            ),
            format!(
                "If the printed 40 were a sum over the 200 modes of 100 cells, the mean would be 0.2, which is crossed at α = {} (in brackets \
                 the exceptional line of the mode at q*): below the line of the theory for P₀ up to 3.2, above it beyond. Which it is the paper \
                 does not say. See [corrections](corrections.md) and [validation](validation/model.md#modes).",
                low.join(", ")
            ),
        ],
        panels: vec![output.panel("", "Mean square frequency of all modes", "mean square frequency")?],
    })
}

fn phases(size: Size) -> Result<Made, Box<dyn Error>> {
    let (rest, seeds) = size.pick(("--cells 36 --time 4 --dt 0.02", 2), ("--cells 100 --time 200", 8));
    let (mut panels, mut found) = (Vec::new(), Vec::new());
    for (name, expected, point) in [
        ("1", "hexatic solid", "--P_0 3.3 --alpha 2"),
        ("2", "hexatic liquid", "--P_0 3.7 --alpha 2"),
        ("3", "disordered solid", "--P_0 3.3 --alpha 0"),
        ("4", "disordered liquid", "--P_0 4 --alpha 1"),
    ] {
        let (mut squares, mut orders, mut moduli) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 1..=seeds {
            let output = command::run(&format!("simulate {point} {rest} --seed {seed}"))?;
            let report = output.report()?;
            let number = |name: &str| report[name].as_f64().unwrap_or(f64::NAN);
            let (square, order) = (number("mean_square_velocity"), number("hexatic_order"));
            squares.push(square);
            orders.push(order);
            moduli.push(number("hexatic_mean_modulus"));
            if seed == 1 {
                let caption =
                    format!("{point}, the paper's {expected}, seed 1: ⟨v²⟩ = {square:.1e}, Ψ₆ = {order:.2}");
                panels.push(output.panel(name, &caption, "shape index P/√A, the end of the run")?);
            }
        }
        let words = |(value, error): (f64, f64)| format!("{value:.2} ± {error:.2}");
        let fastest = squares.iter().copied().fold(0.0, f64::max);
        let motion =
            if fastest < 1e-12 { "at rest".into() } else { format!("⟨v²⟩ up to {fastest:.1e}") };
        found.push(format!(
            "{expected}, {point}: {motion}, Ψ₆ = {}, mean modulus {}, {} of {seeds} with Ψ₆ > 0.7",
            words(mean(&orders)),
            words(mean(&moduli)),
            orders.iter().filter(|order| **order > 0.7).count()
        ));
    }
    Ok(Made {
        settings: format!(
            "`voronudge simulate --P_0 … --alpha … {rest}`, seeds 1 to {seeds}; means and standard errors"
        ),
        found: vec![format!("{}.", found.join("; "))],
        panels,
    })
}
