//! The objective of a movie linearised: a row for each step of each motion.

use super::anchors::{Anchors, Share};
use super::objective::{MovieObjective, Moving, Placed};
use super::row_builder::RowBuilder;
use super::states::{Motion, Place};
use crate::Error;
use crate::least_squares::combined;
use crate::linearisation::{Linearisation, Local};
use crate::normal_equations::{NormalEquations, Reduced};
use crate::rows::Rows;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Motions per task.
const CHUNK: usize = 128;

/// Derivatives of the velocities by the positions, at instants and in middles.
#[derive(Default)]
struct Jacobians {
    instants: Vec<BlockMatrix>,
    middles: Vec<BlockMatrix>,
}

impl MovieObjective<'_> {
    /// The problem linearised about a point.
    pub fn linearise(&self, parameters: &[f64]) -> Result<NormalEquations, Error> {
        self.linearise_with(parameters, Share::Known)
    }

    /// The same, perhaps with the share of the way to the centroids as a further coefficient, after all others.
    pub(super) fn linearise_with(&self, parameters: &[f64], share: Share) -> Result<NormalEquations, Error> {
        let placed = self.place(parameters)?;
        let residuals = self.residuals(&placed, parameters);
        let displacements = self.split(parameters).1;
        let anchors = Anchors::new(self, &placed, displacements, share);
        self.equations(parameters, &placed, residuals, &anchors, displacements)
    }

    /// The problem in β alone about a minimum whose residuals have changed by so much.
    pub fn response(&self, parameters: &[f64], residuals: Vec<Vector<f64>>) -> Result<Reduced, Error> {
        let placed = self.place(parameters)?;
        let displacements = self.split(parameters).1;
        let anchors = Anchors::new(self, &placed, displacements, Share::Known).without_rests();
        self.equations(parameters, &placed, residuals, &anchors, &vec![0.0; displacements.len()])?.reduced()
    }

    /// The equations for some residuals and displacements, with the derivatives at a point.
    fn equations(
        &self,
        parameters: &[f64],
        placed: &Placed<'_>,
        residuals: Vec<Vector<f64>>,
        anchors: &Anchors,
        displacements: &[f64],
    ) -> Result<NormalEquations, Error> {
        let (free, _) = self.split(parameters);
        let coefficients = self.space.coefficients(free);
        let all = |moving: &[Moving<'_>]| -> Vec<BlockMatrix> {
            let jacobian =
                |(nudged, evaluated): &Moving<'_>| nudged.jacobian(coefficients.as_slice(), evaluated);
            moving.par_iter().map(jacobian).collect()
        };
        let jacobians = Jacobians { instants: all(&placed.instants), middles: all(&placed.middles) };
        let jacobian = self.rows(&jacobians);
        let columns = self.columns(placed, &jacobians);
        drop(jacobians);
        let p = anchors.dimension;
        let row = |(row, (rest, x)): (usize, (Vector<f64>, DMatrix<f64>))| {
            (row, rest, x.resize_horizontally(p, 0.0))
        };
        let rows: Vec<(usize, Vector<f64>, DMatrix<f64>)> =
            residuals.into_iter().zip(columns).enumerate().map(row).collect();
        let anchored = self.anchored();
        let floor = self.floor();
        let of_block = |block: usize| if anchored[block] { 0.0 } else { floor };
        let linearised = Linearisation::new(&Local {
            velocities: Rows { jacobian: &jacobian, rows: &rows },
            positions: anchors.rows(),
            nudges: displacements,
            floor: (0..displacements.len()).map(|i| of_block(i / 2)).collect(),
            free: p,
            places: self.states.where_and_when(),
        })?;
        let mut free = free.to_vec();
        let further = p - free.len();
        free.resize(p, 0.0);
        Ok(NormalEquations::new(&self.space.widened(further), self.levels, &free, vec![linearised]))
    }

    /// The derivatives of all rows by the unknowns, with the sign of a prediction: less that of the residual.
    fn rows(&self, jacobians: &Jacobians) -> BlockMatrix {
        let parts: Vec<BlockMatrix> = self
            .states
            .motions
            .par_chunks(CHUNK)
            .map(|motions| {
                let mut rows = RowBuilder::new(self.states.blocks());
                for motion in motions {
                    (0..self.states.rule.steps)
                        .for_each(|step| self.fill(motion, step, jacobians, &mut rows));
                }
                rows.matrix
            })
            .collect();
        let mut jacobian = BlockMatrix { row_start: vec![0], ..BlockMatrix::default() };
        for part in parts {
            let offset = jacobian.column.len();
            jacobian.row_start.extend(part.row_start[1..].iter().map(|end| offset + end));
            jacobian.column.extend(part.column);
            jacobian.block.extend(part.block);
        }
        jacobian
    }

    /// Adds the row of one step of a motion.
    fn fill(&self, motion: &Motion, step: usize, jacobians: &Jacobians, rows: &mut RowBuilder) {
        let states = self.states;
        let index = motion.interval * states.rule.steps + step;
        let unit = self.unit(motion.interval);
        let length = self.length(motion.interval);
        let (of_ends, of_middle) = states.rule.weights();
        let ends = [&states.instants[index], &states.instants[index + 1]];
        for (end, sign) in [(0, unit), (1, -unit)] {
            let cell = motion.cells[step + end] as usize;
            rows.add(ends[end].place[cell], sign, &IDENTITY);
            for (other, block) in jacobians.instants[index + end].row(cell) {
                rows.add(ends[end].place[other], of_ends[end] * length * unit, block);
            }
        }
        if let Some(drift) = states.drift(motion.interval) {
            rows.add(Place::Own(drift as u32), unit / states.rule.steps as f64, &IDENTITY);
        }
        if let Some(cell) = motion.middles.get(step) {
            let middle = &states.middles[index];
            let factor = of_middle * length * unit;
            for (other, block) in jacobians.middles[index].row(*cell as usize) {
                for (end, sign) in [(0, 1.0), (1, -1.0)] {
                    let at_end = middle.ends[other][end] as usize;
                    rows.add(ends[end].place[at_end], 0.5 * factor, block);
                    if middle.led[other] {
                        for (third, own) in jacobians.instants[index + end].row(at_end) {
                            let share = sign * factor * length / 8.0;
                            rows.add(ends[end].place[third], share, &product(block, own));
                        }
                    }
                }
            }
        }
        rows.end();
    }

    /// The derivative of each row by β (2, p), of a rule without middles.
    pub fn columns_without_middles(&self, placed: &Placed<'_>) -> Vec<DMatrix<f64>> {
        self.columns(placed, &Jacobians::default())
    }

    /// The derivative of each row by β (2, p).
    fn columns(&self, placed: &Placed<'_>, jacobians: &Jacobians) -> Vec<DMatrix<f64>> {
        let states = self.states;
        let p = self.space.dimension();
        let along: Vec<Vec<f64>> =
            (0..p).map(|k| self.space.basis().column(k).iter().copied().collect()).collect();
        let (of_ends, of_middle) = states.rule.weights();
        let of_step = |motion: &Motion, step: usize| {
            let index = motion.interval * states.rule.steps + step;
            let length = self.length(motion.interval);
            let scale = length * self.unit(motion.interval);
            let mut x = DMatrix::zeros(2, p);
            for (k, along) in along.iter().enumerate() {
                let at_end = |end: usize, cell: u32| {
                    combined(&placed.instants[index + end].1.by_coefficient, along, cell as usize)
                };
                let mut sum = at_end(0, motion.cells[step]) * of_ends[0]
                    + at_end(1, motion.cells[step + 1]) * of_ends[1];
                if let Some(cell) = motion.middles.get(step) {
                    let middle = &states.middles[index];
                    let cell = *cell as usize;
                    sum += combined(&placed.middles[index].1.by_coefficient, along, cell) * of_middle;
                    for (other, b) in
                        jacobians.middles[index].row(cell).filter(|(other, _)| middle.led[*other])
                    {
                        let [first, last] = middle.ends[other];
                        let moved = (at_end(0, first) - at_end(1, last)) * (of_middle * length / 8.0);
                        sum += Vector::new(b[0] * moved.x + b[1] * moved.y, b[2] * moved.x + b[3] * moved.y);
                    }
                }
                x[(0, k)] = scale * sum.x;
                x[(1, k)] = scale * sum.y;
            }
            x
        };
        let of_motion =
            |motion| (0..states.rule.steps).map(move |step| of_step(motion, step)).collect::<Vec<_>>();
        states.motions.par_iter().flat_map_iter(of_motion).collect()
    }
}

