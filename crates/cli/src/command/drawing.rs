//! Cells of a tessellation as figures show them.

use voronudge_geometry::{CellPolygon, Domain, Tessellation, Vector};
use voronudge_report::{CellStatus, CellView};

/// A cell without velocities, as used; its centre inside the box.
pub(crate) fn cell_view(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    cell: usize,
    polygon: &mut CellPolygon<f64>,
) -> CellView {
    let centre = match tessellation.domain() {
        Domain::Periodic(cell_box) => cell_box.wrap(positions[cell]),
        Domain::Open => positions[cell],
    };
    let place = |r: Vector<f64>| [r.x, r.y];
    let mut view = CellView {
        centre: place(centre),
        polygon: Vec::new(),
        area: f64::NAN,
        perimeter: f64::NAN,
        status: CellStatus::Used,
        measured: None,
        predicted: None,
        nudge: [0.0; 2],
    };
    if tessellation.is_closed(cell) {
        polygon.fill(tessellation, positions, cell);
        view.polygon = polygon.vertices().map(|corner| place(centre + corner)).collect();
        view.area = polygon.shape().area;
        view.perimeter = polygon.shape().perimeter;
    }
    view
}
