//! The rows against differences of what they are the derivatives of.

use super::*;
use crate::linearisation::Accuracy;
use crate::tracks::memory::Memory;
use crate::tracks::own_motion::OwnMotion;
use crate::tracks::rule::Rule;
use crate::tracks::sample::{Filmed, followed};
use crate::tracks::states::States;
use crate::tracks::{Drift, Movie};
use crate::{Activity, CoefficientSpace, Constraints, NoiseLevels};
use voronudge_geometry::{Domain, FieldOfView};
use voronudge_model::Structure;

/// A tissue cut out of its surroundings, with a gap, a track that ends and one that begins.
fn open_movie(jump: Vector<f64>, time: f64) -> Movie {
    let (mut film, domain, _) = Filmed { size: [144, 3], step: 0.1, error: 0.01, seed: 2 }.film();
    let Domain::Periodic(cell_box) = domain else { panic!("a periodic film") };
    let first = film[0].clone();
    for (r, start) in film.iter_mut().flat_map(|cells| cells.iter_mut().zip(&first)) {
        *r = r.zip(*start).map(|(r, start)| r + cell_box.wrap(start) - start);
    }
    for (frame, cells) in film.iter_mut().enumerate() {
        cells[20] = cells[20].filter(|_| frame != 1);
        cells[30] = cells[30].filter(|_| frame < 2);
        cells[40] = cells[40].filter(|_| frame > 0);
        if frame == 2 {
            cells.iter_mut().flatten().for_each(|r| *r += jump);
        }
    }
    Movie::new(vec![0.0, time, 2.5 * time], &film, Domain::Open, FieldOfView::default(), Drift::PerInterval)
        .unwrap()
}

fn objective<'a>(
    movie: &'a Movie,
    states: &'a States,
    structure: &'a Structure,
    space: &'a CoefficientSpace,
    rule: Rule,
) -> MovieObjective<'a> {
    let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
    let memory = (states.polarities.count() > 0).then_some(Memory::FIRST);
    MovieObjective { movie, states, rule, structure, space, levels, memory }
}

/// A point and the residuals around it, along a direction in all unknowns.
struct Around<'a> {
    objective: MovieObjective<'a>,
}

impl Around<'_> {
    fn along(k: usize) -> f64 {
        (0.9 * k as f64).sin()
    }

    fn at(&self, step: f64) -> Vec<f64> {
        let p = self.objective.space.dimension();
        let free = [0.1, 2.0, 0.5, 1.0];
        let all = (0..p + 2 * self.objective.states.blocks()).map(|k| {
            let size = if k < p { free[k] } else { 0.003 * (1.7 * k as f64).cos() };
            size + step * Self::along(k)
        });
        all.collect()
    }

    fn residuals(&self, step: f64) -> Vec<Vector<f64>> {
        let at = self.at(step);
        self.objective.residuals(&self.objective.displaced(&at).unwrap(), &at)
    }

    /// What the first polarities should be less what they are.
    fn outset(&self, at: &[f64]) -> Outset {
        let Self { objective } = self;
        Outset::new(objective, &objective.displaced(at).unwrap(), objective.split(at).1, 4)
    }

    /// Relative error of each row of the motions.
    fn misses(&self) -> Vec<f64> {
        let Self { objective } = self;
        let p = objective.space.dimension();
        let at = self.at(0.0);
        let c = objective.space.coefficients(&at[..p]);
        let rows = objective.motion_rows(&objective.displaced(&at).unwrap(), c.as_slice());
        let by_coefficients = |x: &DMatrix<f64>| -> Vector<f64> {
            (0..p).map(|k| Vector::new(x[(0, k)], x[(1, k)]) * Self::along(k)).sum()
        };
        let of_coefficients: Vec<Vector<f64>> = rows.columns.iter().map(by_coefficients).collect();
        self.missed(&rows.jacobian, &of_coefficients, |step| self.residuals(step))
    }

    /// The same of the first polarities.
    fn misses_of_outset(&self) -> Vec<f64> {
        let rests = |outset: &Outset| outset.rows().rows.iter().map(|(_, rest, _)| *rest).collect::<Vec<_>>();
        let own = self.outset(&self.at(0.0));
        let nothing = vec![Vector::zeros(); rests(&own).len()];
        self.missed(own.rows().jacobian, &nothing, |step| rests(&self.outset(&self.at(step))))
    }

    /// By how much rows, and what the coefficients add, miss the differences of what is left, in shares of these.
    fn missed(
        &self,
        jacobian: &BlockMatrix,
        by_coefficients: &[Vector<f64>],
        rests: impl Fn(f64) -> Vec<Vector<f64>>,
    ) -> Vec<f64> {
        const STEP: f64 = 1e-7;
        let p = self.objective.space.dimension();
        let [before, after] = [-STEP, STEP].map(rests);
        let direction: Vec<Vector<f64>> = (0..self.objective.states.blocks())
            .map(|block| Vector::new(Self::along(p + 2 * block), Self::along(p + 2 * block + 1)))
            .collect();
        let by_places = jacobian.apply(&direction);
        let miss = |(row, by_coefficients): (usize, &Vector<f64>)| {
            let difference = (before[row] - after[row]) / (2.0 * STEP);
            (by_places[row] + by_coefficients - difference).norm() / (1.0 + difference.norm())
        };
        by_coefficients.iter().enumerate().map(miss).collect()
    }
}

