//! How unusual a measurement is among simulated ones.

use nalgebra::{DMatrix, DVector};

/// λ: what is added to the correlations of a function with itself, which few sets do not tell well.
const RIDGE: f64 = 0.1;

/// How one of several sets of values compares with the others.
pub(super) struct Ranks {
    /// Of each function, the share of sets that are as far from the mean of all as the first set, or farther.
    pub single: Vec<f64>,
    /// The share of sets of which some function is as unusual as the most unusual of the first set, or more.
    pub joint: f64,
}

/// Ranks the first of several sets, each of which has the same functions, each the same points: `sets[set][function][point]`.
///
/// The distance of a function from the mean over all sets is `dᵀ (C + λ)⁻¹ d` of the deviations d, each over the standard deviation at that point, with their correlations C over all
/// sets: what goes together counts once. Points where something is not finite in any set, or where all sets are the same, are left out. All sets are treated
/// alike: if the first comes from the same distribution as the others, every rank is as likely as any other, whatever the distribution.
pub(super) fn ranks(sets: &[Vec<Vec<f64>>]) -> Ranks {
    let count = sets.len();
    let functions = sets.first().map_or(0, Vec::len);
    let unusual: Vec<Vec<f64>> = (0..functions)
        .map(|function| {
            let all: Vec<&[f64]> = sets.iter().map(|set| set[function].as_slice()).collect();
            standardised(&distances(&all))
        })
        .collect();
    let most: Vec<f64> =
        (0..count).map(|set| unusual.iter().map(|own| own[set]).fold(f64::NEG_INFINITY, f64::max)).collect();
    let joint = if functions == 0 { 1.0 } else { share(&most) };
    Ranks { single: unusual.iter().map(|own| share(own)).collect(), joint }
}

/// Distances on a scale on which those of functions with few and with many points are alike: their cube roots, which are nearly normal for sums of squares, less the
/// mean, over the standard deviation.
fn standardised(distances: &[f64]) -> Vec<f64> {
    let roots = DVector::from_iterator(distances.len(), distances.iter().map(|own| own.max(0.0).cbrt()));
    let (mean, width) = (roots.mean(), roots.variance().sqrt());
    roots.iter().map(|own| if width > 0.0 { (own - mean) / width } else { 0.0 }).collect()
}

/// The distance of each set from the mean of all.
fn distances(sets: &[&[f64]]) -> Vec<f64> {
    let (count, points) = (sets.len(), sets.iter().map(|set| set.len()).min().unwrap_or(0));
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for point in 0..points {
        let values = DVector::from_iterator(count, sets.iter().map(|set| set[point]));
        let mean = values.mean();
        let variance = values.variance();
        if variance.is_finite() && variance > 1e-24 * mean * mean {
            columns.push(values.map(|value| (value - mean) / variance.sqrt()));
        }
    }
    if columns.is_empty() {
        return vec![0.0; count];
    }
    let deviations = DMatrix::from_columns(&columns);
    let correlations = deviations.tr_mul(&deviations) / count as f64
        + DMatrix::identity(columns.len(), columns.len()) * RIDGE;
    match correlations.cholesky() {
        Some(factor) => {
            let whitened = factor.solve(&deviations.transpose());
            (0..count).map(|set| deviations.row(set).transpose().dot(&whitened.column(set))).collect()
        }
        None => deviations.row_iter().map(|own| own.norm_squared()).collect(),
    }
}

/// The share of all values that are as large as the first or larger.
fn share(values: &[f64]) -> f64 {
    let Some(first) = values.first() else { return 1.0 };
    values.iter().filter(|other| *other >= first).count() as f64 / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    /// Two functions of correlated points, the first set shifted by so many standard deviations.
    fn drawn(rng: &mut Pcg64, shift: f64) -> Vec<Vec<Vec<f64>>> {
        (0..40)
            .map(|set| {
                let shift = if set == 0 { shift } else { 0.0 };
                let walk = |rng: &mut Pcg64| -> Vec<f64> {
                    let mut value = 0.0;
                    let mut next = || {
                        value = 0.7 * value + rng.random_range(-1.0..1.0);
                        value + shift
                    };
                    (0..6).map(|_| next()).collect()
                };
                vec![walk(rng), walk(rng)]
            })
            .collect()
    }

    #[test]
    fn ranks_are_uniform_where_nothing_differs_and_small_where_something_does() {
        let mut rng = Pcg64::seed_from_u64(1);
        let joint: Vec<f64> = (0..400).map(|_| ranks(&drawn(&mut rng, 0.0)).joint).collect();
        for level in [0.1, 0.25, 0.5, 0.75] {
            let share = joint.iter().filter(|p| **p <= level).count() as f64 / 400.0;
            // Four standard deviations, and ties of the least of two ranks on the careful side.
            let width = 4.0 * (level * (1.0 - level) / 400.0_f64).sqrt();
            assert!(share < level + width && share > level - width - 0.05, "{share} below {level}");
        }
        let found = (0..50).filter(|_| ranks(&drawn(&mut rng, 4.0)).joint <= 0.026).count();
        assert!(found > 45, "{found} of 50");
    }

    #[test]
    fn points_that_say_nothing_are_left_out() {
        let same = vec![vec![1.0, f64::NAN, 3.0]];
        let mut sets = vec![same.clone(); 9];
        sets.push(vec![vec![1.0, f64::NAN, 4.0]]);
        assert_eq!(ranks(&sets).single, [1.0]);
        sets.reverse();
        let found = ranks(&sets);
        assert_eq!((found.single[0], found.joint), (0.1, 0.1));
    }
}
