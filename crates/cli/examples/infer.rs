//! The parameters of a tissue from positions and velocities with noise, by nudged inference, beside the truth and a naive fit.

use std::ops::ControlFlow;
use voronudge::infer::{Constraints, FitParameter};
use voronudge::io::Source;
use voronudge::problem::{Problem, Question};

/// What the bundled tissue was simulated with.
const TRUTH: [(FitParameter, f64); 4] = [
    (FitParameter::ChiralCoefficient, 3.4),
    (FitParameter::PreferredPerimeter, 4.0),
    (FitParameter::Chirality, 3.4),
    (FitParameter::PerimeterElasticity, 1.0),
];

/// Prints parameters with 95 % intervals in the units of the data, and the errors of the fits.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/chiral-liquid");
    let data = Source::folder(folder).load()?;
    let constraints = Constraints::fixed([(FitParameter::AreaElasticity, 0.1)]);
    let mut problem = Problem::new(&data, &Question { constraints, ..Question::default() })?;
    let mut watch = |_: voronudge::infer::Progress<'_>| ControlFlow::Continue(());
    problem.understand(&mut watch)?; // cells that were not detected, centroids taken for sites
    let (found, _) = problem.infer(&mut watch)?;
    println!("parameter   nudged    95 % interval        truth");
    for (quantity, truth) in TRUTH {
        let own = problem.estimate(&found, quantity);
        let [low, high] = own.interval.map(Option::unwrap_or_default);
        println!("{:10} {:7.3}    {low:6.3} to {high:6.3}   {truth:6.2}", quantity.name(), own.value);
    }
    let naive = found.naive.perimeter_elasticity * found.naive.chirality / problem.scale.time;
    println!("K_P alpha without nudges: {naive:.3}");
    if let Some([held_out, error]) = found.nmse.cross_validated {
        let noise = found.nmse.noise_floor;
        println!("error of velocities held out {held_out:.3} ± {error:.3}, of noise alone {noise:.3}");
    }
    Ok(())
}
