//! Velocities on a grid: every pixel moves with the cell whose site is nearest, and a window is an average over pixels.

use super::film::{Film, root_mean_square};
use ndarray::Array3;
use rand_distr::{Distribution, Normal, NormalError};
use rand_pcg::Pcg64;
use voronudge_geometry::Vector;

/// Pixels along ℓ₀.
const PIXELS: f64 = 16.0;
/// Pixels between grid points: a spacing of half ℓ₀.
const SPACING: usize = 8;
/// Reach of a Gaussian in standard deviations.
const REACH: f64 = 4.0;

/// How much of the surroundings a grid point averages over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Window {
    /// Weights of a Gaussian of this standard deviation in ℓ₀.
    Gaussian(f64),
    /// A square of this side in grid spacings.
    Square(f64),
}

/// A flow field of the first frame.
pub(super) struct Flow {
    /// Of the columns, and of the rows.
    pub coordinates: Vec<f64>,
    /// (rows, columns, 2)
    pub velocities: Array3<f64>,
}

/// The flow field seen through a window, with independent errors of this share of its root mean square.
pub(super) fn measure(film: &Film, window: Window, noise: f64, rng: &mut Pcg64) -> Result<Flow, NormalError> {
    let [side, _] = film.cell_box.lengths();
    let pixels = (side * PIXELS).round() as usize;
    let picture = picture(film, pixels);
    let weights = window.weights();
    // Windows are products of a function of x and one of y.
    let along_x =
        |row: usize, column: usize| average(&weights, column, pixels, |x| picture[row * pixels + x]);
    let points = pixels / SPACING;
    let at = |k: usize| k * SPACING + SPACING / 2;
    let averaged: Vec<Vec<Vector<f64>>> =
        (0..points).map(|k| (0..pixels).map(|row| along_x(row, at(k))).collect()).collect();
    let mut flow: Vec<Vector<f64>> = (0..points * points)
        .map(|k| average(&weights, at(k / points), pixels, |y| averaged[k % points][y]))
        .collect();
    let error = Normal::new(0.0, noise * root_mean_square(&flow))?;
    flow.iter_mut().for_each(|v| *v += Vector::new(error.sample(rng), error.sample(rng)));
    // The middle of a pixel is half a pixel from its corner.
    let coordinates = (0..points).map(|k| (at(k) as f64 + 0.5) / PIXELS).collect();
    let component = |(row, column, axis): (usize, usize, usize)| flow[row * points + column][axis];
    Ok(Flow { coordinates, velocities: Array3::from_shape_fn((points, points, 2), component) })
}

/// The velocity of each pixel, row after row.
fn picture(film: &Film, pixels: usize) -> Vec<Vector<f64>> {
    let frame = &film.frames[0];
    let centre = |k: usize| (k as f64 + 0.5) / PIXELS;
    (0..pixels * pixels)
        .map(|pixel| {
            let point = Vector::new(centre(pixel % pixels), centre(pixel / pixels));
            let distance = |cell: &usize| film.cell_box.shortest(point - frame.sites[*cell]).norm_squared();
            let nearest = (0..frame.sites.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            nearest.map_or(Vector::zeros(), |cell| frame.velocities[cell])
        })
        .collect()
}

impl Window {
    /// Weights of the pixels along one axis by their offset, from the most negative one on, of an odd number.
    fn weights(self) -> Vec<f64> {
        let reach = match self {
            Self::Gaussian(width) => REACH * width * PIXELS,
            Self::Square(side) => 0.5 * side * SPACING as f64,
        };
        let reach = reach.round() as i64;
        let weight = |offset: i64| match self {
            Self::Gaussian(width) => (-0.5 * (offset as f64 / (width * PIXELS)).powi(2)).exp(),
            // The outermost pixels are halved, so that the square is centred.
            Self::Square(_) if offset.abs() == reach => 0.5,
            Self::Square(_) => 1.0,
        };
        let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / sum).collect()
    }
}

/// A weighted average over a line of pixels that closes on itself.
fn average(
    weights: &[f64],
    middle: usize,
    pixels: usize,
    value: impl Fn(usize) -> Vector<f64>,
) -> Vector<f64> {
    let first = (middle + pixels * (1 + weights.len() / pixels)) - weights.len() / 2;
    weights.iter().enumerate().map(|(k, weight)| value((first + k) % pixels) * *weight).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_their_widths() {
        let spread = |window: Window| {
            let weights = window.weights();
            let middle = (weights.len() / 2) as f64;
            let moment: f64 = weights.iter().enumerate().map(|(k, w)| w * (k as f64 - middle).powi(2)).sum();
            moment.sqrt() / PIXELS
        };
        assert!((spread(Window::Gaussian(0.5)) - 0.5).abs() < 1e-3);
        let side = 1.5 * SPACING as f64 / PIXELS;
        assert!((spread(Window::Square(1.5)) - side / 12f64.sqrt()).abs() < 2e-3);
    }

    #[test]
    fn an_average_closes_on_itself() {
        let weights = Window::Square(1.5).weights();
        let mean = average(&weights, 1, 40, |x| Vector::new(if x < 20 { 1.0 } else { 0.0 }, 1.0));
        assert!((mean.y - 1.0).abs() < 1e-12);
        // From -5 to 7: half of the last of 13 pixels, and those from 0 to 6.
        assert!((mean.x - 7.5 / 12.0).abs() < 1e-12, "{}", mean.x);
    }
}
