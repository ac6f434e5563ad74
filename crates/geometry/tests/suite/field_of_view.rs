//! What is called certain in a window is what it is in the whole tissue.

use crate::samples::{periodic, random};
use voronudge_geometry::{
    Certificate, Domain, Error, FieldOfView, Region, Seen, Tessellation, Vector, Visibility, areas,
};

/// Cells of a periodic box, of which a window sees some.
struct Window {
    tissue: Vec<Vector<f64>>,
    whole: Tessellation,
    seen: Vec<usize>,
    positions: Vec<Vector<f64>>,
    tessellation: Tessellation,
}

/// Side of the box, in cells.
const SIDE: usize = 24;

impl Window {
    fn new(seed: u64, is_seen: impl Fn(Vector<f64>) -> bool) -> Result<Self, Error> {
        let offsets = random(SIDE * SIDE, [0.8, 0.8], seed);
        let place = |i: usize| Vector::new((i % SIDE) as f64, (i / SIDE) as f64);
        let tissue: Vec<Vector<f64>> = offsets.iter().enumerate().map(|(i, d)| place(i) + d).collect();
        let whole = Tessellation::new(&tissue, periodic([SIDE as f64; 2])?)?;
        let seen: Vec<usize> = (0..tissue.len()).filter(|&i| is_seen(tissue[i])).collect();
        let positions: Vec<Vector<f64>> = seen.iter().map(|&i| tissue[i]).collect();
        let tessellation = Tessellation::new(&positions, Domain::Open)?;
        Ok(Self { tissue, whole, seen, positions, tessellation })
    }

    fn judge(&self, seen: Seen) -> Certificate {
        let view = FieldOfView { seen, margin: 0.0, ..FieldOfView::default() };
        view.judge(&self.tessellation, &self.positions)
    }

    /// Number of cells that count, and of those of which a polygon, their own or a neighbour's, is not the true one.
    fn counted(&self, view: &Certificate) -> [usize; 2] {
        let own = areas(&self.tessellation, &self.positions);
        let true_areas = areas(&self.whole, &self.tissue);
        let is_true = |cell: usize| {
            let names = |k: &u32| self.seen[*k as usize] as u32;
            let mut neighbours: Vec<u32> = self.tessellation.neighbours(cell).iter().map(names).collect();
            let mut truth = self.whole.neighbours(self.seen[cell]).to_vec();
            neighbours.sort_unstable();
            truth.sort_unstable();
            neighbours == truth && (own[cell] - true_areas[self.seen[cell]]).abs() < 1e-9
        };
        let counted: Vec<usize> = (0..self.seen.len()).filter(|&cell| view.counts(cell)).collect();
        let ring_is_true = |cell: &usize| {
            is_true(*cell) && self.tessellation.neighbours(*cell).iter().all(|&k| is_true(k as usize))
        };
        [counted.len(), counted.iter().filter(|cell| !ring_is_true(cell)).count()]
    }
}

fn polygon(corners: &[[f64; 2]]) -> Result<Region, Error> {
    Region::polygon(corners.iter().map(|r| Vector::from(*r)).collect())
}

/// A rectangle, a convex and two concave polygons: an L and a horseshoe.
fn regions() -> Result<[Region; 4], Error> {
    let horseshoe = [
        [2.0, 2.0],
        [22.0, 2.0],
        [22.0, 22.0],
        [15.0, 22.0],
        [15.0, 10.0],
        [9.0, 10.0],
        [9.0, 22.0],
        [2.0, 22.0],
    ];
    Ok([
        Region::rectangle([3.0, 4.0, 21.0, 20.0])?,
        polygon(&[[4.0, 3.0], [21.0, 6.0], [18.0, 21.0], [3.0, 17.0]])?,
        polygon(&[[2.0, 2.0], [22.0, 2.0], [22.0, 12.0], [12.0, 12.0], [12.0, 22.0], [2.0, 22.0]])?,
        polygon(&horseshoe)?,
    ])
}

