//! The director field: the shapes of cells, smoothed.

use crate::Frame;
use crate::pairs::{places, wrapped};
use voronudge_geometry::{Domain, Places, Vector, shape_tensors};

/// Widths of the Gaussian beyond which cells are left out: their weights are below 3·10⁻⁴.
pub(super) const CUT: f64 = 4.0;

/// The sum of the shape tensors of the cells that count, weighted by Gaussians of the distance from a place.
pub(super) struct DirectorField<'a> {
    frame: &'a Frame,
    /// Shape tensors of the cells that count, of which nought is taken of the others.
    pub shapes: Vec<[f64; 2]>,
    places: Places,
    width: f64,
}

/// The field at a place, to a factor, and its derivatives by x and y.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Local {
    pub value: [f64; 2],
    /// `[[∂_x Q_xx, ∂_x Q_xy], [∂_y Q_xx, ∂_y Q_xy]]`
    pub gradient: [[f64; 2]; 2],
}

impl<'a> DirectorField<'a> {
    /// Of the shapes of cells, smoothed over a standard deviation.
    pub fn new(frame: &'a Frame, width: f64) -> Self {
        let mut shapes = shape_tensors(&frame.tessellation, &frame.positions);
        for (shape, counts) in shapes.iter_mut().zip(&frame.counted) {
            if !counts {
                *shape = [0.0; 2];
            }
        }
        Self::of_shapes(frame, shapes, width)
    }

    /// Of other shape tensors of the cells.
    pub fn of_shapes(frame: &'a Frame, shapes: Vec<[f64; 2]>, width: f64) -> Self {
        Self { frame, shapes, places: places(frame, CUT * width), width }
    }

    /// The boundary condition.
    pub fn domain(&self) -> Domain {
        self.frame.tessellation.domain()
    }

    /// The field around a place in the box.
    pub fn at(&self, r: Vector<f64>) -> Local {
        let per_square = 1.0 / (self.width * self.width);
        let reach = CUT * self.width;
        let mut local = Local::default();
        for (cell, d) in self.places.within(r, reach) {
            let weight = (-0.5 * d.norm_squared() * per_square).exp();
            for (k, own) in self.shapes[cell].iter().enumerate() {
                local.value[k] += weight * own;
                for axis in 0..2 {
                    local.gradient[axis][k] += weight * own * d[axis] * per_square;
                }
            }
        }
        local
    }

    /// The field at each cell.
    pub fn at_cells(&self) -> Vec<[f64; 2]> {
        (0..self.frame.tracks.len()).map(|cell| self.at(wrapped(self.frame, cell)).value).collect()
    }
}

impl Local {
    /// Where the field vanishes, from here, if it were linear.
    pub fn step_to_zero(&self) -> Option<Vector<f64>> {
        let [[a, c], [b, d]] = self.gradient;
        let determinant = a * d - b * c;
        let [u, v] = self.value;
        let step = Vector::new(b * v - d * u, c * u - a * v) / determinant;
        (step.x + step.y).is_finite().then_some(step)
    }

    /// The direction of a defect, from the derivatives of the field (Vromans and Giomi 2016): of +½ that in which the head of the comet points, of −½ one
    /// of the three along which its arms lie.
    pub fn direction(&self, charge: f64) -> f64 {
        let [[x_xx, x_xy], [y_xx, y_xy]] = self.gradient;
        if charge > 0.0 {
            (y_xx - x_xy).atan2(-x_xx - y_xy)
        } else {
            -(-x_xy - y_xx).atan2(x_xx - y_xy) / 3.0
        }
    }
}
