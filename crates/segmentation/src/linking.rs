//! Which cell of a frame is which of the next.

use crate::Error;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;
use voronudge_geometry::{Domain, Vector};

/// For each place of a frame, the index of the same cell among the places of the next, if one is within `limit`.
///
/// Pairs are made from the nearest up, each place at most once. If no cell moves by as much as half the distance to its nearest
/// neighbour, this is the assignment of least total distance; beyond that, cells that pass each other may be exchanged.
pub fn link_nearest(
    before: &[Vector<f64>],
    after: &[Vector<f64>],
    limit: f64,
    domain: Domain,
) -> Vec<Option<usize>> {
    let places = after.iter().enumerate().map(|(j, to)| {
        let to = domain.wrap(*to);
        GeomWithData::new([to.x, to.y], j)
    });
    let places = RTree::bulk_load(places.collect());
    // What is near by the rounded places is looked at by the given ones.
    let reach = (1.001 * limit).powi(2);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (i, from) in before.iter().enumerate() {
        let found = images(*from, limit, domain);
        let found = found.iter().flat_map(|image| places.locate_within_distance(*image, reach));
        for j in found.map(|place| place.data) {
            let distance = domain.shortest(after[j] - from).norm();
            if distance <= limit {
                pairs.push((distance, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let (mut next, mut taken) = (vec![None; before.len()], vec![false; after.len()]);
    for (_, i, j) in pairs {
        if next[i].is_none() && !taken[j] {
            (next[i], taken[j]) = (Some(j), true);
        }
    }
    next
}

/// Where a place is met from places in the box that are within `limit` of one of its images.
fn images(from: Vector<f64>, limit: f64, domain: Domain) -> Vec<[f64; 2]> {
    let Domain::Periodic(own) = domain else { return vec![[from.x, from.y]] };
    let [width, height] = own.lengths();
    let within = |value: f64, length: f64| -limit <= value && value <= length + limit;
    // A shortest displacement spans half a box at most, so it begins in the box or in one beside it.
    let rows = (-1..=1).flat_map(|row| {
        // The box above is displaced by shear, so columns are counted in each row by itself.
        let image = from + own.translation([0, row - own.image(from)[1]]);
        let column = (image.x / width).floor();
        (-1..=1).map(move |shift: i32| [image.x + (f64::from(shift) - column) * width, image.y])
    });
    rows.filter(|[x, y]| within(*x, width) && within(*y, height)).collect()
}

/// For each label of an image, the label of the next that it shares most pixels with, if that one shares most pixels with it too.
///
/// Of equal numbers of pixels the lowest label counts.
///
/// # Errors
/// [`Error::Raster`] if the images differ in size.
pub fn link_overlapping(before: &[i64], after: &[i64]) -> Result<BTreeMap<i64, i64>, Error> {
    if before.len() != after.len() {
        return Err(Error::Raster { values: after.len(), columns: before.len(), rows: 1 });
    }
    let mut shared: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    for pair in before.iter().copied().zip(after.iter().copied()).filter(|&(a, b)| a != 0 && b != 0) {
        *shared.entry(pair).or_insert(0) += 1;
    }
    let (mut forward, mut backward) = (BTreeMap::new(), BTreeMap::new());
    for (&(a, b), &pixels) in &shared {
        keep_larger(&mut forward, a, (pixels, b));
        keep_larger(&mut backward, b, (pixels, a));
    }
    let mutual = |(&a, &(_, b)): (&i64, &(usize, i64))| {
        backward.get(&b).is_some_and(|&(_, back)| back == a).then_some((a, b))
    };
    Ok(forward.iter().filter_map(mutual).collect())
}

fn keep_larger(best: &mut BTreeMap<i64, (usize, i64)>, key: i64, candidate: (usize, i64)) {
    let kept = best.entry(key).or_insert(candidate);
    if candidate.0 > kept.0 {
        *kept = candidate;
    }
}
