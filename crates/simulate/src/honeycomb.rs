//! Starting positions on a lattice of hexagonal cells.

use crate::Error;
use voronudge_geometry::{PeriodicBox, Vector};

/// Centres (N) of a lattice of equal hexagonal cells, rows along x, and the box of unit area per cell that they fill.
///
/// Of the numbers of columns and of rows (even) whose product is `cells`, those are taken that make the box most nearly a
/// square. For another box, stretch both; the hexagons are then no longer regular.
///
/// # Errors
/// [`Error::Honeycomb`] for an odd number of cells or fewer than four.
///
/// ```
/// use voronudge_geometry::{Domain, Tessellation};
/// use voronudge_observables::hexatic;
/// use voronudge_simulate::honeycomb;
/// let (positions, cell_box) = honeycomb(120)?;
/// assert!((cell_box.area() - 120.0).abs() < 1e-10);
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
/// assert!((hexatic(&tessellation, &positions).mean_modulus - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn honeycomb(cells: usize) -> Result<(Vec<Vector<f64>>, PeriodicBox), Error> {
    // Both lengths of the box are those of one column and two rows times the numbers of these.
    let [spacing, pair_of_rows] = voronudge_geometry::honeycomb(1, 2).1;
    let height = 0.5 * pair_of_rows;
    let anisotropy = |rows: usize| {
        let columns = cells / rows;
        ((columns as f64 * spacing) / (rows as f64 * height)).ln().abs()
    };
    let rows = (2..=cells / 2)
        .filter(|rows| rows % 2 == 0 && cells.is_multiple_of(*rows))
        .min_by(|a, b| anisotropy(*a).total_cmp(&anisotropy(*b)))
        .ok_or(Error::Honeycomb { cells })?;
    let (positions, lengths) = voronudge_geometry::honeycomb(cells / rows, rows);
    let cell_box = PeriodicBox::new(lengths).map_err(|source| Error::Tessellation { time: 0.0, source })?;
    Ok((positions, cell_box))
}
