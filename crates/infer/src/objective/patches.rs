//! Patches of large frames, from whose velocities noise levels come.
//!
//! Errors of positions correlate the velocities of cells near each other, so that a likelihood takes a factor for all nudges of a frame. Velocities that
//! depend on cells of one patch alone are independent of those of other patches, up to the coefficients: their likelihood is a sum over patches, each with a
//! small factor. It is a likelihood of fewer data, and exact; velocities at the borders of patches are not asked. Which are is a matter of the contacts as
//! measured, so that likelihoods of different fits are of the same data.

use crate::free_cells::Free;
use crate::rows::{Row, Rows};
use crate::{Observation, Velocities};
use voronudge_geometry::{Tessellation, Vector};
use voronudge_model::BlockMatrix;

/// Cells of a frame up to which all of its velocities are asked, and those of a patch.
const WHOLE: usize = 8000;
const LARGEST: usize = 2500;

/// Contacts from a cell to the next one of another patch from which on its velocity is asked, and its centroid: these depend on cells two and one contacts
/// away, and contacts change in a fit.
const OF_VELOCITIES: u32 = 4;
const OF_CENTROIDS: u32 = 3;

/// The cells of a frame in patches of about the same number.
pub(crate) struct Patches {
    /// The cells of each patch.
    pub cells: Vec<Vec<usize>>,
    /// Of each cell its patch, its place there, and the contacts to the next cell of another one.
    patch: Vec<usize>,
    seat: Vec<u32>,
    contacts: Vec<u32>,
    /// Contacts from which on a measured position is asked.
    of_positions: u32,
}

/// Rows of one patch, with the columns of its own cells.
pub(super) struct OwnRows {
    jacobian: BlockMatrix,
    rows: Vec<Row>,
}

impl OwnRows {
    pub fn rows(&self) -> Rows<'_> {
        Rows { jacobian: &self.jacobian, rows: &self.rows }
    }

    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// Which of so many cells are in them.
    pub fn mark(&self, cells: &mut [bool]) {
        self.jacobian.column.iter().for_each(|cell| cells[*cell as usize] = true);
    }
}

impl Patches {
    /// Those of a frame; none if it is asked as a whole.
    pub fn of(frame: &Observation) -> Option<Self> {
        Self::are_of(frame).then(|| Self::new(frame, LARGEST))
    }

    /// Whether a frame is asked in patches.
    pub fn are_of(frame: &Observation) -> bool {
        let of_cells = matches!(frame.velocities, Velocities::OfCells(_)) && frame.is_free();
        of_cells && frame.positions.len() > WHOLE
    }

    /// Patches of so many cells at most.
    pub fn new(frame: &Observation, largest: usize) -> Self {
        let mut cells = Vec::new();
        bisect(&frame.positions, (0..frame.positions.len()).collect(), largest.max(1), &mut cells);
        let count = frame.positions.len();
        let (mut patch, mut seat) = (vec![0; count], vec![0; count]);
        for (own, cells) in cells.iter().enumerate() {
            for (cell, place) in cells.iter().zip(0..) {
                (patch[*cell], seat[*cell]) = (own, place);
            }
        }
        let neighbours =
            |cell: usize| frame.tessellation.neighbours(cell).iter().map(|other| *other as usize);
        let mut contacts = vec![u32::MAX; count];
        let mut reached: Vec<usize> =
            (0..count).filter(|cell| neighbours(*cell).any(|other| patch[other] != patch[*cell])).collect();
        let mut distance = 1;
        while !reached.is_empty() && distance < OF_VELOCITIES.max(OF_CENTROIDS) {
            reached.iter().for_each(|cell| contacts[*cell] = distance);
            let next = reached.iter().flat_map(|cell| neighbours(*cell));
            reached = next.filter(|cell| contacts[*cell] == u32::MAX).collect();
            reached.sort_unstable();
            reached.dedup();
            distance += 1;
        }
        let of_positions = if frame.share() == 0.0 { 0 } else { OF_CENTROIDS };
        Self { cells, patch, seat, contacts, of_positions }
    }

    /// The patch of a cell.
    pub fn patch(&self, cell: usize) -> usize {
        self.patch[cell]
    }

    /// The cells of a patch and of so many rings around it.
    pub fn with_rings(&self, patch: usize, tessellation: &Tessellation, rings: usize) -> Free {
        let mut within = vec![false; self.patch.len()];
        let mut last = self.cells[patch].clone();
        for _ in 0..=rings {
            last.retain(|cell| !std::mem::replace(&mut within[*cell], true));
            last = last
                .iter()
                .flat_map(|cell| tessellation.neighbours(*cell))
                .map(|cell| *cell as usize)
                .collect();
        }
        Free::new(within.len(), |cell| within[cell])
    }

