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

#[cfg(test)]
mod tests {
    use super::*;
    use voronudge_geometry::{Domain, PeriodicBox, areas};

    /// Cells in no order.
    fn scattered() -> Vec<Vector<f64>> {
        let place =
            |k: usize| Vector::new((k as f64 * 0.754_877_666).fract(), (k as f64 * 0.569_840_291).fract());
        (0..60).map(place).collect()
    }

    #[test]
    fn a_rigid_rotation_has_twice_its_rate() {
        let positions = scattered();
        let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
        let velocities: Vec<_> =
            positions.iter().map(|r| Some(Vector::new(3.0 - 0.9 * r.y, 0.9 * r.x))).collect();
        let found = vorticities(&tessellation, &positions, &velocities);
        let known: Vec<f64> = found.iter().copied().flatten().collect();
        assert_eq!(known.len(), (0..60).filter(|&cell| tessellation.is_closed(cell)).count());
        assert!(known.len() > 30 && known.iter().all(|own| (own - 1.8).abs() < 1e-9));
    }

    #[test]
    fn there_is_no_circulation_around_a_whole_periodic_box() {
        let positions = scattered();
        let domain = Domain::Periodic(PeriodicBox::new([1.0, 1.0]).unwrap());
        let tessellation = Tessellation::new(&positions, domain).unwrap();
        let velocities: Vec<_> =
            (0..60).map(|k| Some(Vector::new((k as f64).sin(), (7.0 * k as f64).cos()))).collect();
        let found = vorticities(&tessellation, &positions, &velocities);
        let circulations =
            found.iter().zip(areas(&tessellation, &positions)).map(|(own, area)| own.unwrap() * area);
        assert!(circulations.sum::<f64>().abs() < 1e-12);
    }

    #[test]
    fn a_velocity_that_is_not_known_leaves_its_neighbours_without() {
        let positions = scattered();
        let tessellation = Tessellation::new(&positions, Domain::Open).unwrap();
        let mut velocities = vec![Some(Vector::new(1.0, 0.0)); positions.len()];
        velocities[7] = None;
        let found = vorticities(&tessellation, &positions, &velocities);
        assert_eq!(found[7], None);
        assert!(tessellation.neighbours(7).iter().all(|&other| found[other as usize].is_none()));
        assert!(found.iter().any(Option::is_some));
    }
}
