//! What the base model misses of a tissue that drifts: the effect that explains it, and the error before and after.

use std::ops::ControlFlow;
use voronudge::infer::Unkept;
use voronudge::io::Source;
use voronudge::problem::{Problem, Question};

/// Prints the verdict, the effects that were added with their coefficients, and the best candidates.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/drifting-liquid");
    let data = Source::folder(folder).load()?;
    let mut problem = Problem::new(&data, &Question::default())?;
    let mut watch = |_: voronudge::infer::Progress<'_>| ControlFlow::Continue(());
    problem.understand(&mut watch)?;
    problem.surround(&data)?; // what effects may refer to: the middle, labels, the edge
    let mut search = problem.search();
    search.null_sets = Some(0); // synthetic data without an effect, to be on the safe side
    let found = problem.discover(&search, &mut Unkept, &mut watch)?;
    println!("{:?}: {:.0} % of what was missing", found.verdict, 100.0 * found.share_of_excess);
    for added in &found.selected {
        println!("{}: {}", added.effect.id, added.effect.meaning);
        for coefficient in &added.coefficients {
            let own = coefficient.in_unit(problem.scale.unit(added.effect.unit));
            println!("  {:.3} ± {:.3}", own.value, own.standard_error);
        }
    }
    for (when, fitted) in [("before", &found.before), ("after", &found.after)] {
        let error = fitted.held_out.ok_or("there are enough cells to hold some out")?;
        println!("error on data held out {when}: {:.3} ± {:.3}", error.value, error.standard_error);
    }
    for candidate in found.ranking.iter().take(5) {
        println!("{:24} p = {:.1e}  {:?}", candidate.effect.id, candidate.p, candidate.fate);
    }
    Ok(())
}
