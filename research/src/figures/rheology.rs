//! The response to strains that oscillate, and to slow ones: storage and loss moduli, and the yield of solids.

use super::{Drawn, Figure, Made, Panel, Series, Size, command};
use serde_json::Value;
use std::error::Error;
use voronudge_report::chart::AxisScale;
use voronudge_report::figure::ErrorPoint;
use voronudge_report::numbers::significant;

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "moduli-a-f",
        title: "elastic moduli against chirality",
        stated: "at P₀ = 3.0 μ, Kᵒ, B and A are those of the mean field; at 3.7 both shear moduli vanish at large |α|; at 4.0 they vanish for any α; A and B are finite \
                 for all α ≠ 0, A large in the liquid",
        make: against_chirality,
    },
    Figure {
        name: "dynamic-moduli",
        title: "storage and loss moduli of a solid and of a liquid",
        stated: "iω𝒜(ω) = G′(ω) + iG″(ω) with odd parts; at low frequencies a solid is elasticity and viscosity in parallel (Kelvin–Voigt) and a liquid \
                 is both in series (Maxwell); no G′, G″ are shown",
        make: oscillating,
    },
    Figure {
        name: "moduli-g",
        title: "viscosities measured in solids",
        stated: "in the chiral solid η and ηᵒ diverge in the measurement, due to the yield stress",
        make: yielding,
    },
    Figure {
        name: "table-1",
        title: "moduli and viscosities of the inferred tissues",
        stated: "B, A, μ, Kᵒ in K_P and η, ηᵒ: HT1080 2.2, −7.1, 0, 0, −0.1, −0.09; HBEC at the start 3.6, 1.0, 0, 0, −0.02, 0.05, at the end 0, 0, 0, 0, 0.07, 0; \
                 C2C12 myoblasts 0, 0, 0, 0, 0.07, 0",
        make: table,
    },
];

/// The rows of Table 1: the tissue, P₀, α, and what is printed for B, A, μ, Kᵒ, η, ηᵒ.
const TISSUES: [(&str, f64, f64, [f64; 6]); 4] = [
    ("HT1080", 4.0, 2.9, [2.2, -7.1, 0.0, 0.0, -0.1, -0.09]),
    ("HBEC at the start", 4.5, -0.8, [3.6, 1.0, 0.0, 0.0, -0.02, 0.05]),
    ("HBEC at the end", 4.0, 0.0, [0.0, 0.0, 0.0, 0.0, 0.07, 0.0]),
    ("C2C12", 3.9, 0.0, [0.0, 0.0, 0.0, 0.0, 0.07, 0.0]),
];

fn table(size: Size) -> Result<Made, Box<dyn Error>> {
    let rest = size.pick(
        "--K_A 0 --cells 16 --replicas 2 --time 1 --transient 0.2 --average 0.5 --viscosity --period 2 --periods 1 --dt 0.02",
        "--K_A 0 --cells 100 --replicas 8 --time 100 --viscosity --periods 6",
    );
    let mut found = Vec::new();
    let mut series = Vec::new();
    for (tissue, preferred, alpha, printed) in TISSUES {
        let report = command::run(&format!("moduli --P_0 {preferred} --alpha {alpha} {rest}"))?.report()?;
        let records =
            ["moduli", "viscosities"].map(|name| report[name].as_array().cloned().unwrap_or_default());
        let records: Vec<Value> = records.into_iter().flatten().collect();
        let words = records.iter().zip(printed).map(|(record, printed)| {
            let (value, error) = estimate(record);
            let symbol = record["symbol"].as_str().unwrap_or_default();
            // Minus zero is zero.
            format!("{symbol} {:.3} ± {error:.3} ({printed})", (1e3 * value).round() / 1e3 + 0.0)
        });
        found.push(format!(
            "{tissue}, P₀ = {preferred}, α = {alpha}, and in brackets what is printed: {}.",
            words.collect::<Vec<_>>().join(", ")
        ));
        let points = records.iter().zip(printed).map(|(record, printed)| {
            let (value, error) = estimate(record);
            ErrorPoint { at: [printed, value], error: [None, Some(error)] }
        });
        series.push(Series { name: tissue.into(), drawn: Drawn::Marks, points: points.collect() });
    }
    let line = [-8.0, 4.0].map(|x| ErrorPoint::from([x, x]));
    series.push(Series { name: "as printed".into(), drawn: Drawn::BrokenLine, points: line.into() });
    let labels = ["printed", "measured here"];
    Ok(Made {
        settings: format!(
            "`voronudge moduli --P_0 … --alpha … {rest}`, means and standard errors over tissues"
        ),
        found,
        panels: vec![Panel {
            name: "",
            caption: "Moduli (K_P) and viscosities (friction) of Table 1, as printed and as measured here"
                .into(),
            svg: super::chart("Table 1", labels, super::EVEN, &series),
        }],
    })
}

