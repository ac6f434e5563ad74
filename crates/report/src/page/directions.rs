//! The table of what the data determine.

use serde::Serialize;

use super::parameter_table::symbol_of;
use super::uncertainty::printed;
use crate::colour::diverging;
use crate::infer_report::EigenDirection;
use crate::numbers::NO_VALUE;

/// The table of eigenvalues: one column per parameter, tinted by the component.
#[derive(Serialize)]
pub(super) struct Directions {
    names: Vec<String>,
    rows: Vec<DirectionRow>,
}

#[derive(Serialize)]
struct DirectionRow {
    words: String,
    eigenvalue: f64,
    cells: Vec<DirectionCell>,
}

#[derive(Serialize)]
struct DirectionCell {
    text: String,
    colour: String,
}

/// The table of the given directions, in their order.
pub(super) fn directions(modes: &[EigenDirection]) -> Directions {
    let mut names: Vec<&String> = modes.iter().flat_map(|mode| mode.direction.keys()).collect();
    names.sort();
    names.dedup();
    let cell = |component: Option<&f64>| {
        let component = component.copied().filter(|value| value.is_finite());
        // Half strength keeps the text legible on the tint.
        let tint = diverging(0.5 + 0.16 * component.unwrap_or(0.0).clamp(-1.0, 1.0));
        let [red, green, blue] = tint;
        let size = component.unwrap_or(0.0).abs();
        DirectionCell {
            text: component
                .map_or_else(|| NO_VALUE.to_owned(), |value| format!("{value:.2}").replace('-', "−")),
            colour: if size < 0.1 { "#fff".into() } else { format!("#{red:02x}{green:02x}{blue:02x}") },
        }
    };
    let rows = modes.iter().map(|mode| DirectionRow {
        words: printed(&mode.words),
        eigenvalue: mode.eigenvalue,
        cells: names.iter().map(|name| cell(mode.direction.get(*name))).collect(),
    });
    Directions { rows: rows.collect(), names: names.iter().map(|name| symbol_of(name)).collect() }
}
