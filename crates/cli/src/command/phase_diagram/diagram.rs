//! Runs as numbers over the grid.

use super::points::Points;
use super::request::{Quantity, Request};
use crate::failure::Failure;
use ndarray::{Array1, Array2};
use std::collections::BTreeMap;
use voronudge_io::OutputDirectory;

/// A quantity over the grid (n_alpha, n_P0), and its standard error; NaN where it is not known.
pub(super) struct Field {
    pub mean: Array2<f64>,
    pub error: Array2<f64>,
}

/// All quantities of a diagram.
pub(super) struct Diagram {
    pub preferred_perimeters: Vec<f64>,
    pub chiralities: Vec<f64>,
    pub fields: BTreeMap<Quantity, Field>,
}

impl Diagram {
    /// Means over the runs at each point. The error is that of the mean of several runs; of a single run, that of its average
    /// over time.
    pub fn new(points: &Points) -> Self {
        let request = &points.header.request;
        let mut fields = BTreeMap::new();
        for &quantity in &request.quantities {
            let mut measured = vec![Vec::new(); request.points()];
            for record in &points.records {
                if let Some([Some(value), error]) = record.values.get(&quantity)
                    && let Some(slot) = measured.get_mut(record.point)
                {
                    slot.push((*value, error.unwrap_or(f64::NAN)));
                }
            }
            let [mean, error] =
                [0, 1].map(|which| over_grid(request, |point| mean_and_error(&measured[point])[which]));
            fields.insert(quantity, Field { mean, error });
        }
        Self {
            preferred_perimeters: request.preferred_perimeters.values(),
            chiralities: request.chiralities.values(),
            fields,
        }
    }

    /// Writes the axes, and each quantity with its error.
    pub fn write(&self, out: &mut OutputDirectory) -> Result<(), Failure> {
        for (name, values) in [("P_0.npy", &self.preferred_perimeters), ("alpha.npy", &self.chiralities)] {
            out.write_array(name, Array1::from(values.clone()).view())?;
        }
        for (quantity, field) in &self.fields {
            let name = quantity.name();
            out.write_array(&format!("{name}.npy"), field.mean.view())?;
            out.write_array(&format!("{name}_error.npy"), field.error.view())?;
        }
        Ok(())
    }
}

fn over_grid(request: &Request, value: impl Fn(usize) -> f64) -> Array2<f64> {
    let columns = request.preferred_perimeters.count;
    Array2::from_shape_fn((request.chiralities.count, columns), |(row, column)| value(row * columns + column))
}

fn mean_and_error(runs: &[(f64, f64)]) -> [f64; 2] {
    let count = runs.len() as f64;
    let mean = runs.iter().map(|run| run.0).sum::<f64>() / count;
    match runs {
        [] => [f64::NAN; 2],
        [run] => [run.0, run.1],
        _ => {
            let squares: f64 = runs.iter().map(|run| (run.0 - mean).powi(2)).sum();
            [mean, (squares / (count - 1.0) / count).sqrt()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_tell_the_error_of_their_mean() {
        assert_eq!(mean_and_error(&[(2.0, 0.1)]), [2.0, 0.1]);
        // Variance 2, so the error of the mean of two is one.
        assert_eq!(mean_and_error(&[(1.0, 0.1), (3.0, f64::NAN)]), [2.0, 1.0]);
        assert!(mean_and_error(&[]).iter().all(|x| x.is_nan()));
    }
}
