//! The table of what the data determine.

use super::parameter_table::symbol_of;
use super::words::printed;
use super::{Block, Cell, Row, Table};
use crate::colour::diverging;
use crate::infer_report::EigenDirection;
use crate::numbers::{NO_VALUE, significant};

/// The eigenvalues in their order: one column per parameter, tinted by the component. Empty without any.
pub(super) fn directions(modes: &[EigenDirection]) -> Block {
    let mut names: Vec<&String> = modes.iter().flat_map(|mode| mode.direction.keys()).collect();
    names.sort();
    names.dedup();
    let symbols = names.iter().map(|name| symbol_of(name).into());
    let header = [Cell::from("eigenvalue")].into_iter().chain(symbols).chain([("in words", "words").into()]);
    let row = |mode: &EigenDirection| -> Row {
        let components = names.iter().map(|name| component(mode.direction.get(*name)));
        let ends = [significant(mode.eigenvalue, 3), printed(&mode.words)].map(Cell::from);
        let [eigenvalue, words] = ends;
        [eigenvalue].into_iter().chain(components).chain([words]).collect()
    };
    Block::table(Table::new(header).class("directions").without_names().rows(modes.iter().map(row)))
}

fn component(component: Option<&f64>) -> Cell {
    let component = component.copied().filter(|value| value.is_finite());
    // Half strength keeps the text legible on the tint.
    let [red, green, blue] = diverging(0.5 + 0.16 * component.unwrap_or(0.0).clamp(-1.0, 1.0));
    let size = component.unwrap_or(0.0).abs();
    let text = component.map_or_else(|| NO_VALUE.to_owned(), |value| format!("{value:.2}").replace('-', "−"));
    Cell::from(text).on(if size < 0.1 { "#fff".into() } else { format!("#{red:02x}{green:02x}{blue:02x}") })
}
