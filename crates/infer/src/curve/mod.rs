//! Curves through measured points with errors: a straight line, a decay from both edges of a channel.

mod decay;
mod line;

pub use decay::{DecayFit, DecayPoint, DecayShape, fit_decay};
pub use line::{Intercept, Line, LinePoint, straight_line};

/// Rise of χ² at the ends of a 95 % interval of one parameter.
const RISE_95: f64 = 3.84;

/// Halvings and sections: enough for double precision.
const ITERATIONS: usize = 80;

/// The place of the least value, by golden sections.
fn least(value: &impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..ITERATIONS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if value(a) < value(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Where a value passes zero between a place where it is negative and one where it is positive.
fn crossing(value: impl Fn(f64) -> f64, mut negative: f64, mut positive: f64) -> f64 {
    for _ in 0..ITERATIONS {
        let middle = 0.5 * (negative + positive);
        if value(middle) < 0.0 { negative = middle } else { positive = middle }
    }
    0.5 * (negative + positive)
}
