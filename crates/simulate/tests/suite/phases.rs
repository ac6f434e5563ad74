//! Solid and liquid: the mean square velocity on either side of the transition.

use std::ops::ControlFlow;
use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_observables::mean_square_velocity;
use voronudge_simulate::{
    Completion, Error, Event, RandomPlacement, Schedule, Simulation, Summary, generator, run,
};

fn tissue(preferred_perimeter: f64, chirality: f64) -> Simulation {
    let parameters = Parameters { preferred_perimeter, chirality, ..Parameters::default() };
    let cell_box = PeriodicBox::new([10.0, 10.0]).unwrap();
    let positions = RandomPlacement::new(100, cell_box).draw(&mut generator(1)).unwrap();
    Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(&parameters)).unwrap()
}

fn run_to(simulation: &mut Simulation, time: f64) -> Summary {
    let schedule = Schedule { time, time_step: 0.02, frames: 1 };
    run(simulation, &schedule, |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn a_chiral_liquid_keeps_moving() {
    let summary = run_to(&mut tissue(4.0, 1.0), 60.0);
    assert_eq!(summary.completion, Completion::Finished);
    assert_eq!(summary.steps, 3000);
    // An independent implementation finds 7.5 ± 0.2 over 150 time units at this very time step (smaller ones give
    // about 8); 30 time units scatter more.
    let mean = summary.mean_square_velocity.unwrap();
    assert!((mean - 7.5).abs() < 0.08 * 7.5, "{mean}");
}

#[test]
fn a_solid_comes_to_rest() {
    let mut simulation = tissue(3.0, 1.0);
    run_to(&mut simulation, 100.0);
    let rest = mean_square_velocity(simulation.velocities());
    assert!(rest < 1e-12, "{rest}");
}

#[test]
fn frames_are_evenly_spaced_and_steps_no_larger_than_asked() {
    let mut simulation = tissue(3.5, 0.2);
    let mut times = Vec::new();
    let schedule = Schedule { time: 0.3, time_step: 0.03, frames: 3 };
    let summary = run(&mut simulation, &schedule, |event| {
        if let Event::Frame(frame) = event {
            assert_eq!(frame.index, times.len());
            times.push(frame.simulation.time());
        }
        ControlFlow::Continue(())
    });
    assert_eq!(summary.unwrap().steps, 12);
    for (time, expected) in times.iter().zip([0.1, 0.2, 0.3]) {
        assert!((time - expected).abs() < 1e-14);
    }
}

#[test]
fn a_run_can_be_stopped_between_frames() {
    let mut simulation = tissue(3.5, 0.2);
    let schedule = Schedule { time: 10.0, time_step: 0.02, frames: 1 };
    let summary = run(&mut simulation, &schedule, |event| match event {
        Event::Step { done: 7, total: 500, .. } => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    })
    .unwrap();
    assert_eq!((summary.steps, summary.completion), (7, Completion::Stopped));
}

#[test]
fn impossible_schedules_are_refused() {
    let mut simulation = tissue(3.5, 0.2);
    let sound = Schedule { time: 1.0, time_step: 0.02, frames: 1 };
    let mut refusal = |schedule| run(&mut simulation, &schedule, |_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(refusal(Schedule { frames: 0, ..sound }), Error::NoFrames);
    assert_eq!(refusal(Schedule { time: -1.0, ..sound }), Error::Duration { time: -1.0 });
    assert_eq!(refusal(Schedule { time_step: 0.0, ..sound }), Error::TimeStep { time_step: 0.0 });
}
