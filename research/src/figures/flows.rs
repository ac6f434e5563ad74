//! Flows in a channel in which cells are extruded and born.

use super::command::{self, Output};
use super::decays;
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size};
use crate::study::Replicas;
use crate::study::flows::{AVERAGE, TRANSIENT, edge_currents, tell};
use std::error::Error;
use voronudge_io::read_flow_profile;
use voronudge_report::figure::ErrorPoint;

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "3cf-m5c",
        title: "HT1080 in a channel",
        stated: "cells converge from the edges and flow along them, with v_y/v_x = α/(3 − aP₀/ℓ₀) up to the sign (see the corrections); \
                 profiles decay over 35 to 44 µm; a birth on a vertex disturbs its neighbours much less than one beside a mother",
        make: ht1080,
    },
    Figure {
        name: "m5fg",
        title: "velocities across the channel for several chiralities",
        stated: "α does not affect v_x but dramatically changes v_y; P₀ = 3.0 and 4.0 do not differ qualitatively",
        make: chiralities,
    },
    Figure {
        name: "m4b",
        title: "edge currents at torque-free walls",
        stated: "in the solid edge currents appear only for |α| > √3 (P_MF − P₀)/(4 P_MF), in the liquid for any α; above the threshold v_E ∼ α",
        make: edge,
    },
];

/// α, and v_x and v_y over the distance from the edge.
type Profiles = (f64, [Vec<ErrorPoint>; 2]);

fn profiles(output: &Output) -> Result<[Vec<ErrorPoint>; 2], Box<dyn Error>> {
    let profile = read_flow_profile(&output.path().join("folded_profile.csv"))?;
    let component = |which: usize| -> Vec<ErrorPoint> {
        let places = profile.x.iter().zip(&profile.velocity[which]).enumerate();
        let error = |row: usize| profile.errors.as_ref().map(|errors| errors[which][row]);
        places.map(|(row, (&x, &v))| ErrorPoint { at: [x, v], error: [None, error(row)] }).collect()
    };
    Ok([component(0), component(1)])
}

fn ht1080(size: Size) -> Result<Made, Box<dyn Error>> {
    let output = command::run(size.pick(
        "channel --preset ht1080 --width 150 --length 150 --relaxation 2 --time 6 --samples 4 --dt 0.02",
        "channel --preset ht1080",
    ))?;
    let report = output.report()?;
    let number = |value: &serde_json::Value| value.as_f64().map_or("–".into(), |x| format!("{x:.3}"));
    let flow = &report["chirality_from_flow"];
    let lengths: Vec<String> = ["density", "velocity_x", "velocity_y"]
        .into_iter()
        .filter_map(|name| {
            let own = &report["decays"][name];
            let end =
                |end: usize| own["length_ci95"][end].as_f64().map_or("–".into(), |x| format!("{x:.0}"));
            Some(format!("{name} {:.0} µm ({} to {})", own["length"].as_f64()?, end(0), end(1)))
        })
        .collect();
    let widths = widths(size)?;
    let (protocols, [normalised, axis]) = decays::protocols(size)?;
    Ok(Made {
        settings: format!("{}; for the widths {}", output.typed, widths.settings),
        found: [
            format!(
                "v_y/v_x = {}, which says α = {} ({} to {}; put in: 2.9).",
                number(&flow["slope"]),
                number(&flow["alpha"]),
                number(&flow["alpha_ci95"][0]),
                number(&flow["alpha_ci95"][1])
            ),
            format!(
                "Decay lengths and 95 % intervals, fitted beyond the layer of births as a decay from both edges: {}.",
                lengths.join(", ")
            ),
        ]
        .into_iter()
        .chain(protocols)
        .chain([widths.found])
        .collect(),
        panels: vec![
            output.panel("density", "Density", "density across the channel")?,
            output.panel("velocity", "Velocities, with the continuum theory", "velocities")?,
            normalised,
            axis,
            output.panel("rates", "Births and extrusions", "births and extrusions")?,
            output.panel("ratio", "v_y against v_x", "v_y against v_x")?,
            widths.panel,
            output.panel(
                "drive",
                "What flows along the channel between a distance and the middle, and what drives it: shear stress, and the torques of the cells alone",
                "what drives the flow along the channel",
            )?,
            output.panel(
                "births",
                "How much a birth changes velocities nearby, on a vertex and beside a mother",
                "disturbance by a birth",
            )?,
        ],
    })
}

