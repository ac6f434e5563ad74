//! Flows in a channel in which cells are extruded and born.

use super::command::{self, Output};
use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size};
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
            Some(format!("{name} {:.0} µm", report["decay"][name]["length"]["value"].as_f64()?))
        })
        .collect();
    Ok(Made {
        settings: output.typed.clone(),
        found: vec![
            format!(
                "v_y/v_x = {}, which says α = {} (put in: 2.9).",
                number(&flow["slope"]),
                number(&flow["alpha"])
            ),
            format!("Decay lengths: {}.", lengths.join(", ")),
        ],
        panels: vec![
            Panel {
                name: "density",
                caption: "Density".into(),
                svg: output.picture("density across the channel")?,
            },
            Panel {
                name: "velocity",
                caption: "Velocities, with the continuum theory".into(),
                svg: output.picture("velocities")?,
            },
            Panel {
                name: "ratio",
                caption: "v_y against v_x".into(),
                svg: output.picture("v_y against v_x")?,
            },
            Panel {
                name: "births",
                caption: "How much a birth changes velocities nearby, on a vertex and beside a mother".into(),
                svg: output.picture("disturbance by a birth")?,
            },
        ],
    })
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
