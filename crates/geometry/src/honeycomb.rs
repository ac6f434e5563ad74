//! The lattice of hexagonal cells.

use crate::Vector;

/// Centres (columns × rows, row by row) of a lattice of regular hexagonal cells of unit area, rows along x, and the lengths of the
/// periodic box that they fill.
///
/// The number of rows must be even, or the last does not fit the first.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation, areas, honeycomb};
/// let (positions, lengths) = honeycomb(5, 6);
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new(lengths)?))?;
/// assert!(areas(&tessellation, &positions).iter().all(|area| (area - 1.0).abs() < 1e-12));
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn honeycomb(columns: usize, rows: usize) -> (Vec<Vector<f64>>, [f64; 2]) {
    // Spacing a and distance of rows a √3/2 at unit density: a² √3/2 = 1.
    let spacing = (2.0 / 3f64.sqrt()).sqrt();
    let height = 0.5 * 3f64.sqrt() * spacing;
    let place = |cell: usize| {
        let (column, row) = (cell % columns, cell / columns);
        Vector::new((column as f64 + 0.5 * (row % 2) as f64) * spacing, row as f64 * height)
    };
    let positions = (0..columns * rows).map(place).collect();
    (positions, [columns as f64 * spacing, rows as f64 * height])
}
