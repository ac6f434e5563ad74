//! Some eigenvalues of a large sparse matrix: those near a shift, and those with the largest real part.

use crate::arnoldi::{Preference, Ritz, Settings, arnoldi};
use crate::eigenpairs::{Vectors, norm, unit};
use crate::front_factor::Side;
use crate::number::Number;
use crate::sparse_lu::SparseLu;
use crate::{BlockSparse, Eigenpairs, Error, Wanted};
use num_complex::Complex64;

/// Residuals of the iteration that count as converged, relative to its largest eigenvalue.
const TOLERANCE: f64 = 1e-13;
/// Restarts after which the iteration gives up.
const RESTARTS: usize = 100;
/// The same without inversion, where it only has to find what sticks out of the spectrum.
const OUTWARD_RESTARTS: usize = 4;
/// Residuals ‖A x − λ x‖/‖A‖_∞ of what is taken for an eigenvalue.
pub const RESIDUAL_LIMIT: f64 = 1e-8;
/// Eigenvalues closer than this, relative to ‖A‖_∞, are one that was found twice.
const SAME: f64 = 1e-7;

/// Some eigenvalues and how well they are known.
#[derive(Debug, Clone, PartialEq)]
pub struct PartialEigenpairs {
    /// The eigenvalues, the largest real part first. Of a conjugate pair both are there.
    pub pairs: Eigenpairs,
    /// ‖A x − λ x‖/‖A‖_∞ for each, with unit x.
    pub residuals: Vec<f64>,
    /// Where the matrix was factorised.
    pub shift: Complex64,
    /// Every eigenvalue nearer to the shift than this is there, as far as the iteration can tell: a start vector that
    /// has no share in an eigenvector, or an eigenvalue that occurs several times, can hide some.
    pub reach: f64,
}

/// Where a computation stands: what is done, the step and the most steps there may be.
pub type Progress<'a> = dyn FnMut(&'static str, usize, usize) + Send + 'a;

/// The `count` eigenvalues nearest to a shift σ, by Arnoldi's method on `(A − σ 1)⁻¹`.
///
/// `places` are the places of the block rows in the plane, by which the matrix is dissected: coupled rows should be near
/// each other, or a period apart. A real shift costs half the memory of a complex one. Left vectors cost as much as right
/// ones again. Of an eigenvalue that occurs several times fewer may be found.
///
/// # Errors
/// [`Error::Malformed`] if there is not one place for each block row, [`Error::Singular`], [`Error::NoConvergence`].
///
/// ```
/// use voronudge_linalg::{BlockSparse, Complex64, Wanted, nearest};
/// let turn = |rate: f64| [0.0, -rate, rate, 0.0];
/// let matrix = BlockSparse::new(vec![0, 1, 2], vec![0, 1], vec![turn(1.0), turn(3.0)])?;
/// let places = [[0.0, 0.0], [1.0, 0.0]];
/// let found = nearest(&matrix, &places, Complex64::new(0.1, 2.8), 1, Wanted::Right, &mut |_, _, _| {})?;
/// assert!((found.pairs.values[0].im - 3.0).abs() < 1e-12);
/// # Ok::<(), voronudge_linalg::Error>(())
/// ```
pub fn nearest(
    matrix: &BlockSparse,
    places: &[[f64; 2]],
    shift: Complex64,
    count: usize,
    wanted: Wanted,
    progress: &mut Progress<'_>,
) -> Result<PartialEigenpairs, Error> {
    let search = Search { matrix, places, count, wanted };
    if shift.im == 0.0 {
        search.inverted::<f64>(shift, progress)
    } else {
        search.inverted::<Complex64>(shift, progress)
    }
}

/// The `count` eigenvalues with the largest real part, and one more where a conjugate pair would be cut.
///
/// Arnoldi's method on A itself finds those that stick out of the spectrum, also at high frequency, and tells where the
/// spectrum ends; that on `(A − σ 1)⁻¹`, σ just right of this end, those near the real axis, however crowded. Both are
/// merged. What neither can exclude is a mode inside the convex hull of the spectrum, further from σ than `reach`, whose
/// real part is nevertheless among the largest.
///
/// # Errors
/// As [`nearest`].
pub fn rightmost(
    matrix: &BlockSparse,
    places: &[[f64; 2]],
    count: usize,
    wanted: Wanted,
    progress: &mut Progress<'_>,
) -> Result<PartialEigenpairs, Error> {
    let search = Search { matrix, places, count, wanted };
    let outward = search.outward(progress)?;
    let end = outward.iter().map(|ritz| ritz.value.re).fold(f64::NEG_INFINITY, f64::max);
    let shift = end.max(0.0) + matrix.norm().max(f64::MIN_POSITIVE) / matrix.rows().max(1) as f64;
    let mut found = search.inverted::<f64>(shift.into(), progress)?;
    search.merge(&outward, &mut found);
    found.keep(count);
    Ok(found)
}

