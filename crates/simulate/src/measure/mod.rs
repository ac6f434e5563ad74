//! Measurements that need the model, or a run of it; those of positions alone are in `voronudge_observables`.

mod channel;
mod lyapunov;
mod pinching;

pub use channel::{ChannelProfile, ChannelRecorder, Estimate, ShapeRecorder, ShapesByAge};
pub use lyapunov::{LyapunovExponent, LyapunovSchedule, largest_lyapunov_exponent};
pub use pinching::{PinchedFlow, Pinching, pinched_flow};

use voronudge_geometry::{CellPolygon, Tessellation, Vector};
use voronudge_model::{ForceTerm, Model};

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
