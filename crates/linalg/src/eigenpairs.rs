//! Eigenvalues with their vectors.

use crate::number::Number;
use crate::small_matrix::smallest_singular_value;
use faer::ColRef;
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

/// Eigenvalues of a matrix, the largest real part first, with vectors of unit length.
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
    /// coalesce. An error δA moves the eigenvalue by at most this times ‖δA‖, to first order.
    ///
    /// Eigenvalues within `same` of it count as one that occurs several times; then it is the norm of the projector on
    /// all their vectors. `None` if these are not independent to rounding, or vectors were not asked for.
    pub fn condition(&self, index: usize, same: f64) -> Option<f64> {
        let (right, left) = (self.right.as_ref()?, self.left.as_ref()?);
        let members: Vec<usize> =
            (0..self.values.len()).filter(|&other| self.is_same(index, other, same)).collect();
        let basis = |vectors: &Vectors| {
            let basis = orthonormal(members.iter().map(|&member| vectors.get(member)), INDEPENDENT);
            (basis.len() == members.len()).then_some(basis)
        };
        let (x, y) = (basis(right)?, basis(left)?);
        let product = |row: usize, column: usize| inner(&y[row], &x[column]);
        let smallest = if x.len() == 1 && y.len() == 1 {
            product(0, 0).norm()
        } else {
            smallest_singular_value(y.len(), x.len(), product)?
        };
        Some(1.0 / smallest)
    }

    /// Whether two eigenvalues are one that occurs several times, to a tolerance.
    pub fn is_same(&self, one: usize, other: usize, tolerance: f64) -> bool {
        one == other || (self.values[one] - self.values[other]).norm() <= tolerance
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

/// Share of a unit vector that the others do not span, from which it counts as independent.
const INDEPENDENT: f64 = 1e-4;

/// `aᴴ b`
fn inner(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a.conj() * b).sum()
}

/// Orthonormal vectors that span the same space, without those of which less than the share `independent` is new.
pub(crate) fn orthonormal(
    vectors: impl Iterator<Item = Vec<Complex64>>,
    independent: f64,
) -> Vec<Vec<Complex64>> {
    let mut basis: Vec<Vec<Complex64>> = Vec::new();
    for vector in vectors {
        let mut vector = unit(vector);
        for _ in 0..2 {
            for known in &basis {
                let share = inner(known, &vector);
                vector.iter_mut().zip(known).for_each(|(x, v)| *x -= share * v);
            }
        }
        // NaN stays, and tells that a vector is missing.
        let size = norm(&vector);
        if size > independent || size.is_nan() {
            basis.push(vector.into_iter().map(|x| x / size).collect());
        }
    }
    basis
}

/// A vector scaled to unit length.
pub(crate) fn unit(mut vector: Vec<Complex64>) -> Vec<Complex64> {
    let norm = norm(&vector);
    if norm > 0.0 {
        vector.iter_mut().for_each(|x| *x /= norm);
    }
    vector
}

pub(crate) fn norm<T: Number>(vector: &[T]) -> f64 {
    ColRef::from_slice(vector).norm_l2()
}