/// The errors of the rows of a rule for frames some time apart, in ascending order.
fn misses(time: f64, rule: Rule, [crawling, told_apart]: [bool; 2]) -> Vec<f64> {
    let movie = open_movie(Vector::zeros(), time);
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let mut states = States::new(&movie).unwrap();
    assert!(states.motions.len() > 20 && states.drifts.1 == 2);
    if crawling {
        states = states.crawling(&movie, structure.terms.len());
        assert!(states.polarities.count() > states.motions.len());
    }
    if told_apart {
        let around = Around { objective: objective(&movie, &states, &structure, &space, rule) };
        let own_motion = OwnMotion::at(&around.objective, &around.at(0.0)).unwrap();
        states = States { own_motion, ..states };
    }
    let mut misses = Around { objective: objective(&movie, &states, &structure, &space, rule) }.misses();
    misses.sort_by(f64::total_cmp);
    misses
}

/// Every rule's rows against differences of the residuals, along a direction in all unknowns. What is left is the places of cells
/// beyond two rings, which grows with the time.
#[test]
fn rows_are_the_derivatives_of_the_residuals() {
    let quantile = |misses: &[f64], share: f64| misses[(share * (misses.len() - 1) as f64) as usize];
    // The ways that cells crawl count within two rings, too; motions that are told apart depend on what is farther less.
    for (crawling, beyond, [most, nearly_all]) in
        [([false; 2], 1.0, [0.06, 0.2]), ([true, false], 1.5, [0.09, 0.3]), ([true; 2], 1.5, [0.03, 0.225])]
    {
        let still = misses(0.1, Rule::Trapezoid, crawling);
        assert!(quantile(&still, 1.0) < 1e-6, "{still:?}");
        for steps in [1, 2, 4, 8] {
            let short = misses(0.001, Rule::RungeKutta(steps), crawling);
            assert!(
                quantile(&short, 0.9) < beyond * 1e-4 && quantile(&short, 1.0) < beyond * 2e-3,
                "{short:?}"
            );
        }
        for steps in [2, 4, 8] {
            let long = misses(0.1, Rule::RungeKutta(steps), crawling);
            let [middle, high] = [0.5, 0.9].map(|share| quantile(&long, share));
            assert!(middle < most && high < nearly_all, "{crawling:?} {steps}: {middle} {high}");
        }
    }
}

/// What is left of a motion that is told apart does not depend on the ways that other cells crawl, but for those far off.
#[test]
fn motions_that_are_told_apart_depend_on_their_own_way_alone() {
    let movie = open_movie(Vector::zeros(), 0.05);
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let crawling = States::new(&movie).unwrap().crawling(&movie, structure.terms.len());
    let rule = Rule::RungeKutta(4);
    let together = Around { objective: objective(&movie, &crawling, &structure, &space, rule) };
    let at = together.at(0.0);
    let own_motion = OwnMotion::at(&together.objective, &at).unwrap();
    let apart = States { own_motion, ..crawling.clone() };
    const STEP: f64 = 1e-6;
    let spread = |states: &States| -> f64 {
        let residuals = |at: &[f64]| {
            let own = objective(&movie, states, &structure, &space, rule);
            own.residuals(&own.displaced(at).unwrap(), at)
        };
        let before = residuals(&at);
        let (mut own, mut others) = (0.0, 0.0);
        for (number, motion) in states.motions.iter().enumerate().step_by(4) {
            let [way, _] = states.polarity(motion).unwrap();
            let mut pushed = at.clone();
            pushed[space.dimension() + 2 * way] += STEP;
            for (other, (after, before)) in residuals(&pushed).iter().zip(&before).enumerate() {
                let moved = (after - before).norm_squared() / (STEP * STEP);
                match states.motions[other].track == motion.track {
                    true => own += moved * f64::from(u8::from(other == number)),
                    false => others += moved,
                }
            }
        }
        others / own
    };
    let [together, apart] = [&crawling, &apart].map(spread);
    assert!(together > 0.02 && apart < 0.1 * together, "{together} {apart}");
}

