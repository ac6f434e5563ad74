//! Importing points that nobody has followed: a table, or an array of points of napari.

use std::path::Path;

use voronudge_geometry::{Domain, PeriodicBox, Vector};

use crate::boundary::Boundary;
use crate::error::{Error, SettingFault, table_error};
use crate::input::read_input;
use crate::linking::{Follower, Place, PlaceLinking, default_limit};
use crate::napari;
use crate::note::Note;
use crate::positive::positive;
use crate::table::{Layout, decompressed, read_spots};
use crate::tracks::{Import, ImportOptions, finish, frame_span};

/// Points that were followed from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PointImport {
    /// The data set; tracks are numbered in the order in which they begin.
    pub import: Import,
    /// Points in each frame.
    pub counts: Vec<usize>,
    /// Points that continue one of the frame before, over all frames.
    pub linked: usize,
}

/// Imports a table with one row per point: x, y and perhaps a frame; or a `.npy` array of rows (frame, (z,)) y, x, as napari keeps points.
/// Separators, encodings and names of columns are those of [`crate::import_tracks`].
///
/// # Errors
/// [`Error::File`] and [`Error::Table`], the latter with the line; [`Error::Shape`] for an array of another shape; [`Error::Setting`] for
/// options out of range; [`Error::Value`] for two points in one place.
pub fn import_points(
    path: &Path,
    options: &ImportOptions,
    linking: PlaceLinking,
) -> Result<PointImport, Error> {
    options.scale.begin(Boundary::Open)?;
    if let PlaceLinking::Nearest { limit: Some(limit) } = linking {
        positive("link_limit", limit).map_err(Error::Setting)?;
    }
    let (bytes, record) = read_input(path)?;
    let unfolded = decompressed(&bytes).map_err(|fault| table_error(path, fault))?;
    let mut table = match unfolded.starts_with(napari::SIGNATURE) {
        true => napari::read_layer(path, &unfolded, Layout::Points)?,
        false => read_spots(path, &unfolded, Layout::Points, &options.columns)?,
    };
    let (first, frames) =
        frame_span(table.spots.iter().map(|spot| spot.frame)).map_err(|fault| table_error(path, fault))?;
    table.stated.is_still = frames == 1;
    let mut notes = Vec::new();
    let pixel = table.stated.settle(&options.scale, &mut notes).pixel_size.unwrap_or(1.0);
    let domain = match options.boundary {
        Some(Boundary::Periodic { lengths }) => {
            let fault =
                |_| Error::Setting(SettingFault::NotPositive { key: "box length", value: lengths[0] });
            Domain::Periodic(PeriodicBox::new(lengths).map_err(fault)?)
        }
        _ => Domain::Open,
    };
    let mut rows: Vec<Vec<usize>> = vec![Vec::new(); frames];
    for (row, spot) in table.spots.iter().enumerate() {
        rows[(spot.frame - first) as usize].push(row);
    }
    let mut follower = Follower::new(linking, domain);
    let mut limits: Option<[f64; 2]> = None;
    for rows in &rows {
        let places: Vec<Place> = rows
            .iter()
            .map(|&row| {
                let spot = &table.spots[row];
                Place { position: Vector::new(spot.x * pixel, spot.y * pixel), kind: 0 }
            })
            .collect();
        let spacing = spacing(&places, options.boundary);
        let [low, high] = limits.unwrap_or([spacing; 2]);
        limits = Some([low.min(spacing), high.max(spacing)]);
        for (&row, track) in rows.iter().zip(follower.follow(&places, spacing)) {
            table.spots[row].track = track as i64;
        }
    }
    if let (PlaceLinking::Nearest { limit: None }, Some([low, high]), true) = (linking, limits, frames > 1) {
        // Three digits are enough to see whether that is meant.
        let limit = |spacing: f64| format!("{:.3}", default_limit(spacing));
        let range = if low == high { limit(low) } else { format!("{} to {}", limit(low), limit(high)) };
        table.notes.push(Note::guessed(format!(
            "cells move by no more than {range} between frames, half their distance"
        )));
    }
    let import = finish(path, options, record, (table, Layout::Points))?;
    let counts = rows.iter().map(Vec::len).collect();
    Ok(PointImport { import, counts, linked: follower.linked })
}

/// The mean distance of points: in the periodic box, or in the rectangle around them.
fn spacing(places: &[Place], boundary: Option<Boundary>) -> f64 {
    let area = match boundary {
        Some(Boundary::Periodic { lengths }) => lengths[0] * lengths[1],
        _ => [0, 1]
            .map(|axis| {
                let along = || places.iter().map(|place| place.position[axis]);
                along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
            })
            .iter()
            .product(),
    };
    (area.max(0.0) / places.len().max(1) as f64).sqrt()
}
