use super::*;
use crate::tracks::movie::Movie;
use crate::tracks::rule::Rule;
use crate::tracks::sample::Filmed;
use crate::{CoefficientSpace, Constraints, NoiseLevels};

const MEMORY: Memory = Memory { times: 0.3, speed: 0.5, free: 0.7, alignment: 0.4 };

struct Case {
    movie: Movie,
    states: States,
    structure: Structure,
    space: CoefficientSpace,
}

impl Case {
    fn new(align: bool) -> Self {
        let (movie, _) = Filmed { size: [64, 4], step: 0.1, error: 0.01, seed: 2 }.movie();
        let structure = Structure::base(1.0);
        let mut states = States::new(&movie).unwrap().crawling(&movie, structure.terms.len());
        if align {
            states = states.aligning();
        }
        let states = states.driven_by(Drives { contact_inhibition: true, velocity_alignment: true });
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        Self { movie, states, structure, space }
    }

    fn objective(&self) -> MovieObjective<'_> {
        let Self { movie, states, structure, space } = self;
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        let memory = Some(Memory { alignment: if states.polarities.align() { 0.4 } else { 0.0 }, ..MEMORY });
        MovieObjective { movie, states, rule: Rule::Trapezoid, structure, space, levels, memory }
    }

    /// A point some way along a direction in all unknowns.
    fn at(&self, step: f64) -> Vec<f64> {
        let free = [0.1, 2.0, 0.5, 1.0];
        let block = self.states.polarities.of_drives().unwrap();
        let all = (0..4 + 2 * self.states.blocks()).map(|k| {
            let size = match k {
                0..4 => free[k],
                _ if k == 4 + 2 * block => 0.2,
                _ if k == 5 + 2 * block => -0.3,
                _ => 0.003 * (1.7 * k as f64).cos(),
            };
            size + step * (0.9 * k as f64).sin()
        });
        all.collect()
    }
}

/// The rows of drives are the derivatives of what is left of them.
#[test]
fn rows_of_drives_are_derivatives() {
    const STEP: f64 = 1e-7;
    for align in [false, true] {
        let case = Case::new(align);
        let objective = case.objective();
        let rows = |step: f64| {
            let at = case.at(step);
            objective.drive_rows(&objective.displaced(&at).unwrap(), &at, 4)
        };
        let along = |k: usize| (0.9 * k as f64).sin();
        let direction: Vec<Vector<f64>> = (0..case.states.blocks())
            .map(|block| Vector::new(along(4 + 2 * block), along(5 + 2 * block)))
            .collect();
        let (own, before, after) = (rows(0.0), rows(-STEP), rows(STEP));
        assert_eq!(own.len(), if align { 4 } else { 3 });
        for (own, (before, after)) in own.iter().zip(before.iter().zip(&after)) {
            assert_eq!(own.rows.len(), 3 * 64);
            let by_places = own.jacobian.apply(&direction);
            for (row, (_, _, x)) in own.rows.iter().enumerate() {
                let by_coefficients: Vector<f64> =
                    (0..4).map(|k| Vector::new(x[(0, k)], x[(1, k)]) * along(k)).sum();
                let difference = (before.rows[row].1 - after.rows[row].1) / (2.0 * STEP);
                let miss = by_places[row] + by_coefficients - difference;
                assert!(miss.norm() < 1e-5 * (1.0 + difference.norm()), "{miss:?} {difference:?}");
            }
        }
    }
}

/// All that holds polarities adds up to the squares of what is new in them, with the drive that is expected.
#[test]
fn driven_polarities_are_held_to_what_is_expected() {
    for align in [false, true] {
        let case = Case::new(align);
        let objective = case.objective();
        let memory = objective.memory.unwrap();
        let at = case.at(0.0);
        let placed = objective.displaced(&at).unwrap();
        let (free, displacements) = objective.split(&at);
        let polarities = &case.states.polarities;
        let u =
            |cell: usize, frame: usize| States::vector(displacements, polarities.block[frame][cell] as usize);
        let c = objective.drives(displacements);
        let fields = objective.fields(&placed, objective.space.coefficients(free).as_slice(), c);
        let g = |cell: usize, frame: usize| {
            fields[frame].of_cells[0][cell] * c[0] + fields[frame].of_cells[1][cell] * c[1]
        };
        let (rho, a) = ((-0.3_f64).exp(), if align { 1.0 - (-0.4_f64).exp() } else { 0.0 });
        let mut expected = 0.0;
        for frame in 0..3 {
            let tessellation = &case.states.instants[frame].cells.tessellation;
            for cell in 0..64 {
                let others = tessellation.neighbours(cell).iter();
                let turn: Vector<f64> =
                    others.map(|other| u(*other as usize, frame) - u(cell, frame)).sum::<Vector<f64>>()
                        * (a / 6.0);
                let drive = match frame {
                    0 => g(cell, 0),
                    _ => g(cell, frame) * 1.5 - g(cell, frame - 1) * 0.5,
                };
                let new = u(cell, frame + 1) - (u(cell, frame) + turn) * rho - drive;
                expected += new.norm_squared() / (1.0 - rho * rho);
            }
        }
        expected *= objective.ratio(memory);
        // The same with nothing driven, and what the drives change.
        let mut plain = polarities.clone();
        (plain.drives, plain.driven) = (Drives::default(), Vec::new());
        let states = States { polarities: plain, ..case.states.clone() };
        let without = MovieObjective { states: &states, ..objective };
        let undriven: Vec<f64> = displacements[..2 * states.blocks()].to_vec();
        let mut apart = 0.0;
        for (frame, cell) in (0..3).flat_map(|frame| (0..64).map(move |cell| (frame, cell))) {
            let others = case.states.instants[frame].cells.tessellation.neighbours(cell).iter();
            let turn: Vector<f64> =
                others.map(|other| u(*other as usize, frame) - u(cell, frame)).sum::<Vector<f64>>()
                    * (a / 6.0);
            let new = u(cell, frame + 1) - (u(cell, frame) + turn) * rho;
            apart += new.norm_squared() / (1.0 - rho * rho);
        }
        let change = expected - apart * objective.ratio(memory);
        let drives = polarities.of_drives().unwrap();
        let of_unknowns = objective.floor() * States::vector(displacements, drives).norm_squared();
        let found = objective.stiffness().of(displacements) + objective.driven(&placed, &at)
            - without.stiffness().of(&undriven)
            - of_unknowns;
        assert!((found - change).abs() < 1e-8 * expected, "{found} {change} {expected}");
        assert!(change.abs() > 1e-3 * expected);
    }
}