fn number(report: &Value, pointer: &str) -> f64 {
    report.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

fn estimate(value: &Value) -> (f64, f64) {
    (number(value, "/value"), number(value, "/error"))
}

fn against_chirality(size: Size) -> Result<Made, Box<dyn Error>> {
    let (rest, chiralities): (_, &[f64]) = size.pick(
        ("--cells 16 --replicas 2 --time 2 --transient 0.2 --average 0.5 --dt 0.02", &[0.0, 1.0]),
        ("--cells 100 --replicas 8 --time 200 --seed 1", &[0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0]),
    );
    let names = ["μ", "Kᵒ", "B", "A"];
    let order = [2, 3, 0, 1];
    let mut series: Vec<Vec<Series>> = names.iter().map(|_| Vec::new()).collect();
    let mut found = Vec::new();
    for preferred in [3.0, 3.7, 4.0] {
        let mut points = [const { Vec::new() }; 4];
        let mut theory = [const { Vec::new() }; 4];
        let mut told = Vec::new();
        for &alpha in chiralities {
            let report =
                command::run(&format!("moduli --P_0 {preferred} --alpha {alpha} {rest}"))?.report()?;
            let replicas = report["replicas"].as_array().cloned().unwrap_or_default();
            let flowing = replicas.iter().filter(|own| own["motion"] == "flowing").count();
            let mut words = Vec::new();
            for (k, which) in order.into_iter().enumerate() {
                let record = &report["moduli"][which];
                let (value, error) = estimate(record);
                points[k].push(ErrorPoint { at: [alpha, value], error: [None, Some(error)] });
                theory[k].push(ErrorPoint::from([alpha, number(record, "/mean_field")]));
                words.push(format!("{} {:.2} ± {error:.2}", names[k], (1e2 * value).round() / 1e2 + 0.0));
            }
            if [0.0, 1.0, 3.0].contains(&alpha) {
                told.push(format!(
                    "{} at α = {alpha} ({flowing} of {} flow)",
                    words.join(", "),
                    replicas.len()
                ));
            }
        }
        found.push(format!("P₀ = {preferred}: {}.", told.join("; ")));
        for (k, (points, theory)) in points.into_iter().zip(theory).enumerate() {
            let name = format!("P_0 = {preferred}");
            series[k].push(Series { name, drawn: Drawn::JoinedMarks, points });
            if preferred < 3.5 {
                let name = "mean field, P_0 = 3".into();
                series[k].push(Series { name, drawn: Drawn::BrokenLine, points: theory });
            }
        }
    }
    let panels = series.iter().zip(names).zip(["mu", "ko", "b", "a"]).map(|((series, symbol), name)| Panel {
        name,
        caption: format!("{symbol} against chirality"),
        svg: super::chart(symbol, ["α", &format!("{symbol} / K_P")], super::EVEN, series),
    });
    Ok(Made {
        settings: format!(
            "`voronudge moduli --P_0 … --alpha … {rest}`, means and standard errors over tissues"
        ),
        found,
        panels: panels.collect(),
    })
}

fn oscillating(size: Size) -> Result<Made, Box<dyn Error>> {
    let (solid, liquid) = size.pick(
        ("--cells 16 --replicas 2 --P_0 3 --alpha 0.5 --frequencies 0.01 1 100".to_owned(), LIQUID_QUICK.to_owned()),
        (
            format!("--cells 100 --replicas 20 --P_0 3 --alpha 0.5 --frequencies {}", spaced(-3, 3, 3)),
            format!(
                "--cells 100 --replicas 8 --P_0 4 --alpha 1 --time 1 --transient 0.1 --average 30 --frequencies {}",
                spaced(-1, 2, 3)
            ),
        ),
    );
    let (mut found, mut panels) = (Vec::new(), Vec::new());
    for (name, what, settings) in [("solid", "a solid", &solid), ("liquid", "a liquid", &liquid)] {
        let report = command::run(&format!("moduli {settings}"))?.report()?;
        let records = report["dynamic"].as_array().ok_or("no moduli")?;
        let mut series = Vec::new();
        let mut at_ends = Vec::new();
        for (modulus, symbol) in [("shear", "μ"), ("odd_shear", "Kᵒ")] {
            for (part, mark) in [("storage", "′"), ("loss", "″")] {
                let points: Vec<ErrorPoint> = records
                    .iter()
                    .filter_map(|own| {
                        let moduli = own["moduli"].as_array()?;
                        let (value, error) = estimate(&moduli.iter().find(|m| m["name"] == modulus)?[part]);
                        Some(ErrorPoint {
                            at: [own["frequency"].as_f64()?, value],
                            error: [None, Some(error)],
                        })
                    })
                    .collect();
                if let [first, .., last] = points.as_slice() {
                    let words = |point: &ErrorPoint| {
                        format!("{:.3} ± {:.3}", point.at[1], point.error[1].unwrap_or(f64::NAN))
                    };
                    at_ends.push(format!("{symbol}{mark} from {} to {}", words(first), words(last)));
                }
                series.push(Series { name: format!("{symbol}{mark}"), drawn: Drawn::JoinedMarks, points });
            }
        }
        let media: Vec<String> = (report["media"].as_array().into_iter().flatten())
            .map(|own| {
                let pair = |name: &str| [0, 1].map(|k| significant(number(own, &format!("/{name}/{k}")), 2));
                let ([mu, odd], [eta, odd_eta]) = (pair("elasticity"), pair("viscosity"));
                let arrangement = if own["arrangement"] == "maxwell" { "Maxwell" } else { "Kelvin–Voigt" };
                format!(
                    "{arrangement} (μ {mu}, Kᵒ {odd}, η {eta}, ηᵒ {odd_eta}) misses by {:.0} %",
                    100.0 * number(own, "/missed")
                )
            })
            .collect();
        found.push(format!("In {what}: {}; {}.", at_ends.join(", "), media.join(", ")));
        panels.push(Panel {
            name,
            caption: format!("Storage (′) and loss (″) moduli of {what}, `moduli {settings}`"),
            svg: super::chart(
                &format!("storage and loss moduli of {what}"),
                ["angular frequency ω (K_P)", "μ*, Kᵒ* / K_P"],
                [AxisScale::Logarithmic, AxisScale::Linear],
                &series,
            ),
        });
    }
    Ok(Made {
        settings: format!("`voronudge moduli {solid}` and `voronudge moduli {liquid}`"),
        found,
        panels,
    })
}

const LIQUID_QUICK: &str = "--cells 16 --replicas 2 --P_0 4 --alpha 1 --time 1 --transient 0.1 --average 1 --frequencies 10 30 --dt 0.02";

/// Frequencies from 10^from to 10^to, so many for each power of ten.
fn spaced(from: i32, to: i32, each: i32) -> String {
    let all =
        (from * each..=to * each).map(|k| format!("{:.3e}", 10f64.powf(f64::from(k) / f64::from(each))));
    all.collect::<Vec<_>>().join(" ")
}

/// The stress of solids that are sheared back and forth by one, at several rates, and what their linear response says.
fn yielding(size: Size) -> Result<Made, Box<dyn Error>> {
    let (cells, replicas, rates): (_, _, &[f64]) =
        size.pick((16, 2, &[0.1, 0.4]), (100, 8, &[0.005, 0.01, 0.02, 0.05, 0.1, 0.2]));
    let (mut series, mut found) = (Vec::new(), Vec::new());
    for (alpha, preferred) in [(0.0, 3.0), (0.5, 3.0), (0.0, 4.0)] {
        let mut points = [Vec::new(), Vec::new()];
        for &rate in rates {
            // The response to slow strains of a tissue that does not come to rest would take as long as these.
            let slow = if rate == rates[0] && preferred < 3.5 {
                "--time 2000 --frequencies 1e-4"
            } else {
                "--time 1"
            };
            let settings = format!(
                "moduli --cells {cells} --replicas {replicas} --P_0 {preferred} --alpha {alpha} --transient 0.1 --average 0.1 \
                 --viscosity --rate {rate} --period {} --periods 2 --dt 0.02 {slow}",
                2.0 / rate
            );
            let report = command::run(&settings)?.report()?;
            for (k, points) in points.iter_mut().enumerate() {
                let (value, error) = estimate(&report["viscosities"][k]);
                points.push(ErrorPoint { at: [rate, value * rate], error: [None, Some(error * rate)] });
            }
            if rate == rates[0] && preferred < 3.5 {
                let loss = |name: &str| {
                    let moduli = report["dynamic"][0]["moduli"].as_array().cloned().unwrap_or_default();
                    let own = moduli.iter().find(|m| m["name"] == name).map(|m| estimate(&m["loss"]));
                    let (value, error) = own.unwrap_or((f64::NAN, f64::NAN));
                    format!("{:.3} ± {:.3}", value / 1e-4, error / 1e-4)
                };
                found.push(format!(
                    "The linear response of solids at P₀ = {preferred}, α = {alpha} has η = {} and ηᵒ = {} for ω → 0.",
                    loss("shear"),
                    loss("odd_shear")
                ));
            }
        }
        let [shear, odd] = points;
        let words = |points: &[ErrorPoint]| {
            let own = points.iter().map(|point| {
                format!("{:.3} ± {:.3} at {}", point.at[1], point.error[1].unwrap_or(f64::NAN), point.at[0])
            });
            own.collect::<Vec<_>>().join(", ")
        };
        found.push(format!(
            "P₀ = {preferred}, α = {alpha}: the shear stress η ε̇ is {}; ηᵒ ε̇ is {}.",
            words(&shear),
            words(&odd)
        ));
        series.push(Series {
            name: format!("P_0 = {preferred}, α = {alpha}"),
            drawn: Drawn::JoinedMarks,
            points: shear,
        });
    }
    let svg = super::chart(
        "stress of tissues sheared back and forth",
        ["rate of shear ε̇ (K_P)", "shear stress η ε̇ (K_P)"],
        [AxisScale::Logarithmic, AxisScale::Linear],
        &series,
    );
    Ok(Made {
        settings: format!(
            "{cells} cells, {replicas} tissues each, `voronudge moduli --viscosity --rate ε̇ --period 2/ε̇`, so that the strain goes from 0 to 1 and back"
        ),
        found,
        panels: vec![Panel { name: "", caption: "Mean shear stress against the rate".into(), svg }],
    })
}
