//! Cells of a tessellation as figures show them.

use voronudge_geometry::{CellPolygon, Domain, Tessellation, Vector};
use voronudge_report::{CellStatus, CellView, ChangedEdges, FrameView};

/// The cells of a tessellation with their polygons; those that are not used are shown as left out.
pub(super) fn cells_view(
    label: String,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    is_used: impl Fn(usize) -> bool,
) -> FrameView {
    let domain = tessellation.domain();
    let mut polygon = CellPolygon::default();
    let cells = (0..positions.len())
        .map(|cell| {
            let centre = match domain {
                Domain::Periodic(cell_box) => cell_box.wrap(positions[cell]),
                Domain::Open => positions[cell],
            };
            let closed = tessellation.is_closed(cell);
            if closed {
                polygon.fill(tessellation, positions, cell);
            }
            let (place, shape) = (|r: Vector<f64>| [r.x, r.y], polygon.shape());
            CellView {
                centre: place(centre),
                polygon: if closed {
                    polygon.vertices().map(|c| place(centre + c)).collect()
                } else {
                    Vec::new()
                },
                area: if closed { shape.area } else { f64::NAN },
                perimeter: if closed { shape.perimeter } else { f64::NAN },
                status: if is_used(cell) { CellStatus::Used } else { CellStatus::LeftOut },
                measured: None,
                predicted: None,
                nudge: [0.0; 2],
            }
        })
        .collect();
    FrameView {
        label,
        cells,
        changed_edges: ChangedEdges::default(),
        outline: match domain {
            Domain::Periodic(cell_box) => Some([[0.0; 2], cell_box.lengths()]),
            Domain::Open => None,
        },
    }
}