    /// Rows of velocities of a patch.
    pub(super) fn velocities(&self, patch: usize, rows: &Rows<'_>) -> OwnRows {
        self.own(patch, rows, OF_VELOCITIES)
    }

    /// Rows of its measured positions, and which of its cells have none.
    pub(super) fn positions(&self, patch: usize, rows: &Rows<'_>) -> (OwnRows, Vec<bool>) {
        let own = self.own(patch, rows, self.of_positions);
        let mut lacking = vec![true; self.cells[patch].len()];
        for (cell, ..) in self.asked(patch, rows, self.of_positions) {
            lacking[self.seat[*cell] as usize] = false;
        }
        (own, lacking)
    }

    /// The rows of cells of a patch that are so many contacts or more away from others.
    fn asked<'r>(&self, patch: usize, rows: &Rows<'r>, contacts: u32) -> impl Iterator<Item = &'r Row> {
        rows.rows.iter().filter(move |row| self.patch[row.0] == patch && self.contacts[row.0] >= contacts)
    }

    fn own(&self, patch: usize, rows: &Rows<'_>, contacts: u32) -> OwnRows {
        let mut jacobian = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        let mut own = Vec::new();
        for (cell, rest, by_free) in self.asked(patch, rows, contacts) {
            for (column, block) in rows.jacobian.row(*cell).filter(|(other, _)| self.patch[*other] == patch) {
                jacobian.column.push(self.seat[column]);
                jacobian.block.push(*block);
            }
            jacobian.row_start.push(jacobian.column.len());
            own.push((own.len(), *rest, by_free.clone()));
        }
        OwnRows { jacobian, rows: own }
    }
}

/// Halves cells along the longer side of where they are until there are few enough.
fn bisect(positions: &[Vector<f64>], mut cells: Vec<usize>, largest: usize, into: &mut Vec<Vec<usize>>) {
    if cells.len() <= largest {
        cells.sort_unstable();
        into.push(cells);
        return;
    }
    let extent = |axis: usize| {
        let at = cells.iter().map(|cell| positions[*cell][axis]);
        at.clone().fold(f64::NEG_INFINITY, f64::max) - at.fold(f64::INFINITY, f64::min)
    };
    let axis = usize::from(extent(1) > extent(0));
    let half = cells.len() / 2;
    cells.select_nth_unstable_by(half, |one, other| {
        positions[*one][axis].total_cmp(&positions[*other][axis]).then(one.cmp(other))
    });
    let rest = cells.split_off(half);
    bisect(positions, cells, largest, into);
    bisect(positions, rest, largest, into);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placing::Placing;
    use crate::sample::with_objective;
    use crate::whitened::Whitened;

    /// The likelihood of the velocities that patches are asked for is that of these velocities in one problem.
    #[test]
    fn patches_together_are_one_problem() {
        for share in [0.0, 0.8] {
            with_objective(24, share, |objective, at| {
                let mut linear = objective.linear(&objective.placed_at(at).unwrap(), at, &[]).unwrap();
                let linear = &mut linear[0];
                let patches = Patches::new(linear.frame, 200);
                assert_eq!(patches.cells.len(), 4);
                let (own, components) = linear.in_patches(&patches, &at[4..]);
                linear.rows.retain(|row| patches.contacts[row.0] >= OF_VELOCITIES);
                assert!((100..400).contains(&linear.rows.len()), "{}", linear.rows.len());
                let data = linear.rows.len();
                let whole = linear.whole(&at[4..]);
                for spring in [1.0, 10.0] {
                    let parts: Vec<Whitened> = own.iter().map(|part| part.whiten(spring).unwrap()).collect();
                    let (sum, whole) = (Whitened::sum(&parts, 4), whole.whiten(spring).unwrap());
                    if share > 0.0 {
                        // Cells at the borders are without a measured position, which costs data, and tells less.
                        assert!(
                            components < 2 * data && sum.data < whole.data && sum.log_determinant.is_finite()
                        );
                        continue;
                    }
                    assert_eq!(components, 2 * data);
                    assert!(
                        (sum.log_determinant - whole.log_determinant).abs() < 1e-8 * whole.log_determinant
                    );
                    assert!((sum.data - whole.data).abs() < 1e-9 * whole.data);
                    assert!((sum.free - &whole.free).amax() < 1e-9 * whole.free.amax());
                    assert!((sum.mixed - &whole.mixed).amax() < 1e-9 * whole.mixed.amax());
                }
            });
        }
    }
}