/// The same of what is expected of the polarities with which tracks begin.
#[test]
fn rows_of_the_outset_are_derivatives_too() {
    let movie = open_movie(Vector::zeros(), 0.1);
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let states = States::new(&movie).unwrap().crawling(&movie, structure.terms.len());
    let around = Around { objective: objective(&movie, &states, &structure, &space, Rule::RungeKutta(2)) };
    let misses = around.misses_of_outset();
    assert!(misses.len() > 20 && misses.iter().all(|miss| *miss < 1e-6), "{misses:?}");
}

/// Along a line on which transitions move through the stages and steps of the integration, displacements of most cells do not leap. What
/// is left are transitions next to each other, and what a jump at one stage does to the next: of second order in the step.
#[test]
fn displacements_are_continuous_where_neighbours_change() {
    const STEP: f64 = 2e-5;
    let movie = open_movie(Vector::zeros(), 0.1);
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let states = States::new(&movie).unwrap();
    let around = Around { objective: objective(&movie, &states, &structure, &space, Rule::RungeKutta(2)) };
    let all: Vec<Vec<Vector<f64>>> = (0..200).map(|k| around.residuals(STEP * f64::from(k))).collect();
    let leaps = |row: usize| {
        let second = all.windows(3).map(move |w| (w[2][row] - w[1][row] * 2.0 + w[0][row]).norm());
        second.fold(0.0, f64::max)
    };
    let mut largest: Vec<f64> = (0..all[0].len()).map(leaps).collect();
    largest.sort_by(f64::total_cmp);
    // The transitions alone would make the middle one 1.7e-4.
    assert!(largest[largest.len() / 2] < 3e-5, "{largest:?}");
    let placed = around.objective.displaced(&around.at(0.0)).unwrap();
    let turns = placed.passages.iter().flat_map(|passage| &passage.steps).map(|step| step.turns.len());
    assert!(turns.sum::<usize>() > 20);
}

/// A jump of the stage changes nothing.
#[test]
fn a_jump_of_the_stage_is_no_motion() {
    let space = CoefficientSpace::new(&Constraints::default()).unwrap();
    let structure = Structure::base(1.0);
    let [still, jumped] = [Vector::zeros(), Vector::new(0.3, -0.2)].map(|jump| {
        let movie = open_movie(jump, 0.1);
        let states = States::new(&movie).unwrap();
        let objective = objective(&movie, &states, &structure, &space, Rule::RungeKutta(2));
        objective.value(&objective.start(&[0.1, 2.0, 0.5, 1.0]))
    });
    assert!((still - jumped).abs() < 1e-9 * still, "{still} {jumped}");
}

/// What is left where unknowns are eliminated by iteration is what factors leave: of cells that crawl, and of such that align.
#[test]
fn iterations_end_where_factors_do() {
    for activity in [Activity::None, Activity::Polarity, Activity::Alignment] {
        let (movie, request, followed) = followed(activity);
        let space = request.space().unwrap();
        let objective = followed.objective(&movie, &request.structure, &space);
        let equations = objective.linearise(&followed.fit.parameters).unwrap();
        let frame = &equations.frames[0];
        let spring = objective.levels.spring();
        for damping in [vec![], vec![0.1 * spring; frame.order()]] {
            let [factor, iteration] = [None, Some(Accuracy::OfResults)]
                .map(|way| frame.eliminate_by(way, spring, &damping).unwrap());
            let off = (&iteration.schur - &factor.schur).amax() / factor.schur.amax();
            assert!(off > 0.0 && off < 1e-10, "{activity:?} {off}");
            let off = (&iteration.gradient - &factor.gradient).amax();
            assert!(off < 1e-9 * factor.gradient.amax().max(1.0), "{activity:?} {off}");
            assert!((iteration.gain - factor.gain).abs() < 1e-9 * factor.gain);
            let free = factor.gradient.map(|_| 0.01);
            let [factor, iteration] = [factor, iteration].map(|own| own.nudge_step(&free));
            let size = factor.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
            let off = factor.iter().zip(&iteration).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-5 * size, "{activity:?} {off} of {size}");
        }
    }
}
