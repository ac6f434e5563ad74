//! What an array is, by its shape and its numbers.

use std::path::Path;

use ndarray::{ArrayD, Axis};

use super::{InputKind, Inspection, of_stack};
use crate::array::{parse_integers, parse_reals, pickled};
use crate::error::{Error, FormatFault, ShapeFault};
use crate::image::{Wanted, parse_field_images};
use crate::linking::PlaceLinking;
use crate::note::Note;
use crate::points::import_points;
use crate::series::read_images;
use crate::tracks::{ImportOptions, import_tracks};

/// What an array of numbers is; `None` for one of labels, which is an image like others.
pub(super) fn of_array(path: &Path, bytes: &[u8]) -> Result<Option<Inspection>, Error> {
    if pickled(bytes).is_some() {
        return Ok(None);
    }
    match parse_integers(path, bytes) {
        // A narrow array of integers may be one of tracks; others are labels.
        Ok(array) if matches!(array.shape(), [rows, 4 | 5] if *rows > 5) => of_tracks(path).map(Some),
        Ok(_) => Ok(None),
        Err(Error::Format { fault: FormatFault::UnsupportedType { .. }, .. }) => {
            of_reals(path, parse_reals(path, bytes)?).map(Some)
        }
        Err(error) => Err(error),
    }
}

fn of_reals(path: &Path, array: ArrayD<f64>) -> Result<Inspection, Error> {
    let shape = array.shape().to_vec();
    let vectors = |kind, axes: &str| {
        let notes = vec![Note::guessed(format!("axes are {axes}"))];
        Inspection {
            shape: Some(shape.clone()),
            files: vec![path.to_path_buf()],
            notes,
            ..Inspection::of(kind)
        }
    };
    match shape.as_slice() {
        [_, 4 | 5] if counts(&array, 2) => of_tracks(path),
        [_, 3] if counts(&array, 1) => {
            let found = import_points(path, &ImportOptions::default(), PlaceLinking::Separate)?.import;
            Ok(Inspection::of_points(&found.dataset, found.notes))
        }
        [cells, 2] => {
            let axes = "cells, and x and y (in a points layer of napari y comes first)";
            Ok(Inspection { frames: Some(1), cells: Some(*cells), ..vectors(InputKind::Positions, axes) })
        }
        [frames, cells, 2] => {
            let axes = "frames, cells, and x and y; one frame of vectors on a grid looks the same";
            let (frames, cells) = (Some(*frames), Some(*cells));
            Ok(Inspection { frames, cells, ..vectors(InputKind::Positions, axes) })
        }
        [frames, _, _, 2] => {
            let axes = "frames, rows, columns, and x and y";
            Ok(Inspection { frames: Some(*frames), ..vectors(InputKind::FlowArray, axes) })
        }
        [_, _] | [_, _, _] => {
            let stack = read_images(&[path.to_path_buf()], Wanted::Field, parse_field_images)?;
            of_stack(InputKind::Field, &stack)
        }
        _ => {
            const EXPECTED: &str = "two to four";
            let fault = ShapeFault::Dimensions { found: shape, expected: EXPECTED };
            Err(Error::Shape { path: path.to_path_buf(), fault })
        }
    }
}

fn of_tracks(path: &Path) -> Result<Inspection, Error> {
    let found = import_tracks(path, &ImportOptions::default())?;
    Ok(Inspection::of_data(InputKind::Tracks, &found.dataset, found.notes))
}

/// Whether the first columns of an array hold whole numbers only, as those of tracks and frames do.
fn counts(array: &ArrayD<f64>, columns: usize) -> bool {
    array.axis_iter(Axis(0)).all(|row| row.iter().take(columns).all(|value| value.fract() == 0.0))
}
