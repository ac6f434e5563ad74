//! The fewest nodes that keep two parts of a graph apart.

use crate::graph::Graph;

/// Two parts of a graph that are not coupled to each other, and the nodes between that keep them apart.
#[derive(Debug)]
pub(crate) struct Halves {
    pub sides: [Vec<u32>; 2],
    pub separator: Vec<u32>,
}

impl Halves {
    /// Few nodes between sides of about the same size are best.
    pub fn cost(&self) -> f64 {
        let product: f64 = self.sides.iter().map(|side| side.len().max(1) as f64).product();
        self.separator.len() as f64 / product
    }
}

/// No number.
pub(crate) const NONE: u32 = u32::MAX;

/// The couplings across a cut, of which every one has to lose a node.
///
/// The fewest nodes that do so are as many as the pairs of a largest matching, and follow from one (König).
struct Crossing {
    /// For each node of the first side, those of the second that it is coupled to, one after the other.
    start: Vec<u32>,
    coupled: Vec<u32>,
    /// Partners in a matching.
    mate: [Vec<u32>; 2],
}

/// Separates two parts of a graph by as few of their nodes as can do it.
///
/// `seat` is room for a number per node of the graph, [`NONE`] each, and is left so.
pub(crate) fn separate(graph: &Graph, sides: [Vec<u32>; 2], seat: &mut [u32]) -> Halves {
    let mut crossing = Crossing::new(graph, [&sides[0], &sides[1]], seat);
    crossing.match_all();
    let covered = crossing.cover();
    let mut separator = Vec::new();
    let mut rest = |nodes: &[u32], covered: &[bool]| {
        let (apart, rest): (Vec<_>, Vec<_>) = nodes.iter().zip(covered).partition(|(_, covered)| **covered);
        separator.extend(apart.into_iter().map(|(node, _)| *node));
        rest.into_iter().map(|(node, _)| *node).collect()
    };
    let sides = [rest(&sides[0], &covered[0]), rest(&sides[1], &covered[1])];
    Halves { sides, separator }
}

impl Crossing {
    fn new(graph: &Graph, [near, far]: [&[u32]; 2], seat: &mut [u32]) -> Self {
        far.iter().zip(0..).for_each(|(&node, k)| seat[node as usize] = k);
        let (mut start, mut coupled) = (vec![0], Vec::new());
        for &node in near {
            let seats = graph.neighbours(node).iter().map(|&other| seat[other as usize]);
            coupled.extend(seats.filter(|k| *k != NONE));
            start.push(coupled.len() as u32);
        }
        far.iter().for_each(|&node| seat[node as usize] = NONE);
        Self { start, coupled, mate: [vec![NONE; near.len()], vec![NONE; far.len()]] }
    }

    fn coupled(&self, near: u32) -> &[u32] {
        &self.coupled[self.start[near as usize] as usize..self.start[near as usize + 1] as usize]
    }

    fn pair(&mut self, near: u32, far: u32) {
        (self.mate[0][near as usize], self.mate[1][far as usize]) = (far, near);
    }

    /// Those of the first side that are coupled and have no partner.
    fn alone(&self) -> Vec<u32> {
        let near = 0..self.mate[0].len() as u32;
        near.filter(|&a| self.mate[0][a as usize] == NONE && !self.coupled(a).is_empty()).collect()
    }

    /// A largest matching: whoever is free, then by paths on which partners are exchanged.
    fn match_all(&mut self) {
        for near in self.alone() {
            let free = self.coupled(near).iter().find(|far| self.mate[1][**far as usize] == NONE);
            if let Some(&far) = free {
                self.pair(near, far);
            }
        }
        let far = self.mate[1].len();
        let (mut reached_in, mut reached_from) = (vec![NONE; far], vec![NONE; far]);
        for first in self.alone() {
            let (mut queue, mut next) = (vec![first], 0);
            let mut end = NONE;
            'paths: while next < queue.len() {
                let near = queue[next];
                next += 1;
                for &far in self.coupled(near) {
                    if reached_in[far as usize] == first {
                        continue;
                    }
                    (reached_in[far as usize], reached_from[far as usize]) = (first, near);
                    match self.mate[1][far as usize] {
                        NONE => {
                            end = far;
                            break 'paths;
                        }
                        partner => queue.push(partner),
                    }
                }
            }
            while end != NONE {
                let near = reached_from[end as usize];
                let left = self.mate[0][near as usize];
                self.pair(near, end);
                end = left;
            }
        }
    }

    /// The nodes of either side that cover all couplings: of the first those that no path from a node without a partner reaches, of the
    /// second those that one does.
    fn cover(&self) -> [Vec<bool>; 2] {
        let mut queue = self.alone();
        let mut reached = self.mate.each_ref().map(|own| vec![false; own.len()]);
        queue.iter().for_each(|&near| reached[0][near as usize] = true);
        let mut next = 0;
        while next < queue.len() {
            for &far in self.coupled(queue[next]) {
                if !std::mem::replace(&mut reached[1][far as usize], true) {
                    let partner = self.mate[1][far as usize];
                    if partner != NONE && !std::mem::replace(&mut reached[0][partner as usize], true) {
                        queue.push(partner);
                    }
                }
            }
            next += 1;
        }
        let [mut near, far] = reached;
        near.iter_mut().zip(&self.mate[0]).for_each(|(own, mate)| *own = !*own && *mate != NONE);
        [near, far]
    }
}
