//! The cells around a place, in coordinates that do not jump: what a change there does to the velocities nearby.

use super::law::Law;
use super::misfit::{Misfit, Residuals};
use super::polygons::size_around;
use super::scene::{Cell, Scene};
use crate::flow::Sampling;
use crate::objective::Nudged;
use crate::{Error, Flow, Velocities};
use nalgebra::{DMatrix, DVector, Matrix2};
use std::sync::Arc;
use voronudge_geometry::{
    CellPolygon, Domain, Grid, MovingTessellation, Tessellation, Vector, Visibility, areas, circumcentre,
};
use voronudge_model::Environment;

/// Distance from the centre within which velocities are compared, in ℓ₀: two rings around a cell that moves.
const COMPARED: f64 = 3.0;

/// Distance within which cells shape those.
const CONTEXT: f64 = 5.4;

/// Gain that ends a placement, in −2 log likelihood.
const SMALL_GAIN: f64 = 0.05;

/// Longest step of a placement, in ℓ₀: what a linearisation is worth.
const LONGEST_STEP: f64 = 0.3;

/// Damping at first, and beyond which no step is short enough.
const DAMPING: [f64; 2] = [1e-2, 1e4];

/// Cells around a place.
pub(super) struct Neighbourhood {
    pub cells: Vec<Cell>,
    pub positions: Vec<Vector<f64>>,
    /// Who is whose neighbour as things are.
    pub tessellation: Tessellation,
    /// Data that are compared, and what is to be explained: of a cell, or of a point of the grid.
    targets: Vec<(usize, Vector<f64>)>,
    flow: Option<Flow>,
    has_labels: bool,
}

/// Free cells with a normal prior of their places.
#[derive(Debug, Clone)]
pub(super) struct Guess {
    /// Where they are looked for first.
    pub start: Vec<Vector<f64>>,
    /// Where they are expected.
    pub places: Vec<Vector<f64>>,
    /// Standard deviation of a coordinate about those.
    pub spread: f64,
    /// What the velocity of the only one is to be.
    pub target: Option<Vector<f64>>,
    /// Their labels, where cells have labels.
    pub labels: Vec<Option<i64>>,
}

/// Cells beside those of a neighbourhood.
#[derive(Clone, Copy)]
struct Beside<'a> {
    places: &'a [Vector<f64>],
    target: Option<Vector<f64>>,
    labels: &'a [Option<i64>],
}

impl Guess {
    fn at<'a>(&'a self, places: &'a [Vector<f64>]) -> Beside<'a> {
        Beside { places, target: self.target, labels: &self.labels }
    }
}

/// Free cells at the places that suit the velocities best.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub positions: Vec<Vector<f64>>,
    /// Deviance of the velocities nearby.
    pub deviance: f64,
    /// The largest factor λ of one of them.
    pub strain: f64,
    /// `Σ ‖z − z₀‖² / s²`
    pub prior: f64,
    /// Information of the velocities on the coordinates.
    pub information: DMatrix<f64>,
}

impl Neighbourhood {
    /// Around a place, with some of the changes undone, without some further detections.
    pub fn new(
        scene: &Scene<'_>,
        centre: Vector<f64>,
        undone: &[usize],
        without: &[usize],
    ) -> Result<Self, Error> {
        let (mut cells, mut positions, mut targets) = (Vec::new(), Vec::new(), Vec::new());
        for (cell, d) in scene.cells_around(centre, CONTEXT, undone, without) {
            if let Some(target) = cell.target.filter(|_| d.norm_squared() < COMPARED * COMPARED) {
                targets.push((cells.len(), target));
            }
            cells.push(cell);
            positions.push(centre + d);
        }
        let tessellation = tessellate(&positions)?;
        let flow = match &scene.measured.velocities {
            Velocities::OfCells(_) => None,
            Velocities::OnGrid(flow) => around(scene, flow, centre, &mut targets),
        };
        Ok(Self { cells, positions, tessellation, targets, flow, has_labels: scene.has_labels() })
    }

    /// What surrounds its cells and free ones.
    fn environment(&self, free: Beside<'_>) -> Result<Arc<Environment>, Error> {
        if !self.has_labels {
            return Ok(Arc::default());
        }
        let of_free = free.places.iter().enumerate().map(|(k, _)| free.labels.get(k).copied().flatten());
        let labels = self.cells.iter().map(|cell| cell.label).chain(of_free).collect();
        Ok(Arc::new(Environment::default().with_labels(labels)?))
    }

