//! Parts of the plane within closed lines.

use crate::{Error, Vector};
use robust::{Coord, orient2d};

/// What closed lines enclose: a point belongs to it if a ray from it crosses them an odd number of times.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    loops: Vec<Vec<Vector<f64>>>,
}

impl Region {
    /// The rectangle between two opposite corners `[x0, y0, x1, y1]`.
    ///
    /// # Errors
    /// As [`Region::polygon`].
    pub fn rectangle([x0, y0, x1, y1]: [f64; 4]) -> Result<Self, Error> {
        Self::polygon([[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(Vector::from).to_vec())
    }

    /// A simple polygon, which may be concave. Corners in either sense of rotation; the first may be repeated at the end.
    ///
    /// # Errors
    /// [`Error::RegionCorners`], [`Error::RegionCorner`], [`Error::RegionArea`], [`Error::RegionCrossing`].
    pub fn polygon(mut corners: Vec<Vector<f64>>) -> Result<Self, Error> {
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        let count = corners.len();
        if count < 3 {
            return Err(Error::RegionCorners { found: count });
        }
        let unusable = |r: &Vector<f64>| !(r.x.is_finite() && r.y.is_finite());
        if let Some(corner) = corners.iter().position(unusable) {
            return Err(Error::RegionCorner { corner, x: corners[corner].x, y: corners[corner].y });
        }
        let region = Self { loops: vec![corners] };
        let sides: Vec<Side> = region.sides().collect();
        let extent = sides.iter().map(|[a, b]| (b - a).norm_squared()).fold(0.0, f64::max);
        if region.area() <= 1e-12 * extent {
            return Err(Error::RegionArea);
        }
        for (first, a) in sides.iter().enumerate() {
            for (second, b) in sides.iter().enumerate().skip(first + 1) {
                let follows = second == first + 1;
                let precedes = first == 0 && second == count - 1;
                let crosses = match (follows, precedes) {
                    (true, _) => folds_back(a[0], a[1], b[1]),
                    (_, true) => folds_back(b[0], b[1], a[1]),
                    _ => meet(a, b),
                };
                if crosses {
                    return Err(Error::RegionCrossing { first, second });
                }
            }
        }
        Ok(region)
    }

    /// Made of lines that are known not to cross.
    pub(crate) fn of_loops(loops: Vec<Vec<Vector<f64>>>) -> Self {
        Self { loops }
    }

    /// The closed lines, each as its corners.
    pub fn loops(&self) -> &[Vec<Vector<f64>>] {
        &self.loops
    }

    fn sides(&self) -> impl Iterator<Item = Side> + '_ {
        self.loops.iter().flat_map(|corners| {
            (0..corners.len()).map(move |m| [corners[m], corners[(m + 1) % corners.len()]])
        })
    }

    /// Area within a single line; of several, the sum over lines with their sense of rotation.
    pub fn area(&self) -> f64 {
        let twice: f64 = self.sides().map(|[a, b]| a.x * b.y - a.y * b.x).sum();
        0.5 * twice.abs()
    }

    /// Whether a point lies inside. On which side of a line it lies is decided exactly; points on the border belong to
    /// either part.
    pub fn contains(&self, r: Vector<f64>) -> bool {
        let crossings = self.sides().filter(|[a, b]| {
            let upward = a.y <= r.y && r.y < b.y;
            let downward = b.y <= r.y && r.y < a.y;
            (upward && turn(*a, *b, r) > 0.0) || (downward && turn(*a, *b, r) < 0.0)
        });
        crossings.count() % 2 == 1
    }

    /// Whether a point lies inside or, to rounding, on the border.
    pub fn holds(&self, r: Vector<f64>) -> bool {
        self.contains(r) || self.distance_from_border(r) <= 1e-9 * r.norm()
    }

    /// Distance of a point from the border.
    pub fn distance_from_border(&self, r: Vector<f64>) -> f64 {
        self.sides().map(|side| squared_distance(r, side)).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Whether a closed disk lies inside: its centre does, at least its radius away from the border. A radius that is not
    /// finite does not.
    pub fn holds_disk(&self, centre: Vector<f64>, radius: f64) -> bool {
        let squared = radius * radius;
        squared.is_finite()
            && self.contains(centre)
            && self.sides().all(|side| squared_distance(centre, side) >= squared)
    }

    /// The region in a unit of length that is `1/factor` times as large.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |corners: &Vec<Vector<f64>>| corners.iter().map(|r| r * factor).collect();
        Self { loops: self.loops.iter().map(scaled).collect() }
    }
}

type Side = [Vector<f64>; 2];

/// Positive if `c` lies to the left of the line from `a` to `b`; the sign is exact.
fn turn(a: Vector<f64>, b: Vector<f64>, c: Vector<f64>) -> f64 {
    let coordinates = |r: Vector<f64>| Coord { x: r.x, y: r.y };
    orient2d(coordinates(a), coordinates(b), coordinates(c))
}

fn squared_distance(r: Vector<f64>, [a, b]: Side) -> f64 {
    let (along, from) = (b - a, r - a);
    let share = (from.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    (from - along * share).norm_squared()
}

/// Whether the way from `a` by `b` to `c` goes back on itself, or does not go anywhere.
fn folds_back(a: Vector<f64>, b: Vector<f64>, c: Vector<f64>) -> bool {
    a == b || b == c || (turn(a, b, c) == 0.0 && (b - a).dot(&(c - b)) < 0.0)
}

/// Whether two sides have a point in common.
fn meet([a, b]: &Side, [c, d]: &Side) -> bool {
    let within = |r: &Vector<f64>, p: &Vector<f64>, q: &Vector<f64>| {
        (r.x - p.x) * (r.x - q.x) <= 0.0 && (r.y - p.y) * (r.y - q.y) <= 0.0
    };
    let ends = [turn(*a, *b, *c), turn(*a, *b, *d), turn(*c, *d, *a), turn(*c, *d, *b)];
    let apart = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    (apart(ends[0], ends[1]) && apart(ends[2], ends[3]))
        || (ends[0] == 0.0 && within(c, a, b))
        || (ends[1] == 0.0 && within(d, a, b))
        || (ends[2] == 0.0 && within(a, c, d))
        || (ends[3] == 0.0 && within(b, c, d))
}
