//! Gradients of a displacement field at the cells.

use voronudge_geometry::{Tessellation, Vector, cross, dot};
use voronudge_linalg::Complex64;
use voronudge_model::signs_of;

/// The affine map that fits the displacements of a cell's neighbours relative to it, for each cell that moves.
///
/// `G = Σ_n (u_n − u_0) ⊗ w_n` with `w_n = (Σ_m d_m ⊗ d_m)⁻¹ d_n` and the displacements `d_n` to the neighbours. It is exact
/// for affine fields. Mirror images move with their cells.
#[derive(Debug, Clone)]
pub(crate) struct Gradients {
    start: Vec<usize>,
    /// Number among the cells that move, if it does, what its displacement is multiplied by, as an image, and weight.
    neighbour: Vec<(Option<u32>, [f64; 2], Vector<f64>)>,
}

impl Gradients {
    pub fn new(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        cells: &[usize],
        number: &[Option<u32>],
        mirrors: &[usize],
    ) -> Self {
        let mut gradients = Self { start: vec![0], neighbour: Vec::new() };
        for &cell in cells {
            let ring = || tessellation.ring(cell);
            let across = |h: usize| tessellation.displacement(positions, cell, h);
            let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
            for d in ring().map(across) {
                xx += d.x * d.x;
                xy += d.x * d.y;
                yy += d.y * d.y;
            }
            let determinant = xx * yy - xy * xy;
            for h in ring() {
                let d = across(h);
                let weight = Vector::new(yy * d.x - xy * d.y, xx * d.y - xy * d.x) / determinant;
                let (image, cell) =
                    (tessellation.neighbour(h) / number.len(), tessellation.neighbour(h) % number.len());
                gradients.neighbour.push((number[cell], signs_of(image, mirrors), weight));
            }
            gradients.start.push(gradients.neighbour.len());
        }
        gradients
    }

    /// Sums over the cells of |div u|² and |curl u|². Cells that do not move have u = 0.
    pub fn divergence_and_curl(&self, u: &[Complex64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (own, range) in self.start.windows(2).enumerate() {
            let (mut divergence, mut curl) = (Complex64::ZERO, Complex64::ZERO);
            for &(number, signs, weight) in &self.neighbour[range[0]..range[1]] {
                let at = |axis: usize| {
                    let other = number.map_or(Complex64::ZERO, |number| u[2 * number as usize + axis]);
                    other * signs[axis] - u[2 * own + axis]
                };
                let (x, y) = (at(0), at(1));
                let (real, imaginary) = (Vector::new(x.re, y.re), Vector::new(x.im, y.im));
                divergence += Complex64::new(dot(weight, real), dot(weight, imaginary));
                curl += Complex64::new(cross(weight, real), cross(weight, imaginary));
            }
            sums[0] += divergence.norm_sqr();
            sums[1] += curl.norm_sqr();
        }
        sums
    }
}
