//! Units that the header of a table of vectors states.

use super::FlowOptions;
use crate::dataset::DataSet;
use crate::note::Note;
use crate::stated::{is_pixel, same_unit};
use crate::table::VectorTable;

/// Takes units that options leave open, and tells of them.
pub(super) fn take_units(table: &VectorTable, options: &FlowOptions, dataset: &mut DataSet) -> Vec<Note> {
    let mut notes = vec![Note::guessed(format!("of the {}", table.columns))];
    notes.extend(table.notes.iter().cloned());
    let is_scaled = options.scale.pixel_size.is_some() || options.scale.frame_interval.is_some();
    let (Some(place), false) = (table.place_unit.as_deref(), is_scaled) else { return notes };
    let (length, time) = match table.unit.as_deref().and_then(|unit| unit.split_once('/')) {
        Some((length, time)) => (length.trim(), Some(time.trim())),
        None => (place, None),
    };
    if !same_unit(place, length) {
        notes.push(Note::doubtful(format!(
            "places are in {place}, but displacements in {length}: the flow comes out by the ratio of the two too small or too large"
        )));
    }
    if options.scale.length_unit.is_none() {
        place.clone_into(&mut dataset.length_unit);
    }
    if let (Some(time), None) = (time, &options.scale.time_unit) {
        time.clone_into(&mut dataset.time_unit);
    }
    notes.push(Note::read(format!(
        "lengths in {place}, velocities in {} (header of the table)",
        table.unit.as_deref().unwrap_or("the same")
    )));
    if !is_pixel(place) && dataset.flow.as_ref().is_none_or(|flow| flow.velocities.dim().0 > 1) {
        let unit = &dataset.time_unit;
        notes.push(Note::guessed(format!(
            "frames follow each other at a time of 1 {unit}; set frame_interval in dataset.toml where that is not so"
        )));
    }
    notes
}
