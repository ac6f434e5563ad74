//! Extrusion and proliferation, in a periodic box and between walls.

mod cycles;
mod periodic;
mod walled;

use voronudge_simulate::{
    CellCycle, DivisionAxis, EdgeRate, Injection, LivingTissue, Proliferation, Turnover,
};

const TURNOVER: Turnover = Turnover {
    extrusion: EdgeRate { rate: 0.77, decay_length: 1.4 },
    proliferation: Proliferation::Replacing { decay_length: 0.25 },
    injection: Injection::Vertex,
    most_cells: 1000,
    seed: 3,
};

const CYCLE: CellCycle =
    CellCycle { variation: 0.3, size_at_division: 1.386, distance: None, axis: DivisionAxis::Long };

/// The cells of a tissue are the lives without an end.
fn assert_the_living_are_told(tissue: &LivingTissue) {
    let lives = tissue.lives();
    let mut living = tissue.identities().to_vec();
    living.sort_unstable();
    let expected: Vec<usize> = (0..lives.len()).filter(|&life| lives[life].goes_on()).collect();
    assert_eq!(living, expected);
}

/// A seed has the same lives on one and on several threads, and another seed has others.
fn assert_threads_do_not_matter(several: usize, tissue: fn(Turnover) -> LivingTissue) {
    let lives = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut tissue = tissue(Turnover { seed, ..TURNOVER });
            (0..300).for_each(|_| tissue.step(0.01).unwrap());
            (tissue.lives().to_vec(), tissue.simulation().positions().to_vec())
        })
    };
    assert_eq!(lives(1, 3), lives(several, 3));
    assert_ne!(lives(1, 3).0, lives(1, 4).0);
}
