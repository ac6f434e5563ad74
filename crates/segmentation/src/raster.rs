//! Values on the pixels of an image.

use crate::Error;

/// What is beyond the border of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edge {
    /// The image repeats.
    Periodic,
    /// Nothing is known.
    #[default]
    Open,
}

/// A Gaussian average of standard deviation `width`, in pixels, of values on an image, row after row. At an open edge it is the
/// average over the pixels that are there.
///
/// # Errors
/// [`Error::Raster`] if there is not one value for each pixel.
pub fn smooth(values: &[f64], size: [usize; 2], width: f64, edge: Edge) -> Result<Vec<f64>, Error> {
    let [columns, rows] = size;
    if values.is_empty() || columns.checked_mul(rows) != Some(values.len()) {
        return Err(Error::Raster { values: values.len(), columns, rows });
    }
    if width <= 0.0 || !width.is_finite() {
        return Ok(values.to_vec());
    }
    let reach = (4.0 * width).ceil() as isize;
    let kernel: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / width).powi(2)).exp()).collect();
    let mut along_rows = vec![0.0; values.len()];
    for (row, smoothed) in values.chunks_exact(columns).zip(along_rows.chunks_exact_mut(columns)) {
        for (column, value) in smoothed.iter_mut().enumerate() {
            *value = average(&kernel, column, columns, edge, |k| row[k]);
        }
    }
    let mut smoothed = vec![0.0; values.len()];
    for row in 0..rows {
        for column in 0..columns {
            smoothed[row * columns + column] =
                average(&kernel, row, rows, edge, |k| along_rows[k * columns + column]);
        }
    }
    Ok(smoothed)
}

fn average(kernel: &[f64], at: usize, length: usize, edge: Edge, value: impl Fn(usize) -> f64) -> f64 {
    let reach = (kernel.len() / 2) as isize;
    let (mut sum, mut weight) = (0.0, 0.0);
    for (k, &w) in kernel.iter().enumerate() {
        let place = at as isize + k as isize - reach;
        let place = match edge {
            Edge::Periodic => place.rem_euclid(length as isize),
            Edge::Open if place < 0 || place >= length as isize => continue,
            Edge::Open => place,
        };
        sum += w * value(place as usize);
        weight += w;
    }
    sum / weight
}
