//! Extrusion and proliferation: laws of rates, identities, conservation, what a birth disturbs.

use super::{TURNOVER, assert_the_living_are_told, assert_threads_do_not_matter};
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{
    ChannelSchedule, EdgeRate, Error, Injection, LivingTissue, Origin, Proliferation, RandomPlacement,
    Simulation, Turnover, generator, run_channel,
};

fn simulation(lengths: [f64; 2], preferred_perimeter: f64, chirality: f64) -> Simulation {
    let cell_box = PeriodicBox::new(lengths).unwrap();
    let cells = cell_box.area().round() as usize;
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(1)).unwrap();
    let parameters =
        Parameters { area_elasticity: 0.0, preferred_perimeter, chirality, ..Parameters::default() };
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters)).unwrap()
}

fn tissue(turnover: Turnover) -> LivingTissue {
    LivingTissue::new(simulation([8.0, 6.0], 4.0, 1.0), turnover).unwrap()
}

fn schedule(time: f64) -> ChannelSchedule {
    ChannelSchedule { relaxation: 0.0, time, time_step: 0.01, samples: 16, bins: 16 }
}

/// The number of cells stays, each life is told once, and the living are those without an end.
#[test]
fn cells_keep_their_identity_from_birth_to_death() {
    let mut tissue = tissue(TURNOVER);
    let mut followed = Vec::new();
    for _ in 0..1000 {
        let before = tissue.identities().to_vec();
        tissue.step(0.01).unwrap();
        assert_eq!(tissue.simulation().positions().len(), 48);
        let step = tissue.last_step();
        assert_eq!(step.births.len(), step.extrusions.len());
        followed.push(before.iter().zip(tissue.identities()).filter(|(a, b)| a != b).count());
    }
    let lives = tissue.lives();
    let dead = lives.iter().filter(|life| life.extruded.is_some()).count();
    assert!(dead > 50 && lives.len() == 48 + dead);
    assert_eq!(followed.iter().sum::<usize>(), dead);
    assert_the_living_are_told(&tissue);
    assert!(lives[48..].iter().all(|life| life.origin == Origin::Vertex && life.born > 0.0));
    assert!(lives.iter().all(|life| life.extruded.is_none_or(|end| end > life.born)));
    assert!(lives[..48].windows(2).all(|pair| pair[0].born == pair[1].born));
}

/// With an infinite decay length extrusion is a Poisson process of rate k per cell: 48 · 2 · 20 = 1920 ± 44 events; four deviations.
#[test]
fn events_happen_at_their_rate() {
    let everywhere = EdgeRate { rate: 2.0, decay_length: f64::INFINITY };
    let uniform = Turnover {
        extrusion: everywhere,
        proliferation: Proliferation::Replacing { decay_length: f64::INFINITY },
        ..TURNOVER
    };
    let mut tissue = LivingTissue::new(simulation([8.0, 6.0], 3.0, 0.0), uniform).unwrap();
    for _ in 0..2000 {
        tissue.step(0.01).unwrap();
    }
    let events = tissue.lives().len() as f64 - 48.0;
    assert!((events - 1920.0).abs() < 176.0, "{events}");
}

/// Extrusions follow the rate of the place where a cell is, also right after one was replaced by another: as many as the sum of the
/// probabilities over cells and steps, in the half of the channel near the edges and in the other. About 1000 and 100 events; four
/// deviations of counts.
#[test]
fn extrusions_follow_the_rate_of_their_place() {
    let mut tissue = tissue(TURNOVER);
    let (mut counted, mut expected) = ([0.0; 2], [0.0; 2]);
    let channel = tissue.channel();
    for _ in 0..4000 {
        tissue.step(0.01).unwrap();
        let step = tissue.last_step();
        let half = |place: &Vector<f64>| usize::from(channel.edge_distance(*place) > 2.0);
        for place in &step.to {
            let rate = TURNOVER.extrusion.at(channel.edge_distance(*place));
            expected[half(place)] += 1.0 - (-rate * 0.01).exp();
        }
        step.extrusions.iter().for_each(|place| counted[half(place)] += 1.0);
    }
    for half in [0, 1] {
        let off: f64 = counted[half] - expected[half];
        assert!(off.abs() < 4.0 * f64::sqrt(expected[half]), "{counted:?} {expected:?}");
    }
}

