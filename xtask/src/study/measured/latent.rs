//! Latent cells against the cells that are hidden.

use super::record::Recovery;
use claims::measured::{Truth, View};
use std::error::Error;
use std::path::Path;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_io::read_reals;

/// Farther than this from a hidden cell, in ℓ₀, a latent cell is another one.
const NEAR: f64 = 0.3;
/// Cells nearer than this to the rim of a field of view, in ℓ₀, need not be found.
const RIM: f64 = 2.0;

/// A place in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub frame: usize,
    pub at: Vector<f64>,
}

/// The latent cells of a run; none if it names none.
pub fn read(out: &Path) -> Result<Option<Vec<Place>>, Box<dyn Error>> {
    let path = out.join("latent_cells.npy");
    if !path.is_file() {
        return Ok(None);
    }
    let cells = read_reals(&path)?;
    let place = |row: ndarray::ArrayViewD<'_, f64>| Place {
        frame: row[[2]] as usize,
        at: Vector::new(row[[0]], row[[1]]),
    };
    Ok(Some(cells.outer_iter().map(place).collect()))
}

/// How many of the hidden cells a run found, and how many of its latent cells are hidden ones.
pub fn recovery(truth: &Truth, view: View, out: &Path) -> Result<Option<Recovery>, Box<dyn Error>> {
    let Some(latent) = read(out)? else {
        return Ok(None);
    };
    let [_, _, width, height] = truth.field_of_view;
    let domain = match view {
        View::Whole => Domain::Periodic(PeriodicBox::new([width, height])?),
        View::Window => Domain::Open,
    };
    let groups: Vec<Vec<Place>> = truth
        .hidden
        .iter()
        .map(|hidden| {
            let place = |site: &[f64; 2]| Place { frame: hidden.frame, at: Vector::new(site[0], site[1]) };
            hidden.sites.iter().map(place).collect()
        })
        .collect();
    let found = matches(&latent, &groups, domain, NEAR);
    let inside = |x: f64, length: f64| (RIM..length - RIM).contains(&x);
    let counts = |group: &[Place]| {
        view == View::Whole
            || group.iter().all(|place| inside(place.at.x, width) && inside(place.at.y, height))
    };
    let expected: Vec<usize> = (0..groups.len()).filter(|group| counts(&groups[*group])).collect();
    Ok(Some(Recovery {
        hidden: expected.len(),
        found: expected.iter().filter(|group| found[**group].is_some()).count(),
        latent: latent.len(),
        right: found.iter().flatten().count(),
    }))
}

/// The latent cell that is each of some groups of hidden ones, at most one of a group, the nearest first.
pub fn matches(latent: &[Place], groups: &[Vec<Place>], domain: Domain, near: f64) -> Vec<Option<usize>> {
    let mut pairs = Vec::new();
    for (group, places) in groups.iter().enumerate() {
        for (index, own) in latent.iter().enumerate() {
            let same_frame = places.iter().filter(|place| place.frame == own.frame);
            let distances = same_frame.map(|place| domain.shortest(own.at - place.at).norm());
            if let Some(distance) = distances.min_by(f64::total_cmp).filter(|distance| *distance <= near) {
                pairs.push((distance, group, index));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut found, mut taken) = (vec![None; groups.len()], vec![false; latent.len()]);
    for (_, group, index) in pairs {
        if found[group].is_none() && !taken[index] {
            (found[group], taken[index]) = (Some(index), true);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_is_matched_once() {
        let at = |frame, x| Place { frame, at: Vector::new(x, 0.0) };
        let groups = [vec![at(0, 1.0)], vec![at(0, 1.2), at(0, 2.0)], vec![at(1, 1.0)]];
        let latent = [at(0, 1.15), at(0, 0.9), at(1, 1.5)];
        assert_eq!(matches(&latent, &groups, Domain::Open, 0.3), [Some(1), Some(0), None]);
        let cell_box = Domain::Periodic(PeriodicBox::new([4.0, 4.0]).unwrap());
        assert_eq!(matches(&[at(0, 3.9)], &[vec![at(0, 0.1)]], cell_box, 0.3), [Some(0)]);
    }
}
