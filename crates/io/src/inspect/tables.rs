//! What a table is, by the names of its columns.

use std::collections::BTreeSet;
use std::path::Path;

use super::{InputKind, Inspection};
use crate::error::{Error, TableFault, table_error};
use crate::linking::PlaceLinking;
use crate::note::Note;
use crate::outline_import::{OutlineOptions, import_outlines};
use crate::points::import_points;
use crate::shapes::ShapeImport;
use crate::table::{FlowColumnNames, decompressed, read_table};
use crate::trackmate_xml::is_xml;
use crate::tracks::{ImportOptions, import_trackmate, import_tracks};

/// The most specific kind of table that it can be read as; else what is wrong with it as one of tracks.
pub(super) fn of_table(path: &Path, bytes: &[u8]) -> Result<Inspection, Error> {
    let options = ImportOptions::default();
    let unfolded = decompressed(bytes).map_err(|fault| table_error(path, fault))?;
    let trackmate = import_trackmate(path, &options);
    if is_xml(&unfolded) || trackmate.is_ok() {
        let found = trackmate?;
        return Ok(Inspection::of_data(InputKind::TrackMate, &found.dataset, found.notes));
    }
    if let Ok(vectors) = read_table(path, bytes, &FlowColumnNames::default()) {
        let frames: BTreeSet<i64> = vectors.vectors.iter().map(|vector| vector.frame).collect();
        let unit = vectors.unit.map(|unit| Note::read(format!("displacements in {unit}")));
        let notes = unit.into_iter().chain(vectors.notes).collect();
        return Ok(Inspection {
            shape: Some(vec![vectors.vectors.len()]),
            frames: Some(frames.len()),
            files: vec![path.to_path_buf()],
            notes,
            ..Inspection::of(InputKind::FlowTable)
        });
    }
    let error = match import_tracks(path, &options) {
        Ok(found) => return Ok(Inspection::of_data(InputKind::Tracks, &found.dataset, found.notes)),
        Err(error) => error,
    };
    // Corners of one cell in one frame look like a track in several places.
    let (may_be_outlines, may_be_points) = match &error {
        Error::Table { fault: TableFault::MissingColumn { role, .. }, .. } => {
            (*role == "frame", *role == "track")
        }
        Error::Table { fault: TableFault::SpotTwice { .. }, .. } => (true, true),
        Error::Table { fault: TableFault::Untracked { .. }, .. } => (false, true),
        _ => (false, false),
    };
    if may_be_outlines && let Ok(found) = import_outlines(path, &OutlineOptions::default()) {
        let ShapeImport { dataset, notes, .. } = found;
        return Ok(Inspection::of_data(InputKind::Outlines, &dataset, notes));
    }
    if may_be_points && let Ok(found) = import_points(path, &options, PlaceLinking::Separate) {
        return Ok(Inspection::of_points(&found.import.dataset, found.import.notes));
    }
    Err(error)
}
