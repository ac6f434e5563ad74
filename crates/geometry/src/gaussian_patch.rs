//! Integrals of a Gaussian over polygons and along lines.

use crate::{Scalar, Vector, cross, dot};

/// Nodes and weights of Gauss and Legendre's rule of five points on (0, 1), one half: the rest is symmetric.
const NODES: [[f64; 2]; 3] = [
    [0.5, 0.284_444_444_444_444_45],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_24],
    [0.046_910_077_030_668_004, 0.118_463_442_528_094_54],
];

/// Most pieces of a side; longer sides are those of polygons at the rim of an open field.
const MOST_PIECES: f64 = 64.0;

/// `∫ f dt` for t from 0 to 1 along a side of some length, in pieces no longer than `scale`.
fn along<T>(length: f64, scale: f64, zero: T, mut add: impl FnMut(T, f64, f64) -> T) -> T {
    let pieces = (length / scale).ceil().clamp(1.0, MOST_PIECES);
    let mut sum = zero;
    for piece in 0..pieces as usize {
        for [node, weight] in NODES {
            let mirrored = if node == 0.5 { None } else { Some(1.0 - node) };
            for place in [Some(node), mirrored].into_iter().flatten() {
                sum = add(sum, (piece as f64 + place) / pieces, weight / pieces);
            }
        }
    }
    sum
}

/// `∫ exp(−x²/2s²) dA` over a polygon, counter-clockwise, with the centre of the Gaussian at the origin.
///
/// With `u = x²/2s²` the field `x (1 − e⁻ᵘ)/2u` has the divergence `e⁻ᵘ`, so that each side from p to q contributes
/// `(p × q) ∫ (1 − e⁻ᵘ)/2u dt`.
pub(crate) fn gaussian_area<S: Scalar>(vertices: impl Iterator<Item = Vector<f64>> + Clone, width: S) -> S {
    let Some(last) = vertices.clone().last() else {
        return S::constant(0.0);
    };
    let narrow = (width * width * 2.0).recip();
    let (sum, _) = vertices.fold((S::constant(0.0), last), |(sum, p), q| {
        let side = along((q - p).norm(), width.real(), S::constant(0.0), |sum, t, weight| {
            sum + share(narrow * (p + (q - p) * t).norm_squared()) * weight
        });
        (sum + side * cross(p, q), q)
    });
    sum
}

/// u below which `1 − e⁻ᵘ` loses digits, and above which it is one.
const SMALL: f64 = 1e-2;
const LARGE: f64 = 37.0;

/// `(1 − e⁻ᵘ)/2u`
fn share<S: Scalar>(u: S) -> S {
    match u.real() {
        small if small < SMALL => {
            let series = [1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5, -1.0];
            series.into_iter().fold(S::constant(-1.0 / 5040.0), |sum, next| sum * u + next) * -0.5
        }
        large if large > LARGE => (u * 2.0).recip(),
        _ => (S::constant(1.0) - (-u).exp()) / (u * 2.0),
    }
}

/// `∫ exp(−x²/2s²) dl` along a line from one end to the other, and the mean place of that weight, with the centre at the origin.
pub(crate) fn gaussian_line([from, to]: [Vector<f64>; 2], width: f64) -> (f64, Vector<f64>) {
    let length = (to - from).norm();
    let zero = (0.0, Vector::zeros());
    let (sum, moment) = along(length, width, zero, |(sum, moment): (f64, Vector<f64>), t, weight| {
        let x = from + (to - from) * t;
        let weight = weight * (-0.5 * dot(x, x) / (width * width)).exp();
        (sum + weight, moment + x * weight)
    });
    (sum * length, moment / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::Dual64;

    /// Over a large square, and over a part of the plane, against sums over a fine mesh.
    #[test]
    fn areas_are_those_of_a_fine_mesh() {
        let width = 0.7;
        let square = [[-9.0, -8.0], [8.0, -8.0], [8.0, 9.0], [-9.0, 9.0]].map(|[x, y]| Vector::new(x, y));
        let all = gaussian_area(square.into_iter(), width);
        assert!((all / (std::f64::consts::TAU * width * width) - 1.0).abs() < 1e-9, "{all}");
        let triangle = [[0.2, -0.6], [1.4, 0.3], [-0.3, 0.8]].map(|[x, y]| Vector::new(x, y));
        let inside = |x: Vector<f64>| {
            (0..3).all(|k| cross(triangle[(k + 1) % 3] - triangle[k], x - triangle[k]) > 0.0)
        };
        let mesh = 2000;
        let at = |k: i32| -1.0 + 3.0 * (f64::from(k) + 0.5) / f64::from(mesh);
        let mut expected = 0.0;
        for (ix, iy) in (0..mesh).flat_map(|ix| (0..mesh).map(move |iy| (ix, iy))) {
            let x = Vector::new(at(ix), at(iy));
            if inside(x) {
                expected += (-0.5 * dot(x, x) / (width * width)).exp() * (3.0 / f64::from(mesh)).powi(2);
            }
        }
        let found = gaussian_area(triangle.into_iter(), Dual64::from_re(width).derivative());
        assert!((found.re - expected).abs() < 1e-4, "{} {expected}", found.re);
        let [above, below] = [1e-5, -1e-5].map(|step| gaussian_area(triangle.into_iter(), width + step));
        assert!((found.eps - (above - below) / 2e-5).abs() < 1e-8);
    }

    #[test]
    fn shares_join_smoothly() {
        for u in [1e-9, 1e-4, 9.999e-3, 1.0001e-2, 0.3, 5.0, 36.9, 37.1, 400.0] {
            let found = share(Dual64::from_re(u).derivative());
            let expected = -f64::exp_m1(-u) / (2.0 * u);
            let slope = if u < 1e-3 { -0.25 + u / 6.0 } else { ((-u).exp() / 2.0 - expected) / u };
            assert!((found.re / expected - 1.0).abs() < 1e-13 && (found.eps - slope).abs() < 1e-8, "{u}");
        }
    }

    #[test]
    fn lines_have_the_weight_of_their_points() {
        let (from, to) = (Vector::new(-6.0, 0.4), Vector::new(6.0, 0.4));
        let (weight, mean) = gaussian_line([from, to], 0.8);
        let expected = 0.8 * std::f64::consts::TAU.sqrt() * (-0.5 * (0.4f64 / 0.8).powi(2)).exp();
        assert!((weight - expected).abs() < 1e-9, "{weight} {expected}");
        assert!((mean - Vector::new(0.0, 0.4)).norm() < 1e-9);
    }
}
