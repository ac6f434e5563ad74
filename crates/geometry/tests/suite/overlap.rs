//! Cells and sides in the squares of a grid.

use crate::samples::{difference, honeycomb, periodic, random, sheared, squares};
use voronudge_geometry::{
    BySquare, Domain, Error, Grid, Overlap, Patch, Tessellation, Vector, areas, overlaps, perimeters,
    side_pieces,
};

/// A grid that covers a box once, its lower left corner anywhere.
fn covering(lengths: [f64; 2], corner: [f64; 2], size: [usize; 2]) -> Result<Grid, Error> {
    let spacing = [lengths[0] / size[0] as f64, lengths[1] / size[1] as f64];
    Grid::new([corner[0] + 0.5 * spacing[0], corner[1] + 0.5 * spacing[1]], spacing, size)
}

/// Total area of each cell.
fn totals(overlaps: &BySquare<Overlap>, cells: usize) -> Vec<f64> {
    let mut totals = vec![0.0; cells];
    for overlap in (0..overlaps.len()).flat_map(|square| overlaps.square(square)) {
        totals[overlap.cell as usize] += overlap.area;
    }
    totals
}

/// Areas as a dense matrix (squares, cells).
fn dense(overlaps: &BySquare<Overlap>, cells: usize) -> Vec<f64> {
    let mut dense = vec![0.0; overlaps.len() * cells];
    for square in 0..overlaps.len() {
        for overlap in overlaps.square(square) {
            dense[square * cells + overlap.cell as usize] += overlap.area;
        }
    }
    dense
}

#[test]
fn overlaps_sum_to_the_areas_and_squares_are_covered() -> Result<(), Error> {
    for (seed, cells) in [1, 2, 7, 60, 400].into_iter().enumerate() {
        for (lengths, offset) in [([5.0, 4.0], 0.0), ([4.0, 6.0], 1.7), ([3.0, 3.0], -11.3)] {
            let positions: Vec<_> = random(cells, lengths, seed as u64)
                .into_iter()
                // Not all in the box.
                .enumerate()
                .map(|(k, r)| r + Vector::new(lengths[0], 0.0) * (k % 3) as f64)
                .collect();
            let tessellation = Tessellation::new(&positions, sheared(lengths, offset)?)?;
            let areas = areas(&tessellation, &positions);
            for size in [[1, 1], [3, 2], [17, 40]] {
                let grid = covering(lengths, [-1.3, 20.1], size)?;
                let overlaps = overlaps(&tessellation, &positions, &grid);
                assert!(difference(&totals(&overlaps, cells), &areas) < 1e-12);
                for square in 0..grid.len() {
                    assert!((overlaps.covered(square) - grid.square_area()).abs() < 1e-12);
                    assert!(overlaps.square(square).windows(2).all(|pair| pair[0].cell < pair[1].cell));
                }
            }
            // A single square of two by three boxes.
            let large = [2.0 * lengths[0], 3.0 * lengths[1]];
            let overlaps = overlaps(&tessellation, &positions, &covering(large, [0.4, -0.2], [1, 1])?);
            let sixfold: Vec<f64> = areas.iter().map(|area| 6.0 * area).collect();
            assert!(difference(&totals(&overlaps, cells), &sixfold) < 1e-11);
        }
    }
    Ok(())
}

/// Points of a fine mesh belong to the nearest centre.
#[test]
fn overlaps_agree_with_nearest_centres() -> Result<(), Error> {
    let (lengths, offset, cells, mesh) = ([4.0, 3.0], 0.9, 12, 100);
    let positions = random(cells, lengths, 5);
    let domain = sheared(lengths, offset)?;
    let tessellation = Tessellation::new(&positions, domain)?;
    let grid = Grid::new([3.7, 2.8], [0.6, 0.9], [2, 2])?;
    let found = dense(&overlaps(&tessellation, &positions, &grid), cells);
    let mut expected = vec![0.0; found.len()];
    let share = grid.square_area() / f64::from(mesh * mesh);
    for square in 0..grid.len() {
        for k in 0..mesh * mesh {
            let at = [k % mesh, k / mesh].map(|k| (f64::from(k) + 0.5) / f64::from(mesh) - 0.5);
            let x = grid.centre(square) + Vector::new(at[0] * grid.spacing()[0], at[1] * grid.spacing()[1]);
            let distance = |cell: &usize| {
                let d = domain.shortest(positions[*cell] - x);
                (0..9).map(|k| (d + image(lengths, offset, k)).norm()).fold(f64::INFINITY, f64::min)
            };
            let nearest = (0..cells).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            expected[square * cells + nearest.unwrap()] += share;
        }
    }
    assert!(difference(&found, &expected) < 0.005 * grid.square_area());
    Ok(())
}

/// One of the nine lattice vectors around.
fn image(lengths: [f64; 2], offset: f64, k: i32) -> Vector<f64> {
    let [nx, ny] = [k % 3 - 1, k / 3 - 1].map(f64::from);
    Vector::new(nx * lengths[0] + ny * offset, ny * lengths[1])
}

