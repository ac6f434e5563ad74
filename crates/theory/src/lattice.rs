//! The honeycomb: its cells, its reciprocal lattice, and the points of high symmetry.

use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI};

/// Side `d` of a regular hexagon of unit area, `(3√3/2) d² = 1`, that is `d = √2/3^{3/4}`.
pub fn hexagon_side() -> f64 {
    (2.0 / (3.0 * 3f64.sqrt())).sqrt()
}

/// Perimeter `P_MF = 6d` of a regular hexagon of unit area: the limit of stability of the honeycomb.
pub fn hexagon_perimeter() -> f64 {
    6.0 * hexagon_side()
}

/// How the lattice lies in the frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Orientation {
    /// Each cell has neighbours straight above and below. This is the paper's lattice, with `a⁽²⁾` along y.
    NeighbourAlongY,
    /// Each cell has neighbours straight to the right and the left: rows of cells along x.
    NeighbourAlongX,
}

impl Orientation {
    /// Both.
    pub const ALL: [Self; 2] = [Self::NeighbourAlongY, Self::NeighbourAlongX];

    /// Direction of `a⁽¹⁾` from the x axis.
    fn first_angle(self) -> f64 {
        match self {
            Self::NeighbourAlongY => FRAC_PI_6,
            Self::NeighbourAlongX => 0.0,
        }
    }

    /// The six neighbours of a cell, counter-clockwise: `a⁽ⁿ⁾`, of length `√3 d`, at angles of 60°.
    ///
    /// `a⁽¹⁾` is at 30° from the x axis for [`Orientation::NeighbourAlongY`] (paper, Methods) and at 0° otherwise.
    pub fn neighbours(self) -> [[f64; 2]; 6] {
        let length = 3f64.sqrt() * hexagon_side();
        std::array::from_fn(|n| polar(length, self.first_angle() + n as f64 * FRAC_PI_3))
    }

    /// Two vectors `g⁽ᵐ⁾` that span the reciprocal lattice: `g⁽ᵐ⁾·a⁽ⁿ⁾ = 2π δ_mn` for the first two neighbours.
    pub fn reciprocal(self) -> [[f64; 2]; 2] {
        // Perpendicular to the other neighbour, so at 30° from the own one: |g| √3 d cos 30° = 2π.
        let length = 4.0 * PI / (3.0 * hexagon_side());
        [-FRAC_PI_6, 0.5 * PI].map(|turn| polar(length, self.first_angle() + turn))
    }

    /// The wave vector of a point of high symmetry, on the edge of the first Brillouin zone.
    pub fn wave_vector(self, point: SymmetryPoint) -> [f64; 2] {
        match point {
            SymmetryPoint::Gamma => [0.0; 2],
            SymmetryPoint::M => polar(2.0 * PI / (3.0 * hexagon_side()), self.first_angle() - FRAC_PI_6),
            SymmetryPoint::K => polar(4.0 * PI / (3.0 * 3f64.sqrt() * hexagon_side()), self.first_angle()),
        }
    }
}

/// Points of high symmetry of the hexagonal Brillouin zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SymmetryPoint {
    /// Γ, the centre: all cells move alike.
    Gamma,
    /// K, a corner, along a neighbour: `|q| = 4π/(3√3 d)`. Its symmetry is three-fold.
    K,
    /// M, the middle of an edge, between two neighbours: `|q| = 2π/(3d)`. Rows of cells alternate.
    M,
}

/// One point on a path through the Brillouin zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Wave vector.
    pub q: [f64; 2],
    /// Length of the path up to here.
    pub distance: f64,
    /// The point of high symmetry, if it is one.
    pub corner: Option<SymmetryPoint>,
}

/// The path Γ–K–M–Γ, with about `steps` equal steps on each of its three legs, at least one.
///
/// The first and the last point are Γ.
///
/// ```
/// use voronudge_theory::{Orientation, SymmetryPoint, symmetry_path};
/// let path = symmetry_path(Orientation::NeighbourAlongX, 10);
/// assert_eq!(path.len(), 31);
/// assert_eq!(path[10].corner, Some(SymmetryPoint::K));
/// ```
pub fn symmetry_path(orientation: Orientation, steps: usize) -> Vec<PathPoint> {
    use SymmetryPoint::{Gamma, K, M};
    let steps = steps.max(1);
    let mut path = vec![PathPoint { q: [0.0; 2], distance: 0.0, corner: Some(Gamma) }];
    let mut start = 0.0;
    for (from, to) in [(Gamma, K), (K, M), (M, Gamma)] {
        let [p, q] = [from, to].map(|point| orientation.wave_vector(point));
        let length = (q[0] - p[0]).hypot(q[1] - p[1]);
        path.extend((1..=steps).map(|step| {
            let t = step as f64 / steps as f64;
            PathPoint {
                q: if step == steps { q } else { [0, 1].map(|axis| p[axis] + t * (q[axis] - p[axis])) },
                distance: start + t * length,
                corner: (step == steps).then_some(to),
            }
        }));
        start += length;
    }
    path
}

fn polar(length: f64, angle: f64) -> [f64; 2] {
    [length * angle.cos(), length * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hexagon_has_unit_area() {
        let d = hexagon_side();
        assert!((1.5 * 3f64.sqrt() * d * d - 1.0).abs() < 1e-15);
        assert!((d - 2f64.sqrt() / 3f64.powf(0.75)).abs() < 1e-15);
    }

    #[test]
    fn direct_and_reciprocal_lattice_fit() {
        for orientation in Orientation::ALL {
            let (a, g) = (orientation.neighbours(), orientation.reciprocal());
            for (m, g) in g.iter().enumerate() {
                for (n, a) in a[..2].iter().enumerate() {
                    let expected = if m == n { 2.0 * PI } else { 0.0 };
                    assert!((g[0] * a[0] + g[1] * a[1] - expected).abs() < 1e-13);
                }
            }
            // M is half a reciprocal vector, K a third of the way to the sum with the other one.
            let (k, m) =
                (orientation.wave_vector(SymmetryPoint::K), orientation.wave_vector(SymmetryPoint::M));
            for axis in 0..2 {
                assert!((m[axis] - 0.5 * g[0][axis]).abs() < 1e-14);
                assert!((k[axis] - (2.0 * g[0][axis] + g[1][axis]) / 3.0).abs() < 1e-14);
            }
        }
        // The paper's lattice: a⁽²⁾ along y, and its q* along x.
        let a = Orientation::NeighbourAlongY.neighbours();
        assert!(a[1][0].abs() < 1e-15 && a[1][1] > 0.0);
        assert!(Orientation::NeighbourAlongY.wave_vector(SymmetryPoint::M)[1].abs() < 1e-15);
    }

    #[test]
    fn the_path_is_continuous_and_closed() {
        for orientation in Orientation::ALL {
            let path = symmetry_path(orientation, 7);
            for pair in path.windows(2) {
                let step = (pair[1].q[0] - pair[0].q[0]).hypot(pair[1].q[1] - pair[0].q[1]);
                assert!((step - (pair[1].distance - pair[0].distance)).abs() < 1e-14 && step > 0.0);
            }
            assert_eq!(path[0].q, path[21].q);
            assert_eq!(symmetry_path(orientation, 0).len(), 4);
        }
    }
}