    /// The velocities nearby with free cells, which the tessellation of an earlier place of theirs follows, if there is one.
    fn residuals(
        &self,
        law: &Law<'_>,
        beside: Beside<'_>,
        earlier: &mut Option<MovingTessellation>,
    ) -> Result<Residuals, Error> {
        let Beside { places: free, target, .. } = beside;
        let fixed = self.positions.len();
        let positions: Vec<Vector<f64>> = self.positions.iter().chain(free).copied().collect();
        let tessellation = match earlier {
            _ if free.is_empty() => self.tessellation.clone(),
            None => {
                let first = tessellate(&positions)?;
                earlier.insert(MovingTessellation::of(first, &positions)).tessellation().clone()
            }
            Some(moving) => {
                moving.renew(&positions).map_err(|source| Error::Geometry { frame: 0, source })?;
                moving.tessellation().clone()
            }
        };
        let sampling = self.flow.as_ref().map(|flow| {
            Sampling::new(flow, &tessellation, &positions, &vec![Visibility::Counted; positions.len()])
        });
        let nudged =
            Nudged::placed(law.structure, self.environment(beside)?, positions, tessellation, sampling);
        let evaluated = nudged.evaluate(law.coefficients);
        let jacobian = nudged.jacobian(law.coefficients, &evaluated.of_cells);
        let own = target.map(|target| (fixed, target));
        let data: Vec<(usize, Vector<f64>)> = self.targets.iter().copied().chain(own).collect();
        let measured: Vec<Option<f64>> =
            (0..fixed).map(|cell| Some(law.position_variance() * self.cells[cell].variance?)).collect();
        let mut by_free = DMatrix::zeros(2 * data.len(), 2 * free.len());
        let mut by_measured = DMatrix::zeros(2 * data.len(), 2 * fixed);
        for (row, (datum, _)) in data.iter().enumerate() {
            for (column, b) in jacobian.row(*datum) {
                let b = Matrix2::new(b[0], b[1], b[2], b[3]);
                match measured.get(column) {
                    None => by_free.fixed_view_mut::<2, 2>(2 * row, 2 * (column - fixed)).copy_from(&b),
                    Some(Some(variance)) => by_measured
                        .fixed_view_mut::<2, 2>(2 * row, 2 * column)
                        .copy_from(&(b * variance.sqrt())),
                    Some(None) => {}
                }
            }
        }
        let rests = data.iter().map(|(datum, target)| target - evaluated.predicted[*datum]);
        let residuals = DVector::from_vec(rests.flat_map(|rest| [rest.x, rest.y]).collect());
        Ok(Residuals { residuals, by_free, by_measured, variance: law.velocity_variance() })
    }

    /// How well the velocities nearby are explained with free cells, from the factors of places nearby.
    fn misfit(
        &self,
        law: &Law<'_>,
        free: Beside<'_>,
        earlier: &mut Option<MovingTessellation>,
        factors: &mut Vec<f64>,
    ) -> Result<Misfit, Error> {
        let misfit = self.residuals(law, free, earlier)?.misfit(factors);
        misfit.ok_or_else(|| Error::Optimiser("velocities that are not finite".into()))
    }

    /// Deviance of the velocities nearby as things are.
    pub fn deviance(&self, law: &Law<'_>) -> Result<f64, Error> {
        let nothing = Beside { places: &[], target: None, labels: &[] };
        let misfit = self.misfit(law, nothing, &mut None, &mut Vec::new());
        Ok(misfit.map_or(f64::INFINITY, |misfit| misfit.deviance))
    }

    /// Damped Gauss–Newton on the places of free cells, the coefficients held. Steps are counted by evaluations.
    pub fn settled(&self, law: &Law<'_>, guess: &Guess, steps: usize) -> Result<Placed, Error> {
        let stiffness = guess.spread.powi(-2);
        let from_prior = |z: &[Vector<f64>]| -> f64 {
            z.iter().zip(&guess.places).map(|(z, at)| (z - at).norm_squared()).sum::<f64>() * stiffness
        };
        let mut z = guess.start.clone();
        let (mut factors, mut tessellation) = (Vec::new(), None);
        let Ok(mut misfit) = self.misfit(law, guess.at(&z), &mut tessellation, &mut factors) else {
            return Ok(Placed {
                deviance: f64::INFINITY,
                strain: f64::INFINITY,
                prior: 0.0,
                information: DMatrix::zeros(2 * z.len(), 2 * z.len()),
                positions: z,
            });
        };
        let mut value = misfit.deviance + from_prior(&z);
        let (mut damping, mut done) = (DAMPING[0], 1);
        while done < steps && damping < DAMPING[1] && !z.is_empty() {
            let Some(delta) = step(&misfit, &z, guess, damping) else { break };
            let trial: Vec<Vector<f64>> = z.iter().zip(&delta).map(|(z, d)| z + d).collect();
            done += 1;
            let mut of_trial = factors.clone();
            let other = self.misfit(law, guess.at(&trial), &mut tessellation, &mut of_trial);
            let next = other.as_ref().map_or(f64::INFINITY, |other| other.deviance + from_prior(&trial));
            match other {
                Ok(other) if next < value => {
                    let small = value - next < SMALL_GAIN;
                    (z, misfit, value, factors) = (trial, other, next, of_trial);
                    damping = (0.2 * damping).max(1e-4);
                    if small {
                        break;
                    }
                }
                _ => damping *= 6.0,
            }
        }
        let prior = from_prior(&z);
        let strain = factors.iter().copied().fold(0.0, f64::max);
        Ok(Placed { positions: z, deviance: value - prior, strain, prior, information: misfit.information })
    }

