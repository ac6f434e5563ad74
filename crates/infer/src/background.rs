//! A smooth flow that is no concern of the model: a stage, a pump, a boundary far away.
//!
//! Each frame may have a background `Σ_m b_m f_m(x, y)` of all polynomials up to a degree, with coefficients of its own.
//! Least squares over them is a projection: with the projector Q onto what no polynomial describes, residuals are
//! `Q (v − F)` and columns `Q X`.

use voronudge_geometry::Vector;

/// Orthonormal polynomials over the places of a frame's targets.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Background {
    /// Each over the targets, in their order.
    functions: Vec<Vec<f64>>,
}

impl Background {
    /// All monomials `x^a y^b` with `a + b ≤ degree`, made orthonormal over the places.
    pub fn new(places: &[Vector<f64>], degree: u32) -> Self {
        let count = places.len().max(1) as f64;
        let middle: Vector<f64> = places.iter().sum::<Vector<f64>>() / count;
        let size = (places.iter().map(|r| (r - middle).norm_squared()).sum::<f64>() / count).sqrt();
        let mut functions: Vec<Vec<f64>> = Vec::new();
        for (a, b) in (0..=degree).flat_map(|order| (0..=order).map(move |b| (order - b, b))) {
            let value = |r: &Vector<f64>| {
                let d = (r - middle) / size;
                d.x.powi(a as i32) * d.y.powi(b as i32)
            };
            let mut function: Vec<f64> = places.iter().map(value).collect();
            let before = norm(&function);
            // The second pass removes what rounding leaves after the first.
            for other in functions.iter().chain(&functions) {
                let share: f64 = function.iter().zip(other).map(|(f, o)| f * o).sum();
                function.iter_mut().zip(other).for_each(|(f, o)| *f -= share * o);
            }
            let after = norm(&function);
            if after > 1e-9 * before {
                function.iter_mut().for_each(|f| *f /= after);
                functions.push(function);
            }
        }
        Self { functions }
    }

    /// Number of coefficients: two for each polynomial.
    pub fn dimension(&self) -> usize {
        2 * self.functions.len()
    }

    /// Removes the background from a field over the targets.
    pub fn remove(&self, field: &mut [Vector<f64>]) {
        for function in &self.functions {
            let share: Vector<f64> = field.iter().zip(function).map(|(v, f)| v * *f).sum();
            field.iter_mut().zip(function).for_each(|(v, f)| *v -= share * *f);
        }
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_vanish_and_what_is_left_stays() {
        let places: Vec<Vector<f64>> =
            (0..60).map(|i| Vector::new(100.0 + (f64::from(i) * 1.7).sin(), f64::from(i % 7))).collect();
        let background = Background::new(&places, 2);
        assert_eq!(background.dimension(), 12);
        let mut field: Vec<Vector<f64>> =
            places.iter().map(|r| Vector::new(1.0 + r.x * r.y, 3.0 - r.y + 0.5 * r.x * r.x)).collect();
        background.remove(&mut field);
        assert!(field.iter().all(|v| v.norm() < 1e-8));
        let mut rough: Vec<Vector<f64>> =
            (0..60).map(|i| Vector::new((7.0 * f64::from(i)).sin(), (5.0 * f64::from(i)).cos())).collect();
        background.remove(&mut rough);
        let once = rough.clone();
        background.remove(&mut rough);
        assert!(rough.iter().zip(&once).all(|(a, b)| (a - b).norm() < 1e-12));
        assert!(rough.iter().any(|v| v.norm() > 0.5));
    }
}
