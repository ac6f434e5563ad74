//! Where outlines of cells touch.

use crate::Mask;
use crate::outline::shared_sides;
use nalgebra::{Matrix2, SymmetricEigen};
use std::collections::BTreeMap;
use voronudge_geometry::{Interface, Vector};

/// Moments of the points of a line.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    weight: f64,
    first: Vector<f64>,
    second: Matrix2<f64>,
}

impl Moments {
    /// Adds a straight piece from one end to the other.
    fn add(&mut self, [from, to]: [Vector<f64>; 2], weight: f64) {
        let (middle, along) = ((from + to) * 0.5, to - from);
        self.weight += weight;
        self.first += middle * weight;
        self.second += (middle * middle.transpose() + along * along.transpose() / 12.0) * weight;
    }

    /// The line, its length as found from its direction.
    fn interface(&self, cells: [usize; 2], length: impl Fn(Vector<f64>) -> f64) -> Option<Interface> {
        let middle = self.first / self.weight;
        let spread = SymmetricEigen::new(self.second / self.weight - middle * middle.transpose());
        let (along, across) = (spread.eigenvalues.imax(), spread.eigenvalues.imin());
        let direction: Vector<f64> = spread.eigenvectors.column(along).into();
        let difference = spread.eigenvalues[along] - spread.eigenvalues[across];
        let extent = direction * difference.max(0.0).sqrt();
        let length = length(direction);
        (length > 0.0 && middle.iter().all(|x| x.is_finite())).then_some(Interface {
            cells,
            length,
            middle,
            extent,
        })
    }
}

impl Mask<'_> {
    /// Where pairs of labels touch across at most `gap` pixels of background, lengths in pixels; `index` makes cells of labels.
    ///
    /// Rows and columns of pixels are followed; where one goes from one label to another, the middle of the pixels between
    /// them is a point of the line. Rows meet a line of normal n `|n_x|` times for each pixel of its length, columns `|n_y|` times:
    /// those that meet it more often tell its length.
    pub fn interfaces(&self, gap: usize, index: impl Fn(i64) -> Option<usize>) -> Vec<Interface> {
        let mut found: BTreeMap<[i64; 2], (Moments, [f64; 2])> = BTreeMap::new();
        let mut follow = |lines: usize, places: usize, label: &dyn Fn(usize, usize) -> i64, upright: bool| {
            for line in 0..lines {
                let mut last: Option<(usize, i64)> = None;
                for place in 0..places {
                    let here = label(line, place);
                    if here == 0 {
                        continue;
                    }
                    if let Some((before, other)) = last.replace((place, here))
                        && other != here
                        && place - before <= gap + 1
                    {
                        let (along, line) = (0.5 * (before + place + 1) as f64, line as f64);
                        let ends = match upright {
                            true => [Vector::new(line, along), Vector::new(line + 1.0, along)],
                            false => [Vector::new(along, line), Vector::new(along, line + 1.0)],
                        };
                        let (moments, met) = found.entry([other.min(here), other.max(here)]).or_default();
                        moments.add(ends, 1.0);
                        met[usize::from(upright)] += 1.0;
                    }
                }
            }
        };
        let [columns, rows] = self.size();
        follow(rows, columns, &|row, column| self.label(column, row), false);
        follow(columns, rows, &|column, row| self.label(column, row), true);
        let interfaces = found.into_iter().filter_map(|(labels, (moments, [rows, columns]))| {
            let [Some(a), Some(b)] = labels.map(&index) else { return None };
            moments.interface([a, b], |along| match along.x.abs() < along.y.abs() {
                true => rows / along.y.abs(),
                false => columns / along.x.abs(),
            })
        });
        interfaces.collect()
    }
}

/// Where polygons touch: the sides that two of them have in common, corners within `tolerance` of each other being one. Cells with
/// several such sides in common have one interface.
pub fn outline_interfaces(outlines: &[Vec<Vector<f64>>], tolerance: f64) -> Vec<Interface> {
    let mut found: BTreeMap<[usize; 2], Moments> = BTreeMap::new();
    for (cells, ends) in shared_sides(outlines, tolerance) {
        found.entry(cells).or_default().add(ends, (ends[1] - ends[0]).norm());
    }
    found.into_iter().filter_map(|(cells, moments)| moments.interface(cells, |_| moments.weight)).collect()
}
