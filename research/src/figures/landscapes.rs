//! What errors of positions do to a fit, and what nudging makes of them.

use super::{Drawn, EVEN, Figure, Made, Panel, Series, Size, chart};
use crate::study::quartiles;
use claims::{Noise, TRUTH, Tissue};
use std::error::Error;
use std::ops::ControlFlow;
use voronudge_geometry::{Tessellation, Vector};
use voronudge_infer::{Constraints, FitParameter, Inference, Observation, Prior, Request, infer};
use voronudge_model::{Model, Parameters, velocities};
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::Palette;
use voronudge_report::figure::{LineStyle, MapLine, PhaseMap, phase_map};

pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "1e-f",
        title: "a fit at measured positions, and one that nudges them",
        stated: "with the wrong topology the best velocities are visibly incorrect; nudging by a very small amount mends the \
                 topology and gives excellent predictions",
        make: fits,
    },
    Figure {
        name: "1g-m0b",
        title: "the loss across a T1 transition",
        stated: "the optimum stays at the true α = 3.4 up to a displacement Δr_c ≈ 1/30 of a cell, where the topology changes, and \
                 then jumps to an incorrect value",
        make: across_a_transition,
    },
    Figure {
        name: "m0d",
        title: "the loss with and without nudging",
        stated: "the least nudged loss, although a non-negative term is added to it, is much lower than that at measured positions, \
                 and it is at the right parameter",
        make: nudged_loss,
    },
];

/// The largest displacement drawn, in ℓ₀.
const LARGEST: f64 = 0.06;

fn relative_loss(tissue: &Tissue, predicted: &[Vector<f64>]) -> f64 {
    let squares: f64 = predicted.iter().zip(&tissue.velocities).map(|(p, v)| (p - v).norm_squared()).sum();
    let all: f64 = tissue.velocities.iter().map(Vector::norm_squared).sum();
    (squares / all).sqrt()
}

/// Velocities without chirality and per unit of chirality, other parameters at the truth, in the units of the tissue.
fn parts(tissue: &Tissue, positions: &[Vector<f64>]) -> Result<[Vec<Vector<f64>>; 2], Box<dyn Error>> {
    let tessellation = Tessellation::new(positions, tissue.tessellation.domain())?;
    let of = |chirality: f64| {
        let model = Model::chiral_voronoi(&Parameters { chirality, ..TRUTH });
        velocities(&tessellation, positions, &model).into_iter().map(|v| v / tissue.rms).collect()
    };
    let (achiral, chiral): (Vec<Vector<f64>>, Vec<Vector<f64>>) = (of(0.0), of(1.0));
    let slope = chiral.iter().zip(&achiral).map(|(a, b)| a - b).collect();
    Ok([achiral, slope])
}

/// The chirality of least loss.
fn best_chirality(tissue: &Tissue, [achiral, slope]: &[Vec<Vector<f64>>; 2]) -> f64 {
    let rest = tissue.velocities.iter().zip(achiral).map(|(v, a)| v - a);
    let (above, below) =
        rest.zip(slope).fold((0.0, 0.0), |(a, b), (rest, s)| (a + rest.dot(s), b + s.norm_squared()));
    above / below
}

/// A displacement of every cell, of root mean square 1 per cell, in fixed directions at random.
fn directions(tissue: &Tissue, seed: u64) -> Result<Vec<Vector<f64>>, Box<dyn Error>> {
    // What a unit of noise does to positions, without the velocities.
    let noise = Noise { position: 1e-3, velocity: 0.0 };
    let frame = tissue.measured(noise, seed)?;
    let moved: Vec<Vector<f64>> = frame.positions.iter().zip(&tissue.positions).map(|(a, b)| a - b).collect();
    let rms = (moved.iter().map(Vector::norm_squared).sum::<f64>() / moved.len() as f64).sqrt();
    Ok(moved.into_iter().map(|d| d / rms).collect())
}

