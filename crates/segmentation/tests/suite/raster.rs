//! Smoothed fields on a raster.

use voronudge_segmentation::{Edge, smooth};

/// A wave is damped by exp(−q²w²/2), and a constant stays, also at an edge.
#[test]
fn waves_are_damped_and_constants_stay() {
    let (size, width) = ([32, 24], 2.0);
    let q = 2.0 * std::f64::consts::TAU / 32.0;
    let wave: Vec<f64> = (0..32 * 24).map(|k| (q * (k % 32) as f64).cos()).collect();
    let smoothed = smooth(&wave, size, width, Edge::Periodic).unwrap();
    let damped = (-0.5 * (q * width).powi(2)).exp();
    // The kernel ends at four standard deviations.
    assert!(smoothed.iter().zip(&wave).all(|(s, w)| (s - damped * w).abs() < 1e-3));
    let constant = smooth(&[3.0; 32 * 24], size, width, Edge::Open).unwrap();
    assert!(constant.iter().all(|x| (x - 3.0).abs() < 1e-12));
    let refused = smooth(&wave, [32, 25], width, Edge::Open).unwrap_err();
    assert_eq!(refused.to_string(), "768 values do not fill an image of 32 columns and 25 rows");
    assert!(refused.hint().is_some());
}
