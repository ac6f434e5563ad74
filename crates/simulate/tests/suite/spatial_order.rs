//! Numbers along a curve.

use voronudge_geometry::{PeriodicBox, Vector};
use voronudge_simulate::sort_in_space;

#[test]
fn the_curve_goes_from_square_to_neighbouring_square() {
    let side = 32u32;
    let cell_box = PeriodicBox::new([f64::from(side); 2]).unwrap();
    // A corner of each square.
    let mut squares: Vec<_> =
        (0..side * side).map(|k| Vector::new(f64::from(k % side), f64::from(k / side))).collect();
    sort_in_space(&mut squares, &cell_box);
    for pair in squares.windows(2) {
        assert_eq!((pair[0] - pair[1]).abs().sum(), 1.0, "{pair:?}");
    }
}
