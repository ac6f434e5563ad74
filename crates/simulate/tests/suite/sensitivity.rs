//! Derivatives of whole runs against differences of runs.

use num_dual::DualSVec64;
use voronudge_geometry::{Domain, PeriodicBox, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{
    Direction, Driving, RandomPlacement, Shear, Simulation, Walls, derivatives, generator,
};

const TIME_STEP: f64 = 0.005;

fn parameters(preferred_perimeter: f64) -> Parameters<f64> {
    Parameters {
        preferred_perimeter,
        chirality: if preferred_perimeter > SOLID { 0.6 } else { 0.1 },
        ..Parameters::default()
    }
}

/// P_0 of a solid, and of a tissue whose cells change neighbours.
const SOLID: f64 = 3.2;
const LIQUID: f64 = 3.7;

/// A tissue of 100 cells after a while.
fn tissue(preferred_perimeter: f64, seed: u64, driving: Driving, walls: Option<Walls>) -> Simulation {
    let cell_box = PeriodicBox::new([10.0, 10.0]).unwrap();
    let positions = RandomPlacement::new(100, cell_box).draw(&mut generator(seed)).unwrap();
    let model = Model::chiral_voronoi(&parameters(preferred_perimeter));
    let mut tissue = Simulation::new(positions, Domain::Periodic(cell_box), model).unwrap();
    if let Some(walls) = walls {
        tissue = tissue.with_walls(walls).unwrap();
    }
    tissue = tissue.with_driving(driving).unwrap();
    (0..500).for_each(|_| tissue.step(0.02).unwrap());
    tissue
}

/// By α, P_0 and where one cell starts.
fn directions() -> [Direction; 3] {
    let parameter = |name: &str| Direction::parameter(name, &parameters(LIQUID)).unwrap();
    [parameter("alpha"), parameter("P_0"), Direction::position(17, 1)]
}

type Edges = Vec<(u32, u32, [i16; 2])>;

/// Where the cells are after a run, and the edges at each step.
fn run(mut tissue: Simulation, steps: usize) -> (Vec<Vector<f64>>, Vec<Edges>) {
    let mut edges: Vec<Edges> = Vec::new();
    for _ in 0..steps {
        tissue.step(TIME_STEP).unwrap();
        // Of a cell, its neighbour and both images behind a wall, which are on one circle, either diagonal will do.
        let is_of_cells = |edge: &(u32, u32, [i16; 2])| edge.0.max(edge.1) < 100;
        edges.push(tissue.tessellation().edges().into_iter().filter(is_of_cells).collect());
    }
    (tissue.positions().to_vec(), edges)
}

/// Compares all derivatives of a run with differences, and returns how many steps changed neighbours.
fn compare(tissue: &Simulation, steps: usize) -> usize {
    let directions = directions();
    let mut exact = tissue.along(&directions).unwrap();
    (0..steps).for_each(|_| exact.step(TIME_STEP).unwrap());
    let (places, edges) = run(tissue.clone(), steps);
    for (r, exact) in places.iter().zip(exact.positions()) {
        assert!((r - Vector::new(exact.x.re, exact.y.re)).norm() < 1e-11);
    }
    for (k, direction) in directions.iter().enumerate() {
        let both = |way: f64| [way, -way].map(|way| run(tissue.beside(direction, way).unwrap(), steps));
        let same = |ends: &[(Vec<Vector<f64>>, Vec<Edges>); 2]| ends.iter().all(|end| end.1 == edges);
        // Near enough for the same transitions at the same steps.
        let (way, [(plus, _), (minus, _)]) =
            [1e-6, 2e-7].into_iter().map(|way| (way, both(way))).find(|(_, ends)| same(ends)).unwrap();
        let own = |number: &DualSVec64<3>| derivatives(number)[k];
        let of_cell = |cell: usize| {
            let exact = &exact.positions()[cell];
            (Vector::new(own(&exact.x), own(&exact.y)), (plus[cell] - minus[cell]) / (2.0 * way))
        };
        let pairs: Vec<_> = (0..places.len()).map(of_cell).collect();
        let size: f64 = pairs.iter().map(|(exact, _)| exact.norm()).fold(0.0, f64::max);
        let error = pairs.iter().map(|(exact, seen)| (exact - seen).norm()).fold(0.0, f64::max);
        assert!(size > 0.01 && error < 1e-6 * size, "direction {k}: error {error:.1e} of {size:.1e}");
    }
    edges.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[test]
fn a_run_of_100_steps_is_differentiated_before_and_through_transitions() {
    assert_eq!(compare(&tissue(SOLID, 1, Driving::default(), None), 100), 0);
    let transitions: Vec<usize> =
        (1..5).map(|seed| compare(&tissue(LIQUID, seed, Driving::default(), None), 100)).collect();
    assert!(transitions.iter().all(|count| *count > 0), "{transitions:?}");
}

#[test]
fn so_are_sheared_crawling_and_walled_ones() {
    let sheared = Driving { shear: Some(Shear::Steady { rate: 0.2 }), ..Driving::default() };
    let crawling = Driving {
        speed: 0.2,
        rotational_diffusion: 0.3,
        alignment: 0.5,
        contact_inhibition: 0.1,
        velocity_alignment: 0.2,
        diffusion: 1e-5,
        seed: 4,
        ..Driving::default()
    };
    let free = Driving { free_speed: true, ..crawling };
    for driving in [sheared, crawling, free] {
        compare(&tissue(SOLID, 2, driving, None), 30);
    }
    compare(&tissue(SOLID, 2, Driving::default(), Some(Walls::Both)), 30);
}

#[test]
fn a_cell_that_is_not_there_cannot_be_displaced() {
    let error = tissue(SOLID, 1, Driving::default(), None).along(&[Direction::position(100, 0)]).unwrap_err();
    assert_eq!(error.to_string(), "there is no cell 100 among 100");
}
