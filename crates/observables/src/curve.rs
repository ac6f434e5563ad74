//! Means as functions of something, with errors from parts of the field.

use crate::Quantity;

/// Parts into which the cells are divided by where they are first seen; errors come from leaving out one at a time.
pub(crate) const PARTS: usize = 16;

/// A measured function, or a number: a function of nothing with a single value.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it is.
    pub of: Quantity,
    /// Lags, distances, wave numbers or values; 0 of a number.
    pub at: Vec<f64>,
    /// The values; NaN where nothing was seen.
    pub value: Vec<f64>,
    /// Their standard errors: by leaving out sixteenths of the cells, or of structure factors by the scatter among wave vectors. NaN where they cannot be told.
    pub standard_error: Vec<f64>,
    /// Cells, pairs, displacements or wave vectors that each value rests on.
    pub count: Vec<usize>,
}

/// Sums of which the ratio is a mean.
#[derive(Debug, Clone, Copy, Default)]
struct Pair {
    above: f64,
    below: f64,
    count: usize,
}

/// Sums for each point of a curve: all, and what goes with each part of the field.
#[derive(Debug, Clone)]
pub(crate) struct Sums {
    points: Vec<(Pair, [Pair; PARTS])>,
}

impl Sums {
    pub fn new(points: usize) -> Self {
        Self { points: vec![Default::default(); points] }
    }

    /// Takes in one sample, of a cell of a part.
    pub fn add(&mut self, point: usize, part: usize, above: f64, below: f64) {
        self.add_pair(point, [part, part], above, below);
    }

    /// Takes in one sample, of two cells: without the part of either there would be none.
    pub fn add_pair(&mut self, point: usize, parts: [usize; 2], above: f64, below: f64) {
        let (all, touching) = &mut self.points[point];
        all.add(above, below);
        touching[parts[0]].add(above, below);
        if parts[0] != parts[1] {
            touching[parts[1]].add(above, below);
        }
    }

    /// The same samples of other frames.
    pub fn merge(mut self, other: &Self) -> Self {
        for ((all, touching), (others, those)) in self.points.iter_mut().zip(&other.points) {
            all.merge(others);
            touching.iter_mut().zip(those).for_each(|(own, other)| own.merge(other));
        }
        self
    }

    pub fn curve(&self, of: Quantity, at: Vec<f64>) -> Curve {
        let (value, standard_error) = self.shares().unzip();
        Curve { of, at, value, standard_error, count: self.counts() }
    }

    /// The mean at each point, and its standard error.
    pub fn shares(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.points.iter().map(share)
    }

    /// Samples at each point.
    pub fn counts(&self) -> Vec<usize> {
        self.points.iter().map(|(all, _)| all.count).collect()
    }
}

impl Pair {
    fn add(&mut self, above: f64, below: f64) {
        self.merge(&Self { above, below, count: 1 });
    }

    fn merge(&mut self, other: &Self) {
        self.above += other.above;
        self.below += other.below;
        self.count += other.count;
    }
}

/// A ratio of sums and its standard error by leaving out one part at a time.
fn share((all, touching): &(Pair, [Pair; PARTS])) -> (f64, f64) {
    let value = all.above / all.below;
    let seen = || touching.iter().filter(|own| own.count > 0);
    let count = seen().count() as f64;
    if count < 3.0 || !value.is_finite() {
        return (value, f64::NAN);
    }
    let without = || seen().map(|own| (all.above - own.above) / (all.below - own.below));
    let mean = without().sum::<f64>() / count;
    let squares: f64 = without().map(|value| (value - mean).powi(2)).sum();
    (value, ((count - 1.0) / count * squares).sqrt())
}
