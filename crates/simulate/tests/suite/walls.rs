//! Cells between torque-free walls.

use std::ops::ControlFlow;
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, Vector};
use voronudge_model::{CellFactors, CellParameter, Environment, Model, Parameters, jacobian_with_images};
use voronudge_simulate::moduli::{Motion, Relaxation, Settled};
use voronudge_simulate::{
    Driving, Error, RandomPlacement, Shear, Simulation, Walls, generator, honeycomb, measure,
};

fn parameters(preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { preferred_perimeter, chirality, ..Parameters::default() }
}

fn between(walls: Walls, positions: Vec<Vector<f64>>, lengths: [f64; 2], p: &Parameters<f64>) -> Simulation {
    let domain = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
    Simulation::new(positions, domain, Model::chiral_voronoi(p)).unwrap().with_walls(walls).unwrap()
}

fn random(cells: usize, seed: u64) -> (Vec<Vector<f64>>, [f64; 2]) {
    let lengths = [(cells as f64).sqrt(); 2];
    let placement = RandomPlacement::new(cells, PeriodicBox::new(lengths).unwrap());
    (placement.draw(&mut generator(seed)).unwrap(), lengths)
}

#[test]
fn the_cells_fill_the_box_between_the_walls() {
    for walls in [Walls::X, Walls::Both] {
        let (positions, lengths) = random(60, 1);
        let simulation = between(walls, positions, lengths, &parameters(3.5, 0.5));
        let all = simulation.positions_with_images();
        assert_eq!(all.len(), 60 * walls.images());
        let areas = voronudge_geometry::areas(simulation.tessellation(), all);
        assert!((areas[..60].iter().sum::<f64>() - 60.0).abs() < 1e-10);
    }
}

/// A mirror turns chirality round.
#[test]
fn mirrored_cells_of_opposite_chirality_flow_mirrored() {
    let (positions, lengths) = random(80, 2);
    for walls in [Walls::X, Walls::Both] {
        let mirrored = positions.iter().map(|r| Vector::new(r.x, lengths[1] - r.y)).collect();
        let mut one = between(walls, positions.clone(), lengths, &parameters(3.8, 0.7));
        let mut other = between(walls, mirrored, lengths, &parameters(3.8, -0.7));
        for _ in 0..20 {
            for (v, w) in one.velocities().iter().zip(other.velocities()) {
                assert!((v.x - w.x).abs() + (v.y + w.y).abs() < 1e-9, "{v} {w}");
            }
            let (edge, opposite) = (one.edge_velocity().unwrap(), other.edge_velocity().unwrap());
            assert!((edge + opposite).abs() < 1e-9);
            one.step(0.01).unwrap();
            other.step(0.01).unwrap();
        }
    }
}

/// Velocities reach two rings, so that cells with four spacings to the walls do not know of them.
#[test]
fn far_from_the_walls_the_box_is_periodic() {
    let (positions, lengths) = random(225, 3);
    let p = parameters(3.6, 1.0);
    let periodic = Simulation::new(
        positions.clone(),
        Domain::Periodic(PeriodicBox::new(lengths).unwrap()),
        Model::chiral_voronoi(&p),
    );
    let periodic = periodic.unwrap();
    let (channel, closed) =
        (between(Walls::X, positions.clone(), lengths, &p), between(Walls::Both, positions, lengths, &p));
    let mut far = 0;
    for (i, r) in periodic.positions().iter().enumerate() {
        let depth = |axis: usize| r[axis].min(lengths[axis] - r[axis]);
        let v = periodic.velocities()[i];
        if depth(0) > 4.5 {
            far += 1;
            assert!((channel.velocities()[i] - v).norm() < 1e-11);
        }
        if depth(0).min(depth(1)) > 4.5 {
            far += 1;
            assert!((closed.velocities()[i] - v).norm() < 1e-11);
        }
    }
    assert!(far > 60, "{far}");
}

/// Rows of a honeycomb along a channel: each moves as a whole. The chiral forces on the outermost rows are opposite at both
/// walls; without chirality nothing moves along them.
#[test]
fn a_honeycomb_along_a_channel_moves_in_rows() {
    let (positions, cell_box) = honeycomb(120).unwrap();
    // Rows along y, half a spacing of rows from the walls.
    let [width, height] = cell_box.lengths();
    let rows = positions.iter().map(|r| r.y).fold(f64::INFINITY, f64::min);
    let gap = 0.5 * positions.iter().map(|r| r.y).filter(|y| *y > rows + 1e-6).fold(f64::INFINITY, f64::min)
        - 0.5 * rows;
    let turned: Vec<_> = positions.iter().map(|r| Vector::new(r.y - rows + gap, width - r.x)).collect();
    for alpha in [0.0, 0.8, -0.8] {
        let simulation = between(Walls::X, turned.clone(), [height, width], &parameters(3.2, alpha));
        let edge = simulation.edge_velocity().unwrap();
        for (r, v) in simulation.positions().iter().zip(simulation.velocities()) {
            let depth = r.x.min(height - r.x);
            if depth < 1.5 * gap {
                let anticlockwise = if r.x < 0.5 * height { -v.y } else { v.y };
                assert!((anticlockwise - edge).abs() < 1e-12, "{alpha}: {v} {edge}");
            } else if depth > 6.0 * gap {
                assert!(v.norm() < 1e-12, "{alpha}: {v}");
            }
        }
        if alpha == 0.0 {
            assert!(edge.abs() < 1e-12);
        } else {
            // The prestress has σ_yx = −α K_P P_MF²/2, of which a wall at the right returns nothing.
            assert!(edge * alpha > 0.1, "{alpha}: {edge}");
        }
    }
}