/// Births on vertices, weighted by exp(−d_b/d), lie near the edges: a mean distance of d if vertices are uniform, as against 2 for no
/// weight. Denser edges and vertices as places leave room for 50 %.
#[test]
fn births_are_near_the_edges() {
    let mut tissue = tissue(TURNOVER);
    let mut distances = Vec::new();
    for _ in 0..2000 {
        tissue.step(0.01).unwrap();
        let channel = tissue.channel();
        distances.extend(tissue.last_step().births.iter().map(|&place| channel.edge_distance(place)));
    }
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    assert!((0.12..0.375).contains(&mean), "{mean} of {}", distances.len());
}

/// Cells are conserved whatever they do: in every bin what flows in, is born and dies makes up what is there more at the end. So
/// the rate of change that the books show, summed over all faces, is that of the number of cells; here it is constant.
#[test]
fn the_books_balance() {
    let mut tissue = tissue(TURNOVER);
    let run = run_channel(&mut tissue, &schedule(8.0), |_, _, _| ControlFlow::Continue(())).unwrap();
    let profile = run.recorder.profile();
    let spacing = 0.5;
    let total: f64 = profile.density.iter().map(|density| density.value * spacing * 6.0).sum();
    assert!((total - 48.0).abs() < 1e-9);
    // Imbalance is −dN/dt per cell: over the run at most a few cells come or go between strips of three cells.
    for (face, imbalance) in profile.imbalance.iter().enumerate() {
        assert!((imbalance.value * 8.0).abs() < 1.5, "{face}: {imbalance:?}");
        let difference = profile.flux_rate[face].value - profile.net_rate[face].value;
        assert!((difference - imbalance.value).abs() < 1e-9);
    }
    // In the steady state friction balances the shear stress; the difference is the drift of single cells in a short run.
    let middle = profile.faces.len() / 2;
    assert_eq!((profile.transport[middle].value, profile.shear_stress[middle].value), (0.0, 0.0));
    let moved: f64 =
        (0..middle).map(|bin| profile.density[bin].value * profile.velocity[1][bin].value * spacing).sum();
    assert!((profile.transport[0].value - moved).abs() < 1e-9);
    let [[_, xy], [yx, _]] = &profile.stress;
    let tau = |bin: usize| xy[bin].value - yx[bin].value;
    let at = |face: usize| 0.5 * (tau(face) + tau(face - 1));
    assert!((profile.torque[1].value - 0.5 * (at(1) - at(middle))).abs() < 1e-9);
    // No net momentum: the flux through the whole channel vanishes in both directions.
    for axis in [0, 1] {
        let flux: f64 =
            profile.density.iter().zip(&profile.velocity[axis]).map(|(rho, v)| rho.value * v.value).sum();
        assert!(flux.abs() < 1e-9, "{flux}");
    }
}

#[test]
fn the_same_seed_gives_the_same_lives_on_any_number_of_threads() {
    assert_threads_do_not_matter(3, tissue);
}

