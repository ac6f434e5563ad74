//! Growth and division: rates, sizes, daughters, and whom the clock of births draws.

use super::{CYCLE, TURNOVER, assert_the_living_are_told, assert_threads_do_not_matter};
use std::collections::BTreeMap;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, Vector, areas};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{
    CellCycle, DivisionAxis, EdgeRate, Error, Injection, LivingTissue, Origin, Progress, Proliferation,
    RandomPlacement, Simulation, Turnover, Walls, distance_of_halves, generator,
};

const LENGTHS: [f64; 2] = [8.0, 6.0];
const DIVIDING: Turnover = Turnover { injection: Injection::Cycle(CYCLE), ..TURNOVER };

fn places(lengths: [f64; 2]) -> Vec<Vector<f64>> {
    let cell_box = PeriodicBox::new(lengths).unwrap();
    RandomPlacement::new(cell_box.area().round() as usize, cell_box).draw(&mut generator(1)).unwrap()
}

fn simulation(lengths: [f64; 2], positions: Vec<Vector<f64>>, chirality: f64) -> Simulation {
    let cell_box = PeriodicBox::new(lengths).unwrap();
    let parameters =
        Parameters { area_elasticity: 0.5, preferred_perimeter: 3.8, chirality, ..Parameters::default() };
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters)).unwrap()
}

fn tissue(turnover: Turnover) -> LivingTissue {
    LivingTissue::new(simulation(LENGTHS, places(LENGTHS), 1.0), turnover).unwrap()
}

fn walled(turnover: Turnover) -> LivingTissue {
    let simulation = simulation(LENGTHS, places(LENGTHS), 1.0).with_walls(Walls::X).unwrap();
    LivingTissue::new(simulation, turnover).unwrap()
}

/// One division for each extrusion, of a cell at the end of its cycle, into two of half its size at equal distances on either side; the
/// force of the tissue on itself vanishes, whatever the sizes, across a wall excepted, which takes it up.
#[test]
fn a_mother_of_full_size_has_two_daughters_of_half_of_it() {
    for (mut tissue, walls) in [(tissue(DIVIDING), false), (walled(DIVIDING), true)] {
        let mut divisions = 0;
        for _ in 0..800 {
            let before = tissue.identities().to_vec();
            tissue.step(0.01).unwrap();
            assert_eq!((tissue.cycles().len(), tissue.simulation().positions().len()), (48, 48));
            let last = tissue.last_step();
            assert_eq!(last.divisions.len(), last.extrusions.len());
            assert_eq!(last.births.len(), 2 * last.divisions.len());
            for (pair, mother) in last.births.chunks(2).zip(&last.divisions) {
                assert!(((pair[0] + pair[1]) * 0.5 - mother).norm() < 1e-12);
                let apart = (pair[0] - pair[1]).norm();
                assert!((0.1..1.5).contains(&apart), "{apart}");
                assert!(!walls || pair.iter().all(|r| 0.0 < r.x && r.x < LENGTHS[0]));
            }
            divisions += last.divisions.len();
            let (lives, now) = (tissue.lives(), tissue.simulation().time());
            for (life, progress) in tissue.identities().iter().zip(tissue.cycles()) {
                assert!(progress.phase <= progress.length * (1.0 + 1e-12));
                if lives[*life].origin == Origin::Division && lives[*life].born == now {
                    assert_eq!(CYCLE.size(*progress), 0.5 * CYCLE.size_at_division);
                }
            }
            for life in before.iter().map(|life| lives[*life]).filter(|life| life.divided.is_some()) {
                assert!(life.divided == Some(now) && life.extruded.is_none());
            }
            let total: Vector<f64> = tissue.simulation().velocities().iter().sum();
            assert!(total.y.abs() < 1e-9 && (walls || total.x.abs() < 1e-9), "{total}");
        }
        assert!(divisions > 50, "{divisions}");
        assert_the_living_are_told(&tissue);
        let lives = tissue.lives();
        for (own, life) in lives.iter().enumerate().filter(|(_, life)| life.origin == Origin::Division) {
            let mother = life.mother.unwrap();
            assert_eq!(lives[mother].divided, Some(life.born));
            let sisters = lives.iter().filter(|other| other.mother == Some(mother)).count();
            assert!(mother < own && sisters == 2);
        }
    }
}