/// Between walls, too, each cell has parameters of its own: without chirality velocities are the gradient of the energy of such cells, and the
/// Jacobian is the derivative of the velocities.
#[test]
fn cells_that_differ_move_between_walls_with_their_own_parameters() {
    const CELLS: usize = 50;
    let (positions, lengths) = random(CELLS, 5);
    let own = |parameter: CellParameter, cell: usize| {
        1.0 + 0.3 * (2.0 * cell as f64 + f64::from(parameter as u8)).sin()
    };
    let with = |chirality: f64, positions: Vec<Vector<f64>>| {
        let factors = CellParameter::ALL.into_iter().fold(CellFactors::default(), |factors, parameter| {
            factors.with(parameter, (0..CELLS).map(|cell| own(parameter, cell)).collect()).unwrap()
        });
        let environment = Arc::new(Environment::default().with_cell_factors(factors).unwrap());
        let model = Model::chiral_voronoi(&parameters(3.7, chirality)).within(&environment);
        let domain = Domain::Periodic(PeriodicBox::new(lengths).unwrap());
        Simulation::new(positions, domain, model).unwrap().with_walls(Walls::X).unwrap()
    };
    let energy = |tissue: &Simulation| -> f64 {
        let p = parameters(3.7, 0.0);
        let mut polygon = CellPolygon::default();
        let of_cell = |cell: usize| {
            polygon.fill(tissue.tessellation(), tissue.positions_with_images(), cell);
            let value = |parameter, mean: f64| mean * own(parameter, cell);
            let area = polygon.shape().area - value(CellParameter::PreferredArea, p.preferred_area);
            let perimeter =
                polygon.shape().perimeter - value(CellParameter::PreferredPerimeter, p.preferred_perimeter);
            let stiffness = value(CellParameter::AreaElasticity, p.area_elasticity);
            0.5 * (stiffness * area * area + p.perimeter_elasticity * perimeter * perimeter)
        };
        (0..CELLS).map(of_cell).sum()
    };
    let moved = |cell: usize, axis: usize, shift: f64| {
        let mut moved = positions.clone();
        moved[cell][axis] += shift;
        moved
    };
    let (passive, active) = (with(0.0, positions.clone()), with(0.8, positions.clone()));
    let jacobian = jacobian_with_images(
        active.tessellation(),
        active.positions_with_images(),
        active.model(),
        Walls::X.mirrors(),
        CELLS,
    );
    for (cell, axis) in [(3, 0), (17, 1), (31, 0), (48, 1)] {
        let sides = [1e-5, -1e-5].map(|shift| moved(cell, axis, shift));
        let [after, before] = sides.each_ref().map(|at| energy(&with(0.0, at.clone())));
        let slope = (after - before) / 2e-5;
        assert!((passive.velocities()[cell][axis] + slope).abs() < 1e-6, "{cell}: {slope}");
        let [after, before] = sides.map(|at| with(0.8, at).velocities().to_vec());
        for row in 0..CELLS {
            let own = jacobian.row(row).filter(|(column, _)| *column == cell);
            let by_axis: Vector<f64> = own.map(|(_, block)| Vector::new(block[axis], block[2 + axis])).sum();
            let slope = (after[row] - before[row]) / 2e-5;
            assert!(
                (slope - by_axis).norm() < 1e-5 * (1.0 + slope.norm()),
                "{row} {cell}: {slope} {by_axis}"
            );
        }
    }
}

/// The walls of a channel push across it and exert no force along themselves, whatever the chirality: that they are free of torque.
#[test]
fn walls_of_a_channel_take_up_no_momentum_along_them() {
    let (positions, lengths) = random(64, 4);
    let mut simulation = between(Walls::X, positions, lengths, &parameters(3.9, 1.2));
    let mut across = 0.0_f64;
    for _ in 0..100 {
        simulation.step(0.01).unwrap();
        let momentum: Vector<f64> = simulation.velocities().iter().sum();
        across = across.max(momentum.x.abs());
        assert!(momentum.y.abs() < 1e-9, "{momentum}");
    }
    assert!(across > 0.1, "{across}");
}

