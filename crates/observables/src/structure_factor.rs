//! Density and velocity in Fourier space.

use rayon::prelude::*;
use voronudge_geometry::{PeriodicBox, Vector};

/// Structure factors in a shell of wave numbers, averaged over the wave vectors of the box in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StructureFactor {
    /// Mean wave number of the shell, in 1/length.
    pub wave_number: f64,
    /// Number of wave vectors `±q` in the shell, each pair counted once.
    pub wave_vectors: usize,
    /// `S(q) = |Σ_i exp(−i q·r_i)|²/N` of the density: 1 for random positions.
    pub density: f64,
    /// `|Σ_i q̂·v_i exp(−i q·r_i)|²/N`: compression waves, in the square of the unit of velocity.
    pub longitudinal: f64,
    /// `|Σ_i (ẑ × q̂)·v_i exp(−i q·r_i)|²/N`: shear waves and vortices.
    pub transverse: f64,
}

/// Structure factors of positions and velocities (N each) in a periodic box up to a wave number, in shells of width
/// `2π/max(L_x, L_y)`. Velocities may be empty; their parts are then zero.
///
/// Every wave vector of the box up to `largest` is summed exactly, at a cost of N sines and cosines each.
///
/// ```
/// use voronudge_geometry::{PeriodicBox, honeycomb};
/// use voronudge_observables::structure_factor;
/// let (positions, lengths) = honeycomb(12, 12);
/// let cell_box = PeriodicBox::new(lengths)?;
/// // A perfect crystal does not scatter below its first Bragg peak, 4π/(a√3) for a spacing a.
/// let spacing = (2.0 / 3f64.sqrt()).sqrt();
/// let peak = 4.0 * std::f64::consts::PI / (spacing * 3f64.sqrt());
/// let shells = structure_factor(&positions, &[], &cell_box, 0.9 * peak);
/// assert!(shells.iter().all(|shell| shell.density < 1e-20));
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn structure_factor(
    positions: &[Vector<f64>],
    velocities: &[Vector<f64>],
    cell_box: &PeriodicBox,
    largest: f64,
) -> Vec<StructureFactor> {
    let [width, height] = cell_box.lengths();
    let shell_width = std::f64::consts::TAU / width.max(height);
    let vectors = wave_vectors(cell_box, largest);
    let cells: Vec<Scatterer<1>> = positions
        .iter()
        .enumerate()
        .map(|(i, r)| Scatterer { place: *r, velocity: velocities.get(i).copied(), weights: [1.0] })
        .collect();
    let count = positions.len().max(1) as f64;
    let of_wave = |q: &Vector<f64>| {
        let [sums] = amplitudes(&cells, *q);
        let [density, longitudinal, transverse] = sums.map(|sum| sum.norm_squared() / count);
        [q.norm(), density, longitudinal, transverse]
    };
    let amplitudes: Vec<[f64; 4]> = vectors.par_iter().map(of_wave).collect();
    let mut shells = vec![(0, [0.0; 4]); (largest / shell_width) as usize + 1];
    for amplitudes in amplitudes {
        let shell = &mut shells[(amplitudes[0] / shell_width - 0.5).max(0.0) as usize];
        shell.0 += 1;
        shell.1.iter_mut().zip(amplitudes).for_each(|(sum, value)| *sum += value);
    }
    shells
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, sums)| {
            let [wave_number, density, longitudinal, transverse] = sums.map(|sum| sum / count as f64);
            StructureFactor { wave_number, wave_vectors: count, density, longitudinal, transverse }
        })
        .collect()
}

/// One of each pair `±q` of wave vectors of the box: `q · (lattice vector)` is a multiple of 2π.
pub(crate) fn wave_vectors(cell_box: &PeriodicBox, largest: f64) -> Vec<Vector<f64>> {
    let [width, height] = cell_box.lengths();
    let tau = std::f64::consts::TAU;
    let most = |length: f64| (largest * length / tau).ceil() as i32;
    let columns = most(width);
    // Rows are displaced by the shear of the box.
    let rows = most(height) + (f64::from(columns) * (cell_box.offset() / width).abs()).ceil() as i32;
    (0..=columns)
        .flat_map(|column| (-rows..=rows).map(move |row| (column, row)))
        .filter(|&(column, row)| column > 0 || row > 0)
        .map(|(column, row)| {
            let x = tau * f64::from(column) / width;
            Vector::new(x, (tau * f64::from(row) - x * cell_box.offset()) / height)
        })
        .filter(|q| q.norm() <= largest)
        .collect()
}

/// A cell that waves are scattered by, with its weight in each of some tapers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scatterer<const T: usize> {
    pub place: Vector<f64>,
    pub velocity: Option<Vector<f64>>,
    pub weights: [f64; T],
}

/// For each taper, `Σ_i w_i exp(−i q·r_i)` of the density and of the velocities along and across the wave vector, as (real, imaginary).
pub(crate) fn amplitudes<const T: usize>(cells: &[Scatterer<T>], q: Vector<f64>) -> [[Vector<f64>; 3]; T] {
    let direction = q / q.norm();
    let mut sums = [[Vector::zeros(); 3]; T];
    for cell in cells {
        let (sin, cos) = q.dot(&cell.place).sin_cos();
        let wave = Vector::new(cos, -sin);
        let v = cell.velocity.unwrap_or_default();
        let (along, across) = (direction.dot(&v), direction.x * v.y - direction.y * v.x);
        for (sums, weight) in sums.iter_mut().zip(cell.weights) {
            sums[0] += wave * weight;
            sums[1] += wave * (along * weight);
            sums[2] += wave * (across * weight);
        }
    }
    sums
}
