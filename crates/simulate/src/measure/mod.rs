//! Measurements on a state: numbers of a field or of a tissue.

mod block_average;
mod channel;
mod displacement;
mod hexatic;
mod lyapunov;
mod pinching;
mod shape;
mod structure_factor;
mod transitions;

pub use block_average::BlockAverage;
pub use channel::{ChannelProfile, ChannelRecorder, Estimate};
pub use displacement::mean_square_displacement;
pub use hexatic::{Hexatic, hexatic, hexatic_among};
pub use lyapunov::{LyapunovExponent, LyapunovSchedule, largest_lyapunov_exponent};
pub use pinching::{PinchedFlow, Pinching, pinched_flow};
pub use shape::shape_indices;
pub use structure_factor::{StructureFactor, structure_factor};
pub use transitions::TransitionCounter;

use voronudge_geometry::{CellPolygon, Tessellation, Vector};
use voronudge_model::{ForceTerm, Model};

/// `⟨v²⟩ = (1/N) Σ_i |v_i|²` of velocities (N), in the square of their unit; zero for no cells.
///
/// ```
/// use voronudge_geometry::Vector;
/// use voronudge_simulate::measure::mean_square_velocity;
/// assert_eq!(mean_square_velocity(&[Vector::new(3.0, 4.0), Vector::new(0.0, 1.0)]), 13.0);
/// ```
pub fn mean_square_velocity(velocities: &[Vector<f64>]) -> f64 {
    let sum: f64 = velocities.iter().map(Vector::norm_squared).sum();
    sum / velocities.len().max(1) as f64
}

/// The energy `E = Σ_i Σ_t c_t e_t(A_i, P_i)` of the cells with a closed polygon, for positions (N).
///
/// Terms without an energy (cortical chirality) and responses must have a coefficient of zero; otherwise there is none and
/// the result is `None`. Without them, velocities are `v_i = −∂E/∂r_i` and `E` decreases along every trajectory in a periodic box.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation};
/// use voronudge_model::{Model, Parameters};
/// use voronudge_simulate::{RandomPlacement, generator, measure::energy};
/// let cell_box = PeriodicBox::new([4.0, 4.0])?;
/// let positions = RandomPlacement::new(16, cell_box).draw(&mut generator(1))?;
/// let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
/// let achiral = Parameters::default();
/// let chiral = Parameters { chirality: 1.0, ..achiral };
/// assert!(energy(&tessellation, &positions, &Model::chiral_voronoi(&achiral)).is_some());
/// assert!(energy(&tessellation, &positions, &Model::chiral_voronoi(&chiral)).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn energy(tessellation: &Tessellation, positions: &[Vector<f64>], model: &Model<f64>) -> Option<f64> {
    if model.responses.iter().any(|weighted| weighted.coefficient != 0.0) {
        return None;
    }
    let mut polygon = CellPolygon::default();
    let mut total = 0.0;
    for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell)) {
        polygon.fill(tessellation, positions, cell);
        for weighted in model.terms.iter().filter(|weighted| weighted.coefficient != 0.0) {
            let own = model.environment.cell_factors().term(weighted, cell);
            total += own.coefficient * own.term.energy(polygon.shape())?;
        }
    }
    Some(total)
}