/// What is looked for.
struct Search<'a> {
    matrix: &'a BlockSparse,
    places: &'a [[f64; 2]],
    count: usize,
    wanted: Wanted,
}

impl Search<'_> {
    fn settings(&self, preference: Preference, restarts: usize) -> Settings {
        // One more, so that a conjugate pair at the end is seen.
        Settings { preference, count: self.count + 1, tolerance: TOLERANCE, restarts }
    }

    fn outward(&self, progress: &mut Progress<'_>) -> Result<Vec<Ritz>, Error> {
        let settings = self.settings(Preference::LargestRealPart, OUTWARD_RESTARTS);
        progress("end of the spectrum", 0, 100);
        let apply = &mut |x: &[f64], y: &mut [f64]| self.matrix.apply(x, y);
        arnoldi(self.matrix.order(), &settings, apply, &mut |done| {
            progress("end of the spectrum", done, 100);
        })
    }

    fn inverted<T: Number>(
        &self,
        shift: Complex64,
        progress: &mut Progress<'_>,
    ) -> Result<PartialEigenpairs, Error> {
        progress("factors", 0, 1);
        let scale = self.matrix.norm().max(f64::MIN_POSITIVE);
        let (lu, shift) = match SparseLu::<T>::new(self.matrix, shift, self.places) {
            // An eigenvalue was hit: beside it its neighbourhood looks the same.
            Err(Error::Singular) => {
                let beside = shift + 1e-9 * scale;
                (SparseLu::<T>::new(self.matrix, beside, self.places)?, beside)
            }
            other => (other?, shift),
        };
        let (right, left) = rayon::join(
            || self.solve_side(&lu, Side::AsGiven, progress),
            || match self.wanted {
                Wanted::RightAndLeft => self.solve_side(&lu, Side::Transposed, &mut |_, _, _| {}).map(Some),
                Wanted::Values | Wanted::Right => Ok(None),
            },
        );
        let (right, left) = (right?, left?);
        let order = self.matrix.order();
        let mut vectors = Vectors { order, ..Vectors::default() };
        let (mut values, mut residuals) = (Vec::new(), Vec::new());
        let mut reach = f64::INFINITY;
        for (k, ritz) in right.iter().enumerate() {
            let mut vector = unit(ritz.vector.clone());
            let (mut value, residual) = self.rayleigh(&vector);
            if residual > RESIDUAL_LIMIT {
                reach = reach.min(1.0 / ritz.value.norm());
                continue;
            }
            if shift.im == 0.0 {
                value = without_rounding(value, scale);
                // Pairs are entered with their member above the axis.
                let above = (shift + 1.0 / ritz.value).conj();
                let is_partner = |other: &Ritz| (shift + 1.0 / other.value - above).norm() <= SAME * scale;
                if value.im < 0.0 {
                    if right.iter().enumerate().any(|(other, ritz)| other != k && is_partner(ritz)) {
                        continue;
                    }
                    value = value.conj();
                    vector.iter_mut().for_each(|x| *x = x.conj());
                }
            }
            values.push(value);
            residuals.push(residual);
            vectors.push(&vector);
            if shift.im == 0.0 && value.im > 0.0 {
                values.push(value.conj());
                residuals.push(residual);
                vectors.push_conjugate();
            }
        }
        if values.is_empty() && order > 0 && self.count > 0 {
            return Err(Error::NoConvergence { order });
        }
        if right.len() < order {
            let furthest = right.iter().map(|ritz| 1.0 / ritz.value.norm()).fold(0.0, f64::max);
            reach = reach.min(furthest);
        }
        let mut pairs = Eigenpairs { values, right: Some(vectors), left: None };
        if let Some(left) = left {
            pairs.left = Some(self.left_vectors(&left, shift, &pairs.values)?);
        }
        let mut found = PartialEigenpairs { pairs, residuals, shift, reach };
        found.nearest_only(self.count);
        Ok(found)
    }

    fn solve_side<T: Number>(
        &self,
        lu: &SparseLu<T>,
        side: Side,
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Ritz>, Error> {
        let settings = self.settings(Preference::LargestMagnitude, RESTARTS);
        progress("modes", 0, 100);
        let solve = &mut |x: &[T], y: &mut [T]| {
            y.copy_from_slice(x);
            lu.solve(side, y);
        };
        arnoldi(self.matrix.order(), &settings, solve, &mut |done| progress("modes", done, 100))
    }

    /// Left vectors of eigenvalues: conjugates of the right vectors of the transposed matrix.
    fn left_vectors(
        &self,
        transposed: &[Ritz],
        shift: Complex64,
        values: &[Complex64],
    ) -> Result<Vectors, Error> {
        let order = self.matrix.order();
        let mut vectors = Vectors { order, ..Vectors::default() };
        for value in values {
            let distance = |ritz: &&Ritz| (shift + 1.0 / ritz.value - value).norm();
            let nearest = transposed.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let nearest = nearest.ok_or(Error::NoConvergence { order })?;
            let conjugate: Vec<Complex64> = nearest.vector.iter().map(Complex64::conj).collect();
            vectors.push(&unit(conjugate));
        }
        Ok(vectors)
    }

    /// `xᴴ A x` of a unit vector, and its residual relative to the norm of the matrix.
    fn rayleigh(&self, x: &[Complex64]) -> (Complex64, f64) {
        let mut product = vec![Complex64::ZERO; x.len()];
        self.matrix.apply(x, &mut product);
        let value: Complex64 = x.iter().zip(&product).map(|(x, y)| x.conj() * y).sum();
        product.iter_mut().zip(x).for_each(|(y, x)| *y -= value * x);
        (value, norm(&product) / self.matrix.norm().max(f64::MIN_POSITIVE))
    }

    /// Adds what only the iteration without inversion found.
    fn merge(&self, outward: &[Ritz], found: &mut PartialEigenpairs) {
        let same = SAME * self.matrix.norm();
        for ritz in outward {
            let vector = unit(ritz.vector.clone());
            let (value, residual) = self.rayleigh(&vector);
            let value = without_rounding(value, self.matrix.norm());
            let known = found.pairs.values.iter().any(|other| (other - value).norm() <= same);
            if residual > RESIDUAL_LIMIT || known || value.im < 0.0 {
                continue;
            }
            let members = if value.im > 0.0 { 2 } else { 1 };
            found.pairs.values.extend([value, value.conj()].into_iter().take(members));
            found.residuals.extend([residual; 2].into_iter().take(members));
            // No left vector is known.
            let missing = vec![Complex64::new(f64::NAN, f64::NAN); vector.len()];
            for (vectors, own) in [(&mut found.pairs.right, &vector), (&mut found.pairs.left, &missing)] {
                if let Some(vectors) = vectors {
                    vectors.push(own);
                    (1..members).for_each(|_| vectors.push_conjugate());
                }
            }
        }
    }
}