/// Channels of several widths.
struct Widths {
    settings: String,
    found: String,
    panel: Panel,
}

fn widths(size: Size) -> Result<Widths, Box<dyn Error>> {
    let all: &[usize] = size.pick(&[100, 150], &[100, 200, 300, 500]);
    let rest = size.pick(" --length 100 --relaxation 2 --time 6 --samples 4 --dt 0.02", "");
    let (mut series, mut slopes, mut theory) = (Vec::new(), Vec::new(), f64::NAN);
    let mut fastest = 0.0_f64;
    for &width in all {
        // Strips of half a cell.
        let bins = (2 * width).div_ceil(25);
        let bins = bins + bins % 2;
        let run = command::run(&format!("channel --preset ht1080 --width {width} --bins {bins}{rest}"))?;
        let report = run.report()?;
        let flow = &report["chirality_from_flow"];
        theory = report["continuum"]["ratio"].as_f64().unwrap_or(theory);
        let number = |value: &serde_json::Value| value.as_f64().map_or("–".into(), |x| format!("{x:.2}"));
        let [low, high] = [0, 1].map(|end| number(&flow["slope_ci95"][end]));
        slopes.push(format!("{width} µm {} ({low} to {high})", number(&flow["slope"])));
        let points = against_each_other(&run, flow["range"][0].as_f64().unwrap_or(0.0))?;
        fastest = points.iter().map(|point| point.at[0]).fold(fastest, f64::max);
        series.push(Series { name: format!("W = {width} µm"), drawn: Drawn::JoinedMarks, points });
    }
    series.push(Series {
        name: "α/(3 − a P_0/ℓ_0)".into(),
        drawn: Drawn::BrokenLine,
        points: vec![[0.0, 0.0].into(), [1.1 * fastest, 1.1 * fastest * theory].into()],
    });
    let labels = ["v_x, towards the middle (µm/h)", "v_y, along the edge (µm/h)"];
    let svg = super::chart("several widths", labels, EVEN, &series);
    Ok(Widths {
        settings: format!(
            "`voronudge channel --preset ht1080 --width W{rest}`, W = {} µm",
            all.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
        ),
        found: format!("v_y/v_x for the widths: {}; theory {theory:.2}.", slopes.join(", ")),
        panel: Panel {
            name: "widths",
            caption: "v_y against v_x of the edge flow for several widths, a point for each distance beyond the layer of births; bars are \
                      standard errors"
                .into(),
            svg,
        },
    })
}

/// v_y over v_x with both errors, from a distance of the edge on.
fn against_each_other(output: &Output, from: f64) -> Result<Vec<ErrorPoint>, Box<dyn Error>> {
    let profile = read_flow_profile(&output.path().join("folded_profile.csv"))?;
    let point = |row: usize| ErrorPoint {
        at: [0, 1].map(|axis| profile.velocity[axis][row]),
        error: [0, 1].map(|axis| profile.errors.as_ref().map(|errors| errors[axis][row])),
    };
    Ok((0..profile.x.len()).filter(|&row| profile.x[row] >= from).map(point).collect())
}

