//! The median of some numbers.

/// The middle of some finite values, the mean of the two in the middle of an even number. NaN are left out by the caller.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len();
    (count > 0).then(|| 0.5 * (values[(count - 1) / 2] + values[count / 2]))
}
