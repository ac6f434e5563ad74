//! Areas and shapes of cells.

use voronudge_geometry::{Tessellation, Vector, areas, perimeters};

/// The shape index `P_i/√A_i` of each cell (N): 3.545 for a circle, 3.722 for a regular hexagon, more for longer cells. NaN
/// for cells on the hull of an open field.
///
/// ```
/// use voronudge_geometry::{Domain, Tessellation};
/// use voronudge_simulate::{honeycomb, measure::shape_indices};
/// let (positions, cell_box) = honeycomb(16)?;
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
/// let hexagon = (8.0 * 3f64.sqrt()).sqrt();
/// assert!(shape_indices(&tessellation, &positions).iter().all(|p| (p - hexagon).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn shape_indices(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Vec<f64> {
    let areas = areas(tessellation, positions);
    perimeters(tessellation, positions)
        .iter()
        .zip(areas)
        .map(|(perimeter, area)| perimeter / area.sqrt())
        .collect()
}