/// With independent rates the number of cells changes, mothers are alive at a birth, and both ends are told.
#[test]
fn independent_rates_let_the_number_of_cells_change() {
    let growing = Turnover {
        extrusion: EdgeRate { rate: 0.2, decay_length: 2.0 },
        proliferation: Proliferation::Independent(EdgeRate { rate: 0.6, decay_length: 1.0 }),
        most_cells: 100,
        ..TURNOVER
    };
    for injection in [Injection::Vertex, Injection::Division { distance: 0.2 }] {
        let mut tissue = tissue(Turnover { injection, ..growing });
        let run = run_channel(&mut tissue, &schedule(40.0), |_, _, _| ControlFlow::Continue(())).unwrap();
        assert!(
            matches!(run.ended, Some(Error::TooManyCells { cells: 101.., limit: 100, .. })),
            "{:?}",
            run.ended
        );
        assert!(run.recorder.samples() > 0 && run.cells[1] <= 100);
        let lives = tissue.lives();
        for life in &lives[48..] {
            let mother = lives[life.mother.unwrap()];
            assert!(mother.born < life.born && mother.extruded.is_none_or(|end| end >= life.born));
        }
    }
    let dying = Turnover {
        extrusion: EdgeRate { rate: 3.0, decay_length: f64::INFINITY },
        proliferation: Proliferation::Independent(EdgeRate { rate: 0.0, decay_length: 1.0 }),
        ..TURNOVER
    };
    let run = run_channel(&mut tissue(dying), &schedule(40.0), |_, _, _| ControlFlow::Continue(())).unwrap();
    assert!(matches!(run.ended, Some(Error::Extinct { .. })), "{:?}", run.ended);
}

/// A new cell on a vertex disturbs its surroundings less than one beside its mother (Extended Data Fig. m5C, D): at least three times
/// in the mean of the largest change of velocity.
#[test]
fn a_birth_on_a_vertex_disturbs_less_than_a_division() {
    for (preferred_perimeter, chirality) in [(4.0, 1.0), (4.0, 2.9), (3.0, 1.0)] {
        let mut tissue =
            LivingTissue::new(simulation([8.0, 6.0], preferred_perimeter, chirality), TURNOVER).unwrap();
        for _ in 0..300 {
            tissue.step(0.01 / chirality).unwrap();
        }
        let mean = |injection| {
            let all = tissue.birth_disturbance(injection, 100, 7).unwrap();
            all.iter().sum::<f64>() / 100.0
        };
        let [vertex, division] = [Injection::Vertex, Injection::Division { distance: 0.2 }].map(mean);
        assert!(
            division > 3.0 * vertex,
            "P_0 = {preferred_perimeter}, α = {chirality}: {division} and {vertex}"
        );
    }
}

#[test]
fn unusable_turnover_is_refused() {
    let refused =
        |turnover: Turnover| LivingTissue::new(simulation([4.0, 4.0], 3.8, 0.0), turnover).unwrap_err();
    let negative = Turnover { extrusion: EdgeRate { rate: -1.0, decay_length: 1.0 }, ..TURNOVER };
    assert!(matches!(refused(negative), Error::Turnover { name: "rate of extrusion", value: -1.0, .. }));
    let flat = Turnover { proliferation: Proliferation::Replacing { decay_length: 0.0 }, ..TURNOVER };
    assert!(matches!(refused(flat), Error::Turnover { name: "decay length of proliferation", .. }));
    let on_top = Turnover { injection: Injection::Division { distance: 0.0 }, ..TURNOVER };
    assert!(matches!(refused(on_top), Error::Turnover { .. }));
    assert!(matches!(refused(Turnover { most_cells: 3, ..TURNOVER }), Error::TooManyCells { cells: 16, .. }));
    let sheared = PeriodicBox::sheared([4.0, 4.0], 1.0).unwrap();
    assert!(voronudge_simulate::Channel::new(&sheared).is_err());
    let mut other = simulation([4.0, 4.0], 3.8, 0.0);
    let kept = other.state().clone();
    assert!(other.replace_cells(Vec::new(), Vec::new()).is_err());
    assert!(other.replace_cells(vec![Vector::new(0.0, 0.0); 2], Vec::new()).is_err());
    assert_eq!(*other.state(), kept);
    assert!(matches!(
        run_channel(&mut tissue(TURNOVER), &ChannelSchedule { bins: 7, ..schedule(1.0) }, |_, _, _| {
            ControlFlow::Continue(())
        }),
        Err(Error::Bins { bins: 7 })
    ));
}
