//! What friction between cells makes of forces.

use crate::samples::{jittered, periodic};
use voronudge_geometry::Tessellation;
use voronudge_model::effect::InternalDrag;
use voronudge_model::{BlockMatrix, Flow, FlowResponse, Linearisation, Model, assemble, velocities};

/// The response to forces of which each acts on one cell, `(I + ξ L)⁻¹ − I`, in a strip of cells against all that is done to a row.
#[test]
fn rows_times_the_matrix_are_unit_vectors() {
    let (columns, rows) = (200, 4);
    let cells = columns * rows;
    let positions = jittered(columns, rows, 0.3, 1);
    let tessellation =
        Tessellation::new(&positions, periodic([columns as f64, rows as f64]).unwrap()).unwrap();
    let model = Model::single(voronudge_model::CorticalChirality.into());
    let velocities = velocities(&tessellation, &positions, &model);
    let unit = BlockMatrix {
        row_start: (0..=cells).collect(),
        column: (0..cells as u32).collect(),
        block: vec![[1.0, 0.0, 0.0, 1.0]; cells],
    };
    let response = |drag: f64| {
        let flow = Flow {
            tessellation: &tessellation,
            positions: &positions,
            model: &model,
            velocities: &velocities,
        };
        let at = Linearisation { flow, jacobian: &unit };
        let rows = InternalDrag.linearise(&at, drag);
        assemble(cells, |cell, row| rows(cell, row))
    };
    for drag in [-0.03, 0.0, 0.1, 2.0] {
        let found = response(drag);
        for cell in 0..cells {
            let mut product = vec![0.0; cells];
            let mut add = |j: usize, weight: f64| {
                let neighbours = tessellation.neighbours(j);
                product[j] += weight * (1.0 + drag * neighbours.len() as f64);
                neighbours.iter().for_each(|&next| product[next as usize] -= drag * weight);
            };
            add(cell, 1.0);
            for (j, [xx, xy, yx, yy]) in found.row(cell) {
                assert!(xy == &0.0 && yx == &0.0 && xx == yy);
                add(j, *xx);
            }
            for (j, found) in product.iter().enumerate() {
                let expected = f64::from(u8::from(j == cell));
                assert!((found - expected).abs() < 1e-5, "ξ {drag}: {cell} {j} {found}");
            }
        }
        // Friction spreads a force over several cells, not over all.
        assert!((0..cells).all(|cell| found.row(cell).count() < 3 * cells / 4), "{drag}");
    }
    let beyond = response(-0.2);
    assert!((0..cells).all(|cell| beyond.row(cell).any(|(_, block)| block[0].is_nan())));
}
