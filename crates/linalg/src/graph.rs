//! Which unknowns of a sparse matrix are coupled.

use crate::BlockSparse;
use crate::block_sparse::Columns;

/// A graph without directions: nodes and those they are coupled to, themselves perhaps among them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Graph {
    start: Vec<usize>,
    neighbour: Vec<u32>,
}

impl Graph {
    /// The block rows of a matrix, given its columns, coupled where it or its transpose has a block.
    pub fn of_blocks(matrix: &BlockSparse, columns: &Columns) -> Self {
        let mut graph = Self { start: vec![0], neighbour: Vec::new() };
        let mut coupled = Vec::new();
        for node in 0..matrix.rows() {
            coupled.clear();
            coupled.extend(matrix.row(node).map(|(other, _)| other as u32));
            coupled.extend(columns.rows(node));
            coupled.sort_unstable();
            coupled.dedup();
            graph.neighbour.extend(&coupled);
            graph.start.push(graph.neighbour.len());
        }
        graph
    }

    /// Groups of so many unknowns each, coupled where the lower triangle of a symmetric matrix, in compressed columns, has an entry.
    pub fn of_lower_triangle(column_start: &[usize], row: &[usize], group: usize) -> Self {
        let groups = (column_start.len() - 1) / group;
        // One column of each group tells: entries come in whole blocks, the first couples the group to itself.
        let mut start = vec![0; groups + 1];
        let mut edges = Vec::with_capacity(row.len() / (group * group));
        for node in 0..groups {
            let rows = &row[column_start[node * group]..column_start[node * group + 1]];
            for other in rows.iter().step_by(group).skip(1).map(|row| row / group) {
                edges.push((node as u32, other as u32));
                start[node + 1] += 1;
                start[other + 1] += 1;
            }
        }
        for node in 0..groups {
            start[node + 1] += start[node];
        }
        let (mut next, mut neighbour) = (start.clone(), vec![0; 2 * edges.len()]);
        for (a, b) in edges {
            for (from, to) in [(a, b), (b, a)] {
                neighbour[next[from as usize]] = to;
                next[from as usize] += 1;
            }
        }
        Self { start, neighbour }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.start.len() - 1
    }

    /// How many others a node is coupled to in the mean.
    pub fn degree(&self) -> usize {
        self.neighbour.len() / self.nodes().max(1)
    }

    /// What a node is coupled to.
    pub fn neighbours(&self, node: u32) -> &[u32] {
        &self.neighbour[self.start[node as usize]..self.start[node as usize + 1]]
    }
}