#[test]
fn certain_polygons_are_those_of_the_whole_tissue() -> Result<(), Error> {
    for region in regions()? {
        for seed in 0..10 {
            let window = Window::new(50 + seed, |r| region.contains(r))?;
            let [counted, wrong] = window.counted(&window.judge(Seen::Within(region.clone())));
            assert_eq!(wrong, 0);
            assert!(10 * counted > 3 * window.seen.len(), "{counted} of {}", window.seen.len());
        }
    }
    Ok(())
}

/// With nothing declared, nothing is wrong in a convex window, and next to nothing in a concave one: the cells show its notch
/// by not being there.
#[test]
fn the_hull_of_the_cells_does_for_a_region() -> Result<(), Error> {
    for (index, region) in regions()?.into_iter().enumerate() {
        let (mut all, mut certain, mut amiss) = (0, 0, 0);
        for seed in 0..10 {
            let window = Window::new(50 + seed, |r| region.contains(r))?;
            let [counted, wrong] = window.counted(&window.judge(Seen::Hull));
            (all, certain, amiss) = (all + window.seen.len(), certain + counted, amiss + wrong);
        }
        assert!(5 * certain > all, "{certain} of {all}");
        assert!(500 * amiss <= certain && (index > 1 || amiss == 0), "{amiss} of {certain}");
    }
    Ok(())
}

/// Holes are within the hull; the cells around them do not count, since their polygons are too large.
#[test]
fn cells_around_a_hole_do_not_count() -> Result<(), Error> {
    let middle = Vector::new(12.0, 12.0);
    let window = Window::new(7, |r| (r - middle).norm() > 2.5)?;
    let view = window.judge(Seen::Hull);
    let around = (0..window.seen.len()).filter(|&cell| (window.positions[cell] - middle).norm() < 3.2);
    assert!(around.clone().count() > 8);
    for cell in around {
        assert!(!view.counts(cell), "{}", window.positions[cell]);
    }
    assert_eq!(view.region().map_or(0, |region| region.loops().len()), 1);
    Ok(())
}

/// A margin keeps errors of the positions from making uncertain polygons certain.
#[test]
fn a_margin_allows_for_errors_of_positions() -> Result<(), Error> {
    let region = Region::rectangle([3.0, 4.0, 21.0, 20.0])?;
    let mut amiss = [0; 2];
    for seed in 0..60 {
        let exact = Window::new(50 + seed, |r| region.contains(r))?;
        let errors = random(exact.positions.len(), [0.04, 0.04], 90 + seed);
        let moved: Vec<Vector<f64>> =
            exact.positions.iter().zip(&errors).map(|(r, e)| r + e - Vector::new(0.02, 0.02)).collect();
        let tessellation = Tessellation::new(&moved, Domain::Open)?;
        let truth = exact.judge(Seen::Within(region.clone()));
        for (margin, amiss) in [0.0, 0.05].into_iter().zip(&mut amiss) {
            let view = FieldOfView { seen: Seen::Within(region.clone()), margin, ..FieldOfView::default() };
            let view = view.judge(&tessellation, &moved);
            *amiss += (0..moved.len())
                .filter(|&cell| truth.visibility()[cell] == Visibility::Unseen)
                .filter(|&cell| view.visibility()[cell] < Visibility::TooLarge)
                .count();
        }
    }
    assert!(amiss[0] > 8 && 5 * amiss[1] < amiss[0], "{amiss:?}");
    Ok(())
}

#[test]
fn all_cells_of_a_periodic_box_count() -> Result<(), Error> {
    let positions = random(200, [14.0, 14.0], 41);
    let tessellation = Tessellation::new(&positions, periodic([14.0, 14.0])?)?;
    let view = FieldOfView::default().judge(&tessellation, &positions);
    assert!((0..200).all(|cell| view.counts(cell)));
    assert!(view.region().is_none());
    Ok(())
}
