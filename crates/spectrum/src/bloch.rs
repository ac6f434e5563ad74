//! The periodic tissue beside a strip: its matrix as a function of one complex phase factor, winding numbers, and the generalised
//! Brillouin zone.

use crate::Error;
use voronudge_linalg::{Complex64, eigen_complex};

/// `J(β) = Σ_m J_m β^m` at one wave number along the rows: what acts on waves `u β^r exp(i q y)`, where `r` counts rows from the left to the
/// right. On the circle `|β| = 1` it is `−D(q)` of the honeycomb.
#[derive(Debug, Clone, PartialEq)]
pub struct BlochMatrix {
    /// `J_m` from `m = −range` on: entries (xx, xy, yx, yy), 1/time.
    blocks: Vec<[Complex64; 4]>,
}

/// Magnitudes of the two roots `β_M`, `β_{M+1}` of `det(J(β) − λ) = 0` that decide about a mode of a strip, as growth per row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MiddleRoots {
    /// `ln |β_M|`: the slowest decay of what is fixed at the left end.
    pub below: f64,
    /// `ln |β_{M+1}|`: that of what is fixed at the right end.
    pub above: f64,
}

impl MiddleRoots {
    /// `½ ln |β_M β_{M+1}|`. Both magnitudes are equal on the generalised Brillouin zone, where the values of a long strip are: there this is how the mode
    /// grows per row. Its localisation length is the inverse, in rows, of its magnitude.
    pub fn growth(&self) -> f64 {
        0.5 * (self.below + self.above)
    }

    /// `ln |β_{M+1}/β_M|`: it vanishes as one over the length of a strip for modes that fill it, and stays for those of an edge.
    pub fn gap(&self) -> f64 {
        self.above - self.below
    }
}

/// Coefficients below this share of the largest are rounding.
const ROUNDING: f64 = 1e-11;

/// Roots whose magnitudes have smaller logarithms are on the unit circle.
const ON_CIRCLE: f64 = 1e-8;

/// Newton steps on roots that the QR algorithm found.
const POLISH: usize = 3;

impl BlochMatrix {
    /// From `J_m`, `m = −range … range`, entries (xx, xy, yx, yy).
    pub fn new(blocks: Vec<[Complex64; 4]>) -> Self {
        Self { blocks }
    }

    /// How many rows away the farthest row is that a row feels.
    pub fn range(&self) -> usize {
        self.blocks.len() / 2
    }

    /// `J(β)`, entries (xx, xy, yx, yy).
    pub fn at(&self, beta: Complex64) -> [Complex64; 4] {
        let mut sum = [Complex64::ZERO; 4];
        let mut power = beta.powi(-(self.range() as i32));
        for block in &self.blocks {
            sum.iter_mut().zip(block).for_each(|(sum, entry)| *sum += entry * power);
            power *= beta;
        }
        sum
    }

    /// Both eigenvalues of `J(β)`, that with the larger imaginary part first.
    pub fn eigenvalues(&self, beta: Complex64) -> [Complex64; 2] {
        let [xx, xy, yx, yy] = self.at(beta);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let root = (half * half + xy * yx).sqrt();
        if root.im < 0.0 { [mean - root, mean + root] } else { [mean + root, mean - root] }
    }

    /// Coefficients of `det(J(β) − λ)` by rising powers of β, without those that are rounding, and the power of the first.
    fn characteristic(&self, value: Complex64) -> (i32, Vec<Complex64>) {
        let range = self.range();
        let entry = |which: usize| -> Vec<Complex64> {
            let own = |(m, block): (usize, &[Complex64; 4])| match which {
                0 | 3 if m == range => block[which] - value,
                _ => block[which],
            };
            self.blocks.iter().enumerate().map(own).collect()
        };
        let [xx, xy, yx, yy] = [0, 1, 2, 3].map(entry);
        let mut coefficients = vec![Complex64::ZERO; 4 * range + 1];
        for a in 0..self.blocks.len() {
            for b in 0..self.blocks.len() {
                coefficients[a + b] += xx[a] * yy[b] - xy[a] * yx[b];
            }
        }
        let largest = coefficients.iter().map(|c| c.norm()).fold(0.0, f64::max);
        let counts = |c: &Complex64| c.norm() > ROUNDING * largest;
        let (first, last) = (coefficients.iter().position(counts), coefficients.iter().rposition(counts));
        match (first, last) {
            (Some(first), Some(last)) => {
                (first as i32 - 2 * range as i32, coefficients[first..=last].to_vec())
            }
            _ => (0, Vec::new()),
        }
    }

    /// The order of the pole of `det(J(β) − λ)` at β = 0 and its roots by rising magnitude.
    ///
    /// # Errors
    /// [`Error::LinearAlgebra`] if a matrix is not finite.
    pub fn roots(&self, value: Complex64) -> Result<(i32, Vec<Complex64>), Error> {
        let (lowest, coefficients) = self.characteristic(value);
        let mut roots = roots(&coefficients)?;
        roots.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        Ok((-lowest, roots))
    }

