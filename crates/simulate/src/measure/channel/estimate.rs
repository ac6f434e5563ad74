//! A mean with its standard error.

use voronudge_observables::BlockAverage;

/// An average over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The average; NaN where nothing was there.
    pub value: f64,
    /// Its standard error by [blocking](BlockAverage); `None` for fewer than 16 samples.
    pub error: Option<f64>,
}

impl Estimate {
    /// The ratio of the means of two series, `Σ a / Σ b`, with the standard error of `(a − R b)/⟨b⟩`: that of the ratio to first
    /// order, correlations in time and between the two included.
    ///
    /// ```
    /// use voronudge_simulate::measure::Estimate;
    /// let series: Vec<(f64, f64)> = (0..64).map(|i| (3.0 * (1.0 + f64::from(i % 5)), 1.0 + f64::from(i % 5))).collect();
    /// let ratio = Estimate::ratio(&series);
    /// assert_eq!(ratio.value, 3.0);
    /// assert!(ratio.error.unwrap() < 1e-12); // they fluctuate together
    /// ```
    pub fn ratio(series: &[(f64, f64)]) -> Self {
        let sum: f64 = series.iter().map(|(a, _)| a).sum();
        let weight: f64 = series.iter().map(|(_, b)| b).sum();
        if weight == 0.0 {
            return Self { value: f64::NAN, error: None };
        }
        let (value, mean) = (sum / weight, weight / series.len() as f64);
        let mut average = BlockAverage::default();
        series.iter().for_each(|(a, b)| average.add((a - value * b) / mean));
        Self { value, error: average.standard_error() }
    }

    /// `[low, high]` two standard errors to either side.
    pub fn interval(&self) -> Option<[f64; 2]> {
        self.error.map(|error| [self.value - 2.0 * error, self.value + 2.0 * error])
    }
}
