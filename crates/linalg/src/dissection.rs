//! Nested dissection by places in the plane or in space and time: an order of elimination with little fill.
//!
//! Cuts are tried at several places along each axis, never between nodes that are equally far along it (the cells of one frame of a movie,
//! seen along time), and the fewest nodes that separate the sides of a cut are found exactly: for movies of tracks this takes half the operations of
//! all nodes next to the cut on one of its sides.

use crate::graph::Graph;
use crate::separator::{Halves, NONE, separate};

/// Nodes that are not cut any further.
const LEAF: usize = 24;

/// Shares of the nodes that a cut leaves on its first side, ascending.
const SHARES: [f64; 3] = [0.42, 0.5, 0.58];

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

/// Where a node is; a node without a place is coupled to too much to be on one side of a cut, and is eliminated at the end.
pub(crate) type Place = Option<[f64; 3]>;

impl Dissection {
    /// Cuts a graph along straight lines or planes through the places of its nodes.
    pub fn new(graph: &Graph, places: &[Place]) -> Self {
        let mut made = Self::ordered(graph, places);
        for (position, &node) in made.order.iter().enumerate() {
            made.position[node as usize] = position as u32;
        }
        for index in 0..made.fronts.len() {
            made.find_boundary(index, graph);
        }
        made
    }

    /// The order alone.
    pub fn order(graph: &Graph, places: &[Place]) -> Vec<u32> {
        Self::ordered(graph, places).order
    }

    /// The fronts without their boundaries, in their order.
    fn ordered(graph: &Graph, places: &[Place]) -> Self {
        let nodes = graph.nodes();
        let (near, last): (Vec<u32>, Vec<u32>) =
            (0..nodes as u32).partition(|&node| places[node as usize].is_some());
        let mut cut = Cut {
            graph,
            places: places.iter().map(|place| place.unwrap_or_default()).collect(),
            seat: vec![NONE; nodes],
            made: Self {
                fronts: Vec::new(),
                order: Vec::with_capacity(nodes),
                position: vec![0; nodes],
                roots: Vec::new(),
            },
        };
        let children = cut.divide(near);
        cut.made.roots = if last.is_empty() { children } else { vec![cut.front(last, children)] };
        cut.made
    }

    fn find_boundary(&mut self, index: usize, graph: &Graph) {
        let Front { first, own, ref children, .. } = self.fronts[index];
        let behind = (first + own) as u32;
        let coupled = self.order[first..first + own].iter().flat_map(|&node| graph.neighbours(node));
        let mut boundary: Vec<u32> = coupled
            .map(|&node| self.position[node as usize])
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
    graph: &'a Graph,
    places: Vec<[f64; 3]>,
    /// Room for a number per node.
    seat: Vec<u32>,
    made: Dissection,
}

impl Cut<'_> {
    /// Orders some nodes; tells the fronts at the top.
    fn divide(&mut self, nodes: Vec<u32>) -> Vec<usize> {
        if nodes.is_empty() {
            return Vec::new();
        }
        if nodes.len() <= LEAF {
            return vec![self.front(nodes, Vec::new())];
        }
        let cuts = [0, 1, 2].into_iter().flat_map(|axis| self.cuts(&nodes, axis));
        let cuts: Vec<[Vec<u32>; 2]> = cuts.collect();
        let halves = cuts.into_iter().map(|sides| separate(self.graph, sides, &mut self.seat));
        let best = halves.min_by(|a, b| a.cost().total_cmp(&b.cost()));
        let Some(Halves { sides, separator }) = best else {
            return vec![self.front(nodes, Vec::new())];
        };
        drop(nodes);
        let mut children = Vec::new();
        for side in sides {
            children.extend(self.divide(side));
        }
        if separator.is_empty() { children } else { vec![self.front(separator, children)] }
    }

    /// Cuts nodes across an axis, none of two nodes that are equally far along it.
    fn cuts(&self, nodes: &[u32], axis: usize) -> Vec<[Vec<u32>; 2]> {
        let along = |node: u32| self.places[node as usize][axis];
        let mut sorted = nodes.to_vec();
        sorted.sort_unstable_by(|&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
        let mut ends: Vec<usize> = SHARES
            .iter()
            .filter_map(|share| {
                let middle = (share * sorted.len() as f64) as usize;
                let value = along(sorted[middle]);
                let below = sorted.partition_point(|&node| along(node) < value);
                let above = sorted.partition_point(|&node| along(node) <= value);
                let ends = [below, above].into_iter().filter(|end| (1..sorted.len()).contains(end));
                ends.min_by_key(|end| end.abs_diff(middle))
            })
            .collect();
        ends.dedup();
        ends.into_iter().map(|end| [sorted[..end].to_vec(), sorted[end..].to_vec()]).collect()
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

    fn places(side: usize) -> Vec<Place> {
        sample::places(side).into_iter().map(|[x, y]| Some([x, y, 0.0])).collect()
    }

    #[test]
    fn every_node_is_eliminated_once_and_knows_what_it_couples_to() {
        let side = 23;
        let matrix = sample::lattice(side, 0.2);
        let transposed = matrix.transposed();
        let dissection = Dissection::new(&Graph::of_blocks(&matrix, &transposed), &places(side));
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
        let graph = Graph::of_blocks(&matrix, &matrix.transposed());
        let dissection = Dissection::new(&graph, &[Some([0.0; 3]); 81]);
        assert_eq!(dissection.order.len(), 81);
    }
}
