//! The study as tables.

use super::super::seeds::quartiles;
use super::{Outcomes, Row, Setting};

pub(super) fn print(settings: &[Setting]) {
    println!("Medians over seeds; errors in %, position errors in % of ℓ₀, seconds on one core.\n");
    println!(
        "| N | σ_v | σ_r | K_P α: naive | descent | search | P_0: naive | descent | search | wrong edges: before | descent | search | \
         share left | long sides: before | search | position error: before | descent | search |"
    );
    println!("|{}", "---|".repeat(18));
    settings.iter().for_each(|setting| println!("{}", errors(setting)));
    println!(
        "\n| N | σ_v | σ_r | Φ/expected: descent | search | seconds: descent | search | to the descent's Φ | faster by | at least as low | \
         covers K_P α | covers P_0 | K_P α within 3 % | 12 % | flagged | of these off | not flagged but off |"
    );
    println!("|{}", "---|".repeat(17));
    settings.iter().for_each(|setting| println!("{}", costs(setting)));
}

/// The first columns: the setting.
fn named(setting: &Setting) -> String {
    let percent = [setting.noise.velocity, setting.noise.position].map(|noise| 100.0 * noise);
    format!("| {} | {} | {}", setting.cells, percent[0], percent[1])
}

fn median(setting: &Setting, value: &dyn Fn(&Row) -> f64) -> f64 {
    quartiles(setting.rows.iter().map(value).collect())[1]
}

/// A row of the first table.
pub(super) fn errors(setting: &Setting) -> String {
    let percent = |value: &dyn Fn(&Row) -> f64| format!("{:.1}", 100.0 * median(setting, value));
    let count = |value: &dyn Fn(&Row) -> f64| format!("{:.0}", median(setting, value));
    let share = |row: &Row| row.ours.wrong_edges as f64 / row.edges_before as f64;
    format!(
        "{} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
        named(setting),
        percent(&|row| row.naive.chiral),
        percent(&|row| row.paper.chiral),
        percent(&|row| row.ours.chiral),
        percent(&|row| row.naive.perimeter),
        percent(&|row| row.paper.perimeter),
        percent(&|row| row.ours.perimeter),
        count(&|row| row.edges_before as f64),
        count(&|row| row.paper.wrong_edges as f64),
        count(&|row| row.ours.wrong_edges as f64),
        if setting.noise.position > 0.0 { format!("{:.2}", median(setting, &share)) } else { "–".into() },
        sum(setting, |row| row.sides_before),
        sum(setting, |row| row.ours.lost_sides),
        percent(&|row| row.naive.position_error),
        percent(&|row| row.paper.position_error),
        percent(&|row| row.ours.position_error),
    )
}

/// A row of the second table.
pub(super) fn costs(setting: &Setting) -> String {
    let rows = &setting.rows;
    let median = |value: &dyn Fn(&Row) -> f64| median(setting, value);
    let count = |test: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| test(row)).count();
    let covers = |index: usize| count(&|row| row.ours.covered.is_some_and(|covered| covered[index]));
    format!(
        "{} | {:.2} | {:.2} | {:.2} | {:.2} | {:.3} | {:.0} | {} | {} | {} | {} | {} | {} | {} | {} |",
        named(setting),
        median(&|row| row.paper.objective),
        median(&|row| row.ours.objective),
        median(&|row| row.paper.seconds),
        median(&|row| row.ours.seconds),
        median(&|row| row.seconds_to_paper),
        median(&|row| row.paper.seconds / row.seconds_to_paper),
        count(&|row| row.ours.objective <= row.paper.objective),
        covers(0),
        covers(1),
        count(&|row| row.ours.chiral < 0.03),
        count(&|row| row.ours.chiral < 0.12),
        count(&|row| row.ours.flagged),
        count(&|row| row.ours.flagged && off(&row.ours)),
        count(&|row| !row.ours.flagged && off(&row.ours)),
    )
}

/// Whether K_P α is further from the truth than three standard errors.
fn off(outcomes: &Outcomes) -> bool {
    outcomes.deviation > 3.0
}

fn sum(setting: &Setting, count: impl Fn(&Row) -> usize) -> usize {
    setting.rows.iter().map(count).sum()
}
