//! Rates fitted to the courses of waves.

use super::{Fluctuations, PatternWave, PhaseRequest, RateOrder, ReferencePlaces};
use crate::Error;
use nalgebra::{DMatrix, DVector};
use voronudge_observables::RateMatrix;

/// Steps of the search.
const STEPS: usize = 60;

/// Matrices that the coefficients multiply, with the power of q² that goes with each.
pub(super) struct Basis(Vec<(i32, RateMatrix)>);

impl Basis {
    /// The terms of the equation (D_∥, D_⊥, D_∥^×, D_⊥^×), and to fourth order any matrix times q⁴.
    pub fn of(order: RateOrder) -> Self {
        let second = [
            [[1.0, 0.0], [0.0, 0.0]],
            [[1.0, 0.0], [0.0, 1.0]],
            [[0.0, 0.0], [-1.0, 0.0]],
            [[0.0, 1.0], [-1.0, 0.0]],
        ];
        let mut terms: Vec<(i32, RateMatrix)> = second.map(|matrix| (1, RateMatrix(matrix))).to_vec();
        if order == RateOrder::Fourth {
            terms.extend(entries().map(|matrix| (2, matrix)));
        }
        Self(terms)
    }

    /// The four entries of D(q) themselves, of waves of one length.
    pub fn free() -> Self {
        Self(entries().map(|matrix| (0, matrix)).to_vec())
    }

    pub fn matrix(&self, coefficients: &[f64], square: f64) -> RateMatrix {
        let terms = self.0.iter().zip(coefficients);
        terms.fold(RateMatrix::ZERO, |sum, (&(power, matrix), &c)| sum + matrix * (c * square.powi(power)))
    }
}

/// The matrices with a single one.
fn entries() -> [RateMatrix; 4] {
    std::array::from_fn(|k| {
        let mut matrix = RateMatrix::ZERO;
        matrix.0[k / 2][k % 2] = 1.0;
        matrix
    })
}

/// The result of a fit.
pub(super) struct Fit {
    pub values: Vec<f64>,
    covariance: DMatrix<f64>,
    /// Degrees of freedom of the residuals.
    pub freedom: f64,
    /// Their root mean square per degree of freedom.
    pub residual: f64,
    pub explained: f64,
    pub correlation: f64,
}

struct Problem<'a> {
    waves: &'a [PatternWave],
    basis: Basis,
    request: &'a PhaseRequest,
    times: &'a [f64],
}

