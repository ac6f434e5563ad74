//! Sites and centroids of cells, from where outlines touch.

use crate::failure::Failure;
use clap::ValueEnum;
use ndarray::{Array2, Array3};
use std::collections::{BTreeMap, BTreeSet};
use voronudge_geometry::{Domain, Interface, Tessellation, Vector};
use voronudge_infer::{Outlined, sites};
use voronudge_io::{DataSet, Noise, PositionsAre, ShapeImport, Snapshot};
use voronudge_report::shape_report::SiteRecord;

/// What of a cell its position is to be, with its error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Positions {
    /// The centroid of its outline, whose errors are small and nearly independent.
    Centroids,
    /// The site whose Voronoi polygon follows the outline best. Errors of neighbouring sites have opposite signs,
    /// which fits do not take into account.
    Sites,
}

/// Where cells were seen as a whole.
pub(super) struct Centroids {
    positions: Array3<f64>,
    /// NaN for cells that go on beyond the image or touch no other.
    errors: Array2<f64>,
}

impl Centroids {
    /// Puts positions at the centroids. Cells whose centroid is not known, or whose Voronoi polygon may be another because of cells beyond the image,
    /// stay at their sites: a fit has nothing to compare a centroid with there.
    pub fn apply_to(&self, dataset: &mut DataSet) {
        let of_centroids = DataSet { positions: self.positions.clone(), ..dataset.clone() };
        let certain = [&*dataset, &of_centroids].map(certain_cells);
        for (at, error) in self.errors.indexed_iter().filter(|(_, error)| error.is_finite()) {
            if !certain.iter().all(|cells| cells.contains(&at)) {
                continue;
            }
            for axis in 0..2 {
                dataset.positions[(at.0, at.1, axis)] = self.positions[(at.0, at.1, axis)];
            }
            if let Some(errors) = &mut dataset.position_errors {
                errors[at] = *error;
            }
        }
        dataset.positions_are = Some(PositionsAre::CENTROIDS);
    }
}

/// Frame and track of the cells whose Voronoi polygon is certain.
fn certain_cells(dataset: &DataSet) -> BTreeSet<(usize, usize)> {
    let view = dataset.view().unwrap_or_default();
    let mut certain = BTreeSet::new();
    for frame in 0..dataset.frames() {
        let snapshot = Snapshot::new(dataset, frame);
        let Ok(tessellation) = Tessellation::new(&snapshot.positions, Domain::Open) else { continue };
        let judged = view.judge(&tessellation, &snapshot.positions);
        for (cell, visibility) in snapshot.cells.iter().zip(judged.visibility()) {
            if visibility.has_certain_polygon() {
                certain.insert((frame, *cell));
            }
        }
    }
    certain
}

/// Puts positions at the sites and writes down their errors; returns the centroids where they were.
pub(super) fn place_at_sites(import: &mut ShapeImport) -> Result<(SiteRecord, Centroids), Failure> {
    let seen = import.dataset.field_of_view.as_ref().and_then(|area| area.region().ok());
    let mut errors = Array2::from_elem(import.areas.dim(), f64::NAN);
    let mut centroids = Centroids { positions: import.dataset.positions.clone(), errors: errors.clone() };
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
        let places = found.positions.iter().zip(&found.errors).zip(&found.centroid_errors);
        for ((&track, cell), ((site, error), centroid_error)) in tracks.iter().zip(&cells).zip(places) {
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
                centroids.errors[(frame, track)] = *centroid_error;
                offset += (site - cell.centroid).norm_squared();
                count += 1.0;
            }
        }
    }
    let mut sorted: Vec<f64> = errors.iter().copied().filter(|error| error.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    import.dataset.position_errors = Some(errors);
    // How far outlines are from lines also shows how much cells are no Voronoi polygons: errors are known in proportion.
    import.dataset.position_noise = Some(Noise::Estimated);
    import.dataset.positions_are = Some(PositionsAre::SITES);
    let record = SiteRecord {
        misfit_of_centroids: (before / length).sqrt(),
        misfit: (after / length).sqrt(),
        offset: (offset / count).sqrt(),
        median_error: sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN),
    };
    Ok((record, centroids))
}
