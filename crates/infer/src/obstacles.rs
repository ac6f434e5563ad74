//! Where a step fails: the places at which the linearised problem does not hold, because contacts change there.

use voronudge_geometry::Tessellation;

/// Share of the promised decrease that the rest of the tissue must keep.
const KEPT: f64 = 0.5;

/// Share of all places that may be obstacles: what fails at more of them fails as a whole.
const FEW: f64 = 0.1;

/// Neighbours over so many rings make the velocity of a cell.
const RINGS: usize = 2;

/// The terms of Φ, by their owners, without which a step keeps its promise, the worst first; none if they are more than a few of so many places.
pub(crate) fn failing<O: Copy>(
    before: &[(O, f64)],
    after: &[(O, f64)],
    promised: f64,
    places: usize,
) -> Option<Vec<O>> {
    let mut changes: Vec<(O, f64)> =
        after.iter().zip(before).map(|((owner, after), (_, before))| (*owner, after - before)).collect();
    if !changes.iter().all(|change| change.1.is_finite()) {
        return None;
    }
    changes.sort_unstable_by(|one, other| other.1.total_cmp(&one.1));
    let mut rest: f64 = changes.iter().map(|change| change.1).sum();
    let most = (FEW * places as f64) as usize;
    let mut owners = Vec::new();
    for (owner, change) in changes.iter().take(most) {
        if rest <= -KEPT * promised {
            break;
        }
        rest -= change;
        owners.push(*owner);
    }
    (rest <= -KEPT * promised).then_some(owners)
}

/// A cell with those on which its velocity depends.
pub(crate) fn around(tessellation: &Tessellation, cell: usize) -> Vec<usize> {
    let mut within = vec![cell];
    let mut last = 0;
    for _ in 0..RINGS {
        let ring = last..within.len();
        last = ring.end;
        for k in ring {
            for &neighbour in tessellation.neighbours(within[k]) {
                if !within.contains(&(neighbour as usize)) {
                    within.push(neighbour as usize);
                }
            }
        }
    }
    within
}