impl Fit {
    pub fn new(
        waves: &[PatternWave],
        basis: Basis,
        request: &PhaseRequest,
        times: &[f64],
    ) -> Result<Self, Error> {
        let problem = Problem { waves, basis, request, times };
        let mut values = problem.start()?;
        let mut residuals = problem.residuals(&values);
        let mut square = residuals.norm_squared();
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let jacobian = problem.jacobian(&values);
            let (normal, gradient) = (jacobian.transpose() * &jacobian, jacobian.transpose() * &residuals);
            let mut damped = normal.clone();
            for k in 0..values.len() {
                damped[(k, k)] *= 1.0 + damping;
            }
            let step = damped.cholesky().ok_or(Error::Degenerate)?.solve(&gradient);
            let trial: Vec<f64> = values.iter().zip(step.iter()).map(|(value, step)| value - step).collect();
            let at_trial = problem.residuals(&trial);
            let trial_square = at_trial.norm_squared();
            if trial_square.is_finite() && trial_square <= square {
                let gained = square - trial_square;
                (values, residuals, square) = (trial, at_trial, trial_square);
                damping = (0.2 * damping).max(1e-12);
                if gained <= 1e-14 * square {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
        let jacobian = problem.jacobian(&values);
        let freedom = (residuals.len() as f64 - problem.eliminated() - values.len() as f64).max(1.0);
        let variance = square / freedom;
        let inverse = (jacobian.transpose() * &jacobian).cholesky().ok_or(Error::Degenerate)?.inverse();
        Ok(Self {
            covariance: inverse * variance,
            freedom,
            residual: variance.sqrt(),
            explained: 1.0 - square / problem.unexplained(),
            correlation: problem.correlation(&residuals),
            values,
        })
    }

    pub fn variance(&self, i: usize, j: usize) -> f64 {
        self.covariance[(i, j)]
    }
}

impl Problem<'_> {
    /// Amplitudes fitted along in each course: the first state, and the state of rest.
    fn per_course(&self) -> usize {
        let first = usize::from(self.request.fluctuations == Fluctuations::Measurement);
        let rest = usize::from(self.request.reference == ReferencePlaces::Free);
        2 * (first + rest)
    }

    fn eliminated(&self) -> f64 {
        (2 * self.waves.len() * self.per_course()) as f64
    }

    /// Least squares of differences between frames on the mean of both.
    fn start(&self) -> Result<Vec<f64>, Error> {
        let count = self.basis.0.len();
        let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for wave in self.waves {
            let square = wave.square();
            let terms: Vec<RateMatrix> =
                self.basis.0.iter().map(|&(power, matrix)| matrix * square.powi(power)).collect();
            for course in &wave.courses {
                let rest = match self.request.reference {
                    ReferencePlaces::Given => [0.0; 2],
                    ReferencePlaces::Free => mean(course),
                };
                for (k, pair) in course.windows(2).enumerate() {
                    let time = self.times[k + 1] - self.times[k];
                    let middle: [f64; 2] = std::array::from_fn(|a| 0.5 * (pair[0][a] + pair[1][a]) - rest[a]);
                    let columns: Vec<[f64; 2]> = terms.iter().map(|term| term.apply(middle)).collect();
                    for axis in 0..2 {
                        let change = (pair[0][axis] - pair[1][axis]) / time;
                        for i in 0..count {
                            right[i] += columns[i][axis] * change;
                            for j in 0..count {
                                normal[(i, j)] += columns[i][axis] * columns[j][axis];
                            }
                        }
                    }
                }
            }
        }
        let factor = normal.cholesky().ok_or(Error::Degenerate)?;
        Ok(factor.solve(&right).iter().copied().collect())
    }

    fn residuals(&self, coefficients: &[f64]) -> DVector<f64> {
        let mut residuals = Vec::new();
        for wave in self.waves {
            let matrix = self.basis.matrix(coefficients, wave.square());
            match self.request.fluctuations {
                Fluctuations::Measurement => self.about_a_course(wave, &matrix, &mut residuals),
                Fluctuations::Driving => self.of_steps(wave, &matrix, &mut residuals),
            }
        }
        DVector::from_vec(residuals)
    }

    /// `y(t) − exp(−Dt) y_0 − c` at the best y_0 and c.
    fn about_a_course(&self, wave: &PatternWave, matrix: &RateMatrix, residuals: &mut Vec<f64>) {
        let begin = self.times.first().copied().unwrap_or(0.0);
        let columns = self.per_course();
        let design = |frame: usize, axis: usize, column: usize| {
            if column >= 2 {
                return f64::from(u8::from(column - 2 == axis));
            }
            matrix.propagator(self.times[frame] - begin).0[axis][column]
        };
        let design =
            DMatrix::from_fn(2 * self.times.len(), columns, |row, column| design(row / 2, row % 2, column));
        for course in &wave.courses {
            residuals.extend(left_over(&design, course.iter().flatten().copied()));
        }
    }

    /// `y(t′) − c − exp(−D(t′ − t)) (y(t) − c)` at the best c.
    fn of_steps(&self, wave: &PatternWave, matrix: &RateMatrix, residuals: &mut Vec<f64>) {
        let steps: Vec<RateMatrix> =
            self.times.windows(2).map(|pair| matrix.propagator(pair[1] - pair[0])).collect();
        let design = DMatrix::from_fn(2 * steps.len(), self.per_course(), |row, column| {
            RateMatrix::IDENTITY.0[row % 2][column] - steps[row / 2].0[row % 2][column]
        });
        for course in &wave.courses {
            let moves = course.windows(2).zip(&steps).flat_map(|(pair, step)| {
                let expected = step.apply(pair[0]);
                [pair[1][0] - expected[0], pair[1][1] - expected[1]]
            });
            residuals.extend(left_over(&design, moves));
        }
    }

    /// By central differences; the residuals are smooth in the coefficients.
    fn jacobian(&self, coefficients: &[f64]) -> DMatrix<f64> {
        let scale = coefficients.iter().fold(0.0_f64, |most, c| most.max(c.abs())).max(1e-12);
        let columns: Vec<DVector<f64>> = (0..coefficients.len())
            .map(|k| {
                let step = 1e-5 * coefficients[k].abs().max(1e-2 * scale);
                let at = |sign: f64| {
                    let mut moved = coefficients.to_vec();
                    moved[k] += sign * step;
                    self.residuals(&moved)
                };
                (at(1.0) - at(-1.0)) / (2.0 * step)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Sum of squares if nothing relaxes: about the mean, or of the steps.
    fn unexplained(&self) -> f64 {
        let of_course = |course: &Vec<[f64; 2]>| -> f64 {
            match self.request.fluctuations {
                Fluctuations::Measurement => {
                    let mean = mean(course);
                    course.iter().map(|y| (y[0] - mean[0]).powi(2) + (y[1] - mean[1]).powi(2)).sum()
                }
                Fluctuations::Driving => {
                    let steps = course.windows(2);
                    steps
                        .map(|pair| (pair[1][0] - pair[0][0]).powi(2) + (pair[1][1] - pair[0][1]).powi(2))
                        .sum()
                }
            }
        };
        self.waves.iter().flat_map(|wave| &wave.courses).map(of_course).sum()
    }

    /// Correlation of residuals that follow each other within a course.
    fn correlation(&self, residuals: &DVector<f64>) -> f64 {
        let length = residuals.len() / (2 * self.waves.len());
        let (mut product, mut square) = (0.0, 0.0);
        for course in residuals.as_slice().chunks_exact(length) {
            product += course.iter().zip(&course[2..]).map(|(a, b)| a * b).sum::<f64>();
            square += course.iter().map(|a| a * a).sum::<f64>() * (length - 2) as f64 / length as f64;
        }
        product / square
    }
}

fn mean(course: &[[f64; 2]]) -> [f64; 2] {
    let sum = course.iter().fold([0.0; 2], |sum, y| [sum[0] + y[0], sum[1] + y[1]]);
    sum.map(|x| x / course.len() as f64)
}

/// What a design of few columns leaves of a course, at the best coefficients.
fn left_over(design: &DMatrix<f64>, course: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut y = DVector::from_iterator(design.nrows(), course);
    if design.ncols() > 0 {
        let span = design.clone().qr().q();
        y -= &span * (span.transpose() * &y);
    }
    y.as_slice().to_vec()
}
