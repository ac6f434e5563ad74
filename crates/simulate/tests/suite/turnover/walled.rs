//! Extrusion and proliferation between torque-free walls.

use super::{CYCLE, TURNOVER, assert_the_living_are_told, assert_threads_do_not_matter};
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Vector, areas};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::measure::{ChannelProfile, ChannelRecorder, Estimate};
use voronudge_simulate::{
    ChannelSchedule, EdgeRate, Error, Injection, LivingTissue, Proliferation, RandomPlacement, Simulation,
    Turnover, Walls, generator, run_channel,
};

const WIDTH: f64 = 8.0;
const LENGTH: f64 = 6.0;
const CELLS: usize = 48;

const DIVISION: Turnover = Turnover { injection: Injection::Division { distance: 0.3 }, ..TURNOVER };

/// Births from mothers, about as many as extrusions.
const MOTHERS: Turnover = Turnover {
    extrusion: EdgeRate { rate: 0.5, decay_length: 2.0 },
    proliferation: Proliferation::Independent(EdgeRate { rate: 0.5, decay_length: 2.0 }),
    ..TURNOVER
};

fn simulation(positions: Vec<Vector<f64>>, walls: Walls) -> Simulation {
    let cell_box = PeriodicBox::new([WIDTH, LENGTH]).unwrap();
    let parameters = Parameters {
        area_elasticity: 0.0,
        preferred_perimeter: 3.8,
        chirality: 1.0,
        ..Parameters::default()
    };
    let model = Model::chiral_voronoi(&parameters);
    Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap().with_walls(walls).unwrap()
}

fn random() -> Vec<Vector<f64>> {
    let cell_box = PeriodicBox::new([WIDTH, LENGTH]).unwrap();
    RandomPlacement::new(CELLS, cell_box).draw(&mut generator(1)).unwrap()
}

fn tissue(turnover: Turnover) -> LivingTissue {
    LivingTissue::new(simulation(random(), Walls::X), turnover).unwrap()
}

fn is_between(place: &Vector<f64>) -> bool {
    0.0 < place.x && place.x < WIDTH
}

/// The number of cells stays, every cell keeps its life until it is extruded, and all are between the walls, which they fill. In each half
/// as many are born as extruded. After that the simulation is the one that begins with the cells as they are.
#[test]
fn cells_stay_between_the_walls_and_keep_their_identity() {
    for turnover in [TURNOVER, DIVISION] {
        let mut tissue = tissue(turnover);
        let mut exchanged = 0;
        for step in 0..600 {
            let before = tissue.identities().to_vec();
            tissue.step(0.01).unwrap();
            exchanged += before.iter().zip(tissue.identities()).filter(|(a, b)| a != b).count();
            let simulation = tissue.simulation();
            assert_eq!((simulation.positions().len(), simulation.positions_with_images().len()), (48, 96));
            let last = tissue.last_step();
            let on_the_right = |places: &[Vector<f64>]| places.iter().filter(|r| r.x > 0.5 * WIDTH).count();
            assert_eq!(last.births.len(), last.extrusions.len());
            if turnover == TURNOVER {
                assert_eq!(on_the_right(&last.births), on_the_right(&last.extrusions));
            }
            assert!(last.births.iter().chain(&last.extrusions).all(is_between));
            assert!(last.from.iter().chain(&last.to).chain(simulation.positions()).all(is_between));
            if step % 20 == 0 || !last.births.is_empty() {
                let all = areas(simulation.tessellation(), simulation.positions_with_images());
                assert!((all[..CELLS].iter().sum::<f64>() - WIDTH * LENGTH).abs() < 1e-9);
                let anew = self::simulation(simulation.positions().to_vec(), Walls::X);
                for (v, expected) in simulation.velocities().iter().zip(anew.velocities()) {
                    assert!((v - expected).norm() < 1e-9, "{v} {expected}");
                }
            }
        }
        let lives = tissue.lives();
        let dead = lives.iter().filter(|life| life.extruded.is_some()).count();
        assert!(dead > 30 && lives.len() == CELLS + dead && exchanged == dead, "{dead} {exchanged}");
        assert_the_living_are_told(&tissue);
    }
}

