//! Nested dissection by places in the plane: an order of elimination with little fill.

use crate::BlockSparse;

/// Nodes that are not cut any further.
const LEAF: usize = 24;

/// Nodes eliminated together, and the later ones that they couple to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Front {
    /// Position of the first of its own nodes; the others follow.
    pub first: usize,
    /// Number of its own nodes.
    pub own: usize,
    /// Positions of the coupled nodes, ascending, all behind its own.
    pub boundary: Vec<u32>,
    /// Fronts whose boundary is eliminated in this one or later.
    pub children: Vec<usize>,
}

impl Front {
    /// Where a position at or behind the first of its own nodes stands in the front.
    pub fn local(&self, position: u32) -> Option<usize> {
        let ahead = (position as usize).checked_sub(self.first)?;
        if ahead < self.own {
            return Some(ahead);
        }
        self.boundary.binary_search(&position).ok().map(|at| self.own + at)
    }
}

/// The fronts, children before parents.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Dissection {
    pub fronts: Vec<Front>,
    /// Nodes in the order of elimination.
    pub order: Vec<u32>,
    /// Position of each node in that order.
    pub position: Vec<u32>,
    /// Fronts without a parent.
    pub roots: Vec<usize>,
}

impl Dissection {
    /// Cuts the graph of a matrix and its transpose along straight lines through the places of its block rows.
    pub fn new(matrix: &BlockSparse, transposed: &BlockSparse, places: &[[f64; 2]]) -> Self {
        let rows = matrix.rows();
        let mut cut = Cut {
            matrix,
            transposed,
            places,
            right: vec![false; rows],
            made: Self {
                fronts: Vec::new(),
                order: Vec::with_capacity(rows),
                position: vec![0; rows],
                roots: Vec::new(),
            },
        };
        cut.made.roots = cut.divide((0..rows as u32).collect());
        let mut made = cut.made;
        for (position, &node) in made.order.iter().enumerate() {
            made.position[node as usize] = position as u32;
        }
        for index in 0..made.fronts.len() {
            made.find_boundary(index, matrix, transposed);
        }
        made
    }

    fn find_boundary(&mut self, index: usize, matrix: &BlockSparse, transposed: &BlockSparse) {
        let Front { first, own, ref children, .. } = self.fronts[index];
        let behind = (first + own) as u32;
        let coupled = self.order[first..first + own].iter().flat_map(|&node| {
            let neighbours = |matrix: &BlockSparse| {
                let node = node as usize;
                matrix.column[matrix.row_start[node]..matrix.row_start[node + 1]].to_vec()
            };
            [neighbours(matrix), neighbours(transposed)].into_iter().flatten()
        });
        let mut boundary: Vec<u32> = coupled
            .map(|node| self.position[node as usize])
            .chain(children.iter().flat_map(|&child| self.fronts[child].boundary.iter().copied()))
            .filter(|&position| position >= behind)
            .collect();
        boundary.sort_unstable();
        boundary.dedup();
        self.fronts[index].boundary = boundary;
    }

    /// Numbers in the factors, for blocks of 2 × 2.
    #[cfg(test)]
    fn entries(&self) -> usize {
        self.fronts.iter().map(|front| 4 * front.own * (front.own + 2 * front.boundary.len())).sum()
    }
}

/// A dissection in the making.
struct Cut<'a> {
    matrix: &'a BlockSparse,
    transposed: &'a BlockSparse,
    places: &'a [[f64; 2]],
    /// Nodes on the far side of the line at hand.
    right: Vec<bool>,
    made: Dissection,
}

impl Cut<'_> {
    /// Orders some nodes; tells the fronts at the top.
    fn divide(&mut self, mut nodes: Vec<u32>) -> Vec<usize> {
        if nodes.is_empty() {
            return Vec::new();
        }
        if nodes.len() <= LEAF {
            return vec![self.front(nodes, Vec::new())];
        }
        let axis = self.longer_axis(&nodes);
        let middle = nodes.len() / 2;
        let places = self.places;
        let key = |node: &u32| (places[*node as usize][axis], *node);
        nodes.select_nth_unstable_by(middle, |a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        let far = nodes.split_off(middle);
        far.iter().for_each(|&node| self.right[node as usize] = true);
        let (separator, near): (Vec<u32>, Vec<u32>) = nodes.into_iter().partition(|&node| self.crosses(node));
        far.iter().for_each(|&node| self.right[node as usize] = false);
        let mut children = self.divide(near);
        children.extend(self.divide(far));
        if separator.is_empty() { children } else { vec![self.front(separator, children)] }
    }

    fn crosses(&self, node: u32) -> bool {
        [self.matrix, self.transposed].iter().any(|matrix| {
            let range = matrix.row_start[node as usize]..matrix.row_start[node as usize + 1];
            matrix.column[range].iter().any(|&other| self.right[other as usize])
        })
    }

    fn longer_axis(&self, nodes: &[u32]) -> usize {
        let extent = |axis: usize| {
            let along = || nodes.iter().map(|&node| self.places[node as usize][axis]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        usize::from(extent(1) > extent(0))
    }

    fn front(&mut self, nodes: Vec<u32>, children: Vec<usize>) -> usize {
        let (first, own) = (self.made.order.len(), nodes.len());
        self.made.order.extend(nodes);
        self.made.fronts.push(Front { first, own, boundary: Vec::new(), children });
        self.made.fronts.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample;

    #[test]
    fn every_node_is_eliminated_once_and_knows_what_it_couples_to() {
        let side = 23;
        let matrix = sample::lattice(side, 0.2);
        let transposed = matrix.transposed();
        let dissection = Dissection::new(&matrix, &transposed, &sample::places(side));
        let mut seen = dissection.order.clone();
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, &node)| i == node as usize) && seen.len() == side * side);
        for front in &dissection.fronts {
            for position in front.first..front.first + front.own {
                let node = dissection.order[position] as usize;
                for (other, _) in matrix.row(node).chain(transposed.row(node)) {
                    let other = dissection.position[other];
                    assert_eq!(front.local(other).is_some(), other as usize >= front.first);
                }
            }
            for &child in &front.children {
                assert!(dissection.fronts[child].boundary.iter().all(|&p| front.local(p).is_some()));
            }
        }
        // A tenth of the dense matrix.
        assert!(dissection.entries() < (2 * side * side).pow(2) / 2);
    }

    /// Places that tell nothing: the order is poor, not wrong.
    #[test]
    fn coinciding_places_are_no_obstacle() {
        let matrix = sample::lattice(9, 0.2);
        let dissection = Dissection::new(&matrix, &matrix.transposed(), &[[0.0; 2]; 81]);
        assert_eq!(dissection.order.len(), 81);
    }
}