    /// The largest empty circle that a place is in beside some further cells: its centre, and its radius in roots of the mean area
    /// of the cells around.
    pub fn empty_circle(
        &self,
        place: Vector<f64>,
        others: &[Vector<f64>],
    ) -> Result<Option<(Vector<f64>, f64)>, Error> {
        let positions: Vec<Vector<f64>> = self.positions.iter().chain(others).copied().collect();
        let with_others = if others.is_empty() { None } else { Some(tessellate(&positions)?) };
        let tessellation = with_others.as_ref().unwrap_or(&self.tessellation);
        let circles = tessellation.triangles().into_iter().map(|triangle| {
            let [a, b, c] = triangle.cells.map(|cell| positions[cell as usize]);
            let centre = circumcentre(b - a, c - a);
            (a + centre, centre.norm(), triangle.cells.map(|cell| cell as usize))
        });
        let around = circles.filter(|(centre, radius, _)| (place - centre).norm() <= *radius);
        Ok(around.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(centre, radius, cells)| {
            let areas = areas(tessellation, &positions);
            (centre, radius / size_around(tessellation, &areas, &cells))
        }))
    }

    /// The polygon of a cell.
    pub fn polygon(&self, cell: usize) -> Option<CellPolygon<f64>> {
        self.tessellation.is_closed(cell).then(|| {
            let mut polygon = CellPolygon::default();
            polygon.fill(&self.tessellation, &self.positions, cell);
            polygon
        })
    }
}

fn tessellate(positions: &[Vector<f64>]) -> Result<Tessellation, Error> {
    Tessellation::new(positions, Domain::Open).map_err(|source| Error::Geometry { frame: 0, source })
}

/// A damped step of the places of free cells.
fn step(misfit: &Misfit, z: &[Vector<f64>], guess: &Guess, damping: f64) -> Option<Vec<Vector<f64>>> {
    let stiffness = guess.spread.powi(-2);
    let (mut hessian, mut gradient) = (misfit.information.clone(), misfit.gradient.clone());
    for (i, (z, at)) in z.iter().zip(&guess.places).enumerate() {
        let mut slope = gradient.fixed_rows_mut::<2>(2 * i);
        slope -= (z - at) * stiffness;
    }
    for i in 0..2 * z.len() {
        hessian[(i, i)] = (hessian[(i, i)] + stiffness) * (1.0 + damping);
    }
    let delta = hessian.cholesky()?.solve(&gradient);
    let shorter = (LONGEST_STEP / delta.amax().max(f64::MIN_POSITIVE)).min(1.0);
    Some((0..z.len()).map(|i| Vector::new(delta[2 * i], delta[2 * i + 1]) * shorter).collect())
}

/// The part of a grid around a place, in the coordinates of that place, with what is to be explained there. Where a grid does
/// not go on evenly across a periodic box, it ends.
fn around(
    scene: &Scene<'_>,
    flow: &Flow,
    centre: Vector<f64>,
    targets: &mut Vec<(usize, Vector<f64>)>,
) -> Option<Flow> {
    let (spacing, size, origin) = (flow.grid.spacing(), flow.grid.size(), flow.grid.centre(0));
    let lengths = match scene.measured.tessellation.domain() {
        Domain::Periodic(cell_box) if cell_box.offset() == 0.0 => Some(cell_box.lengths()),
        _ => None,
    };
    let axis = |axis: usize| {
        let (first, last) = (
            ((centre[axis] - COMPARED - origin[axis]) / spacing[axis]).ceil() as i64,
            ((centre[axis] + COMPARED - origin[axis]) / spacing[axis]).floor() as i64,
        );
        let even = lengths
            .is_some_and(|lengths| (size[axis] as f64 * spacing[axis] / lengths[axis] - 1.0).abs() < 1e-6);
        let on_grid =
            |k: i64| (even || (0..size[axis] as i64).contains(&k)).then(|| k.rem_euclid(size[axis] as i64));
        (first..=last).map(|k| (k, on_grid(k))).collect::<Vec<_>>()
    };
    let [columns, rows] = [axis(0), axis(1)];
    let ((first_column, _), (first_row, _)) = (columns.first()?, rows.first()?);
    let corner = [origin.x + *first_column as f64 * spacing[0], origin.y + *first_row as f64 * spacing[1]];
    let grid = Grid::new(corner, spacing, [columns.len(), rows.len()]).ok()?;
    let places = rows.iter().flat_map(|row| columns.iter().map(move |column| (column.1, row.1)));
    for (own, place) in places.enumerate() {
        if let (Some(column), Some(row)) = place {
            let datum = row as usize * size[0] + column as usize;
            targets.extend(scene.targets[datum].map(|target| (own, target)));
        }
    }
    Some(Flow { grid, velocities: vec![None; grid.len()], window: flow.window })
}