/// A value whose imaginary part is rounding is real.
fn without_rounding(value: Complex64, scale: f64) -> Complex64 {
    if value.im.abs() <= 1e-13 * scale { value.re.into() } else { value }
}

impl PartialEigenpairs {
    /// Keeps the eigenvalues for which a condition holds.
    pub fn retain(&mut self, kept: impl Fn(Complex64) -> bool) {
        self.choose(
            &(0..self.pairs.values.len()).filter(|&k| kept(self.pairs.values[k])).collect::<Vec<_>>(),
        );
    }

    /// Those with these numbers, in their order.
    fn choose(&mut self, order: &[usize]) {
        self.pairs.values = order.iter().map(|&k| self.pairs.values[k]).collect();
        self.residuals = order.iter().map(|&k| self.residuals[k]).collect();
        for vectors in [&mut self.pairs.right, &mut self.pairs.left].into_iter().flatten() {
            vectors.place = order.iter().map(|&k| vectors.place[k]).collect();
        }
    }

    /// Sorts by the real part and keeps the first, with the partner of the last.
    fn keep(&mut self, count: usize) {
        self.sort();
        let mut length = count.min(self.pairs.values.len());
        if let (Some(last), Some(next)) = (length.checked_sub(1), self.pairs.values.get(length)) {
            let last = self.pairs.values[last];
            length += usize::from(last.im > 0.0 && *next == last.conj());
        }
        self.pairs.values.truncate(length);
        self.residuals.truncate(length);
        for vectors in [&mut self.pairs.right, &mut self.pairs.left].into_iter().flatten() {
            vectors.place.truncate(length);
        }
    }

    fn sort(&mut self) {
        // Residuals follow their values.
        let before = self.pairs.values.clone();
        let residuals = self.residuals.clone();
        self.pairs.sort();
        let mut used = vec![false; before.len()];
        for (value, residual) in self.pairs.values.iter().zip(&mut self.residuals) {
            if let Some(at) = (0..before.len()).find(|&k| !used[k] && before[k] == *value) {
                used[at] = true;
                *residual = residuals[at];
            }
        }
    }

    /// Keeps those nearest to the shift, with the partner of the last.
    fn nearest_only(&mut self, count: usize) {
        let distances: Vec<f64> = self.pairs.values.iter().map(|value| (value - self.shift).norm()).collect();
        let mut order: Vec<usize> = (0..distances.len()).collect();
        order.sort_by(|&a, &b| distances[a].total_cmp(&distances[b]).then(a.cmp(&b)));
        let member = |at: Option<usize>| Some(self.pairs.values[*order.get(at?)?]);
        let pair = member(count.checked_sub(1)).zip(member(Some(count)));
        let cut = pair.is_some_and(|(last, next)| last.im != 0.0 && next == last.conj());
        order.truncate(count + usize::from(cut));
        self.choose(&order);
        self.sort();
    }
}
