//! Nested dissection by places in the plane or in space and time: an order of elimination with little fill.
//!
//! Cuts are tried at several places along each axis, never between nodes that are equally far along it (the cells of one frame of a movie,
//! seen along time), and the fewest nodes that separate the sides of a cut are found exactly: for movies of tracks this takes half the operations of
//! all nodes next to the cut on one of its sides.

use crate::graph::Graph;
use crate::separator::{Halves, NONE, separate};

/// Nodes that are not cut any further, at least; nor are as many as one is coupled to in the mean.
const LEAF: usize = 24;

/// Nodes from which on both sides of a cut are dissected at the same time.
const MANY: usize = 600;

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

    /// The fronts without their boundaries, in their order.
    fn ordered(graph: &Graph, places: &[Place]) -> Self {
        let nodes = graph.nodes();
        let (near, last): (Vec<u32>, Vec<u32>) =
            (0..nodes as u32).partition(|&node| places[node as usize].is_some());
        let cut = Cut {
            graph,
            places: places.iter().map(|place| place.unwrap_or_default()).collect(),
            leaf: LEAF.max(graph.degree()),
        };
        let mut part = Part::default();
        let children = cut.divide(near, &mut part, &mut vec![NONE; nodes]);
        let roots = if last.is_empty() { children } else { vec![part.front(last, children)] };
        let Part { fronts, order, .. } = part;
        Self { fronts, order, position: vec![0; nodes], roots }
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
}

/// What is to be dissected.
struct Cut<'a> {
    graph: &'a Graph,
    places: Vec<[f64; 3]>,
    /// Nodes that are not cut any further.
    leaf: usize,
}

/// Part of a dissection in the making.
#[derive(Default)]
struct Part {
    fronts: Vec<Front>,
    order: Vec<u32>,
    roots: Vec<usize>,
}

impl Part {
    /// Adds a front.
    fn front(&mut self, nodes: Vec<u32>, children: Vec<usize>) -> usize {
        let (first, own) = (self.order.len(), nodes.len());
        self.order.extend(nodes);
        self.fronts.push(Front { first, own, boundary: Vec::new(), children });
        self.fronts.len() - 1
    }

    /// Adds another part behind; tells its fronts at the top.
    fn append(&mut self, other: Self) -> Vec<usize> {
        let (fronts, nodes) = (self.fronts.len(), self.order.len());
        self.order.extend(other.order);
        self.fronts.extend(other.fronts.into_iter().map(|mut front| {
            front.first += nodes;
            front.children.iter_mut().for_each(|child| *child += fronts);
            front
        }));
        other.roots.into_iter().map(|root| root + fronts).collect()
    }
}

impl Cut<'_> {
    /// Orders some nodes behind others; tells the fronts at the top. `seat` is room for a number per node.
    fn divide(&self, nodes: Vec<u32>, part: &mut Part, seat: &mut Vec<u32>) -> Vec<usize> {
        if nodes.is_empty() {
            return Vec::new();
        }
        if nodes.len() <= self.leaf {
            return vec![part.front(nodes, Vec::new())];
        }
        let cuts = [0, 1, 2].into_iter().flat_map(|axis| self.cuts(&nodes, axis));
        let halves = cuts.map(|sides| separate(self.graph, sides, seat));
        let best = halves.min_by(|a, b| a.cost().total_cmp(&b.cost()));
        let Some(Halves { sides: [here, there], separator }) = best else {
            return vec![part.front(nodes, Vec::new())];
        };
        let is_large = nodes.len() >= MANY;
        drop(nodes);
        let mut children;
        if is_large {
            let mut aside = Part::default();
            let other = || aside.roots = self.divide(there, &mut aside, &mut vec![NONE; self.places.len()]);
            (children, ()) = rayon::join(|| self.divide(here, part, seat), other);
            children.extend(part.append(aside));
        } else {
            children = self.divide(here, part, seat);
            children.extend(self.divide(there, part, seat));
        }
        if separator.is_empty() { children } else { vec![part.front(separator, children)] }
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
}
