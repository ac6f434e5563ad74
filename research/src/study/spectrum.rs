//! ⟨ω²⟩ over preferred perimeter and chirality: disordered tissues left to come to rest, and all their modes.
//!
//! K_A 0.1, K_P 1, unit cells. Seed s grows the tissue of every point of the grid with the generator made from s.

use super::flows::{parameters, random};
use super::seeds::on_one_core_each;
use crate::Outcome;
use voronudge_model::Model;
use voronudge_simulate::recommended_time_step;
use voronudge_spectrum::{Character, LinearProblem, Request, Selection, modes};
use voronudge_theory::MeanField;

const PERIMETERS: [f64; 6] = [3.0, 3.2, 3.4, 3.5, 3.6, 3.7];
const CHIRALITIES: [f64; 9] = [0.0, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2];
/// How long a tissue comes to rest.
const TIME: f64 = 60.0;
const CELLS: usize = 64;
/// Levels of ⟨ω²⟩/K_P² for a line of onset: one at which waves set in, and the paper's.
const ONSETS: [f64; 2] = [0.5, 40.0];

/// One tissue.
struct Measured {
    point: (usize, usize),
    square: f64,
    /// Share of the modes that oscillate.
    waves: f64,
    /// ⟨v²⟩ at the end: whether it is at rest.
    motion: f64,
}

pub fn run(seeds: u64, cells: Option<usize>) -> Outcome {
    let cells = cells.unwrap_or(CELLS);
    let points = PERIMETERS.len() * CHIRALITIES.len();
    let all = on_one_core_each(seeds * points as u64, |task| {
        let (point, seed) = (task as usize % points, task / points as u64);
        measure((point / CHIRALITIES.len(), point % CHIRALITIES.len()), seed, cells)
    })?;
    let mean = |p: usize, a: usize, quantity: fn(&Measured) -> f64| {
        let own: Vec<f64> = all.iter().filter(|one| one.point == (p, a)).map(quantity).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    println!("{cells} cells, {seeds} seeds, t = {TIME}\n");
    table("⟨ω²⟩/K_P²", |p, a| format!("{:.3}", mean(p, a, |one| one.square)));
    table("⟨ω²⟩/K_P² of the honeycomb, mean-field theory", |p, a| format!("{:.3}", honeycomb(p, a)));
    table("share of the modes that oscillate", |p, a| format!("{:.2}", mean(p, a, |one| one.waves)));
    table("⟨v²⟩ at the end", |p, a| format!("{:.0e}", mean(p, a, |one| one.motion)));
    let [low, high] = ONSETS;
    println!(
        "| P_0 | α where ⟨ω²⟩ = {low} | of the honeycomb | α where ⟨ω²⟩ = {high} | of the honeycomb | exceptional line of q* |"
    );
    println!("|---|---|---|---|---|---|");
    for (p, p_0) in PERIMETERS.iter().enumerate() {
        let own = |level| crossing(level, |a| mean(p, a, |one| one.square));
        let theory = |level| crossing(level, |a| honeycomb(p, a));
        let columns = [own(low), theory(low), own(high), theory(high)];
        let columns = columns.map(|at| at.map_or("none".to_owned(), |at| format!("{at:.3}")));
        let line = theory_at(*p_0, 0.0)?.exceptional_chirality();
        println!("| {p_0} | {} | {line:.3} |", columns.join(" | "));
    }
    Ok(())
}

fn measure(point: (usize, usize), seed: u64, cells: usize) -> Result<Measured, Box<dyn std::error::Error>> {
    let parameters = parameters(PERIMETERS[point.0], CHIRALITIES[point.1]);
    let model = Model::chiral_voronoi(&parameters);
    let mut simulation = random(cells, &parameters, seed)?;
    let time_step = 2.0 * recommended_time_step(&parameters, 1.0);
    for _ in 0..(TIME / time_step).ceil() as usize {
        simulation.step(time_step)?;
    }
    let problem = LinearProblem::new(simulation.tessellation(), simulation.positions(), &model, |_| true)?;
    let request = Request { character: Character::None, ..Request::new(Selection::All) };
    let found = modes(&problem, &request, &mut |_, _, _| {})?;
    let squares: f64 = simulation.velocities().iter().map(|v| v.norm_squared()).sum();
    Ok(Measured {
        point,
        square: found.mean_square_frequency().unwrap_or(f64::NAN),
        waves: found.counts().oscillating as f64 / found.modes.len() as f64,
        motion: squares / cells as f64,
    })
}

fn theory_at(preferred_perimeter: f64, chirality: f64) -> Result<MeanField, voronudge_theory::Error> {
    MeanField::new(voronudge_theory::Parameters {
        area_elasticity: 0.1,
        preferred_perimeter,
        chirality,
        ..voronudge_theory::Parameters::default()
    })
}

fn honeycomb(p: usize, a: usize) -> f64 {
    theory_at(PERIMETERS[p], CHIRALITIES[a]).map_or(f64::NAN, |theory| theory.mean_square_frequency(40))
}

/// The chirality at which a quantity rises through a level, between points of the grid.
fn crossing(level: f64, value: impl Fn(usize) -> f64) -> Option<f64> {
    (1..CHIRALITIES.len()).find(|&a| value(a - 1) < level && value(a) >= level).map(|a| {
        let share = (level - value(a - 1)) / (value(a) - value(a - 1));
        CHIRALITIES[a - 1] + share * (CHIRALITIES[a] - CHIRALITIES[a - 1])
    })
}

fn table(name: &str, entry: impl Fn(usize, usize) -> String) {
    println!("### {name}\n");
    println!("| P_0 \\ α | {} |", CHIRALITIES.map(|a| a.to_string()).join(" | "));
    println!("|---|{}", "---|".repeat(CHIRALITIES.len()));
    for (p, p_0) in PERIMETERS.iter().enumerate() {
        let row: Vec<String> = (0..CHIRALITIES.len()).map(|a| entry(p, a)).collect();
        println!("| {p_0} | {} |", row.join(" | "));
    }
    println!();
}
