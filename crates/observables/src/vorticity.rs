//! The rotation of velocities over cells.

use voronudge_geometry::{CellPolygon, Tessellation, Vector};

/// The vorticity at each cell (N), in 1/time: the circulation around its polygon over its area,
/// `ω_i = (1/A_i) Σ_j ½(v_i + v_j) · ℓ_ij t_ij`, where a side moves as its two cells do on average. Cells that rotate like a rigid body at
/// a rate Ω have 2Ω, and in a periodic box the mean, each cell counted by its area, is zero. `None` where the velocity of the cell or of a
/// neighbour is not known, or the polygon does not close. Velocities (N) are in the unit of length over that of time.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector, honeycomb};
/// use voronudge_observables::vorticities;
/// let (positions, lengths) = honeycomb(4, 4);
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new(lengths)?))?;
/// let uniform = vec![Some(Vector::new(0.3, 0.1)); positions.len()];
/// let vorticities = vorticities(&tessellation, &positions, &uniform);
/// assert!(vorticities.iter().all(|own| own.is_some_and(|own| own.abs() < 1e-12)));
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn vorticities(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    velocities: &[Option<Vector<f64>>],
) -> Vec<Option<f64>> {
    let known =
        |cell: usize| velocities.get(cell).copied().flatten().filter(|v| v.x.is_finite() && v.y.is_finite());
    let mut polygon = CellPolygon::default();
    let of_cell = |cell: usize| {
        known(cell)?;
        if !tessellation.is_closed(cell) {
            return None;
        }
        polygon.fill(tessellation, positions, cell);
        let mut from = polygon.vertices().last()?;
        let mut circulation = 0.0;
        for (&other, to) in tessellation.neighbours(cell).iter().zip(polygon.vertices()) {
            // The velocity of the cell itself adds nothing, as the polygon closes.
            circulation += 0.5 * known(other as usize)?.dot(&(to - from));
            from = to;
        }
        Some(circulation / polygon.shape().area).filter(|own| own.is_finite())
    };
    (0..velocities.len().min(tessellation.len())).map(of_cell).collect()
}
