//! Whether cells differ at all: the score of a variance at nought.
//!
//! The derivative of the restricted likelihood by `s_q²` at `s_q = 0` is half of `yᵀPZZᵀPy / σ_v² − tr ZᵀPZ`, in units of 1/σ_v². Where
//! other variances are estimated, their scores are nought, and what varies is the part of `ZZᵀ` that is orthogonal to what those variances
//! multiply, `⟨A, B⟩ = tr(P A P B)`: W itself, JJᵀ/k, and ZZᵀ of other parameters. Products with JJᵀ/k are derivatives by log k. The statistic is a
//! quadratic form in normal variables; a gamma distribution with its first three moments is its null distribution.

use super::columns::Layout;
use super::gram::Gram;
use super::levels::Variances;
use crate::{Error, KnownNoise};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Gamma};

/// `ZᵀPZ` and `ZᵀPy` where the parameters of other cells vary.
struct Beside {
    of_cells: DMatrix<f64>,
    data: DVector<f64>,
    /// log det V + log det XᵀV⁻¹X, less what is σ_v's
    log_determinant: f64,
    misfit: f64,
}

impl Beside {
    fn new(gram: &Gram, at: &Variances, layout: &Layout) -> Result<Self, Error> {
        let products = &gram.reduced;
        let roots = at.roots(layout);
        let active: Vec<usize> =
            (0..layout.order()).filter(|i| at.of_cells[i / layout.cells].is_some()).collect();
        let across = DMatrix::from_fn(layout.order(), active.len(), |i, j| {
            products.of_cells[(i, active[j])] * roots[active[j]]
        });
        let data = DVector::from_fn(active.len(), |j, _| products.data[active[j]] * roots[active[j]]);
        let scaled = DMatrix::from_fn(active.len(), active.len(), |i, j| {
            roots[active[i]] * across[(active[i], j)] + if i == j { 1.0 } else { 0.0 }
        });
        let factor = scaled.cholesky().ok_or(Error::Degenerate)?;
        let solved = factor.solve(&data);
        Ok(Self {
            of_cells: &products.of_cells - &across * factor.solve(&across.transpose()),
            data: &products.data - &across * &solved,
            log_determinant: products.log_determinant + factor.ln_determinant(),
            misfit: products.misfit - data.dot(&solved),
        })
    }
}

/// What is asked.
pub(super) struct Question<'a> {
    pub layout: &'a Layout,
    /// The parameter in which cells may differ.
    pub parameter: usize,
    /// Variances without that.
    pub at: &'a Variances,
    pub known: KnownNoise,
    /// n − p
    pub left: f64,
}

