//! Small homogeneous strains of a periodic tissue, and the parts of its stress.

use voronudge_geometry::{PeriodicBox, Vector};

/// A strain without rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strain {
    /// `∇·u`
    Dilation,
    /// `e_1 = ∂_x u_x − ∂_y u_y`
    PureShear1,
    /// `e_2 = ∂_x u_y + ∂_y u_x`
    PureShear2,
}

impl Strain {
    /// All, in the order of the columns of [`StressResponse`](super::StressResponse).
    pub const ALL: [Self; 3] = [Self::Dilation, Self::PureShear1, Self::PureShear2];

    /// The stretch `U = exp(E)`, `E` the symmetric gradient of displacement of an amount; shears keep the area.
    pub fn stretch(self, amount: f64) -> [[f64; 2]; 2] {
        let half = 0.5 * amount;
        match self {
            Self::Dilation => [[half.exp(), 0.0], [0.0, half.exp()]],
            Self::PureShear1 => [[half.exp(), 0.0], [0.0, (-half).exp()]],
            Self::PureShear2 => [[half.cosh(), half.sinh()], [half.sinh(), half.cosh()]],
        }
    }
}

/// A strain as a periodic box can have it: `U = R F`, with `F` upper triangular (its x axis stays along x) and `R` a turn.
///
/// For the second shear `F` is a simple shear of the box, as of Lees–Edwards boundaries, to first order.
#[derive(Debug, Clone, Copy)]
pub struct Deformation {
    gradient: [[f64; 2]; 2],
    turn: [f64; 2],
}

impl Deformation {
    /// That of an amount of a strain.
    pub fn new(strain: Strain, amount: f64) -> Self {
        let u = strain.stretch(amount);
        let length = u[0][0].hypot(u[1][0]);
        let (cosine, sine) = (u[0][0] / length, u[1][0] / length);
        let gradient =
            [[length, cosine * u[0][1] + sine * u[1][1]], [0.0, cosine * u[1][1] - sine * u[0][1]]];
        Self { gradient, turn: [cosine, sine] }
    }

    /// Where a point comes to, in the frame of the box.
    pub fn displaced(&self, r: Vector<f64>) -> Vector<f64> {
        let [[xx, xy], [_, yy]] = self.gradient;
        Vector::new(xx * r.x + xy * r.y, yy * r.y)
    }

    /// Cosine and sine of `R`.
    pub fn turn(&self) -> [f64; 2] {
        self.turn
    }

    /// The deformed box.
    ///
    /// # Errors
    /// Those of [`PeriodicBox::sheared`].
    pub fn cell_box(&self, from: &PeriodicBox) -> Result<PeriodicBox, voronudge_geometry::Error> {
        let [[xx, xy], [_, yy]] = self.gradient;
        let [width, height] = from.lengths();
        PeriodicBox::sheared([xx * width, yy * height], xx * from.offset() + xy * height)
    }

    /// A stress from the frame of the box to that in which the strain has no rotation: `R σ Rᵀ`.
    pub fn turn_back(&self, s: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let [c, n] = self.turn;
        let r = [[c, -n], [n, c]];
        let mut turned = [[0.0; 2]; 2];
        for (i, row) in turned.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = (0..2).flat_map(|k| (0..2).map(move |l| r[i][k] * s[k][l] * r[j][l])).sum();
            }
        }
        turned
    }
}

/// The parts of a stress (row = component of the force), in the order of the rows of [`StressResponse`](super::StressResponse):
/// `(σ_xx + σ_yy)/2`, `(σ_yx − σ_xy)/2`, `(σ_xx − σ_yy)/2`, `(σ_xy + σ_yx)/2`.
pub fn parts(s: [[f64; 2]; 2]) -> [f64; 4] {
    [
        0.5 * (s[0][0] + s[1][1]),
        0.5 * (s[1][0] - s[0][1]),
        0.5 * (s[0][0] - s[1][1]),
        0.5 * (s[0][1] + s[1][0]),
    ]
}

/// The stress of its parts.
pub fn whole(p: [f64; 4]) -> [[f64; 2]; 2] {
    [[p[0] + p[2], p[3] - p[1]], [p[3] + p[1], p[0] - p[2]]]
}
