//! Sites instead of centroids, from where outlines touch.

use crate::failure::Failure;
use clap::ValueEnum;
use ndarray::Array2;
use std::collections::BTreeMap;
use voronudge_geometry::{Interface, Vector};
use voronudge_infer::{Outlined, sites};
use voronudge_io::{PositionsAre, ShapeImport};
use voronudge_report::shape_report::SiteRecord;

/// What of a cell its position is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Positions {
    /// The sites whose Voronoi polygons follow the outlines best, with their errors.
    Sites,
    /// Centroids of the outlines.
    Centroids,
}

/// Puts positions at the sites and writes down their errors.
pub(super) fn place_at_sites(import: &mut ShapeImport) -> Result<SiteRecord, Failure> {
    let seen = import.dataset.field_of_view.as_ref().and_then(|area| area.region().ok());
    let mut errors = Array2::from_elem(import.areas.dim(), f64::NAN);
    let (mut length, mut before, mut after, mut offset, mut count) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (frame, known) in import.frames.iter().enumerate() {
        let tracks: Vec<usize> =
            (0..import.areas.ncols()).filter(|&track| import.areas[(frame, track)].is_finite()).collect();
        let index: BTreeMap<usize, usize> = tracks.iter().copied().zip(0..).collect();
        let place = |track: usize, import: &ShapeImport| {
            let positions = &import.dataset.positions;
            Vector::new(positions[(frame, track, 0)], positions[(frame, track, 1)])
        };
        let cells: Vec<Outlined> = tracks
            .iter()
            .map(|&track| Outlined {
                centroid: place(track, import),
                area: import.areas[(frame, track)],
                is_cut: known.cut.contains(&track),
            })
            .collect();
        let lines: Vec<Interface> = known
            .interfaces
            .iter()
            .filter_map(|line| {
                let [a, b] = line.cells.map(|track| index.get(&track).copied());
                Some(Interface { cells: [a?, b?], ..*line })
            })
            .collect();
        let found = sites(&cells, &lines)?;
        let own: f64 = lines.iter().map(|line| line.length).sum();
        length += own;
        before += own * found.misfit_of_centroids.powi(2);
        after += own * found.misfit.powi(2);
        for ((&track, (site, error)), cell) in
            tracks.iter().zip(found.positions.iter().zip(&found.errors)).zip(&cells)
        {
            // A cell whose site is beyond the image stays where it is seen.
            let (site, error) = match &seen {
                Some(region) if !region.holds(*site) => {
                    let off = (site - cell.centroid).norm() * std::f64::consts::FRAC_1_SQRT_2;
                    (cell.centroid, error.hypot(off))
                }
                _ => (*site, *error),
            };
            errors[(frame, track)] = error;
            for axis in 0..2 {
                import.dataset.positions[(frame, track, axis)] = site[axis];
            }
            if !cell.is_cut {
                offset += (site - cell.centroid).norm_squared();
                count += 1.0;
            }
        }
    }
    let mut sorted: Vec<f64> = errors.iter().copied().filter(|error| error.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    import.dataset.position_errors = Some(errors);
    import.dataset.positions_are = Some(PositionsAre::SITES);
    Ok(SiteRecord {
        misfit_of_centroids: (before / length).sqrt(),
        misfit: (after / length).sqrt(),
        offset: (offset / count).sqrt(),
        median_error: sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN),
    })
}
