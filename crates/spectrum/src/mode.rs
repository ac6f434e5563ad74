//! One mode and what it is like.

use voronudge_linalg::Complex64;

/// What the amplitude of a mode does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Growth {
    /// It decays.
    Decaying,
    /// It grows.
    Growing,
    /// It does neither, to the tolerance.
    Neutral,
}

/// A mode `u exp(λ t)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// λ: rate of growth and angular frequency.
    pub value: Complex64,
    /// ‖J u − λ u‖/‖J‖_∞ where the mode was searched for; `None` of the QR algorithm.
    pub residual: Option<f64>,
    /// Share of the cells that take part, `(Σ |u_i|²)²/(N Σ |u_i|⁴)`: 1 if all move alike, 1/N if one moves.
    pub participation: Option<f64>,
    /// Share of the divergence in the gradients, `Σ |div u|²/Σ (|div u|² + |curl u|²)`: 1 for a longitudinal wave, 0 for a
    /// transverse one. `None` also for translations, which have no gradient.
    pub longitudinal: Option<f64>,
    /// Condition number `1/|yᴴ u|` with the left vector y: 1 where modes are orthogonal, infinite at an exceptional point,
    /// where two modes coalesce. For a value that occurs several times, the norm of the projector on its modes,
    /// if they are independent to rounding.
    pub condition: Option<f64>,
    /// Overlap `|u'ᴴ u|` with the mode of the nearest other value: 1 where they coalesce. Conjugate pairs count.
    pub overlap: Option<f64>,
}

impl Mode {
    /// What the amplitude does, with rates up to `tolerance` taken for none.
    pub fn growth(&self, tolerance: f64) -> Growth {
        if self.value.re > tolerance {
            Growth::Growing
        } else if self.value.re < -tolerance {
            Growth::Decaying
        } else {
            Growth::Neutral
        }
    }

    /// Whether it oscillates, as odd elastic waves do.
    pub fn oscillates(&self, tolerance: f64) -> bool {
        self.value.im.abs() > tolerance
    }

    /// Whether nothing drives it: translations of a periodic tissue.
    pub fn is_zero(&self, tolerance: f64) -> bool {
        self.value.norm() <= tolerance
    }
}

/// `(Σ |u_i|²)²/(N Σ |u_i|⁴)` over cells.
pub(crate) fn participation(u: &[Complex64]) -> f64 {
    let squares = u.chunks_exact(2).map(|u| u[0].norm_sqr() + u[1].norm_sqr());
    let (mut second, mut fourth, mut cells) = (0.0, 0.0, 0.0);
    for square in squares {
        second += square;
        fourth += square * square;
        cells += 1.0;
    }
    second * second / (cells * fourth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn participation_counts_the_cells_that_move() {
        let mut u = vec![Complex64::ZERO; 20];
        for moving in 1..=10 {
            u[2 * moving - 1] = Complex64::new(0.0, -0.7);
            assert!((participation(&u) - moving as f64 / 10.0).abs() < 1e-14);
        }
    }

    #[test]
    fn modes_are_told_apart_by_the_tolerance() {
        let mode = |re: f64, im: f64| Mode {
            value: Complex64::new(re, im),
            residual: None,
            participation: None,
            longitudinal: None,
            condition: None,
            overlap: None,
        };
        assert_eq!(mode(1e-3, 0.0).growth(1e-6), Growth::Growing);
        assert_eq!(mode(-1e-3, 0.0).growth(1e-6), Growth::Decaying);
        assert_eq!(mode(-1e-7, 1.0).growth(1e-6), Growth::Neutral);
        assert!(mode(0.0, -1.0).oscillates(1e-6) && !mode(0.0, 1e-7).oscillates(1e-6));
        assert!(mode(1e-7, 0.0).is_zero(1e-6) && !mode(0.0, 1e-5).is_zero(1e-6));
    }
}