const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 1.0];

/// The product of two blocks.
fn product(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] + a[1] * b[2],
        a[0] * b[1] + a[1] * b[3],
        a[2] * b[0] + a[3] * b[2],
        a[2] * b[1] + a[3] * b[3],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::rule::{Rule, Scheme};
    use crate::tracks::sample::Filmed;
    use crate::tracks::states::States;
    use crate::tracks::{Drift, Movie};
    use crate::{CoefficientSpace, Constraints, NoiseLevels};
    use voronudge_geometry::{Domain, FieldOfView};
    use voronudge_model::Structure;

    /// A tissue cut out of its surroundings, with a gap, a track that ends and one that begins.
    fn open_movie(jump: Vector<f64>) -> Movie {
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
        Movie::new(vec![0.0, 0.1, 0.25], &film, Domain::Open, FieldOfView::default(), Drift::PerInterval)
            .unwrap()
    }

    fn objective<'a>(
        movie: &'a Movie,
        states: &'a States,
        structure: &'a Structure,
        space: &'a CoefficientSpace,
    ) -> MovieObjective<'a> {
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        MovieObjective { movie, states, structure, space, levels }
    }

    /// Every rule's rows against differences of the residuals, along a direction in all unknowns.
    #[test]
    fn rows_are_the_derivatives_of_the_residuals() {
        let movie = open_movie(Vector::zeros());
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        for rule in Rule::LADDER.into_iter().take(3) {
            let states = States::new(&movie, rule).unwrap();
            let objective = objective(&movie, &states, &structure, &space);
            assert!(states.motions.len() > 20 && states.drifts.1 == 2);
            let p = space.dimension();
            let at = |step: f64| -> Vec<f64> {
                let free = [0.1, 2.0, 0.5, 1.0];
                let all = (0..p + 2 * states.blocks()).map(|k| {
                    let size = if k < p { free[k] } else { 0.003 * (1.7 * k as f64).cos() };
                    size + step * (0.9 * k as f64).sin()
                });
                all.collect()
            };
            let residuals = |at: &[f64]| objective.residuals(&objective.place(at).unwrap(), at);
            let [before, after] = [-1e-6, 1e-6].map(|step| residuals(&at(step)));
            let placed = objective.place(&at(0.0)).unwrap();
            let c = space.coefficients(&at(0.0)[..p]);
            let all = |moving: &[Moving<'_>]| -> Vec<BlockMatrix> {
                moving.iter().map(|(nudged, evaluated)| nudged.jacobian(c.as_slice(), evaluated)).collect()
            };
            let jacobians = Jacobians { instants: all(&placed.instants), middles: all(&placed.middles) };
            assert_eq!(placed.middles.is_empty(), rule.scheme == Scheme::Trapezoid);
            let (rows, columns) = (objective.rows(&jacobians), objective.columns(&placed, &jacobians));
            let along = |k: usize| (0.9 * k as f64).sin();
            let direction: Vec<Vector<f64>> = (0..states.blocks())
                .map(|block| Vector::new(along(p + 2 * block), along(p + 2 * block + 1)))
                .collect();
            let by_places = rows.apply(&direction);
            for (row, x) in columns.iter().enumerate() {
                let by_coefficients = (0..p).fold(Vector::zeros(), |sum: Vector<f64>, k| {
                    sum + Vector::new(x[(0, k)], x[(1, k)]) * along(k)
                });
                let difference = (before[row] - after[row]) / 2e-6;
                let miss = (by_places[row] + by_coefficients - difference).norm();
                assert!(miss < 1e-4 * (1.0 + difference.norm()), "{rule:?}, row {row}: {miss}");
            }
        }
    }

    /// A jump of the stage changes nothing.
    #[test]
    fn a_jump_of_the_stage_is_no_motion() {
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let [still, jumped] = [Vector::zeros(), Vector::new(0.3, -0.2)].map(|jump| {
            let movie = open_movie(jump);
            let states = States::new(&movie, Rule::LADDER[1]).unwrap();
            let objective = objective(&movie, &states, &structure, &space);
            objective.value(&objective.start(&[0.1, 2.0, 0.5, 1.0]))
        });
        assert!((still - jumped).abs() < 1e-9 * still, "{still} {jumped}");
    }
}
