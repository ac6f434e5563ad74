//! How fast cells are.

use voronudge_geometry::Vector;

/// `⟨v²⟩ = (1/N) Σ_i |v_i|²` of velocities (N), in the square of their unit; zero for no cells.
///
/// ```
/// use voronudge_geometry::Vector;
/// use voronudge_observables::mean_square_velocity;
/// assert_eq!(mean_square_velocity(&[Vector::new(3.0, 4.0), Vector::new(0.0, 1.0)]), 13.0);
/// ```
pub fn mean_square_velocity(velocities: &[Vector<f64>]) -> f64 {
    let sum: f64 = velocities.iter().map(Vector::norm_squared).sum();
    sum / velocities.len().max(1) as f64
}