/// A place of birth on a vertex is equally far from three cells, and no cell is nearer; mirror images do not count, and are not nearer.
#[test]
fn births_are_on_vertices_of_cells_in_front_of_the_walls() {
    for turnover in [TURNOVER, MOTHERS] {
        let mut tissue = tissue(turnover);
        let mut births = 0;
        for _ in 0..600 {
            tissue.step(0.01).unwrap();
            let last = tissue.last_step();
            for place in &last.births {
                let distance = |r: &Vector<f64>| {
                    let along = r.y - place.y;
                    (r.x - place.x).hypot(along - LENGTH * (along / LENGTH).round())
                };
                let mut distances: Vec<f64> = last.to.iter().map(distance).collect();
                distances.sort_by(f64::total_cmp);
                assert!(distances[2] - distances[0] < 1e-9 && distances[0] > 0.1, "{:?}", &distances[..4]);
                let edge = place.x.min(WIDTH - place.x);
                assert!(edge > 1e-6, "{edge}");
                births += 1;
            }
        }
        assert!(births > 30, "{births}");
    }
}

/// A daughter is as far from her mother as asked, even if a random direction would mostly lead behind a wall.
#[test]
fn daughters_are_in_front_of_the_walls() {
    let everywhere = EdgeRate { rate: 0.3, decay_length: f64::INFINITY };
    let far = Turnover {
        extrusion: everywhere,
        proliferation: Proliferation::Independent(everywhere),
        injection: Injection::Division { distance: 7.5 },
        ..TURNOVER
    };
    let (mut tissue, mut directions) = (tissue(far), [0; 2]);
    for _ in 0..300 {
        let known = tissue.lives().len();
        let identities = tissue.identities().to_vec();
        tissue.step(0.01).unwrap();
        let (last, lives) = (tissue.last_step(), &tissue.lives()[known..]);
        assert_eq!(last.births.len(), lives.len());
        for (place, life) in last.births.iter().zip(lives) {
            let mother = identities.iter().position(|&id| Some(id) == life.mother).unwrap();
            let away = place - last.to[mother];
            assert!(is_between(place) && (away.norm() - 7.5).abs() < 1e-9, "{place}");
            directions[usize::from(away.y > 0.0)] += 1;
        }
    }
    // Up and down alike, to four deviations.
    let [down, up] = directions.map(f64::from);
    assert!(down + up > 20.0 && (up - down).abs() < 4.0 * (down + up).sqrt(), "{directions:?}");
}

/// What flows to a face, plus births, minus extrusions, is what is there more at the end, to rounding: at the walls too, where cells
/// and their mirror images count.
#[test]
fn the_books_balance_up_to_the_walls() {
    let bins = 16;
    let cycles = Turnover { injection: Injection::Cycle(CYCLE), ..TURNOVER };
    for turnover in [TURNOVER, DIVISION, MOTHERS, cycles] {
        let mut tissue = tissue(turnover);
        let mut recorder = ChannelRecorder::new(tissue.channel(), bins).unwrap();
        let width = WIDTH / bins as f64;
        // Number of cells at each face, by their distance from it.
        let at_faces = |tissue: &LivingTissue| -> Vec<f64> {
            let near = |face: usize, x: f64| (1.0 - (x / width - face as f64).abs()).max(0.0);
            let twice = |face: usize| if face == 0 || face == bins { 2.0 } else { 1.0 };
            let places = tissue.simulation().positions();
            (0..=bins).map(|face| places.iter().map(|r| twice(face) * near(face, r.x)).sum()).collect()
        };
        let before = at_faces(&tissue);
        for _ in 0..400 {
            tissue.step(0.01).unwrap();
            recorder.add(tissue.last_step());
        }
        recorder.end_sample();
        let (after, profile) = (at_faces(&tissue), recorder.profile());
        assert_eq!((profile.faces.len(), profile.faces[bins]), (bins + 1, WIDTH));
        let there = |bin: usize| profile.density[bin].value * width * LENGTH * 4.0;
        for face in 0..=bins {
            let around = 0.5 * (there(face.saturating_sub(1)) + there(face.min(bins - 1)));
            let lost = profile.imbalance[face].value * around;
            assert!((lost - (before[face] - after[face])).abs() < 1e-8, "{face}: {lost}");
        }
        // The tissue exerts no force along the walls.
        let [_, v_y] = &profile.velocity;
        let flux: f64 = (0..bins).map(|bin| there(bin) * v_y[bin].value).sum();
        assert!(flux.abs() < 1e-8, "{flux}");
    }
}