#[test]
fn an_open_field_covers_what_is_inside() -> Result<(), Error> {
    let positions = random(150, [10.0, 10.0], 8);
    let tessellation = Tessellation::new(&positions, Domain::Open)?;
    let grid = Grid::new([-0.5, 0.25], [1.0, 1.5], [12, 7])?;
    let overlaps = overlaps(&tessellation, &positions, &grid);
    let partly = (0..grid.len()).filter(|&square| overlaps.covered(square) < 0.99 * grid.square_area());
    assert!(partly.count() > 10);
    for square in 0..grid.len() {
        assert!(overlaps.covered(square) < grid.square_area() * (1.0 + 1e-12));
        assert!(overlaps.square(square).iter().all(|overlap| tessellation.is_closed(overlap.cell as usize)));
        if (grid.centre(square) - Vector::new(5.0, 5.0)).amax() < 2.0 {
            assert!((overlaps.covered(square) - grid.square_area()).abs() < 1e-12);
        }
    }
    // Beyond the field.
    let nothing = Grid::new([1e6, 0.0], [1.0, 1.0], [2, 2])?;
    let nothing = voronudge_geometry::overlaps(&tessellation, &positions, &nothing);
    assert_eq!((0..4).map(|square| nothing.covered(square)).sum::<f64>(), 0.0);
    Ok(())
}

/// The pieces of a grid that covers the box make up all sides: half the perimeters.
#[test]
fn pieces_make_up_the_sides() -> Result<(), Error> {
    for (cells, size) in [(3, [5, 4]), (200, [1, 1]), (200, [7, 9]), (50, [60, 80])] {
        let (lengths, offset) = ([6.0, 5.0], 1.3);
        let positions = random(cells, lengths, 11);
        let tessellation = Tessellation::new(&positions, sheared(lengths, offset)?)?;
        let grid = covering(lengths, [0.7, -3.1], size)?;
        let pieces = side_pieces(&tessellation, &positions, &grid);
        let mut lengths = vec![0.0; cells];
        for piece in (0..grid.len()).flat_map(|square| pieces.square(square)) {
            lengths[piece.cell as usize] += piece.length;
            lengths[piece.neighbour as usize] += piece.length;
            // Points of a side are as far from both cells.
            assert!((piece.from_cell.norm() - piece.from_neighbour.norm()).abs() < 1e-10);
            assert!(((piece.from_cell - piece.from_neighbour).norm() - piece.distance).abs() < 1e-12);
        }
        assert!(difference(&lengths, &perimeters(&tessellation, &positions)) < 1e-11);
    }
    Ok(())
}

/// Every derivative of every area of a grid against central differences.
fn check_derivatives(positions: &[Vector<f64>], domain: Domain, grid: &Grid) -> Result<(), Error> {
    let cells = positions.len();
    let tessellation = Tessellation::new(positions, domain)?;
    let pieces = side_pieces(&tessellation, positions, grid);
    let step = 1e-6;
    // Gaussian patches end where their weight is 4e-6.
    let tolerance = if matches!(grid.patch(), Patch::Gaussian(_)) { 1e-5 } else { 1e-6 };
    let mut largest: f64 = 0.0;
    for moved in 0..cells {
        for axis in 0..2 {
            let mut derivative = vec![0.0; grid.len() * cells];
            for square in 0..grid.len() {
                for piece in pieces.square(square) {
                    let (i, j) = (piece.cell as usize, piece.neighbour as usize);
                    for (cell, gradient) in [i, j].into_iter().zip(piece.area_gradient()) {
                        if cell == moved {
                            derivative[square * cells + i] += gradient[axis];
                            derivative[square * cells + j] -= gradient[axis];
                        }
                    }
                }
            }
            let displaced = |by: f64| {
                let mut positions = positions.to_vec();
                positions[moved][axis] += by;
                let tessellation = Tessellation::new(&positions, domain)?;
                Ok(dense(&overlaps(&tessellation, &positions, grid), cells))
            };
            let (before, after) = (displaced(-step)?, displaced(step)?);
            for (k, found) in derivative.iter().enumerate() {
                let expected = (after[k] - before[k]) / (2.0 * step);
                if tessellation.is_closed(k % cells) {
                    assert!(
                        (found - expected).abs() < tolerance * (1.0 + expected.abs()),
                        "{found} {expected}"
                    );
                    largest = largest.max(expected.abs());
                }
            }
        }
    }
    assert!(largest > 0.05 * grid.spacing()[0].min(grid.spacing()[1]));
    Ok(())
}