/// Two daughters beside each other have the place of their mother, and push its sides away in proportion to their distance.
#[test]
fn two_daughters_fill_the_place_of_their_mother() {
    let off = |distance: f64| {
        let cycle = CellCycle { distance: Some(distance), ..CYCLE };
        let mut tissue = tissue(Turnover { injection: Injection::Cycle(cycle), ..TURNOVER });
        loop {
            let before = tissue.identities().to_vec();
            tissue.step(0.001).unwrap();
            if tissue.last_step().divisions.len() == 1 {
                let last = tissue.last_step();
                // Without the extrusion of the same step, which changes areas as well.
                let gone = before.iter().position(|life| tissue.lives()[*life].extruded.is_some()).unwrap();
                let mother = before.iter().position(|life| tissue.lives()[*life].divided.is_some()).unwrap();
                let area = |positions: &[Vector<f64>], cells: &[usize]| -> f64 {
                    let all = simulation(LENGTHS, positions.to_vec(), 1.0);
                    let all = areas(all.tessellation(), positions);
                    cells.iter().map(|&cell| all[cell]).sum()
                };
                let mut positions = last.to.clone();
                let whole = area(&positions, &[mother]);
                positions[mother] = last.births[0];
                positions.push(last.births[1]);
                let halves = area(&positions, &[mother, positions.len() - 1]);
                assert_ne!(gone, mother);
                return (halves - whole).abs() / whole;
            }
        }
    };
    let [coarse, fine] = [0.02, 0.01].map(off);
    assert!(fine < 0.02 && (1.8..2.2).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// Of a population everywhere alike as many are born per cell and time as was asked, whatever the spread of cycles, from the first moment on:
/// nothing is synchronised. Counts of 16 pieces of time, of which each is within five of its standard errors at random (with cycles that are
/// regular it is less).
#[test]
fn births_have_the_rate_that_was_asked_for() {
    let (rate, lengths) = (1.0, [12.0, 10.0]);
    let everywhere = EdgeRate { rate, decay_length: f64::INFINITY };
    for variation in [0.0, 0.3, 1.0] {
        let (mut births, mut exposure) = ([0.0; 4], [0.0; 4]);
        for seed in 0..6 {
            let turnover = Turnover {
                extrusion: everywhere,
                proliferation: Proliferation::Independent(everywhere),
                injection: Injection::Cycle(CellCycle { variation, ..CYCLE }),
                seed,
                ..TURNOVER
            };
            let mut tissue = LivingTissue::new(simulation(lengths, places(lengths), 0.0), turnover).unwrap();
            for step in 0..160 {
                exposure[step / 40] += 0.02 * tissue.identities().len() as f64;
                tissue.step(0.02).unwrap();
                births[step / 40] += tissue.last_step().divisions.len() as f64;
            }
        }
        for (piece, (births, exposure)) in births.iter().zip(exposure).enumerate() {
            let off: f64 = births - rate * exposure;
            assert!(off.abs() < 4.0 * f64::sqrt(*births), "{variation}, {piece}: {births} of {exposure}");
        }
        let (all, expected) = (births.iter().sum::<f64>(), rate * exposure.iter().sum::<f64>());
        assert!((all / expected - 1.0).abs() < 4.0 / all.sqrt(), "{variation}: {all} of {expected}");
    }
}

/// A cell divides at the end of the step in which its phase comes to the length that was drawn at its birth.
#[test]
fn cells_divide_when_their_cycles_end() {
    let everywhere = |rate: f64| EdgeRate { rate, decay_length: f64::INFINITY };
    let mut tissue = tissue(Turnover {
        extrusion: everywhere(0.0),
        proliferation: Proliferation::Independent(everywhere(0.8)),
        most_cells: 250,
        ..DIVIDING
    });
    let mut lengths = BTreeMap::new();
    while tissue.identities().len() < 200 {
        tissue.step(0.02).unwrap();
        for (life, progress) in tissue.identities().iter().zip(tissue.cycles()) {
            assert_eq!(*lengths.entry(*life).or_insert(progress.length), progress.length);
        }
    }
    let mut ended = 0;
    for (number, life) in
        tissue.lives().iter().enumerate().filter(|(_, life)| life.origin == Origin::Division)
    {
        if let Some(end) = life.divided {
            let phase = 0.8 * (end - life.born);
            assert!((0.0..0.0161).contains(&(phase - lengths[&number])), "{phase} {}", lengths[&number]);
            ended += 1;
        }
    }
    assert!(ended > 30, "{ended}");
}

/// With lengths that vary by one the clock of births draws mothers by the weight exp(−d_b/d), as births beside a mother do; with regular cycles it draws the
/// one that has waited longest.
#[test]
fn the_clock_of_births_draws_mothers_by_their_weight() {
    let (mut near, mut expected, mut spread) = (0.0, 0.0, 0.0);
    let positions = places(LENGTHS);
    for seed in 0..400 {
        let random = CellCycle { variation: 1.0, ..CYCLE };
        let turnover = Turnover {
            extrusion: EdgeRate { rate: 2.0, decay_length: f64::INFINITY },
            proliferation: Proliferation::Replacing { decay_length: 1.5 },
            injection: Injection::Cycle(random),
            seed,
            ..TURNOVER
        };
        let mut tissue = LivingTissue::new(simulation(LENGTHS, positions.clone(), 0.0), turnover).unwrap();
        while tissue.last_step().divisions.is_empty() {
            tissue.step(0.005).unwrap();
        }
        let (channel, last) = (tissue.channel(), tissue.last_step());
        let gone = |r: &Vector<f64>| last.extrusions.contains(r);
        let distances = last.to.iter().filter(|r| !gone(r)).map(|r| channel.edge_distance(*r));
        let weights: Vec<[f64; 2]> =
            distances.map(|d| [(-d / 1.5f64).exp(), f64::from(u8::from(d < 1.0))]).collect();
        let total: f64 = weights.iter().map(|[weight, _]| weight).sum();
        let share = weights.iter().map(|[weight, near]| weight * near).sum::<f64>() / total;
        expected += share;
        spread += share * (1.0 - share);
        near += f64::from(u8::from(channel.edge_distance(last.divisions[0]) < 1.0));
    }
    let off: f64 = near - expected;
    assert!(off.abs() < 4.0 * spread.sqrt(), "{near} {expected}");
}

/// In the mirror the first division is the mirror image, if α is opposite, in a periodic box and between walls.
#[test]
fn the_mirror_image_of_a_division_is_one() {
    let after = |mirror: bool, walls: bool| {
        let sign = if mirror { -1.0 } else { 1.0 };
        let positions: Vec<_> = (places(LENGTHS).into_iter())
            .map(|r| if mirror { Vector::new(LENGTHS[0] - r.x, r.y) } else { r })
            .collect();
        let mut simulation = simulation(LENGTHS, positions, sign * 0.7);
        if walls {
            simulation = simulation.with_walls(Walls::X).unwrap();
        }
        let mut tissue = LivingTissue::new(simulation, DIVIDING).unwrap();
        while tissue.last_step().divisions.is_empty() {
            tissue.step(0.01).unwrap();
        }
        let mut places: Vec<[f64; 2]> = (tissue.simulation().positions().iter())
            .map(|r| {
                let x = if mirror { LENGTHS[0] - r.x } else { r.x };
                [x.rem_euclid(LENGTHS[0]), r.y.rem_euclid(LENGTHS[1])]
            })
            .collect();
        places.sort_by(|a, b| a[0].total_cmp(&b[0]));
        places
    };
    for walls in [false, true] {
        for (own, image) in after(false, walls).iter().zip(after(true, walls)) {
            assert!(
                (own[0] - image[0]).abs() < 1e-8 && (own[1] - image[1]).abs() < 1e-8,
                "{own:?} {image:?}"
            );
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_lives_on_any_number_of_threads() {
    let dividing = |own: Turnover| Turnover { injection: Injection::Cycle(CYCLE), ..own };
    assert_threads_do_not_matter(3, |own| tissue(Turnover { injection: Injection::Cycle(CYCLE), ..own }));
    assert_eq!(dividing(TURNOVER), DIVIDING);
}

#[test]
fn a_division_near_the_end_of_a_cycle_disturbs_and_changes_nothing() {
    let mut tissue = tissue(DIVIDING);
    (0..200).for_each(|_| tissue.step(0.01).unwrap());
    let before = (tissue.simulation().velocities().to_vec(), tissue.cycles().to_vec());
    let all = tissue.birth_disturbance(Injection::Cycle(CYCLE), 40, 7).unwrap();
    assert!(all.iter().all(|change| change.is_finite() && *change > 0.0));
    assert_eq!(before, (tissue.simulation().velocities().to_vec(), tissue.cycles().to_vec()));
    let without = self::tissue(TURNOVER).birth_disturbance(Injection::Cycle(CYCLE), 1, 7);
    assert!(matches!(without, Err(Error::NoPlace { .. })));
}

#[test]
fn unusable_cycles_are_refused() {
    for cycle in [
        CellCycle { variation: -0.1, ..CYCLE },
        CellCycle { variation: 1.5, ..CYCLE },
        CellCycle { size_at_division: 0.0, ..CYCLE },
        CellCycle { distance: Some(f64::NAN), axis: DivisionAxis::Random, ..CYCLE },
    ] {
        let turnover = Turnover { injection: Injection::Cycle(cycle), ..TURNOVER };
        let refused = LivingTissue::new(simulation(LENGTHS, places(LENGTHS), 0.0), turnover);
        assert!(matches!(refused, Err(Error::Turnover { .. })), "{cycle:?}");
    }
}

/// A square of side 1 halves into two whose centroids are ½ apart; cut along the diagonal, √2/3.
#[test]
fn halves_of_a_square_are_where_they_are() {
    let mut polygon = CellPolygon::default();
    let ring = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    polygon.fill_ring(ring.iter().map(|[x, y]| Vector::new(*x, *y)));
    assert!((distance_of_halves(&polygon, Vector::new(1.0, 0.0)) - 0.5).abs() < 1e-12);
    let diagonal = Vector::new(1.0, 1.0) / 2f64.sqrt();
    assert!((distance_of_halves(&polygon, diagonal) - 2f64.sqrt() / 3.0).abs() < 1e-12);
}

/// Lengths have the mean and the variation that were asked for, and `2⟨exp(−Γ)⟩ = 1`; means of 40 000, five standard errors.
#[test]
fn lengths_of_cycles_are_gamma_distributed_and_keep_the_rate() {
    let count = 40_000;
    let error = |deviation: f64| 5.0 * deviation / f64::from(count).sqrt();
    for variation in [0.0, 0.3, 0.7, 1.0] {
        let (cycle, mut rng) = (CellCycle { variation, ..CellCycle::default() }, generator(5));
        let lengths: Vec<f64> = (0..count).map(|_| cycle.newborn(&mut rng).length).collect();
        let mean = |of: &dyn Fn(f64) -> f64| {
            lengths.iter().map(|length| of(*length)).sum::<f64>() / f64::from(count)
        };
        let expected = cycle.mean_length();
        assert!((mean(&|x| x) - expected).abs() < error(variation * expected) + 1e-12, "{variation}");
        let spread = (mean(&|x| x * x) - mean(&|x| x).powi(2)).max(0.0).sqrt() / expected;
        assert!((spread - variation).abs() < 0.03, "{spread} {variation}");
        assert!((2.0 * mean(&|x| (-x).exp()) - 1.0).abs() < error(variation) + 1e-12, "{variation}");
    }
}

/// Of a population that grows, the youngest are twice as many as those that divide, and their phases fall off as `exp(−φ)` while all are there:
/// of cycles
/// of one length the mean phase is `1 − ln 2`, and the mean size that of the model.
#[test]
fn ages_at_the_beginning_are_those_of_a_population_that_grows() {
    let cycle = CellCycle { variation: 0.0, ..CellCycle::default() };
    let (mut rng, count) = (generator(7), 40_000);
    let cells: Vec<Progress> = (0..count).map(|_| cycle.anywhere(&mut rng)).collect();
    let mean = |of: &dyn Fn(&Progress) -> f64| cells.iter().map(of).sum::<f64>() / f64::from(count);
    // ∫φ exp(−φ) / ∫exp(−φ) up to ln 2.
    assert!((mean(&|own| own.phase) - (1.0 - 2f64.ln())).abs() < 0.005);
    assert!((mean(&|own| cycle.size(*own)) - 1.0).abs() < 0.005);
    let young = mean(&|own| f64::from(u8::from(own.phase < 0.5 * own.length)));
    assert!((young - (2.0 - 2f64.sqrt())).abs() < 0.015, "{young}");
}