fn displaced(tissue: &Tissue, directions: &[Vector<f64>], size: f64) -> Vec<Vector<f64>> {
    tissue.positions.iter().zip(directions).map(|(r, d)| r + d * size).collect()
}

/// The least displacement in these directions at which a contact changes, up to 0.5.
fn first_transition(tissue: &Tissue, directions: &[Vector<f64>]) -> Result<f64, Box<dyn Error>> {
    let changed = |size: f64| -> Result<bool, Box<dyn Error>> {
        let moved = Tessellation::new(&displaced(tissue, directions, size), tissue.tessellation.domain())?;
        Ok(tissue.wrong_edges(&moved) > 0)
    };
    let mut high = 0.0;
    while !changed(high)? {
        high += 5e-4;
        if high > 0.5 {
            return Err("no contact changes".into());
        }
    }
    let mut low = high - 5e-4;
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if changed(middle)? { high = middle } else { low = middle }
    }
    Ok(high)
}

/// The first displacement at which a contact changes, and by how much the best α jumps there: medians over tissues, with quartiles.
fn jumps(cells: usize, tissues: u64) -> Result<String, Box<dyn Error>> {
    let each = (1..=tissues)
        .map(|seed| {
            let tissue = Tissue::new(cells, seed)?;
            let directions = directions(&tissue, seed)?;
            let critical = first_transition(&tissue, &directions)?;
            let best = |share: f64| -> Result<f64, Box<dyn Error>> {
                let moved = displaced(&tissue, &directions, share * critical);
                Ok(best_chirality(&tissue, &parts(&tissue, &moved)?))
            };
            Ok([critical, (best(1.0 + 1e-6)? - best(1.0 - 1e-6)?).abs()])
        })
        .collect::<Result<Vec<[f64; 2]>, Box<dyn Error>>>()?;
    let [critical, jump] = [0, 1].map(|k| quartiles(each.iter().map(|own| own[k]).collect()));
    let words = |[low, middle, high]: [f64; 3]| format!("{middle:.4} ({low:.4} to {high:.4})");
    Ok(format!("Δr_c = {} and a jump of {} for {cells} cells", words(critical), words(jump)))
}

fn across_a_transition(size: Size) -> Result<Made, Box<dyn Error>> {
    let tissue = Tissue::new(100, 1)?;
    let directions = directions(&tissue, 3)?;
    let critical = first_transition(&tissue, &directions)?;
    let (rows, columns) = size.pick((11, 16), (61, 61));
    let displacements: Vec<f64> = (0..rows).map(|k| LARGEST * k as f64 / (rows - 1) as f64).collect();
    let chiralities: Vec<f64> = (0..columns).map(|k| 6.0 * k as f64 / (columns - 1) as f64).collect();
    let (mut values, mut optimum) = (Vec::new(), Vec::new());
    for &step in &displacements {
        let parts = parts(&tissue, &displaced(&tissue, &directions, step))?;
        optimum.push([best_chirality(&tissue, &parts), step]);
        values.extend(chiralities.iter().map(|&chirality| {
            let sum: Vec<Vector<f64>> =
                parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b * chirality).collect();
            relative_loss(&tissue, &sum)
        }));
    }
    let at = |step: f64| -> Result<[f64; 2], Box<dyn Error>> {
        let parts = parts(&tissue, &displaced(&tissue, &directions, step))?;
        let best = best_chirality(&tissue, &parts);
        let sum: Vec<Vector<f64>> = parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b * best).collect();
        Ok([best, relative_loss(&tissue, &sum)])
    };
    let (before, after, end) = (at(0.999 * critical)?, at(1.001 * critical)?, at(LARGEST)?);
    let (tissues, sizes): (_, &[usize]) = size.pick((2, &[36]), (60, &[16, 36, 100]));
    let told = sizes.iter().map(|&cells| jumps(cells, tissues)).collect::<Result<Vec<_>, _>>()?;
    let ends = [chiralities[0], chiralities[columns - 1]];
    let lines = [
        MapLine { label: "best α".into(), points: optimum, style: LineStyle::Solid },
        MapLine {
            label: "first T1".into(),
            points: ends.map(|x| [x, critical]).to_vec(),
            style: LineStyle::Dashed,
        },
    ];
    let svg = phase_map(&PhaseMap {
        title: "loss across T1 transitions",
        label: "‖v_{pred} − v_{exp}‖/‖v_{exp}‖",
        x: ("α", &chiralities),
        y: ("displacement Δr / ℓ_0", &displacements),
        values: &values,
        scale: AxisScale::Linear,
        palette: Palette::Sequential,
        lines: &lines,
    });
    Ok(Made {
        settings: "100 cells of a chiral liquid (P₀ = 4, α = 3.4, seed 1), all displaced in fixed directions by Δr on average, the \
                   other parameters at the truth"
            .into(),
        found: vec![format!(
            "The first contact changes at Δr_c = {critical:.4} ℓ₀. The best α is {:.2} just below (loss {:.3}), {:.2} just above (loss {:.3}), \
             and {:.2} at Δr = {LARGEST} (loss {:.3}), where more contacts have changed.",
            before[0], before[1], after[0], after[1], end[0], end[1],
        ),
        format!(
            "Over {tissues} tissues medians (and quartiles) are {}: the optimum drifts as contacts change one after the other, and does not \
             jump at the first. Δr_c falls with the number of cells, as any of them may come first.",
            told.join(", ")
        )],
        panels: vec![Panel { name: "", caption: "Loss against α and displacement".into(), svg }],
    })
}