/// Without chirality the energy of the cells between the walls decreases at every step, and velocities are its gradient.
#[test]
fn without_chirality_the_energy_between_the_walls_decreases() {
    let (positions, lengths) = random(36, 4);
    let p = parameters(3.3, 0.0);
    let mut simulation = between(Walls::Both, positions.clone(), lengths, &p);
    // Each image has the energy of its cell.
    let energy = |simulation: &Simulation| {
        let all = simulation.positions_with_images();
        0.25 * measure::energy(simulation.tessellation(), all, simulation.model()).unwrap()
    };
    for (cell, axis) in [(0, 0), (7, 1), (20, 0), (35, 1)] {
        let at = |shift: f64| {
            let mut moved = positions.clone();
            moved[cell][axis] += shift;
            energy(&between(Walls::Both, moved, lengths, &p))
        };
        let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
        assert!((simulation.velocities()[cell][axis] + slope).abs() < 1e-6);
    }
    let mut before = energy(&simulation);
    for _ in 0..1000 {
        simulation.step(0.02).unwrap();
        let after = energy(&simulation);
        assert!(after <= before + 1e-12 * before.abs(), "{before} {after}");
        before = after;
    }
    assert!(voronudge_observables::mean_square_velocity(simulation.velocities()) < 1e-6);
}

/// A cell that starts behind a wall is its mirror image.
#[test]
fn cells_behind_a_wall_are_put_in_front_of_it() {
    let (mut positions, lengths) = random(36, 5);
    let p = parameters(3.8, 1.0);
    let mut one = between(Walls::Both, positions.clone(), lengths, &p);
    positions[7].x = -positions[7].x;
    positions[9].y = 2.0 * lengths[1] - positions[9].y;
    let mut other = between(Walls::Both, positions, lengths, &p);
    for _ in 0..50 {
        one.step(0.01).unwrap();
        other.step(0.01).unwrap();
    }
    for (r, s) in one.positions().iter().zip(other.positions()) {
        assert!((r - s).norm() < 1e-9 && r.x > 0.0 && r.x < lengths[0] && r.y > 0.0 && r.y < lengths[1]);
    }
}

#[test]
fn walls_and_shear_exclude_each_other() {
    let (positions, lengths) = random(25, 6);
    let simulation = between(Walls::X, positions, lengths, &parameters(3.8, 1.0));
    let driving = Driving { shear: Some(Shear::Steady { rate: 0.1 }), ..Driving::default() };
    assert!(matches!(simulation.with_driving(driving), Err(Error::Walls { .. })));
}

/// The Jacobian between walls is the derivative of the velocities: central differences of the simulator's, which tessellates anew, for
/// both kinds of walls and several seeds.
#[test]
fn the_jacobian_between_walls_is_the_derivative_of_the_velocities() {
    for (walls, seed) in [(Walls::X, 11), (Walls::X, 12), (Walls::Both, 13), (Walls::Both, 14)] {
        let (positions, lengths) = random(49, seed);
        let p = parameters(3.6, 0.9);
        // Cells that have settled a little are not about to change neighbours.
        let mut simulation = between(walls, positions, lengths, &p);
        for _ in 0..200 {
            simulation.step(0.01).unwrap();
        }
        let positions = simulation.positions().to_vec();
        let matrix = jacobian_with_images(
            simulation.tessellation(),
            simulation.positions_with_images(),
            simulation.model(),
            walls.mirrors(),
            49,
        )
        .to_dense();
        let scale = matrix.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let (h, mut largest) = (1e-6, 0.0_f64);
        for column in 0..98 {
            let at = |shift: f64| {
                let mut moved = positions.clone();
                moved[column / 2][column % 2] += shift;
                between(walls, moved, lengths, &p).velocities().to_vec()
            };
            for (cell, (ahead, behind)) in at(h).iter().zip(&at(-h)).enumerate() {
                let slope = (ahead - behind) / (2.0 * h);
                for axis in 0..2 {
                    let entry = matrix[(2 * cell + axis) * 98 + column];
                    largest = largest.max((slope[axis] - entry).abs());
                }
            }
        }
        assert!(largest < 1e-6 * scale, "{walls:?} {seed}: {largest} of {scale}");
    }
}

/// Rows of a honeycomb between walls come to rest with implicit steps, and stay a lattice along the walls.
#[test]
fn a_honeycomb_between_walls_comes_to_rest() {
    let (positions, cell_box) = honeycomb(120).unwrap();
    let [width, height] = cell_box.lengths();
    let gap = 0.25 * height / (positions.iter().filter(|r| r.x < 1e-9).count() as f64);
    let turned: Vec<_> = positions.iter().map(|r| Vector::new(r.y + gap, width - r.x)).collect();
    let simulation = between(Walls::X, turned, [height, width], &parameters(3.0, 0.05));
    let settled = Settled::new(&simulation, &Relaxation::default(), &|| ControlFlow::Continue(())).unwrap();
    assert_eq!(settled.motion(), Motion::AtRest);
    assert!(settled.speed() < 1e-10 && settled.simulation().time() < 50.0);
}
