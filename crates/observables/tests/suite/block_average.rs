//! Errors of means of what is correlated.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_observables::BlockAverage;

/// x' = ρ x + noise: the variance of the mean is (1 + ρ)/(1 − ρ) times the naive one.
#[test]
fn the_error_covers_the_correlation() {
    let (rho, length) = (0.95f64, 1 << 14);
    let (mut ratios, mut misses) = (0.0, 0);
    for seed in 0..100 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let (mut x, mut average) = (0.0, BlockAverage::default());
        for _ in 0..length {
            let noise: f64 = (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
            x = rho * x + (1.0 - rho * rho).sqrt() * noise;
            average.add(x);
        }
        let expected = ((1.0 + rho) / (1.0 - rho) / f64::from(length)).sqrt();
        let error = average.standard_error().unwrap();
        ratios += error / expected / 100.0;
        misses += usize::from(average.mean().unwrap().abs() > 2.0 * error);
    }
    assert!((0.95..1.35).contains(&ratios), "{ratios}");
    assert!(misses < 10, "{misses} of 100");
}

#[test]
fn few_values_tell_no_error() {
    let mut average = BlockAverage::default();
    assert_eq!(average.mean(), None);
    (0..15).for_each(|i| average.add(f64::from(i)));
    assert_eq!((average.mean(), average.standard_error()), (Some(7.0), None));
    assert_eq!(average.count(), 15);
}