fn chiralities(size: Size) -> Result<Made, Box<dyn Error>> {
    let all: &[f64] = size.pick(&[0.0, 2.0], &[0.0, 0.9, 1.8, 2.7, 3.6]);
    let rest = size.pick(
        "--width 150 --length 150 --relaxation 2 --time 6 --samples 4 --dt 0.02",
        "--width 500 --length 500 --bins 40",
    );
    let (mut panels, mut found) = (Vec::new(), Vec::new());
    for (shape_index, names) in [(3.0, ["3-x", "3-y"]), (4.0, ["4-x", "4-y"])] {
        let runs: Vec<Profiles> = all
            .iter()
            .map(|&alpha| {
                let perimeter = 25.0 * shape_index;
                let run = command::run(&format!(
                    "channel --preset ht1080 --P_0 {perimeter} --alpha {alpha} {rest}"
                ))?;
                Ok((alpha, profiles(&run)?))
            })
            .collect::<Result<_, Box<dyn Error>>>()?;
        let largest = |which: usize| -> Vec<String> {
            let most = |points: &[ErrorPoint]| {
                let sizes = points.iter().map(|point| point.at[1]);
                sizes.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
            };
            runs.iter().map(|(_, profiles)| format!("{:.1}", most(&profiles[which]))).collect()
        };
        found.push(format!(
            "P₀ = {shape_index} ℓ₀, largest v_x for rising α: {} µm/h; largest v_y: {} µm/h.",
            largest(0).join(", "),
            largest(1).join(", ")
        ));
        let crooked: Vec<String> = runs
            .iter()
            .map(|(_, profiles)| {
                let [size, expected] = wiggle(&profiles[1]);
                format!("{size:.2} ({expected:.2})")
            })
            .collect();
        found.push(format!(
            "P₀ = {shape_index} ℓ₀: v_y wiggles from strip to strip by {} µm/h (root mean square of the second differences over √6; in brackets what the errors of the \
             strips make).",
            crooked.join(", ")
        ));
        for (which, name) in names.into_iter().enumerate() {
            let component = ["v_x, towards the middle", "v_y, along the edge"][which];
            let series = runs.iter().map(|(alpha, profiles)| Series {
                name: format!("α = {alpha}"),
                drawn: Drawn::JoinedMarks,
                points: profiles[which].clone(),
            });
            let label = format!("{component} (µm/h)");
            let svg = super::chart(
                component,
                ["distance from the edge (µm)", &label],
                EVEN,
                &series.collect::<Vec<_>>(),
            );
            panels.push(Panel { name, caption: format!("P₀ = {shape_index} ℓ₀: {component}"), svg });
        }
    }
    Ok(Made {
        settings: format!(
            "`voronudge channel --preset ht1080 --P_0 … --alpha … {rest}` with P₀ = 75 and 100 µm, α = {}",
            all.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
        ),
        found,
        panels,
    })
}

/// Root mean square of the second differences of a profile over √6, which of independent errors is their size, and that size.
fn wiggle(points: &[ErrorPoint]) -> [f64; 2] {
    let count = points.len().saturating_sub(2).max(1) as f64;
    let squares = points.windows(3).map(|three| {
        let [a, b, c] = [0, 1, 2].map(|k: usize| three[k].at[1]);
        let [e, f, g] = [0, 1, 2].map(|k: usize| three[k].error[1].unwrap_or(f64::NAN));
        [(a - 2.0 * b + c).powi(2), e * e + 4.0 * f * f + g * g]
    });
    let sum = squares.fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    sum.map(|sum| (sum / (6.0 * count)).sqrt())
}

fn edge(size: Size) -> Result<Made, Box<dyn Error>> {
    let (count, times) = size.pick((2, [0.2, 0.2]), (8, [TRANSIENT, AVERAGE]));
    let currents = edge_currents(Replicas { seed: 1, count }, times)?;
    tell(&currents);
    let mut perimeters: Vec<f64> = currents.iter().map(|current| current.preferred_perimeter).collect();
    perimeters.dedup();
    let (mut series, mut found) = (Vec::new(), Vec::new());
    for perimeter in perimeters {
        let own: Vec<_> =
            currents.iter().filter(|current| current.preferred_perimeter == perimeter).collect();
        let points = own.iter().map(|current| ErrorPoint {
            at: [current.chirality, current.velocity.0],
            error: [None, Some(current.velocity.1)],
        });
        series.push(Series {
            name: format!("P_0 = {perimeter}"),
            drawn: Drawn::JoinedMarks,
            points: points.collect(),
        });
        let moving = own.iter().position(|current| current.velocity.0 > 0.01);
        let onset = match moving {
            None => "beyond all α tried".into(),
            Some(0) => format!("below {}", own[0].chirality),
            Some(k) => format!("between {} and {}", own[k - 1].chirality, own[k].chirality),
        };
        found.push(format!("{onset} at P₀ = {perimeter} (printed threshold {:.3})", own[0].thresholds[0]));
    }
    let svg = super::chart("edge currents", ["α", "v_E / (K_P ℓ_0)"], EVEN, &series);
    Ok(Made {
        settings: format!(
            "100 cells between four walls, K_A = 0.1, {count} tissues, averages over {} after {}; see [flows](validation/flows.md)",
            times[1], times[0]
        ),
        found: vec![format!("The current sets in at α {}.", found.join("; "))],
        panels: vec![Panel { name: "", caption: "Velocity along the walls against chirality".into(), svg }],
    })
}
