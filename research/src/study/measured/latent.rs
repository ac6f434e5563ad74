//! Latent cells against the cells that are hidden.

use super::count::Count;
use super::record::Recovery;
use claims::measured::{View, Written};
use std::error::Error;
use std::path::Path;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_io::read_reals;

/// Farther than this from a hidden cell, in ℓ₀, a latent cell is another one.
const NEAR: f64 = 0.3;
/// Farther than this from a detection, in ℓ₀, a place of a track is that of a cell that was not detected.
const SAME: f64 = 0.5;
/// Cells nearer than this to the rim of a field of view, in ℓ₀, need not be found.
const RIM: f64 = 2.0;

/// A place in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub frame: usize,
    pub at: Vector<f64>,
}

/// The cells of a run where none was detected: latent cells, and places in the gaps and beyond the ends of tracks. `unit` is ℓ₀. None if it
/// names none.
pub fn read(
    data: &Path,
    out: &Path,
    domain: Domain,
    unit: f64,
) -> Result<Option<Vec<Place>>, Box<dyn Error>> {
    let [latent, trajectories] = ["latent_cells.npy", "trajectories.npy"].map(|name| out.join(name));
    if !latent.is_file() {
        return Ok(None);
    }
    let cells = read_reals(&latent)?;
    let place = |row: ndarray::ArrayViewD<'_, f64>| Place {
        frame: row[[2]] as usize,
        at: Vector::new(row[[0]], row[[1]]),
    };
    let mut unseen: Vec<Place> = cells.outer_iter().map(place).collect();
    if trajectories.is_file() {
        let (tracked, detected) = (places(&trajectories)?, places(&data.join("positions.npy"))?);
        let of_detections = matches(&detected, &tracked, domain, SAME * unit);
        unseen.extend(tracked.iter().zip(of_detections).filter(|(_, own)| own.is_none()).map(|(at, _)| *at));
    }
    Ok(Some(unseen))
}

/// All places of an array (frames, cells, 2).
fn places(path: &Path) -> Result<Vec<Place>, Box<dyn Error>> {
    let all = read_reals(path)?;
    let of_frame = |(frame, cells): (usize, ndarray::ArrayViewD<'_, f64>)| {
        let at = |row: ndarray::ArrayViewD<'_, f64>| Vector::new(row[[0]], row[[1]]);
        let places = cells.outer_iter().map(|row| Place { frame, at: at(row) });
        places.filter(|place| place.at.x.is_finite()).collect::<Vec<_>>()
    };
    Ok(all.outer_iter().enumerate().flat_map(of_frame).collect())
}

/// How many of the hidden cells a run found, and how many of its latent cells are hidden ones.
pub fn recovery(written: &Written, view: View, out: &Path) -> Result<Option<Recovery>, Box<dyn Error>> {
    let truth = &written.truth;
    let [_, _, width, height] = truth.field_of_view;
    let domain = match view {
        View::Whole => Domain::Periodic(PeriodicBox::new([width, height])?),
        View::Window => Domain::Open,
    };
    let Some(latent) = read(&written.data, out, domain, 1.0)? else {
        return Ok(None);
    };
    let inside = |x: f64, length: f64| view == View::Whole || (RIM..length - RIM).contains(&x);
    let (mut sites, mut groups) = (Vec::new(), Vec::new());
    for hidden in &truth.hidden {
        let first = sites.len();
        sites.extend(
            hidden.sites.iter().map(|site| Place { frame: hidden.frame, at: Vector::new(site[0], site[1]) }),
        );
        let is_expected = hidden.sites.iter().all(|site| inside(site[0], width) && inside(site[1], height));
        groups.push((first..sites.len(), is_expected));
    }
    // A merged detection is found if one of its two cells is; a program may name both.
    let found = matches(&latent, &sites, domain, NEAR);
    let expected = groups.into_iter().filter(|(_, is_expected)| *is_expected);
    let recall = Count::of(expected.map(|(group, _)| found[group].iter().any(Option::is_some)));
    Ok(Some(Recovery {
        hidden: recall.total,
        found: recall.hits,
        latent: latent.len(),
        right: found.iter().flatten().count(),
    }))
}

/// The latent cell that is each of some hidden ones, the nearest first.
pub fn matches(latent: &[Place], hidden: &[Place], domain: Domain, near: f64) -> Vec<Option<usize>> {
    let distance = |a: &Place, b: &Place| (a.frame == b.frame).then(|| domain.shortest(b.at - a.at).norm());
    let mut pairs = Vec::new();
    for (site, place) in hidden.iter().enumerate() {
        let near = latent.iter().enumerate().filter_map(|(index, own)| {
            distance(place, own).filter(|distance| *distance <= near).map(|distance| (distance, site, index))
        });
        pairs.extend(near);
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut found, mut taken) = (vec![None; hidden.len()], vec![false; latent.len()]);
    for (_, site, index) in pairs {
        if found[site].is_none() && !taken[index] {
            (found[site], taken[index]) = (Some(index), true);
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
        let hidden = [at(0, 1.0), at(0, 1.2), at(1, 1.0)];
        let latent = [at(0, 1.15), at(0, 0.9), at(1, 1.5)];
        assert_eq!(matches(&latent, &hidden, Domain::Open, 0.3), [Some(1), Some(0), None]);
        let cell_box = Domain::Periodic(PeriodicBox::new([4.0, 4.0]).unwrap());
        assert_eq!(matches(&[at(0, 3.9)], &[at(0, 0.1)], cell_box, 0.3), [Some(0)]);
    }
}
