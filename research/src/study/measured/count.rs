//! Shares of a few trials, with what they leave open.

use std::fmt;

/// So many of so many.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Count {
    /// Those that are so.
    pub hits: usize,
    /// All.
    pub total: usize,
}

impl Count {
    /// Counts those that are so.
    pub fn of(trials: impl Iterator<Item = bool>) -> Self {
        trials.fold(Self::default(), |Self { hits, total }, hit| Self {
            hits: hits + usize::from(hit),
            total: total + 1,
        })
    }

    /// NaN of none.
    pub fn share(self) -> f64 {
        self.hits as f64 / self.total as f64
    }

    /// Wilson's interval of 95 % for the share.
    pub fn interval(self) -> [f64; 2] {
        const Z: f64 = 1.96;
        let (n, share) = (self.total as f64, self.share());
        let middle = (share + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
        let half = Z / (1.0 + Z * Z / n) * (share * (1.0 - share) / n + (Z / (2.0 * n)).powi(2)).sqrt();
        [(middle - half).max(0.0), (middle + half).min(1.0)]
    }
}

impl std::iter::Sum for Count {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |a, b| Self { hits: a.hits + b.hits, total: a.total + b.total })
    }
}

impl fmt::Display for Count {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.total == 0 {
            return write!(out, "–");
        }
        let [low, high] = self.interval();
        write!(out, "{:.2} ({}/{}; {low:.2}–{high:.2})", self.share(), self.hits, self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_as_in_tables() {
        let [low, high] = Count { hits: 17, total: 20 }.interval();
        assert!((low - 0.640).abs() < 1e-3 && (high - 0.948).abs() < 1e-3, "{low} {high}");
        assert_eq!(Count::default().to_string(), "–");
    }
}
