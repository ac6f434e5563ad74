//! Plain least squares with cross-validation: mean velocities over an interval against the mean of the columns at both of its ends, as measured.
//! A candidate is added as long as the error of intervals left out falls by more than its standard error.

use super::set::{BASE, Set};
use nalgebra::{DMatrix, DVector};
use std::error::Error;
use voronudge_geometry::Vector;

/// Intervals that are left out together.
const FOLDS: usize = 3;

/// Normal equations of an interval.
struct Part {
    normal: DMatrix<f64>,
    mixed: DVector<f64>,
    squares: f64,
}

impl Part {
    /// The same for some columns.
    fn of(&self, chosen: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let q = chosen.len();
        let normal = DMatrix::from_fn(q, q, |i, j| self.normal[(chosen[i], chosen[j])]);
        (normal, DVector::from_fn(q, |i, _| self.mixed[chosen[i]]))
    }
}

/// The coefficients with the base model alone, and after the selection; nought of what was not selected.
pub fn fit(set: &Set, names: &[&str]) -> Result<[Vec<f64>; 2], Box<dyn Error>> {
    let parts = parts(set)?;
    let candidates: Vec<Vec<usize>> = super::set::CANDIDATES
        .iter()
        .map(|name| (0..names.len()).filter(|k| names[*k] == *name).collect())
        .collect();
    let mut chosen: Vec<usize> = (0..BASE.len()).collect();
    let before = of_all(&parts, &chosen, names.len())?;
    let mut errors = held_out(&parts, &chosen)?;
    let mut left = candidates;
    loop {
        let mut best: Option<(usize, Vec<f64>)> = None;
        for (k, columns) in left.iter().enumerate() {
            let with: Vec<usize> = chosen.iter().chain(columns).copied().collect();
            let found = held_out(&parts, &with)?;
            let sum = |errors: &[f64]| errors.iter().sum::<f64>();
            if best.as_ref().is_none_or(|(_, least)| sum(&found) < sum(least)) {
                best = Some((k, found));
            }
        }
        let Some((k, found)) = best else { break };
        let falls: Vec<f64> = errors.iter().zip(&found).map(|(before, after)| before - after).collect();
        let mean = falls.iter().sum::<f64>() / FOLDS as f64;
        let scatter = falls.iter().map(|fall| (fall - mean).powi(2)).sum::<f64>();
        if mean <= (scatter / (FOLDS * (FOLDS - 1)) as f64).sqrt() {
            break;
        }
        chosen.extend(left.remove(k));
        errors = found;
    }
    Ok([before, of_all(&parts, &chosen, names.len())?])
}

fn parts(set: &Set) -> Result<Vec<Part>, Box<dyn Error>> {
    let columns = set.measured.iter().map(|frame| set.columns(frame)).collect::<Result<Vec<_>, _>>()?;
    let p = set.truth.len();
    let part = |interval: usize| {
        let mut part = Part { normal: DMatrix::zeros(p, p), mixed: DVector::zeros(p), squares: 0.0 };
        let ends = set.measured[interval].iter().zip(&set.measured[interval + 1]);
        for (cell, (from, to)) in ends.enumerate() {
            let v = (to - from) / set.interval;
            let x: Vec<Vector<f64>> =
                (0..p).map(|k| (columns[interval][k][cell] + columns[interval + 1][k][cell]) * 0.5).collect();
            for i in 0..p {
                part.mixed[i] += x[i].dot(&v);
                (0..p).for_each(|j| part.normal[(i, j)] += x[i].dot(&x[j]));
            }
            part.squares += v.norm_squared();
        }
        part
    };
    Ok((0..set.measured.len() - 1).map(part).collect())
}

/// Least squares of some columns on some parts.
fn solve<'a>(
    parts: impl Iterator<Item = &'a Part>,
    chosen: &[usize],
) -> Result<DVector<f64>, Box<dyn Error>> {
    let q = chosen.len();
    let (mut normal, mut mixed) = (DMatrix::zeros(q, q), DVector::zeros(q));
    for part in parts {
        let own = part.of(chosen);
        normal += own.0;
        mixed += own.1;
    }
    Ok(normal.cholesky().ok_or("columns are linearly dependent")?.solve(&mixed))
}

/// The same on all parts, as coefficients of all columns.
fn of_all(parts: &[Part], chosen: &[usize], columns: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let found = solve(parts.iter(), chosen)?;
    let mut all = vec![0.0; columns];
    chosen.iter().zip(found.iter()).for_each(|(k, c)| all[*k] = *c);
    Ok(all)
}

/// The error of each fold, fitted without it, as a share of its squared velocities.
fn held_out(parts: &[Part], chosen: &[usize]) -> Result<Vec<f64>, Box<dyn Error>> {
    let of_fold = |fold: usize| {
        let is_out = |k: usize| k * FOLDS / parts.len() == fold;
        let c = solve(parts.iter().enumerate().filter(|(k, _)| !is_out(*k)).map(|(_, part)| part), chosen)?;
        let (mut missed, mut total) = (0.0, 0.0);
        for part in parts.iter().enumerate().filter(|(k, _)| is_out(*k)).map(|(_, part)| part) {
            let (normal, mixed) = part.of(chosen);
            missed += part.squares - 2.0 * c.dot(&mixed) + (c.transpose() * normal * &c).sum();
            total += part.squares;
        }
        Ok(missed / total)
    };
    (0..FOLDS).map(of_fold).collect()
}
