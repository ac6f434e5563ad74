//! A Voronoi polygon by cutting a square with bisectors.

use nalgebra::Vector2;

/// A side of a polygon: the image of the cell on the other side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// The other cell.
    pub cell: usize,
    /// Its image, in box lengths.
    pub image: [i32; 2],
}

/// Images to look at on either side.
const IMAGES: i32 = 2;

/// The sides of the polygon of `cell`, counter-clockwise.
pub fn sides(positions: &[Vector2<f64>], lengths: [f64; 2], cell: usize) -> Vec<Side> {
    let reach = 2.0 * (lengths[0] + lengths[1]);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    // A vertex relative to the cell, and the side that follows it.
    let mut polygon: Vec<(Vector2<f64>, Option<Side>)> =
        corners.map(|[x, y]| (Vector2::new(x * reach, y * reach), None)).to_vec();
    for other in 0..positions.len() {
        for nx in -IMAGES..=IMAGES {
            for ny in -IMAGES..=IMAGES {
                if other == cell && nx == 0 && ny == 0 {
                    continue;
                }
                let shift = Vector2::new(f64::from(nx) * lengths[0], f64::from(ny) * lengths[1]);
                let d = positions[other] + shift - positions[cell];
                polygon = cut(&polygon, d, Side { cell: other, image: [nx, ny] });
            }
        }
    }
    polygon.into_iter().filter_map(|(_, side)| side).collect()
}

/// What is left of a polygon on the near side of the bisector of 0 and `d`.
fn cut(
    polygon: &[(Vector2<f64>, Option<Side>)],
    d: Vector2<f64>,
    side: Side,
) -> Vec<(Vector2<f64>, Option<Side>)> {
    let beyond = |p: Vector2<f64>| p.dot(&d) - 0.5 * d.norm_squared();
    let mut left = Vec::with_capacity(polygon.len() + 1);
    for (m, &(p, label)) in polygon.iter().enumerate() {
        let (q, _) = polygon[(m + 1) % polygon.len()];
        let (at_p, at_q) = (beyond(p), beyond(q));
        if at_p <= 0.0 {
            left.push((p, label));
        }
        if (at_p <= 0.0) != (at_q <= 0.0) {
            let crossing = p + (q - p) * (at_p / (at_p - at_q));
            // Leaving the near side, the bisector follows; coming back, the rest of the old side.
            left.push((crossing, if at_p <= 0.0 { Some(side) } else { label }));
        }
    }
    left
}
