//! Separators against all others that would do.

use voronudge_linalg::{DissectedPattern, SymmetricMatrix};

/// Nodes of either side that may be coupled across, and all of a side.
const CROSSING: [usize; 2] = [5, 6];
const NODES: [usize; 2] = [12, 13];
/// Nodes of a copy.
const ALL: usize = NODES[0] + NODES[1];

/// Whether nodes are coupled across.
fn coupled(seed: u32, a: usize, b: usize) -> bool {
    (f64::from(seed) + 7.1 * a as f64 + 1.7 * b as f64).sin() > 0.4
}

/// The couplings across of a copy, as places among the nodes that may have some: of the first side, then of the second.
fn edges(seed: u32) -> Vec<(usize, usize)> {
    let [near, far] = CROSSING;
    let all = (0..near).flat_map(|a| (near..near + far).map(move |b| (a, b)));
    all.filter(|&(a, b)| coupled(seed, a, b)).collect()
}

/// Copies that are not coupled; the nodes of a side are all at one place, so that a copy can be cut in one way only, and all coupled
/// to the last of the side.
fn pattern(seeds: &[u32]) -> (SymmetricMatrix, Vec<Option<[f64; 3]>>) {
    let mut pairs = Vec::new();
    let mut places = Vec::new();
    for (copy, &seed) in seeds.iter().enumerate() {
        let first = copy * ALL;
        let node = |k: usize| first + if k < CROSSING[0] { k } else { NODES[0] + k - CROSSING[0] };
        pairs.extend(edges(seed).into_iter().map(|(a, b)| (node(a), node(b))));
        pairs.extend((0..NODES[0] - 1).map(|k| (first + k, first + NODES[0] - 1)));
        pairs.extend((NODES[0]..ALL - 1).map(|k| (first + k, first + ALL - 1)));
        let of_side = |side: usize| vec![Some([side as f64, 3.0 * copy as f64, 0.0]); NODES[side]];
        places.extend([0, 1].into_iter().flat_map(of_side));
    }
    let (mut start, mut row) = (vec![0], Vec::new());
    for column in 0..places.len() {
        row.push(column);
        let mut below: Vec<usize> = pairs.iter().filter(|pair| pair.0 == column).map(|pair| pair.1).collect();
        below.sort_unstable();
        row.extend(below);
        start.push(row.len());
    }
    let mut column = start.iter().peekable();
    let value = (0..row.len()).map(|k| match column.next_if_eq(&&k) {
        Some(_) => 20.0,
        None => -1.0,
    });
    let value = value.collect();
    (SymmetricMatrix::new(start, row, value).unwrap(), places)
}

/// Every coupling across is cut, and by no more nodes than any other choice would take.
///
/// What separates is seen by the entries of the inverse: nodes apart meet in none. A separator of fewest nodes couples to the rest of both sides, so that each
/// of its nodes meets the last nodes of both, and each other node one of them. Cuts are made one after the other in the same room.
#[test]
fn the_separator_is_the_smallest_that_separates() {
    let [near, far] = CROSSING;
    for seed in 0..40 {
        let seeds = [seed, seed + 40];
        let (matrix, places) = pattern(&seeds);
        let factor = DissectedPattern::new(&matrix, &places).unwrap().factor(&matrix).unwrap();
        let inverse = factor.selected_inverse().unwrap();
        for (copy, &seed) in seeds.iter().enumerate() {
            let first = copy * ALL;
            let met = |node: usize| {
                [NODES[0] - 1, ALL - 1].map(|last| inverse.entry(first + node, first + last).is_some())
            };
            let separator: Vec<usize> = (0..ALL).filter(|&node| met(node) == [true; 2]).collect();
            let rest = [[true, false], [false, true]]
                .map(|side| (0..ALL).filter(|&node| met(node) == side).collect::<Vec<_>>());
            let apart = |a: &usize| rest[1].iter().all(|b| inverse.entry(first + a, first + b).is_none());
            assert!(rest[0].iter().all(apart));
            assert!(rest[0].iter().all(|a| *a < NODES[0]) && rest[1].iter().all(|b| *b >= NODES[0]));
            let edges = edges(seed);
            let covers =
                |chosen: u32| edges.iter().all(|(a, b)| chosen >> a & 1 == 1 || chosen >> b & 1 == 1);
            let place = |node: &usize| if *node < NODES[0] { *node } else { node - NODES[0] + near };
            let chosen = separator.iter().map(place).fold(0, |chosen, node| chosen | 1 << node);
            assert!(covers(chosen));
            let fewest = (0..1u32 << (near + far)).filter(|c| covers(*c)).map(u32::count_ones).min();
            assert_eq!(fewest, Some(separator.len() as u32), "{seed}");
            assert_eq!(rest.iter().map(Vec::len).sum::<usize>() + separator.len(), ALL);
        }
    }
}
