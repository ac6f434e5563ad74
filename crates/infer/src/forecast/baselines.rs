//! What a regression says that knows nothing of forces.

use super::start::Start;
use super::{Ahead, Said};
use crate::Error;
use nalgebra::{Matrix4, Vector4};
use voronudge_geometry::{Vector, quarter_turn};

/// Displacements below which there is no regression.
const FEWEST: usize = 20;

/// Displacement as a linear function of the velocities of the interval before: that of the cell and the mean of its neighbours, along and across.
pub(super) struct Regression {
    /// Coefficients for each horizon, fitted on frames of the fit; `None` where they are too few.
    coefficients: Vec<Option<Vector4<f64>>>,
}

/// What a displacement is regressed on.
fn predictors(start: &Start<'_>, cell: usize) -> Option<[Vector<f64>; 4]> {
    let own = start.velocity_before(cell)?;
    let around = start.before_around(cell)?;
    Some([own, quarter_turn(own), around, quarter_turn(around)])
}

impl Regression {
    pub fn fitted(ahead: &Ahead<'_>) -> Result<Self, Error> {
        let starts = (1..ahead.first)
            .map(|frame| Start::new(ahead.movie, frame))
            .collect::<Result<Vec<_>, Error>>()?;
        let fit = |horizon: usize| {
            let (mut products, mut right, mut count) = (Matrix4::zeros(), Vector4::zeros(), 0);
            for start in starts.iter().filter(|start| start.frame + horizon < ahead.first) {
                for cell in start.scored() {
                    let told = predictors(start, cell).zip(start.displacement(
                        cell,
                        start.frame,
                        start.frame + horizon,
                    ));
                    let Some((x, y)) = told else { continue };
                    products += Matrix4::from_fn(|i, j| x[i].dot(&x[j]));
                    right += Vector4::from_fn(|i, _| x[i].dot(&y));
                    count += 1;
                }
            }
            if count < FEWEST { None } else { products.cholesky().map(|factor| factor.solve(&right)) }
        };
        Ok(Self { coefficients: (1..=ahead.horizon).map(fit).collect() })
    }

    pub fn forecast(&self, start: &Start<'_>, horizon: usize) -> Said {
        let nothing = Vector::new(f64::NAN, f64::NAN);
        let of = |horizon: usize| {
            let of_cell = |cell: usize| match (self.coefficients[horizon], predictors(start, cell)) {
                (None, _) => nothing,
                (Some(_), None) => Vector::zeros(),
                (Some(c), Some(x)) => (0..4).map(|k| x[k] * c[k]).sum(),
            };
            (0..start.tracks.len()).map(of_cell).collect()
        };
        ((0..horizon).map(of).collect(), None)
    }
}
