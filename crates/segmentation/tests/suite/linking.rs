//! Cells followed from frame to frame.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use voronudge_geometry::{Domain, PeriodicBox, Vector, honeycomb};
use voronudge_segmentation::{link_nearest, link_overlapping};

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
fn tried(before: &[Vector<f64>], after: &[Vector<f64>], limit: f64, domain: Domain) -> Vec<Option<usize>> {
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
