//! Eigenvalues with their vectors.

use num_complex::Complex64;

/// Vectors that belong to eigenvalues, real ones stored as such and conjugate pairs once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Vectors {
    pub order: usize,
    /// Columns of numbers, one after the other.
    pub columns: Vec<f64>,
    /// For each eigenvalue the column of the real part, and that of the imaginary part with its sign.
    pub place: Vec<(usize, Option<(usize, f64)>)>,
}

impl Vectors {
    fn column(&self, index: usize) -> &[f64] {
        &self.columns[index * self.order..][..self.order]
    }

    fn get(&self, index: usize) -> Vec<Complex64> {
        let (real, imaginary) = self.place[index];
        match imaginary {
            None => self.column(real).iter().map(|&x| x.into()).collect(),
            Some((column, sign)) => {
                let parts = self.column(real).iter().zip(self.column(column));
                parts.map(|(&re, &im)| Complex64::new(re, sign * im)).collect()
            }
        }
    }

    pub fn push(&mut self, vector: &[Complex64]) {
        let column = self.columns.len() / self.order;
        self.columns.extend(vector.iter().map(|x| x.re));
        self.columns.extend(vector.iter().map(|x| x.im));
        self.place.push((column, Some((column + 1, 1.0))));
    }

    /// Adds the conjugate of the vector added last.
    pub fn push_conjugate(&mut self) {
        if let Some((real, imaginary)) = self.place.last().copied() {
            self.place.push((real, imaginary.map(|(column, sign)| (column, -sign))));
        }
    }
}

/// Eigenvalues of a real matrix, the largest real part first, with vectors of unit length.
///
/// Of a conjugate pair, where both were found, the value with the positive imaginary part comes first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Eigenpairs {
    /// λ
    pub values: Vec<Complex64>,
    pub(crate) right: Option<Vectors>,
    pub(crate) left: Option<Vectors>,
}

impl Eigenpairs {
    /// The right vector `A x = λ x` of the eigenvalue with this number, if vectors were asked for.
    pub fn right(&self, index: usize) -> Option<Vec<Complex64>> {
        Some(unit(self.right.as_ref()?.get(index)))
    }

    /// The left vector `yᴴ A = λ yᴴ`, if it was asked for.
    pub fn left(&self, index: usize) -> Option<Vec<Complex64>> {
        Some(unit(self.left.as_ref()?.get(index)))
    }

    /// Condition number `1/|yᴴ x|` of an eigenvalue, with unit vectors: 1 for a normal matrix, infinite where vectors
    /// coalesce. An error δA moves the eigenvalue by at most this times ‖δA‖, to first order. For an eigenvalue that occurs
    /// several times it depends on the choice of vectors.
    pub fn condition(&self, index: usize) -> Option<f64> {
        let (x, y) = (self.right(index)?, self.left(index)?);
        let product: Complex64 = x.iter().zip(&y).map(|(x, y)| y.conj() * x).sum();
        Some(1.0 / product.norm())
    }

    /// Brings all into the order of the real part.
    pub(crate) fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.values.len()).collect();
        let values = &self.values;
        order.sort_by(|&a, &b| {
            let (a, b) = (values[a], values[b]);
            b.re.total_cmp(&a.re).then(a.im.abs().total_cmp(&b.im.abs())).then(b.im.total_cmp(&a.im))
        });
        self.values = order.iter().map(|&index| values[index]).collect();
        for vectors in [&mut self.right, &mut self.left].into_iter().flatten() {
            vectors.place = order.iter().map(|&index| vectors.place[index]).collect();
        }
    }
}

/// A vector scaled to unit length.
pub(crate) fn unit(mut vector: Vec<Complex64>) -> Vec<Complex64> {
    let norm = norm(&vector);
    if norm > 0.0 {
        vector.iter_mut().for_each(|x| *x /= norm);
    }
    vector
}

pub(crate) fn norm(vector: &[Complex64]) -> f64 {
    vector.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}
