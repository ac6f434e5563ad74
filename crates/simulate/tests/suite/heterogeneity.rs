//! Multiples of cells that differ.

use voronudge_simulate::{Distribution, generator};

fn mean(own: &[f64]) -> f64 {
    own.iter().sum::<f64>() / own.len() as f64
}

fn moments(own: &[f64]) -> (f64, f64) {
    let mean = mean(own);
    (mean, (own.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / own.len() as f64).sqrt())
}

#[test]
fn mean_and_spread_are_those_asked_for() {
    for distribution in [Distribution::Normal, Distribution::TwoTypes] {
        for cells in [2, 7, 100] {
            let (mean, deviation) = moments(&distribution.draw(0.3, cells, &mut generator(2)));
            assert!(
                (mean - 1.0).abs() < 1e-12 && (deviation - 0.3).abs() < 1e-12,
                "{distribution:?} {cells}"
            );
        }
        assert_eq!(distribution.draw(0.3, 1, &mut generator(2)), [1.0]);
    }
}

/// Of 40 tissues of 400 cells the mean of the deviation has an error of some .003.
#[test]
fn log_normal_multiples_are_positive_and_as_wide_on_average() {
    let drawn: Vec<_> =
        (0..40).map(|seed| Distribution::LogNormal.draw(0.8, 400, &mut generator(seed))).collect();
    assert!(drawn.iter().flatten().all(|own| *own > 0.0));
    assert!(drawn.iter().all(|own| (mean(own) - 1.0).abs() < 1e-12));
    let squares: f64 = drawn.iter().map(|own| moments(own).1.powi(2)).sum::<f64>() / 40.0;
    assert!((squares.sqrt() - 0.8).abs() < 0.04, "{squares}");
}

#[test]
fn names_are_told_apart() {
    for own in Distribution::ALL {
        assert_eq!(Distribution::from_name(own.name()), Some(own));
    }
    assert_eq!(Distribution::from_name("gamma"), None);
}