    /// How many times `det(J(β) − λ₀)` runs around zero, anticlockwise, while β runs once around the unit circle, that is, while the wave number across the
    /// rows runs through the Brillouin zone: roots less poles within the circle. Where it is not zero the modes of a strip with open
    /// ends pile up, at the left end if it is positive. A value of the periodic tissue itself, where it is not defined, has the mean of what is on both
    /// sides.
    ///
    /// # Errors
    /// As [`BlochMatrix::roots`].
    pub fn winding(&self, value: Complex64) -> Result<i32, Error> {
        let (pole, roots) = self.roots(value)?;
        let count =
            |within: fn(f64) -> bool| roots.iter().filter(|root| within(root.norm().ln())).count() as i32;
        let (inside, on) = (count(|growth| growth < -ON_CIRCLE), count(|growth| growth.abs() <= ON_CIRCLE));
        Ok(inside + on / 2 - pole)
    }

    /// The roots that decide about a mode with the value λ of a strip with open ends; `None` if there are not as many.
    ///
    /// # Errors
    /// As [`BlochMatrix::roots`].
    pub fn middle_roots(&self, value: Complex64) -> Result<Option<MiddleRoots>, Error> {
        let (pole, roots) = self.roots(value)?;
        let Some(above) = usize::try_from(pole).ok().filter(|&m| m > 0 && m < roots.len()) else {
            return Ok(None);
        };
        let growth = |which: usize| roots[which].norm().ln();
        Ok(Some(MiddleRoots { below: growth(above - 1), above: growth(above) }))
    }
}

/// The roots of a polynomial with coefficients by rising powers, of which the last is not zero: eigenvalues of its companion matrix, improved.
fn roots(coefficients: &[Complex64]) -> Result<Vec<Complex64>, Error> {
    let degree = coefficients.len().saturating_sub(1);
    let Some(&leading) = coefficients.last().filter(|_| degree > 0) else {
        return Ok(Vec::new());
    };
    let mut companion = vec![Complex64::ZERO; degree * degree];
    for row in 0..degree {
        companion[row * degree + degree - 1] = -coefficients[row] / leading;
        if row > 0 {
            companion[row * degree + row - 1] = Complex64::ONE;
        }
    }
    let mut roots = eigen_complex(&companion, degree, false)?.values;
    for root in &mut roots {
        for _ in 0..POLISH {
            let mut value = Complex64::ZERO;
            let mut slope = Complex64::ZERO;
            for c in coefficients.iter().rev() {
                slope = slope * *root + value;
                value = value * *root + c;
            }
            let step = value / slope;
            // At a root that occurs twice the step is of no use.
            if !(step.is_finite() && step.norm() < 0.1 * root.norm()) {
                break;
            }
            *root -= step;
        }
    }
    Ok(roots)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model of Hatano and Nelson, hopping a to the left and b to the right, beside a second chain with the opposite: β² = b/a.
    #[test]
    fn the_hatano_nelson_chain_is_known() {
        let (left, right) = (1.5, 0.6);
        let pair = |x: f64, y: f64| [x.into(), Complex64::ZERO, Complex64::ZERO, Complex64::from(y)];
        // The second value is far away.
        let chain = BlochMatrix::new(vec![pair(right, 0.0), pair(0.0, -50.0), pair(left, 0.0)]);
        let inside = Complex64::new(0.3, 0.2);
        // J(β) = a β + b/β runs anticlockwise around what is inside the ellipse, once.
        assert_eq!(chain.winding(inside).unwrap(), 1);
        assert_eq!(chain.winding(Complex64::new(3.0, 0.0)).unwrap(), 0);
        // Values of the open chain, 2 √(ab) cos k, have modes (b/a)^{r/2}.
        let value = Complex64::from(2.0 * (left * right).sqrt() * 0.3);
        let middle = chain.middle_roots(value).unwrap().unwrap();
        assert!((middle.growth() - 0.5 * (right / left).ln()).abs() < 1e-12 && middle.gap().abs() < 1e-12);
        let [upper, lower] = chain.eigenvalues(Complex64::I);
        assert!((upper - Complex64::new(0.0, left - right)).norm() < 1e-14);
        assert!((lower + 50.0).norm() < 1e-12);
    }

    #[test]
    fn roots_are_those_of_the_factors() {
        let known = [Complex64::new(0.01, 0.0), Complex64::new(-1.0, 2.0), Complex64::new(30.0, -4.0)];
        let mut coefficients = vec![Complex64::new(2.0, 1.0)];
        for root in known {
            let mut next = vec![Complex64::ZERO; coefficients.len() + 1];
            for (power, c) in coefficients.iter().enumerate() {
                next[power + 1] += c;
                next[power] -= c * root;
            }
            coefficients = next;
        }
        let found = roots(&coefficients).unwrap();
        for root in known {
            assert!(found.iter().any(|other| (other - root).norm() < 1e-12 * root.norm()));
        }
        assert!(roots(&[Complex64::ONE]).unwrap().is_empty());
    }
}
