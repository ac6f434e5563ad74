//! What is timed.

use rand::Rng;
use std::collections::BTreeSet;
use std::error::Error;
use std::hint::black_box;
use std::time::{Duration, Instant};
use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Tessellation, Vector};
use voronudge_model::{BlockMatrix, JacobianBuilder, Model, Parameters, VelocityAssembly, jvp, vjp};
use voronudge_simulate::{RandomPlacement, Simulation, generator, sort_in_space};
use voronudge_spectrum::{Arrangement, Honeycomb, LinearProblem, Request, Selection, modes};

/// Something that is done to all cells of a tissue.
pub struct Kernel {
    pub name: &'static str,
    pub meaning: &'static str,
    /// Most cells for which it is timed.
    pub most: usize,
    /// How often it is done to each cell at a time.
    pub evaluations: usize,
    /// Makes a tissue of a number of cells, and a function that does it.
    pub prepare: fn(usize) -> Result<Repeat, Box<dyn Error>>,
}

/// Does it.
pub type Repeat = Box<dyn FnMut() -> Result<(), Box<dyn Error>>>;

const PARAMETERS: Parameters<f64> = Parameters {
    area_elasticity: 0.1,
    perimeter_elasticity: 1.0,
    preferred_perimeter: 4.0,
    preferred_area: 1.0,
    chirality: 1.0,
};

pub const KERNELS: [Kernel; 9] = [
    Kernel {
        name: "tessellation",
        meaning: "Voronoi tessellation anew, in the same memory",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, mut tessellation, .. } = Tissue::new(cells)?;
            Ok(Box::new(move || Ok(tessellation.renew(black_box(&positions))?)))
        },
    },
    Kernel {
        name: "proof",
        meaning: "proof that a tessellation is still that of the cells",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, domain, .. } = Tissue::new(cells)?;
            let mut moving = MovingTessellation::new(&positions, domain)?;
            Ok(Box::new(move || {
                moving.renew(black_box(&positions))?;
                Ok(())
            }))
        },
    },
    Kernel {
        name: "forces",
        meaning: "velocities, given the tessellation",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, tessellation, model, .. } = Tissue::new(cells)?;
            let (mut assembly, mut v) = (VelocityAssembly::default(), Vec::new());
            Ok(Box::new(move || {
                assembly.evaluate(&tessellation, black_box(&positions), &model, &mut v);
                Ok(())
            }))
        },
    },
    Kernel {
        name: "liquid",
        meaning: "velocities with the upkeep of the tessellation: a quarter of a Runge–Kutta step of .01 in a liquid",
        most: 1_000_000,
        evaluations: 4,
        prepare: |cells| {
            let mut liquid = liquid(cells)?;
            Ok(Box::new(move || Ok(liquid.step(black_box(0.01))?)))
        },
    },
    Kernel {
        name: "jvp",
        meaning: "Jacobian times a vector, without the matrix",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, tessellation, model, .. } = Tissue::new(cells)?;
            Ok(Box::new(move || {
                black_box(jvp(&tessellation, black_box(&positions), &model, &positions));
                Ok(())
            }))
        },
    },
    Kernel {
        name: "vjp",
        meaning: "transposed Jacobian times a vector, without the matrix",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, tessellation, model, .. } = Tissue::new(cells)?;
            Ok(Box::new(move || {
                black_box(vjp(&tessellation, black_box(&positions), &model, &positions));
                Ok(())
            }))
        },
    },
    Kernel {
        name: "jacobian",
        meaning: "sparse Jacobian, given the tessellation",
        most: 1_000_000,
        evaluations: 1,
        prepare: |cells| {
            let Tissue { positions, tessellation, model, .. } = Tissue::new(cells)?;
            let (mut builder, mut matrix) = (JacobianBuilder::default(), BlockMatrix::default());
            Ok(Box::new(move || {
                builder.build(&tessellation, black_box(&positions), &model, &mut matrix);
                Ok(())
            }))
        },
    },
    Kernel {
        name: "all-modes",
        meaning: "all modes of a solid, dense",
        most: 1000,
        evaluations: 1,
        prepare: |cells| {
            let (problem, request) = (linear_problem(cells)?, Request::new(Selection::All));
            Ok(Box::new(move || {
                black_box(modes(&problem, &request, &mut |_, _, _| {})?);
                Ok(())
            }))
        },
    },
    Kernel {
        name: "few-modes",
        meaning: "the eight modes that grow fastest, in a solid, from the sparse Jacobian",
        most: 100_000,
        evaluations: 1,
        prepare: |cells| {
            let (problem, request) = (linear_problem(cells)?, Request::new(Selection::Largest(8)));
            Ok(Box::new(move || {
                black_box(modes(&problem, &request, &mut |_, _, _| {})?);
                Ok(())
            }))
        },
    },
];

