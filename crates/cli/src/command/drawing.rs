//! Cells of a tessellation as figures show them.

use voronudge_geometry::{CellPolygon, Domain, Region, Tessellation, Vector};
use voronudge_report::{CellStatus, CellView, ChangedEdges, FrameView, Units};

/// What lengths and times of a simulation are shown in: ℓ₀ and 1/K_P, where these are 1 and nobody named units.
pub(crate) fn units_of_model(named: &Units, cell_size: f64, perimeter_elasticity: f64) -> Units {
    let own = |unit: &str, none: &str, scale: f64, own: &str| {
        if unit == none && (scale - 1.0).abs() < 1e-9 { own.to_owned() } else { unit.to_owned() }
    };
    Units {
        length: own(&named.length, "length", cell_size, "ℓ₀"),
        time: own(&named.time, "time", perimeter_elasticity, "1/K_P"),
    }
}

/// The border of a field of view in another unit of length, `1/unit` times as large.
pub(crate) fn borders(region: Option<&Region>, unit: f64) -> Vec<Vec<[f64; 2]>> {
    let border = |corners: &Vec<Vector<f64>>| corners.iter().map(|r| [r.x * unit, r.y * unit]).collect();
    region.map_or_else(Vec::new, |region| region.loops().iter().map(border).collect())
}

/// The cells of a tessellation with their polygons; those that are not used are shown as left out.
pub(crate) fn cells_view(
    label: String,
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    is_used: impl Fn(usize) -> bool,
) -> FrameView {
    let mut polygon = CellPolygon::default();
    let cells = (0..positions.len())
        .map(|cell| {
            let status = if is_used(cell) { CellStatus::Used } else { CellStatus::LeftOut };
            CellView { status, ..cell_view(tessellation, positions, cell, &mut polygon) }
        })
        .collect();
    FrameView {
        label,
        time: None,
        cells,
        changed_edges: ChangedEdges::default(),
        outline: match tessellation.domain() {
            Domain::Periodic(cell_box) => Some([[0.0; 2], cell_box.lengths()]),
            Domain::Open => None,
        },
        region: Vec::new(),
    }
}

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
        number: Some(cell),
        centre: place(centre),
        polygon: Vec::new(),
        area: f64::NAN,
        perimeter: f64::NAN,
        status: CellStatus::Used,
        measured: None,
        vorticity: None,
        predicted: None,
        polarity: None,
        held_out: None,
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
