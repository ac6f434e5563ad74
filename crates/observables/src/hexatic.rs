//! Bond-orientational order.

use voronudge_geometry::{Tessellation, Vector};

/// The hexatic order of a state, from `ψ_i = (1/z_i) Σ_j exp(6iθ_ij)` over the neighbours `j` of each cell, in directions
/// `θ_ij`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hexatic {
    /// `(1/N) Σ_i ψ_i` as (real, imaginary): the average of cells, then its modulus and direction. It vanishes for many
    /// grains of different orientations.
    pub average: Vector<f64>,
    /// `(1/N) Σ_i |ψ_i|`: how hexagonal the neighbourhoods are, whatever their orientations.
    pub mean_modulus: f64,
}

impl Hexatic {
    /// `Ψ₆ = |(1/N) Σ_i ψ_i|`: one on a triangular lattice, `1/√N` or so where directions are random.
    pub fn order(&self) -> f64 {
        self.average.norm()
    }
}

/// The hexatic order of a state of positions (N). A pass over all neighbours.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
/// use voronudge_observables::hexatic;
/// let height = 3f64.sqrt() / 2.0;
/// let positions: Vec<_> = (0..16)
///     .map(|i| Vector::new((i % 4) as f64 + 0.5 * (i / 4 % 2) as f64, (i / 4) as f64 * height))
///     .collect();
/// let domain = Domain::Periodic(PeriodicBox::new([4.0, 4.0 * height])?);
/// let tessellation = Tessellation::new(&positions, domain)?;
/// let hexatic = hexatic(&tessellation, &positions);
/// assert!((hexatic.order() - 1.0).abs() < 1e-12 && (hexatic.mean_modulus - 1.0).abs() < 1e-12);
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
pub fn hexatic(tessellation: &Tessellation, positions: &[Vector<f64>]) -> Hexatic {
    hexatic_among(tessellation, positions, |_| true)
}

/// The same over the cells that count, with all their neighbours: between walls those that are no images.
pub fn hexatic_among(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    counts: impl Fn(usize) -> bool,
) -> Hexatic {
    let (mut sum, mut moduli, mut cells) = (Vector::zeros(), 0.0, 0usize);
    for cell in (0..tessellation.len()).filter(|&cell| counts(cell)) {
        cells += 1;
        let own = of_cell(tessellation, positions, cell);
        sum += own;
        moduli += own.norm();
    }
    let cells = cells.max(1) as f64;
    Hexatic { average: sum / cells, mean_modulus: moduli / cells }
}

/// `ψ_i` of one cell, as (real, imaginary).
pub(crate) fn of_cell(tessellation: &Tessellation, positions: &[Vector<f64>], cell: usize) -> Vector<f64> {
    let ring = tessellation.ring(cell);
    let sides = ring.len().max(1) as f64;
    let sum: Vector<f64> = ring
        .map(|h| {
            let d = tessellation.displacement(positions, cell, h);
            let angle = 6.0 * d.y.atan2(d.x);
            Vector::new(angle.cos(), angle.sin())
        })
        .sum();
    sum / sides
}
