//! Lists, shares and probabilities as sentences have them.

use voronudge_report::numbers::significant;

/// Names as a list, with a word before the last.
pub(super) fn listed(names: &[&str], joint: &str) -> String {
    match names {
        [others @ .., last] if !others.is_empty() => format!("{} {joint} {last}", others.join(", ")),
        _ => names.concat(),
    }
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}

/// A probability; the very small ones are not told apart.
pub(super) fn probability(p: f64) -> String {
    if (0.0..1e-4).contains(&p) { "<0.0001".into() } else { significant(p, 2) }
}