#[test]
fn the_same_seed_gives_the_same_lives_on_any_number_of_threads() {
    assert_threads_do_not_matter(2, tissue);
}

fn folded(turnover: Turnover, time: f64) -> ChannelProfile {
    let schedule = ChannelSchedule { relaxation: 4.0, time, time_step: 0.01, samples: 16, bins: 16 };
    let run = run_channel(&mut tissue(turnover), &schedule, |_, _, _| ControlFlow::Continue(())).unwrap();
    assert_eq!((run.ended, run.cells), (None, [CELLS, CELLS]));
    // Neither wall draws the births of the other.
    let density = run.recorder.profile().density;
    let half = |bins: &[Estimate]| bins.iter().map(|at| at.value).sum::<f64>();
    assert!((half(&density[..8]) / half(&density[8..]) - 1.0).abs() < 0.2, "{density:?}");
    run.recorder.folded_profile()
}

/// Cells converge on the middle, and as many flow there as are born nearer to the wall and not extruded; along the walls, which are free of
/// torque, an edge current of a chiral tissue runs anticlockwise.
#[test]
fn cells_converge_on_the_middle_and_flow_along_the_walls() {
    let profile = folded(TURNOVER, 60.0);
    let mean = |values: &[Estimate]| values.iter().map(|at| at.value).sum::<f64>() / values.len() as f64;
    let [v_x, v_y] = &profile.velocity;
    assert!(mean(&v_x[1..7]) > 0.1, "{v_x:?}");
    assert!(v_x[0].value.abs() < mean(&v_x[2..5]), "{v_x:?}");
    let total = |rates: &[Estimate]| -> f64 {
        rates.iter().zip(&profile.density).map(|(rate, density)| rate.value * density.value).sum()
    };
    let [births, deaths] = [&profile.birth_rate, &profile.death_rate].map(|rates| total(rates));
    assert!(births > 0.3 && (births - deaths).abs() < 1e-9, "{births} {deaths}");
    // The left wall: anticlockwise is downwards.
    assert!(v_y[0].value < -1.0, "{v_y:?}");
    for at in &profile.imbalance {
        assert!(at.value.abs() < 5.0 * at.error.unwrap() + 0.02, "{at:?}");
    }
}

#[test]
fn a_birth_disturbs_cells_between_walls_and_changes_nothing() {
    let tissue = tissue(TURNOVER);
    let before = (tissue.simulation().positions().to_vec(), tissue.simulation().velocities().to_vec());
    let mean = |injection| {
        let all = tissue.birth_disturbance(injection, 60, 7).unwrap();
        assert!(all.iter().all(|change| change.is_finite() && *change > 0.0));
        all.iter().sum::<f64>() / 60.0
    };
    let [vertex, division] = [Injection::Vertex, Injection::Division { distance: 0.2 }].map(mean);
    assert!(division > 2.0 * vertex, "{division} {vertex}");
    let after = (tissue.simulation().positions().to_vec(), tissue.simulation().velocities().to_vec());
    assert_eq!(before, after);
}

#[test]
fn unusable_places_and_closed_channels_are_refused() {
    let closed = simulation(random(), Walls::Both);
    assert!(matches!(LivingTissue::new(closed, TURNOVER), Err(Error::ClosedChannel)));
    let mut tissue = simulation(random(), Walls::X);
    let kept = (tissue.state().clone(), tissue.velocities().to_vec());
    let mut on_the_wall = random();
    on_the_wall[5].x = WIDTH;
    assert!(matches!(tissue.replace_cells(on_the_wall, Vec::new()), Err(Error::Tessellation { .. })));
    assert!(tissue.replace_cells(Vec::new(), Vec::new()).is_err());
    assert_eq!((tissue.state().clone(), tissue.velocities().to_vec()), kept);
    tissue.step(0.01).unwrap();
    // Behind a wall a cell is its mirror image.
    let mut behind = random();
    behind[5].x = -behind[5].x;
    tissue.replace_cells(behind, Vec::new()).unwrap();
    assert_eq!(tissue.positions(), random());
    assert_eq!(tissue.velocities(), simulation(random(), Walls::X).velocities());
}