/// Cells scattered about a square lattice at unit density, numbered along a space-filling curve.
struct Tissue {
    positions: Vec<Vector<f64>>,
    domain: Domain,
    tessellation: Tessellation,
    model: Model<f64>,
}

impl Tissue {
    fn new(cells: usize) -> Result<Self, Box<dyn Error>> {
        let side = (cells as f64).sqrt();
        let cell_box = PeriodicBox::new([side; 2])?;
        let mut positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(7))?;
        sort_in_space(&mut positions, &cell_box);
        let domain = Domain::Periodic(cell_box);
        let tessellation = Tessellation::new(&positions, domain)?;
        Ok(Self { positions, domain, tessellation, model: Model::chiral_voronoi(&PARAMETERS) })
    }
}

fn liquid(cells: usize) -> Result<Simulation, Box<dyn Error>> {
    let Tissue { positions, domain, model, .. } = Tissue::new(cells)?;
    let mut simulation = Simulation::new(positions, domain, model)?;
    for _ in 0..if cells < 300_000 { 400 } else { 40 } {
        simulation.step(0.01)?;
    }
    Ok(simulation)
}

/// A honeycomb with every cell moved at random, in the solid.
fn linear_problem(cells: usize) -> Result<LinearProblem, Box<dyn Error>> {
    let side = 2 * ((cells as f64).sqrt() / 2.0).round() as usize;
    let lattice = Honeycomb::new(side, side, Arrangement::RowsAlongX)?;
    let mut rng = generator(5);
    let mut moved =
        |r: &Vector<f64>| r + Vector::new(rng.random_range(-0.1..0.1), rng.random_range(-0.1..0.1));
    let positions: Vec<_> = lattice.positions().iter().map(&mut moved).collect();
    let domain = Domain::Periodic(PeriodicBox::new(lattice.lengths())?);
    let tessellation = Tessellation::new(&positions, domain)?;
    let parameters = Parameters { preferred_perimeter: 3.2, chirality: 0.3, ..PARAMETERS };
    Ok(LinearProblem::new(&tessellation, &positions, &Model::chiral_voronoi(&parameters), |_| true)?)
}

/// Repeats something until it has been seen often enough, and gives the least and the median time.
pub fn times(mut once: impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<[Duration; 2], Box<dyn Error>> {
    const ENOUGH: Duration = Duration::from_millis(1500);
    once()?;
    let (begun, mut times) = (Instant::now(), Vec::new());
    while times.len() < 5 || (begun.elapsed() < ENOUGH && times.len() < 1000) {
        let start = Instant::now();
        once()?;
        times.push(start.elapsed());
        if times.len() >= 3 && begun.elapsed() > 8 * ENOUGH {
            break;
        }
    }
    times.sort_unstable();
    Ok([times[0], times[times.len() / 2]])
}

/// A measure of the processor: divisions and roots of numbers in the first cache, one after another independent of each other (ns each).
pub fn reference() -> Result<f64, Box<dyn Error>> {
    let mut numbers: Vec<f64> = (0..1024).map(|i| 1.0 + f64::from(i)).collect();
    let [least, _] = times(|| {
        for _ in 0..100 {
            for x in black_box(&mut numbers) {
                *x = (1.0 + 1.0 / *x).sqrt();
            }
        }
        Ok(())
    })?;
    Ok(least.as_secs_f64() * 1e9 / 102_400.0)
}

/// A measure of what cannot be foreseen: numbers in disorder put into a tree in order (ns each), with branches and places in memory that differ for each. Busy hours of a shared
/// machine slow this, and tessellations, by factors by which divisions are not slowed.
pub fn branching_reference() -> Result<f64, Box<dyn Error>> {
    const NUMBERS: u64 = 1 << 16;
    let [least, _] = times(|| {
        let mut tree = BTreeSet::new();
        let mut number = 1u64;
        for _ in 0..NUMBERS {
            // Knuth's generator modulo 2⁶⁴; upper bits are in disorder.
            number = number.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            tree.insert(number >> 20);
        }
        black_box(tree.len());
        Ok(())
    })?;
    Ok(least.as_secs_f64() * 1e9 / NUMBERS as f64)
}

/// A measure of the memory: bytes per ns of `a = b + c`, three arrays of 64 MB.
pub fn bandwidth() -> Result<f64, Box<dyn Error>> {
    const LENGTH: usize = 8 << 20;
    let (mut a, b, c) = (vec![0.0; LENGTH], vec![1.0; LENGTH], vec![2.0; LENGTH]);
    let [least, _] = times(|| {
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + c;
        }
        black_box(&a);
        Ok(())
    })?;
    Ok(24.0 * LENGTH as f64 / (least.as_secs_f64() * 1e9))
}