impl Question<'_> {
    /// The probability of a score as great or greater if cells do not differ in the parameter. `grams` are at three values of log k, the
    /// most likely one in the middle.
    pub fn p_value(&self, grams: &[Gram; 3]) -> Result<f64, Error> {
        let [below, here, above] = [0, 1, 2].map(|i| Beside::new(&grams[i], self.at, self.layout));
        let (below, here, above) = (below?, here?, above?);
        let step = 0.5 * (grams[2].log_k - grams[0].log_k);
        let own = self.layout.block(self.parameter);
        let own = (own.start, own.len());
        let form = |of: &Beside| of.of_cells.view((own.0, own.0), (own.1, own.1)).into_owned();
        let central = |f: &dyn Fn(&Beside) -> f64| (f(&above) - f(&below)) / (2.0 * step);
        let bend = |f: &dyn Fn(&Beside) -> f64| (f(&above) - 2.0 * f(&here) + f(&below)) / (step * step);
        let (form_here, slope) = (form(&here), (form(&above) - form(&below)) / (2.0 * step));
        let log_determinant = |of: &Beside| of.log_determinant;
        // tr(I − P) and tr((I − P)²) in the coordinates in which V is one.
        let first = -central(&log_determinant);
        let second = first - bend(&log_determinant);
        let others: Vec<usize> = (0..self.at.of_cells.len())
            .filter(|q| *q != self.parameter && self.at.of_cells[*q].is_some())
            .collect();
        let trace = |of: &Beside, q: usize| {
            let block = self.layout.block(q);
            block.map(|i| of.of_cells[(i, i)]).sum::<f64>()
        };
        let norm = |q: usize, r: usize| {
            let (q, r) = (self.layout.block(q), self.layout.block(r));
            here.of_cells.view((q.start, r.start), (q.len(), r.len())).norm_squared()
        };
        // Products of V and of JJᵀ/k with each other and with the form of a parameter.
        let basic = [[self.left, first], [first, second]];
        let with = |q: usize| [trace(&here, q), central(&|of: &Beside| trace(of, q))];
        // What multiplies variances that are estimated, in terms of V and JJᵀ/k.
        let estimated: Vec<[f64; 2]> = match (self.known.velocity, self.known.position) {
            (None, None) => vec![[1.0, 0.0], [0.0, 1.0]],
            (Some(_), None) => vec![[0.0, 1.0]],
            (None, Some(_)) => vec![[1.0, -1.0]],
            (Some(_), Some(_)) => Vec::new(),
        };
        let (e, n) = (estimated.len(), estimated.len() + others.len());
        let dot = |a: &[f64; 2], b: &[f64; 2]| a[0] * b[0] + a[1] * b[1];
        let products = DMatrix::from_fn(n, n, |i, j| match (i < e, j < e) {
            (true, true) => {
                dot(&estimated[i], &[dot(&basic[0], &estimated[j]), dot(&basic[1], &estimated[j])])
            }
            (true, false) => dot(&estimated[i], &with(others[j - e])),
            (false, true) => dot(&estimated[j], &with(others[i - e])),
            (false, false) => norm(others[i - e], others[j - e]),
        });
        let right = DVector::from_fn(n, |i, _| match i < e {
            true => dot(&estimated[i], &with(self.parameter)),
            false => norm(others[i - e], self.parameter),
        });
        let share = match n {
            0 => DVector::zeros(0),
            _ => products.lu().solve(&right).ok_or(Error::Degenerate)?,
        };
        let whole = norm(self.parameter, self.parameter);
        let variance = 2.0 * (whole - share.dot(&right));
        if variance.is_nan() || variance <= 1e-9 * whole {
            // Nothing tells this parameter from the others.
            return Ok(1.0);
        }
        // The form less c_V V + c_J JJᵀ/k; forms of other parameters are left out of the third moment.
        let c = (0..e).fold([0.0; 2], |sum, i| {
            [sum[0] + share[i] * estimated[i][0], sum[1] + share[i] * estimated[i][1]]
        });
        let square = &form_here * &form_here;
        let [of_own, of_slope] = with(self.parameter);
        let of_bend = 0.5 * (bend(&|of: &Beside| trace(of, self.parameter)) + of_slope);
        let third = square.dot(&form_here) - 3.0 * (c[0] * whole + c[1] * square.dot(&slope))
            + 3.0 * (c[0] * c[0] * of_own + 2.0 * c[0] * c[1] * of_slope + c[1] * c[1] * of_bend)
            - (c[0].powi(3) * self.left
                + 3.0 * c[0] * c[0] * c[1] * first
                + 3.0 * c[0] * c[1] * c[1] * second
                + c[1].powi(3) * second * second / first.max(1e-9));
        let velocity = match self.known.velocity {
            Some(velocity) => velocity * velocity,
            None => here.misfit / self.left,
        };
        let score = here.data.rows(own.0, own.1).norm_squared() / velocity - of_own;
        Ok(beyond(score / variance.sqrt(), 8.0 * third / variance.powf(1.5)))
    }
}

/// Upper tail of a standardised gamma distribution of some skewness.
fn beyond(score: f64, skewness: f64) -> f64 {
    let skewness = skewness.max(1e-3);
    let shape = 4.0 / (skewness * skewness);
    Gamma::new(shape, 1.0).map_or(f64::NAN, |gamma| gamma.sf((shape + score * shape.sqrt()).max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// χ² with few degrees of freedom is a gamma distribution; almost no skewness makes it normal.
    #[test]
    fn tails_are_those_of_the_gamma_distribution() {
        let degrees: f64 = 4.0;
        let at = (9.487_729 - degrees) / (2.0 * degrees).sqrt();
        assert!((beyond(at, (8.0 / degrees).sqrt()) - 0.05).abs() < 1e-6);
        assert!((beyond(1.644_854, 0.0) - 0.05).abs() < 1e-3);
    }
}