/// Errors of positions and velocities in the panels of fits.
const NOISE: Noise = Noise { position: 0.03, velocity: 0.02 };

fn fitted(
    tissue: &Tissue,
    frame: &Observation,
    constraints: Constraints,
) -> Result<Inference, Box<dyn Error>> {
    let request = Request { constraints, ..tissue.request(NOISE.known()) };
    Ok(infer(std::slice::from_ref(frame), &request, &mut |_| ControlFlow::Continue(()))?)
}

fn nudged_loss(size: Size) -> Result<Made, Box<dyn Error>> {
    let tissue = Tissue::new(100, 1)?;
    let frame = tissue.measured(NOISE, 1)?;
    let positions = &frame.positions;
    let parts = parts(&tissue, positions)?;
    let count = size.pick(5, 25);
    let chiralities: Vec<f64> = (0..count).map(|k| 1.0 + 5.0 * k as f64 / (count - 1) as f64).collect();
    let measured: f64 = tissue.velocities.iter().map(Vector::norm_squared).sum();
    let known = [FitParameter::PerimeterElasticity, FitParameter::PreferredPerimeter];
    let (mut quenched, mut nudged) = (Vec::new(), Vec::new());
    for &chirality in &chiralities {
        let sum: Vec<Vector<f64>> = parts[0].iter().zip(&parts[1]).map(|(a, b)| a + b * chirality).collect();
        quenched.push([chirality, relative_loss(&tissue, &sum)]);
        let held = known.map(|quantity| (quantity, tissue.truth(quantity)));
        let mut constraints =
            Constraints::fixed(held.into_iter().chain([(FitParameter::Chirality, chirality)]));
        // A fit needs something to fit: K_A, which is known to one per cent.
        let area = tissue.truth(FitParameter::AreaElasticity);
        let prior = Prior { mean: area, standard_deviation: 0.01 * area };
        constraints.priors.insert(FitParameter::AreaElasticity, prior);
        let fit = fitted(&tissue, &frame, constraints)?;
        nudged.push([chirality, (fit.objective * NOISE.velocity.powi(2) / measured).sqrt()]);
    }
    let least = |curve: &[[f64; 2]]| {
        curve.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::NAN; 2])
    };
    let (low, high) = (least(&nudged), least(&quenched));
    let series = |name: &str, points: Vec<[f64; 2]>| Series {
        name: name.into(),
        drawn: Drawn::JoinedMarks,
        points: points.into_iter().map(Into::into).collect(),
    };
    let svg = chart(
        "loss with and without nudging",
        ["α", "loss / ‖v_{exp}‖"],
        [AxisScale::Linear, AxisScale::Logarithmic],
        &[series("nudged, springs included", nudged), series("at measured positions", quenched)],
    );
    Ok(Made {
        settings: "100 cells of a chiral liquid (P₀ = 4, α = 3.4, seed 1), errors of 3 % of ℓ₀ in positions and 2 % in velocities, \
                   the other parameters at the truth, α held at each value while the positions are nudged"
            .into(),
        found: vec![format!(
            "The least loss is {:.3} at α = {:.2} with nudging, springs included, and {:.3} at α = {:.2} without.",
            low[1], low[0], high[1], high[0]
        )],
        panels: vec![Panel { name: "", caption: "Loss against α".into(), svg }],
    })
}

