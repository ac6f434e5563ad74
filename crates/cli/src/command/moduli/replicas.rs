//! Numbers of single replicas taken together.

/// Mean and standard error over replicas; of a single one its own.
pub(crate) fn over_replicas(values: &[f64], errors: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let error = match errors {
        [own] => *own,
        _ => (values.iter().map(|x| (x - value).powi(2)).sum::<f64>() / (count * (count - 1.0))).sqrt(),
    };
    (value, error)
}
