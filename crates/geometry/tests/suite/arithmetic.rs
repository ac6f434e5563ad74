//! Numbers of several lanes and with slopes against plain and dual ones.

use num_dual::DualSVec64;
use voronudge_geometry::{Arithmetic, Lanes, Tangent};

#[test]
fn each_lane_is_a_number() {
    let (a, b) = ([1.0, -0.3, 4e200, 7.5], [0.1, 3.0, -2.0, f64::MIN_POSITIVE]);
    let formula = |a: f64, b: f64| (-a * b - a + b * 2.0 - 0.5) * (b * b).sqrt().recip() + 1.0;
    let lanes = {
        let (a, b) = (Lanes(a), Lanes(b));
        let mut sum = -a * b - a;
        sum += b * 2.0;
        sum -= Lanes::constant(0.5);
        sum *= (b * b).root().inverse();
        sum + 1.0
    };
    assert_eq!(lanes.0, std::array::from_fn(|lane| formula(a[lane], b[lane])));
}

fn formula<S: Arithmetic>(a: S, b: S) -> S {
    let mut sum = -a * b - a + b * 2.0;
    sum += (a * a + b * b + 1.0).root().inverse();
    sum -= b - 0.25;
    sum *= a;
    sum
}

#[test]
fn slopes_are_those_of_dual_numbers() {
    let [a, b] = [[1.0, -0.3, 4e20, 7.5], [0.1, 3.0, -2.0, 1e-3]];
    let lanes = formula(Tangent::<_, 2>::along(Lanes(a), 0), Tangent::along(Lanes(b), 1));
    for lane in 0..Lanes::WIDTH {
        let dual = |x: f64, k| DualSVec64::<2>::from_re(x).derivative(k);
        let expected = formula(dual(a[lane], 0), dual(b[lane], 1));
        let eps = expected.eps.0.unwrap();
        assert_eq!(lanes.value.0[lane], expected.re);
        for direction in 0..2 {
            let (found, expected) = (lanes.slopes[direction].0[lane], eps[direction]);
            assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found} {expected}");
        }
    }
}
