//! Which cell of a frame is which of the next.

use crate::{Domain, Error, Vector};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PeriodicBox, honeycomb};
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn cells_are_followed_across_the_box() {
        let (before, lengths) = honeycomb(5, 6);
        let domain = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
        let moved: Vec<Vector<f64>> = before.iter().map(|r| r + Vector::new(0.4, -0.2)).collect();
        // The last cell is gone, the others come in reverse order.
        let after: Vec<Vector<f64>> = moved[..29].iter().rev().copied().collect();
        let links = link_nearest(&before, &after, 0.5, domain);
        assert!((0..29).all(|k| links[k] == Some(28 - k)) && links[29].is_none());
        assert!(link_nearest(&before, &after, 0.1, domain).iter().all(Option::is_none));
    }

    /// All pairs, tried one by one.
    fn tried(
        before: &[Vector<f64>],
        after: &[Vector<f64>],
        limit: f64,
        domain: Domain,
    ) -> Vec<Option<usize>> {
        let all = (0..before.len()).flat_map(|i| (0..after.len()).map(move |j| (i, j)));
        let distance = |(i, j): (usize, usize)| domain.shortest(after[j] - before[i]).norm();
        let mut pairs: Vec<_> = all.filter(|pair| distance(*pair) <= limit).collect();
        pairs.sort_by(|a, b| distance(*a).total_cmp(&distance(*b)).then(a.cmp(b)));
        let mut next = vec![None; before.len()];
        for (i, j) in pairs {
            if next[i].is_none() && !next.contains(&Some(j)) {
                next[i] = Some(j);
            }
        }
        next
    }

    #[test]
    fn the_index_finds_the_pairs_that_trying_all_finds() {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut scattered = |count: usize, width: f64| -> Vec<Vector<f64>> {
            let mut place = || random.random_range(-width..2.0 * width);
            (0..count).map(|_| Vector::new(place(), place())).collect()
        };
        for offset in [0.0, 0.7, -37.9] {
            let domain = Domain::Periodic(PeriodicBox::sheared([6.0, 4.0], offset).unwrap());
            for domain in [domain, Domain::Open] {
                let (before, after) = (scattered(80, 6.0), scattered(90, 6.0));
                for limit in [0.0, 0.2, 1.0, 1.9, 3.5, 20.0, f64::INFINITY, -1.0, f64::NAN] {
                    let found = link_nearest(&before, &after, limit, domain);
                    assert_eq!(found, tried(&before, &after, limit, domain), "{domain:?}, {limit}");
                }
            }
        }
    }

    #[test]
    fn the_larger_overlap_wins_on_both_sides() {
        let before = [1, 1, 1, 2, 2, 2, 0, 3];
        let after = [5, 5, 6, 6, 6, 0, 7, 0];
        let links = link_overlapping(&before, &after).unwrap();
        assert_eq!(links.into_iter().collect::<Vec<_>>(), [(1, 5), (2, 6)]);
        assert!(link_overlapping(&before, &after[1..]).is_err());
    }
}