fn fits(_: Size) -> Result<Made, Box<dyn Error>> {
    let tissue = Tissue::new(100, 1)?;
    let frame = tissue.measured(NOISE, 1)?;
    let held = (FitParameter::AreaElasticity, tissue.truth(FitParameter::AreaElasticity));
    let fit = fitted(&tissue, &frame, Constraints::fixed([held]))?;
    let naive_model = Model::chiral_voronoi(&fit.naive);
    let measured_topology = Tessellation::new(&frame.positions, tissue.tessellation.domain())?;
    let naive = velocities(&measured_topology, &frame.positions, &naive_model);
    let nudged = &fit.frames[0].predicted;
    let pairs = |predicted: &[Vector<f64>]| -> Vec<_> {
        let both = tissue.velocities.iter().zip(predicted);
        both.flat_map(|(v, p)| [[v.x, p.x].into(), [v.y, p.y].into()]).collect()
    };
    let reach = tissue.velocities.iter().flat_map(|v| [v.x.abs(), v.y.abs()]).fold(0.0, f64::max);
    let scatter = |title: &str, predicted: &[Vector<f64>]| {
        let line = vec![[-reach, -reach].into(), [reach, reach].into()];
        let labels = ["true velocity component / rms", "predicted / rms"];
        let series = [
            Series { name: title.into(), drawn: Drawn::Marks, points: pairs(predicted) },
            Series { name: String::new(), drawn: Drawn::BrokenLine, points: line },
        ];
        chart(title, labels, EVEN, &series)
    };
    let wrong = tissue.wrong_edges(&measured_topology);
    let left = tissue.wrong_edges(&fit.frames[0].tessellation);
    let errors = [relative_loss(&tissue, &naive), relative_loss(&tissue, nudged)].map(|loss| loss.powi(2));
    Ok(Made {
        settings: "100 cells of a chiral liquid (P₀ = 4, α = 3.4, seed 1), errors of 3 % of ℓ₀ in positions and 2 % in velocities; \
                   K_A known, the other parameters fitted"
            .into(),
        found: vec![
            format!(
                "{wrong} contacts of the measured positions are wrong. The best parameters there give α = {:.2}, P₀ = {:.2} and leave \
                 {:.0} % of the squared velocities.",
                fit.naive.chirality,
                fit.naive.preferred_perimeter,
                100.0 * errors[0]
            ),
            format!(
                "Nudges of {:.3} ℓ₀ leave {left} wrong contacts, give α = {:.2}, P₀ = {:.2}, and velocities with {:.2} % left.",
                fit.nudge_rms,
                fit.model_parameters.chirality,
                fit.model_parameters.preferred_perimeter,
                100.0 * errors[1]
            ),
        ],
        panels: vec![
            Panel {
                name: "measured",
                caption: "Velocities of the best fit at measured positions".into(),
                svg: scatter("at measured positions", &naive),
            },
            Panel {
                name: "nudged",
                caption: "Velocities of the fit that nudges positions".into(),
                svg: scatter("nudged", nudged),
            },
        ],
    })
}
