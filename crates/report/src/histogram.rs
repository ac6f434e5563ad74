//! Counts of values in bins of round width.

use crate::chart::Chart;
use crate::numbers::nice_below;
use crate::svg::PathData;

/// How many values fall into each bin.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Number of values in each bin.
    pub counts: Vec<f64>,
    /// Number of finite values below and above the bins.
    pub outside: [usize; 2],
    /// Edge of the first bin in units of the width.
    first: f64,
    width: f64,
}

impl Histogram {
    /// Counts the finite `values` in at least `bins` bins that cover `range`. `None` if no value is
    /// finite or the range is empty.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = f64>, range: [f64; 2], bins: usize) -> Option<Self> {
        let width = nice_below((range[1] - range[0]) / bins.max(1) as f64)?;
        let first = (range[0] / width + 1e-9).floor();
        let number = (range[1] / width - 1e-9).ceil() - first;
        let is_sound = first.is_finite() && (1.0..1e4).contains(&number);
        let mut counts = if is_sound { vec![0.0; number as usize] } else { return None };
        let mut outside = [0; 2];
        for value in values.into_iter().filter(|value| value.is_finite()) {
            let bin = (value / width - first).floor();
            match counts.get_mut(bin as usize) {
                Some(count) if bin >= 0.0 => *count += 1.0,
                _ => outside[usize::from(bin >= 0.0)] += 1,
            }
        }
        let histogram = Self { counts, outside, first, width };
        (histogram.total() > 0.0).then_some(histogram)
    }

    /// Bins at which bars of `values` values stand for some of them each, at most `most`: of few values they are few, and wide.
    #[must_use]
    pub fn bins(values: usize, most: usize) -> usize {
        ((1.6 * (values as f64).cbrt()) as usize).clamp(4.min(most), most)
    }

    /// Number of finite values, also outside the bins.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.counts.iter().sum::<f64>() + self.outside.iter().sum::<usize>() as f64
    }

    /// Width of a bin.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Lower edge of the first and upper edge of the last bin.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.first * self.width, (self.first + self.counts.len() as f64) * self.width]
    }

    /// The largest count, at least one.
    #[must_use]
    pub fn highest(&self) -> f64 {
        self.counts.iter().copied().fold(1.0, f64::max)
    }

    /// Draws the bars.
    pub fn draw(&self, chart: &mut Chart) {
        let middle = |bin: usize| (self.first + bin as f64 + 0.5) * self.width;
        chart.record(
            "bars, at their middle",
            self.counts.iter().enumerate().map(|(bin, &count)| [middle(bin), count]),
        );
        let mut bars = PathData::new();
        for (bin, &count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
            let low = (self.first + bin as f64) * self.width;
            bars.rectangle(chart.to_pixel([low, count]), chart.to_pixel([low + self.width, 0.0]));
        }
        chart.svg.path(&bars, r##"fill="#9db4c6" stroke="#fff" stroke-width=".8""##);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_finite_value_is_counted_once() {
        let values = [-7.0, -0.99, -0.01, 0.0, 0.5, 0.99, 1.0, 44.0, f64::NAN];
        let histogram = Histogram::new(values, [-1.0, 1.0], 4).unwrap();
        assert_eq!(histogram.counts, [1.0, 1.0, 1.0, 2.0]);
        assert_eq!(histogram.outside, [1, 2]);
        assert_eq!(histogram.total(), 8.0);
        assert_eq!(histogram.range(), [-1.0, 1.0]);
    }

    #[test]
    fn few_values_have_few_bins() {
        assert_eq!([0, 34, 200, 100_000].map(|values| Histogram::bins(values, 36)), [4, 5, 9, 36]);
        assert_eq!(Histogram::bins(10, 2), 2);
    }

    #[test]
    fn without_values_or_range_there_is_none() {
        assert!(Histogram::new([f64::NAN], [0.0, 1.0], 10).is_none());
        assert!(Histogram::new([1.0], [1.0, 1.0], 10).is_none());
        assert!(Histogram::new([1.0], [1.0, f64::INFINITY], 10).is_none());
    }
}
