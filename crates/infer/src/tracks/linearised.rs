//! The objective of a movie linearised: a row for each motion.

use super::anchors::{Anchors, Share};
use super::objective::{MovieObjective, Placed};
use super::row_builder::{IDENTITY, RowBuilder};
use super::states::{Motion, Place};
use super::tangent::Tangent;
use crate::Error;
use crate::least_squares::combined;
use crate::linearisation::{Linearisation, Local};
use crate::normal_equations::{NormalEquations, Reduced};
use crate::rows::Rows;
use nalgebra::DMatrix;
use rayon::prelude::*;
use voronudge_geometry::Vector;
use voronudge_model::BlockMatrix;

/// Rows of motions, with the sign of a prediction: less those of the residuals.
struct MotionRows {
    jacobian: BlockMatrix,
    /// By the coefficients (2, p).
    columns: Vec<DMatrix<f64>>,
}

impl MotionRows {
    /// Rows times a factor each.
    fn scale(&mut self, factors: &[f64]) {
        let blocks = &mut self.jacobian.block;
        for (row, factor) in factors.iter().enumerate() {
            let own = self.jacobian.row_start[row]..self.jacobian.row_start[row + 1];
            blocks[own].iter_mut().flatten().for_each(|entry| *entry *= factor);
            self.columns[row] *= *factor;
        }
    }
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
    pub fn response(
        &self,
        placed: &Placed<'_>,
        parameters: &[f64],
        residuals: Vec<Vector<f64>>,
    ) -> Result<Reduced, Error> {
        let displacements = self.split(parameters).1;
        let anchors = Anchors::new(self, placed, displacements, Share::Known).without_rests();
        self.equations(parameters, placed, residuals, &anchors, &vec![0.0; displacements.len()])?.reduced()
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
        let mut motions = self.motion_rows(placed, coefficients.as_slice());
        let roots: Vec<f64> = self.weights(placed, parameters).into_iter().map(f64::sqrt).collect();
        motions.scale(&roots);
        let MotionRows { jacobian, columns } = motions;
        let p = anchors.dimension;
        let row = |(row, (rest, x)): (usize, (Vector<f64>, DMatrix<f64>))| {
            (row, rest * roots[row], x.resize_horizontally(p, 0.0))
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
            places: self.states.where_and_when(&self.movie.times),
        })?;
        let mut free = free.to_vec();
        let further = p - free.len();
        free.resize(p, 0.0);
        Ok(NormalEquations::new(&self.space.widened(further), self.levels, &free, vec![linearised]))
    }

    /// The derivatives of all motions.
    fn motion_rows(&self, placed: &Placed<'_>, coefficients: &[f64]) -> MotionRows {
        let intervals: Vec<&[Motion]> =
            self.states.motions.chunk_by(|one, next| one.interval == next.interval).collect();
        let of_frames: Vec<BlockMatrix> = match placed.passages.is_empty() {
            true => {
                let instants = placed.instants.par_iter();
                instants.map(|(nudged, evaluated)| nudged.jacobian(coefficients, evaluated)).collect()
            }
            false => Vec::new(),
        };
        let parts: Vec<MotionRows> = intervals
            .into_par_iter()
            .map(|motions| {
                let interval = motions[0].interval;
                match placed.passages.get(interval) {
                    None => self.of_trapezoid(motions, placed, &of_frames),
                    Some(passage) => {
                        self.of_passage(motions, &Tangent::at_end(self, interval, passage, coefficients))
                    }
                }
            })
            .collect();
        let mut all = MotionRows {
            jacobian: BlockMatrix { row_start: vec![0], ..BlockMatrix::default() },
            columns: Vec::new(),
        };
        for MotionRows { jacobian, columns } in parts {
            let offset = all.jacobian.column.len();
            all.jacobian.row_start.extend(jacobian.row_start[1..].iter().map(|end| offset + end));
            all.jacobian.column.extend(jacobian.column);
            all.jacobian.block.extend(jacobian.block);
            all.columns.extend(columns);
        }
        all
    }

    /// The derivatives of all motions by the coefficients (2, p), if the cells are followed.
    pub fn columns_of_passages(&self, placed: &Placed<'_>, coefficients: &[f64]) -> Vec<DMatrix<f64>> {
        let passages = placed.passages.par_iter().enumerate();
        let tangents: Vec<Tangent> = passages
            .map(|(interval, passage)| Tangent::of_coefficients(self, interval, passage, coefficients))
            .collect();
        let column = |motion: &Motion| {
            tangents[motion.interval].by_coefficients(motion.between as usize) * self.unit(motion.interval)
        };
        self.states.motions.iter().map(column).collect()
    }

    /// The motions of an interval by the mean of the velocities at both frames, whose derivatives are given.
    fn of_trapezoid(&self, motions: &[Motion], placed: &Placed<'_>, of_frames: &[BlockMatrix]) -> MotionRows {
        let mut rows = RowBuilder::new(self.states.blocks());
        for motion in motions {
            let unit = self.unit(motion.interval);
            let half = 0.5 * self.span(motion.interval) * unit;
            for (end, sign) in [(0, unit), (1, -unit)] {
                let frame = motion.interval + end;
                let place = &self.states.instants[frame].place;
                let cell = motion.cells[end] as usize;
                rows.add(place[cell], sign, &IDENTITY);
                of_frames[frame].row(cell).for_each(|(other, block)| rows.add(place[other], half, block));
            }
            if let Some(drift) = self.states.drift(motion.interval) {
                rows.add(Place::Own(drift as u32), unit, &IDENTITY);
            }
            rows.end();
        }
        MotionRows { jacobian: rows.matrix, columns: self.columns_of_trapezoid(motions, placed) }
    }

    /// The derivatives of all motions by the coefficients (2, p), if they follow the mean of the velocities at both frames.
    pub fn columns_of_trapezoid(&self, motions: &[Motion], placed: &Placed<'_>) -> Vec<DMatrix<f64>> {
        let along = self.along();
        let of_motion = |motion: &Motion| {
            let half = 0.5 * self.span(motion.interval) * self.unit(motion.interval);
            let mut x = DMatrix::zeros(2, along.len());
            for (along, mut column) in along.iter().zip(x.column_iter_mut()) {
                let at = |end: usize| {
                    let by_coefficient = &placed.instants[motion.interval + end].1.by_coefficient;
                    combined(by_coefficient, along, motion.cells[end] as usize)
                };
                column.copy_from(&((at(0) + at(1)) * half));
            }
            x
        };
        motions.par_iter().map(of_motion).collect()
    }

    /// The motions of an interval by integration.
    fn of_passage(&self, motions: &[Motion], tangent: &Tangent) -> MotionRows {
        let states = self.states;
        let mut rows = RowBuilder::new(states.blocks());
        let mut columns = Vec::with_capacity(motions.len());
        for motion in motions {
            let unit = self.unit(motion.interval);
            let between = &states.intervals[motion.interval].ends;
            let place = [0, 1].map(|end| &states.instants[motion.interval + end].place);
            for (column, block) in tangent.row(motion.between as usize) {
                // Cells of the interval at its beginning, then at its end.
                let (end, cell) = (column / between.len(), between[column % between.len()]);
                rows.add(place[end][cell[end] as usize], unit, block);
            }
            rows.add(place[1][motion.cells[1] as usize], -unit, &IDENTITY);
            if let Some(drift) = states.drift(motion.interval) {
                rows.add(Place::Own(drift as u32), unit, &tangent.by_translation(motion.between as usize));
            }
            rows.end();
            columns.push(tangent.by_coefficients(motion.between as usize) * unit);
        }
        MotionRows { jacobian: rows.matrix, columns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracks::rule::Rule;
    use crate::tracks::sample::Filmed;
    use crate::tracks::states::States;
    use crate::tracks::{Drift, Movie};
    use crate::{CoefficientSpace, Constraints, NoiseLevels};
    use voronudge_geometry::{Domain, FieldOfView};
    use voronudge_model::Structure;

    /// A tissue cut out of its surroundings, with a gap, a track that ends and one that begins.
    fn open_movie(jump: Vector<f64>, time: f64) -> Movie {
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
        Movie::new(
            vec![0.0, time, 2.5 * time],
            &film,
            Domain::Open,
            FieldOfView::default(),
            Drift::PerInterval,
        )
        .unwrap()
    }

    fn objective<'a>(
        movie: &'a Movie,
        states: &'a States,
        structure: &'a Structure,
        space: &'a CoefficientSpace,
        rule: Rule,
    ) -> MovieObjective<'a> {
        let levels = NoiseLevels { position: 0.02, velocity: 0.1 };
        MovieObjective { movie, states, rule, structure, space, levels }
    }

    /// A point and the residuals around it, along a direction in all unknowns.
    struct Around<'a> {
        objective: MovieObjective<'a>,
    }

    impl Around<'_> {
        fn along(k: usize) -> f64 {
            (0.9 * k as f64).sin()
        }

        fn at(&self, step: f64) -> Vec<f64> {
            let p = self.objective.space.dimension();
            let free = [0.1, 2.0, 0.5, 1.0];
            let all = (0..p + 2 * self.objective.states.blocks()).map(|k| {
                let size = if k < p { free[k] } else { 0.003 * (1.7 * k as f64).cos() };
                size + step * Self::along(k)
            });
            all.collect()
        }

        fn residuals(&self, step: f64) -> Vec<Vector<f64>> {
            let at = self.at(step);
            self.objective.residuals(&self.objective.place(&at).unwrap(), &at)
        }

        /// Relative error of each row.
        fn misses(&self) -> Vec<f64> {
            const STEP: f64 = 1e-7;
            let Self { objective } = self;
            let p = objective.space.dimension();
            let [before, after] = [-STEP, STEP].map(|step| self.residuals(step));
            let at = self.at(0.0);
            let c = objective.space.coefficients(&at[..p]);
            let rows = objective.motion_rows(&objective.place(&at).unwrap(), c.as_slice());
            let direction: Vec<Vector<f64>> = (0..objective.states.blocks())
                .map(|block| Vector::new(Self::along(p + 2 * block), Self::along(p + 2 * block + 1)))
                .collect();
            let by_places = rows.jacobian.apply(&direction);
            let miss = |(row, x): (usize, &DMatrix<f64>)| {
                let by_coefficients: Vector<f64> =
                    (0..p).map(|k| Vector::new(x[(0, k)], x[(1, k)]) * Self::along(k)).sum();
                let difference = (before[row] - after[row]) / (2.0 * STEP);
                (by_places[row] + by_coefficients - difference).norm() / (1.0 + difference.norm())
            };
            rows.columns.iter().enumerate().map(miss).collect()
        }
    }

    /// The errors of the rows of a rule for frames some time apart, in ascending order.
    fn misses(time: f64, rule: Rule) -> Vec<f64> {
        let movie = open_movie(Vector::zeros(), time);
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let states = States::new(&movie).unwrap();
        assert!(states.motions.len() > 20 && states.drifts.1 == 2);
        let mut misses = Around { objective: objective(&movie, &states, &structure, &space, rule) }.misses();
        misses.sort_by(f64::total_cmp);
        misses
    }

    /// Every rule's rows against differences of the residuals, along a direction in all unknowns. What is left is the places of cells
    /// beyond the rings that count, which grows with the time.
    #[test]
    fn rows_are_the_derivatives_of_the_residuals() {
        let quantile = |misses: &[f64], share: f64| misses[(share * (misses.len() - 1) as f64) as usize];
        let still = misses(0.1, Rule::Trapezoid);
        assert!(quantile(&still, 1.0) < 1e-6, "{still:?}");
        for steps in [1, 2, 4] {
            let short = misses(0.001, Rule::RungeKutta(steps));
            assert!(quantile(&short, 0.9) < 1e-4 && quantile(&short, 1.0) < 2e-3, "{short:?}");
        }
        for steps in [2, 4] {
            let long = misses(0.1, Rule::RungeKutta(steps));
            assert!(quantile(&long, 0.5) < 0.02 && quantile(&long, 0.9) < 0.15, "{long:?}");
        }
    }

    /// Along a line on which transitions move through the stages and steps of the integration, displacements of most cells do not leap. What
    /// is left are transitions next to each other, and what a jump at one stage does to the next: of second order in the step.
    #[test]
    fn displacements_are_continuous_where_neighbours_change() {
        const STEP: f64 = 2e-5;
        let movie = open_movie(Vector::zeros(), 0.1);
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let states = States::new(&movie).unwrap();
        let around =
            Around { objective: objective(&movie, &states, &structure, &space, Rule::RungeKutta(2)) };
        let all: Vec<Vec<Vector<f64>>> = (0..200).map(|k| around.residuals(STEP * f64::from(k))).collect();
        let leaps = |row: usize| {
            let second = all.windows(3).map(move |w| (w[2][row] - w[1][row] * 2.0 + w[0][row]).norm());
            second.fold(0.0, f64::max)
        };
        let mut largest: Vec<f64> = (0..all[0].len()).map(leaps).collect();
        largest.sort_by(f64::total_cmp);
        // The transitions alone would make the middle one 1.7e-4.
        assert!(largest[largest.len() / 2] < 3e-5, "{largest:?}");
        let placed = around.objective.place(&around.at(0.0)).unwrap();
        let turns = placed.passages.iter().flat_map(|passage| &passage.steps).map(|step| step.turns.len());
        assert!(turns.sum::<usize>() > 20);
    }

    /// A jump of the stage changes nothing.
    #[test]
    fn a_jump_of_the_stage_is_no_motion() {
        let space = CoefficientSpace::new(&Constraints::default()).unwrap();
        let structure = Structure::base(1.0);
        let [still, jumped] = [Vector::zeros(), Vector::new(0.3, -0.2)].map(|jump| {
            let movie = open_movie(jump, 0.1);
            let states = States::new(&movie).unwrap();
            let objective = objective(&movie, &states, &structure, &space, Rule::RungeKutta(2));
            objective.value(&objective.start(&[0.1, 2.0, 0.5, 1.0]))
        });
        assert!((still - jumped).abs() < 1e-9 * still, "{still} {jumped}");
    }
}
