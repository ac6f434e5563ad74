//! Matrices for tests: the stencil of a tissue, with pseudo-random blocks.

use voronudge_linalg::{BlockSparse, SymmetricMatrix};

/// The arrays of a matrix of blocks.
pub struct Stencil {
    pub start: Vec<usize>,
    pub column: Vec<u32>,
    pub block: Vec<[f64; 4]>,
}

impl Stencil {
    pub fn matrix(self) -> BlockSparse {
        BlockSparse::new(self.start, self.column, self.block).unwrap()
    }
}

/// A periodic triangular lattice of `side × side` sites coupled over two rings, which decays: a random symmetric part,
/// dominated by its diagonal, and an antisymmetric part of a strength.
pub fn lattice(side: usize, antisymmetric: f64) -> BlockSparse {
    stencil(side, antisymmetric).matrix()
}

/// Its arrays.
pub fn stencil(side: usize, antisymmetric: f64) -> Stencil {
    let site = |x: i64, y: i64| {
        let wrap = |k: i64| k.rem_euclid(side as i64) as usize;
        wrap(y) * side + wrap(x)
    };
    let mut rows: Vec<std::collections::BTreeMap<u32, [f64; 4]>> = vec![Default::default(); side * side];
    for i in 0..side * side {
        let (x, y) = ((i % side) as i64, (i / side) as i64);
        for (dx, dy) in [(1, 0), (0, 1), (1, -1), (2, 0), (1, 1), (2, -1), (0, 2), (1, -2), (2, -2)] {
            let j = site(x + dx, y + dy);
            let random = |k: i64| ((i as f64 + 0.37) * (1.3 + (3 * dx + 7 * dy + 11 * k) as f64)).sin();
            let b: [f64; 4] = [1.0 + random(0), 0.3 * random(1), 0.3 * random(1), 1.0 + random(2)];
            let turn = [0.0, -antisymmetric * random(3), antisymmetric * random(3), 0.0];
            for (row, column, sign) in [(i, j, 1.0), (j, i, -1.0)] {
                let entry = rows[row].entry(column as u32).or_default();
                (0..4).for_each(|k| entry[k] += b[k] + sign * turn[k]);
                let own = rows[row].entry(row as u32).or_default();
                (0..4).for_each(|k| own[k] -= b[k] + sign * turn[k]);
            }
        }
    }
    let mut start = vec![0];
    let (mut column, mut block) = (Vec::new(), Vec::new());
    for row in rows {
        column.extend(row.keys());
        block.extend(row.values());
        start.push(column.len());
    }
    Stencil { start, column, block }
}

/// The places of the sites.
pub fn places(side: usize) -> Vec<[f64; 2]> {
    (0..side * side).map(|i| [(i % side) as f64 + 0.5 * (i / side) as f64, (i / side) as f64]).collect()
}

/// A positive definite matrix of two unknowns for each node of a square lattice, coupled to all within two steps of the king.
pub fn symmetric(side: usize) -> SymmetricMatrix {
    let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
    for unknown in 0..2 * side * side {
        let (x, y) = (unknown / 2 % side, unknown / 2 / side);
        row.push(unknown);
        value.push(16.3 + (unknown as f64).sin());
        let near = (y..side.min(y + 3))
            .flat_map(|to_y| (x.saturating_sub(2)..side.min(x + 3)).map(move |to_x| to_y * side + to_x))
            .flat_map(|node| [2 * node, 2 * node + 1]);
        for other in near.filter(|other| *other > unknown) {
            row.push(other);
            value.push(-0.3 - 0.05 * ((unknown + other) as f64).cos());
        }
        start.push(row.len());
    }
    SymmetricMatrix::new(start, row, value).unwrap()
}
