//! Small sets of every class through the program.

use super::program::Program;
use super::record::{Fit, Record};
use super::trial;
use claims::measured::{CLASSES, Class};
use rayon::prelude::*;

/// Of tissues this small.
const CELLS: usize = 100;
const SEED: u64 = 2;

/// What the program is held to.
enum Held {
    /// Both parameters within this many standard errors, and K_P α within this share.
    Right { deviation: f64, share: f64 },
    /// A fit, whatever it says.
    Answer,
}

const RIGHT: Held = Held::Right { deviation: 3.0, share: 0.1 };

/// What each class is held to.
fn held(class: &Class) -> Held {
    match class.name {
        "complete" | "open" | "missed-2" | "missed-5" | "open-missed-2" | "merged-split" => RIGHT,
        "flow-gaussian-35" | "flow-gaussian-50" | "flow-square" | "centroids" => RIGHT,
        "tracks-05" | "tracks-15" | "broken-tracks" => RIGHT,
        _ => Held::Answer,
    }
}

fn fit(class: &Class, seed: u64, cells: Option<usize>) -> Fit {
    let program = Program::new(None, "--fix K_A=0.1").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let Record { fit, message, .. } = trial::run(class, seed, cells, &program, false, folder.path()).unwrap();
    fit.unwrap_or_else(|| panic!("{}: {message}", class.name))
}

#[test]
#[ignore = "slow"]
fn small_sets_of_every_class() {
    CLASSES.par_iter().for_each(|class| {
        let fit = fit(class, SEED, Some(CELLS));
        let Held::Right { deviation, share } = held(class) else { return };
        let (chiral, perimeter) = (fit.k_p_alpha, fit.p_0);
        let told = format!("{}: {chiral:?} {perimeter:?}", class.name);
        assert!(chiral.deviation() < deviation && perimeter.deviation() < deviation, "{told}");
        assert!(chiral.error().abs() < share, "{told}");
        assert!(fit.trustworthy, "{told}: {:?}", fit.doubts);
    });
}

/// In this tissue two arrangements of cells next to each other are each better than the other, as each is looked at.
#[test]
#[ignore = "slow"]
fn arrangements_that_take_turns_come_to_an_end() {
    let class = Class::named("merged-split").unwrap();
    let found = fit(&class, 26, None).k_p_alpha;
    assert!(found.error().abs() < 0.1, "{found:?}");
}