#[test]
fn derivatives_of_areas_agree_with_differences() -> Result<(), Error> {
    let lengths = [5.0, 4.0];
    let positions = random(20, lengths, 13);
    for domain in [periodic(lengths)?, sheared(lengths, 1.7)?] {
        for (spacing, size) in [([0.21, 0.17], [30, 30]), ([1.3, 1.1], [4, 4]), ([8.0, 9.0], [1, 1])] {
            check_derivatives(&positions, domain, &Grid::new([-0.4, 0.3], spacing, size)?)?;
        }
    }
    let few = random(3, lengths, 17);
    check_derivatives(&few, sheared(lengths, 0.6)?, &Grid::new([0.0, 0.0], [0.9, 1.1], [6, 4])?)?;
    let (hexagons, lengths) = honeycomb(4, 4);
    check_derivatives(&hexagons, periodic(lengths)?, &Grid::new([0.1, 0.2], [0.7, 0.8], [5, 5])?)?;
    check_derivatives(&random(40, [6.0, 6.0], 19), Domain::Open, &Grid::new([1.0, 1.0], [1.3, 0.9], [4, 5])?)
}

/// As before, of Gaussian patches: narrow ones, and some that meet the same cell in several images.
#[test]
fn derivatives_of_gaussian_patches_agree_with_differences() -> Result<(), Error> {
    let lengths = [5.0, 4.0];
    let grid =
        |width: f64| Ok(Grid::new([-0.4, 0.3], [1.3, 1.1], [4, 4])?.with_patch(Patch::Gaussian(width)));
    for (cells, width) in [(20, 0.4), (20, 1.1), (3, 0.6)] {
        check_derivatives(&random(cells, lengths, 13), sheared(lengths, 1.7)?, &grid(width)?)?;
    }
    check_derivatives(&random(40, [6.0, 6.0], 19), Domain::Open, &grid(0.4)?)
}

/// All cells together fill a Gaussian patch, each its share of the plane by a sum over a mesh.
#[test]
fn cells_share_a_gaussian_patch() -> Result<(), Error> {
    let (lengths, width) = ([5.0, 4.0], 0.6);
    for cells in [1, 3, 25] {
        let positions = random(cells, lengths, 29);
        let tessellation = Tessellation::new(&positions, sheared(lengths, 1.7)?)?;
        let grid = Grid::new([0.3, 1.2], [1.0, 1.0], [2, 1])?.with_patch(Patch::Gaussian(width));
        let overlaps = overlaps(&tessellation, &positions, &grid);
        for square in 0..grid.len() {
            assert!((overlaps.covered(square) / grid.patch_area() - 1.0).abs() < 1e-5);
            let mut expected = vec![0.0; cells];
            let (mesh, step) = (300, 12.0 * width / 300.0);
            for (ix, iy) in (0..mesh).flat_map(|ix| (0..mesh).map(move |iy| (ix, iy))) {
                let from_centre = Vector::new(f64::from(ix) + 0.5, f64::from(iy) + 0.5) * step
                    - Vector::new(6.0 * width, 6.0 * width);
                let x = grid.centre(square) + from_centre;
                let distance = |cell: &usize| tessellation.domain().shortest(positions[*cell] - x).norm();
                let nearest = (0..cells).min_by(|i, j| distance(i).total_cmp(&distance(j)));
                let weight = (-0.5 * from_centre.norm_squared() / (width * width)).exp();
                expected[nearest.unwrap()] += weight * step * step;
            }
            for overlap in overlaps.square(square) {
                let expected = expected[overlap.cell as usize];
                assert!((overlap.area - expected).abs() < 0.01 * grid.patch_area(), "{overlap:?} {expected}");
            }
        }
    }
    Ok(())
}

/// Two cells of a square lattice approach each other, then part: their neighbours change at the perfect lattice.
#[test]
fn areas_are_continuous_where_neighbours_change() -> Result<(), Error> {
    let lengths = [4.0, 4.0];
    let grid = Grid::new([1.2, 1.3], [0.5, 0.7], [3, 3])?;
    let at = |by: f64| {
        let mut positions = squares(4, 4);
        positions[5] += Vector::new(by, by);
        positions[10] -= Vector::new(by, by);
        let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
        let areas = dense(&overlaps(&tessellation, &positions, &grid), 16);
        Ok((tessellation.edges(), areas))
    };
    let (apart, before) = at(-1e-7)?;
    let (close, after) = at(1e-7)?;
    assert_ne!(apart, close);
    assert!(difference(&before, &after) < 1e-6);
    assert!(difference(&before, &at(0.0)?.1) < 1e-6);
    Ok(())
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() -> Result<(), Error> {
    let lengths = [30.0, 25.0];
    let positions = random(700, lengths, 23);
    let tessellation = Tessellation::new(&positions, periodic(lengths)?)?;
    let grid = covering(lengths, [0.0, 0.0], [13, 11])?;
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            (overlaps(&tessellation, &positions, &grid), side_pieces(&tessellation, &positions, &grid))
        })
    };
    assert_eq!(run(1), run(4));
    Ok(())
}

#[test]
fn unusable_grids_are_refused() {
    assert!(matches!(Grid::new([0.0, 0.0], [1.0, -1.0], [1, 1]), Err(Error::Grid { axis: 'y', .. })));
    assert!(matches!(Grid::new([f64::NAN, 0.0], [1.0, 1.0], [1, 1]), Err(Error::Grid { axis: 'x', .. })));
}
