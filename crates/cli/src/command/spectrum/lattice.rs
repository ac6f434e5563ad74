//! A honeycomb as data, and its waves beside the theory.

use super::theory::mean_field;
use crate::arguments::{ChosenEffects, environment};
use crate::failure::Failure;
use ndarray::{Array2, Array3};
use voronudge_geometry::FieldOfView;
use voronudge_io::{Boundary, DataSet, OutputDirectory};
use voronudge_model::{Model, Parameters};
use voronudge_report::figure::DispersionPoint;
use voronudge_spectrum::{Arrangement, Complex64, Honeycomb};
use voronudge_theory::{MeanField, Orientation, SymmetryPoint, symmetry_path};

/// Steps on each of the three legs of the path.
const STEPS: usize = 60;

pub(super) struct Lattice {
    pub honeycomb: Honeycomb,
    pub size: [usize; 2],
}

/// Waves along the path Γ–K–M–Γ.
pub(super) struct Waves {
    pub points: Vec<DispersionPoint>,
    pub wave_vectors: Vec<[f64; 2]>,
    pub size: [usize; 2],
    /// Largest difference of D(q) from the theory, relative to the largest entry on the path.
    pub largest_difference: Option<f64>,
}

impl Lattice {
    pub fn new(size: &[usize]) -> Result<Self, Failure> {
        let (columns, rows) = (size.first().copied().unwrap_or(0), size.get(1).copied().unwrap_or(0));
        // Many more would not fit into memory, and none more is needed.
        if columns.max(rows) > 10_000 {
            return Err(Failure::new(format!("--lattice {columns} {rows} is too large"))
                .with_hint("10 12 shows all there is; larger lattices have more of the same modes"));
        }
        let honeycomb = Honeycomb::new(columns, rows, Arrangement::RowsAlongY)
            .map_err(|error| Failure::new(format!("--lattice: {error}")).with_hint("try --lattice 10 12"))?;
        Ok(Self { honeycomb, size: [columns, rows] })
    }

    pub fn title(&self) -> String {
        format!("honeycomb of {} × {} cells", self.size[0], self.size[1])
    }

    pub fn data_set(&self) -> DataSet {
        let positions = self.honeycomb.positions();
        DataSet {
            frame_interval: 1.0,
            length_unit: "ℓ₀".into(),
            time_unit: "τ".into(),
            unwrapped: true,
            ..DataSet::new(
                Array3::from_shape_fn((1, positions.len(), 2), |(_, cell, axis)| positions[cell][axis]),
                Boundary::Periodic { lengths: self.honeycomb.lengths() },
            )
        }
    }

    /// The waves of the model; beside them those of the theory unless effects are added.
    pub fn waves(&self, parameters: &Parameters<f64>, effects: &ChosenEffects) -> Result<Waves, Failure> {
        let (tessellation, positions) = (self.honeycomb.tessellation(), self.honeycomb.positions());
        let view = FieldOfView::everywhere().judge(tessellation, positions);
        let surroundings = environment(tessellation, positions, &view)?;
        let base = Model::chiral_voronoi(parameters);
        let model = effects.add_to(base, surroundings, tessellation.domain())?;
        let theory = if effects.is_empty() { mean_field(parameters, 1.0) } else { None };
        let jacobian = self.honeycomb.jacobian(&model);
        let orientation = Orientation::NeighbourAlongY;
        let path = symmetry_path(orientation, STEPS);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        let mut points = Vec::new();
        for point in &path {
            let exact = self.honeycomb.dynamical_matrix(&jacobian, 0, point.q);
            let matrix =
                theory.and_then(|theory: MeanField| theory.dynamical_matrix(point.q, orientation).ok());
            for (k, expected) in matrix.iter().flatten().flatten().enumerate() {
                let found = Complex64::new(exact[0][k / 2][k % 2], exact[1][k / 2][k % 2]);
                worst = worst.max((found - expected).norm());
                largest = largest.max(expected.abs());
            }
            let rates = theory.and_then(|theory| theory.decay_rates(point.q, orientation).ok());
            points.push(DispersionPoint {
                distance: point.distance,
                corner: point.corner.map(|corner| match corner {
                    SymmetryPoint::Gamma => "Γ",
                    SymmetryPoint::K => "K",
                    SymmetryPoint::M => "M",
                }),
                exact: decay_rates(exact),
                theory: rates.map(|rates| rates.map(|rate| [rate.real, rate.imaginary])),
            });
        }
        Ok(Waves {
            points,
            wave_vectors: path.iter().map(|point| point.q).collect(),
            size: self.size,
            largest_difference: theory.map(|_| if largest > 0.0 { worst / largest } else { worst }),
        })
    }

    /// Writes the positions as a data set, and dispersion.npy: path length, wave vector, decay rate and frequency of both
    /// waves of the model, then of the theory.
    pub fn write(&self, out: &mut OutputDirectory, data: &DataSet, waves: &Waves) -> Result<(), Failure> {
        data.save(out)?;
        let table = Array2::from_shape_fn((waves.points.len(), 11), |(row, column)| {
            let point = &waves.points[row];
            match column {
                0 => point.distance,
                1 | 2 => waves.wave_vectors[row][column - 1],
                3..7 => point.exact[(column - 3) / 2][(column - 3) % 2],
                _ => point.theory.map_or(f64::NAN, |theory| theory[(column - 7) / 2][(column - 7) % 2]),
            }
        });
        out.write_array("dispersion.npy", table.view())?;
        Ok(())
    }
}

/// Both eigenvalues of a complex 2 × 2 matrix as decay rate and frequency, the slower decay first.
fn decay_rates([real, imaginary]: [[[f64; 2]; 2]; 2]) -> [[f64; 2]; 2] {
    let entry = |i: usize, j: usize| Complex64::new(real[i][j], imaginary[i][j]);
    let mean = 0.5 * (entry(0, 0) + entry(1, 1));
    let half = 0.5 * (entry(0, 0) - entry(1, 1));
    let root = (half * half + entry(0, 1) * entry(1, 0)).sqrt();
    // The root has no negative real part; a purely imaginary one is given the positive frequency first.
    let first = if root.re > root.im.abs() * 1e-9 { mean - root } else { mean + root * root.im.signum() };
    let second = 2.0 * mean - first;
    [first, second].map(|value| [value.re, value.im])
}
