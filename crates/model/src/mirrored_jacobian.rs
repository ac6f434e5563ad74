//! The Jacobian of cells in front of mirrors, whose images move with them.

use crate::block_matrix::Block;
use crate::chunk::CHUNK;
use crate::element_blocks::ElementBlocks;
use crate::mirrors::signs_of;
use crate::{BlockMatrix, Model};
use voronudge_geometry::{Tessellation, Vector};

/// `J_{ij} = ∂v_i/∂r_j` of the first `cells` cells of a tessellation, of which the others are mirror images, in the order of
/// [`HalfEdgeForces::evaluate_with_images`](crate::HalfEdgeForces::evaluate_with_images), whose velocities it is the derivative of; exact to
/// rounding, at frozen topology.
///
/// Only the cells themselves act. Let `a` and `b` run over a cell and its ring, be images of the cells `i` and `j`, and let `R_a` reverse the components that
/// the image `a` reverses. With the blocks `∂f_a/∂r_b` of the elements,
///
/// ```text
/// J_ij = Σ_{a of i} Σ_{b of j} R_a (∂f_a/∂r_b) R_b
/// ```
///
/// The model has shape terms only.
pub fn jacobian_with_images(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    model: &Model<f64>,
    mirrors: &[usize],
    cells: usize,
) -> BlockMatrix {
    let mut elements = ElementBlocks::new(tessellation, positions, model);
    let mut rows: Vec<Vec<(u32, Block)>> = vec![Vec::new(); cells];
    for first in (0..cells).step_by(CHUNK) {
        let owners = first..(first + CHUNK).min(cells);
        elements.evaluate(&owners.clone().map(|owner| owner as u32).collect::<Vec<_>>());
        for owner in owners {
            let ring = tessellation.neighbours(owner);
            let members = || std::iter::once(owner).chain(ring.iter().map(|&cell| cell as usize));
            for (place, of) in members().enumerate() {
                let signs = signs_of(of / cells, mirrors);
                let row = &mut rows[of % cells];
                for (by, block) in members().zip(elements.row(owner, ring.len(), place)) {
                    let by_signs = signs_of(by / cells, mirrors);
                    let turned =
                        std::array::from_fn(|entry| block[entry] * signs[entry / 2] * by_signs[entry % 2]);
                    add(row, (by % cells) as u32, turned);
                }
            }
        }
    }
    let mut matrix = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
    for (column, block) in rows.iter().flatten() {
        matrix.column.push(*column);
        matrix.block.push(*block);
    }
    let mut end = 0;
    matrix.row_start.extend(rows.iter().map(|row| {
        end += row.len();
        end
    }));
    matrix
}

/// Rows are short: about forty blocks.
fn add(row: &mut Vec<(u32, Block)>, column: u32, block: Block) {
    match row.iter_mut().find(|(known, _)| *known == column) {
        Some((_, total)) => total.iter_mut().zip(block).for_each(|(total, entry)| *total += entry),
        None => row.push((column, block)),
    }
}
