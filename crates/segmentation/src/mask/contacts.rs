//! Which cells of a label image touch.

use super::Mask;
use std::collections::{BTreeSet, VecDeque};

/// Steps to the four pixels that share a side.
const SIDES: [[isize; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

impl Mask<'_> {
    /// Pairs of labels, the lower first, that touch across at most `gap` pixels of background.
    ///
    /// Pixels are followed from side to side, not across corners. Of the background each pixel belongs to the cell that is
    /// reached first; two cells touch where such pixels of both meet and the way from cell to cell is not longer than the gap.
    /// With a gap of 0 the cells themselves must share the side of a pixel. Lines of background one pixel wide, as
    /// segmentations draw them, are two steps wide where they run obliquely: a gap of 2 bridges them.
    pub fn contacts(&self, gap: usize) -> BTreeSet<[i64; 2]> {
        let (owner, distance) = self.grown(gap.div_ceil(2));
        let mut contacts = BTreeSet::new();
        for row in 0..self.rows {
            for column in 0..self.columns {
                let here = row * self.columns + column;
                let right = (column + 1 < self.columns).then_some(here + 1);
                let below = (row + 1 < self.rows).then_some(here + self.columns);
                for there in [right, below].into_iter().flatten() {
                    let (a, b) = (owner[here], owner[there]);
                    if a != 0 && b != 0 && a != b && distance[here] + distance[there] <= gap {
                        contacts.insert([a.min(b), a.max(b)]);
                    }
                }
            }
        }
        contacts
    }

    /// For each pixel, the label that is nearest in steps, of at most `reach`, and the number of steps.
    fn grown(&self, reach: usize) -> (Vec<i64>, Vec<usize>) {
        let mut owner = self.labels.to_vec();
        let mut distance = vec![0; owner.len()];
        if reach == 0 {
            return (owner, distance);
        }
        // Pixels within a cell have nothing to grow into.
        let is_rim = |index: usize| {
            let (column, row) = ((index % self.columns) as isize, (index / self.columns) as isize);
            SIDES.iter().any(|[dx, dy]| self.at(column + dx, row + dy) == 0)
        };
        let mut queue: VecDeque<usize> =
            (0..owner.len()).filter(|&index| owner[index] != 0 && is_rim(index)).collect();
        while let Some(index) = queue.pop_front() {
            if distance[index] == reach {
                continue;
            }
            let (column, row) = ((index % self.columns) as isize, (index / self.columns) as isize);
            for [dx, dy] in SIDES {
                let (column, row) = (column + dx, row + dy);
                if column < 0 || row < 0 || column >= self.columns as isize || row >= self.rows as isize {
                    continue;
                }
                let next = row as usize * self.columns + column as usize;
                if owner[next] == 0 {
                    owner[next] = owner[index];
                    distance[next] = distance[index] + 1;
                    queue.push_back(next);
                }
            }
        }
        (owner, distance)
    }
}
