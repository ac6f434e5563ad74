//! Tables of shares.

use super::found::Found;
use crate::study::seeds::quartiles;
use std::collections::BTreeMap;
use voronudge_infer::discover::Verdict;

/// Prints the head of a table.
pub fn head(columns: &[&str]) {
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
}

/// Prints a row of a table.
pub fn row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}

/// How many sets are so.
pub fn count(found: &[Found], is_so: impl Fn(&Found) -> bool) -> String {
    let hits = found.iter().filter(|found| is_so(found)).count();
    let share = hits as f64 / found.len().max(1) as f64;
    format!("{share:.2} ({hits}/{})", found.len())
}

/// How many sets end in a verdict.
pub fn verdict(found: &[Found], verdict: Verdict) -> String {
    count(found, |found| found.verdict_is(verdict))
}

/// Mean and standard deviation.
pub fn spread(values: &[f64]) -> String {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    format!("{mean:.3} ± {:.3}", (squares / (n - 1.0)).sqrt())
}

/// A share as a percentage without needless digits.
pub fn percent(share: f64) -> String {
    format!("{}", (1e4 * share).round() / 100.0)
}

/// The effects that were added, or are as good, in at least a third of the sets where one was.
pub fn named(found: &[Found]) -> String {
    let mut counts = BTreeMap::new();
    let selected: Vec<&Found> = found.iter().filter(|found| found.selected()).collect();
    for own in selected.iter().flat_map(|found| &found.discovery.selected) {
        for effect in std::iter::once(&own.effect).chain(&own.class) {
            *counts.entry(effect.id).or_insert(0) += 1;
        }
    }
    let usual = counts.iter().filter(|(_, count)| 3 * **count >= selected.len());
    usual.map(|(id, count)| format!("`{id}` {count}")).collect::<Vec<_>>().join(", ")
}

/// Median time of a search.
pub fn seconds(found: &[Found]) -> String {
    let [_, median, _] = quartiles(found.iter().map(|found| found.seconds).collect());
    format!("{median:.1}")
}
