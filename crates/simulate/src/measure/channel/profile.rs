//! Time averages across a channel.

use super::Estimate;
use super::recorder::Sample;
use crate::Channel;

/// Averages over time and the length of a channel as functions of `x`.
///
/// Over bins:
///
/// ```text
/// ρ = ⟨N_b⟩/(h L)        v = ⟨Σ_b Δr/Δt⟩/⟨N_b⟩        k_prolif, k_extr = births, extrusions per cell and time
/// ```
///
/// with the number of cells `N_b` in a bin of width `h` and the displacements `Δr` of steps `Δt`. The displacement of a step is the
/// average of the model's velocity over it; births and deaths move no cell. At the faces of bins, weighted by the distance from them:
///
/// ```text
/// ∂_x(ρ v_x)/ρ        and        k_prolif − k_extr
/// ```
///
/// which agree in the steady state, since cells are conserved (continuity equation of the main text). Beyond a wall are
/// the mirror images of the cells, which move the other way along x. Along the channel
///
/// ```text
/// ∫ ρ v_y dx    =    σ_yx(W/2) − σ_yx(x)    =    ½ [τ(x) − τ(W/2)] + part of the symmetric shear stress,        τ = σ_xy − σ_yx
/// ```
///
/// from the face at `x` to the middle: the force on the cells between, which is their friction. τ is the density of torques, of
/// cells with a chiral cortex `ρ ⟨α K_P P²⟩`.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelProfile {
    /// Centres of the bins, from the left edge.
    pub centres: Vec<f64>,
    /// Cells per area ρ.
    pub density: Vec<Estimate>,
    /// Velocities v_x and v_y.
    pub velocity: [Vec<Estimate>; 2],
    /// Stress, row = component of the force, of the bonds in a bin (Irving and Kirkwood).
    pub stress: [[Vec<Estimate>; 2]; 2],
    /// Births per cell and time.
    pub birth_rate: Vec<Estimate>,
    /// Extrusions per cell and time.
    pub death_rate: Vec<Estimate>,
    /// Faces of bins: one for both edges of a periodic channel, the first; otherwise with both ends.
    pub faces: Vec<f64>,
    /// ∂_x(ρ v_x)/ρ there.
    pub flux_rate: Vec<Estimate>,
    /// k_prolif − k_extr there, as counted.
    pub net_rate: Vec<Estimate>,
    /// The difference of both: the rate at which cells become fewer there.
    pub imbalance: Vec<Estimate>,
    /// ∫ ρ v_y dx from there to the middle.
    pub transport: Vec<Estimate>,
    /// σ_yx(W/2) − σ_yx there, which drives it.
    pub shear_stress: Vec<Estimate>,
    /// ½ (τ − τ(W/2)) there, the part of it that is due to torques.
    pub torque: Vec<Estimate>,
}

impl ChannelProfile {
    pub(super) fn over_bins(channel: Channel, samples: &[Sample]) -> Self {
        let bins = samples.first().map_or(0, |sample| sample.residence.len());
        let width = channel.width() / bins as f64;
        let area = width * channel.length();
        let around = if channel.is_walled() {
            (0..=bins).map(|face| beside_mirrors(face, bins)).collect()
        } else {
            (0..bins).map(|face| [((face + bins - 1) % bins, 1.0), (face, 1.0)]).collect()
        };
        Self::over(
            samples,
            (width, area),
            around,
            Along { middle: bins / 2, walls: walls(channel, [0, bins]) },
        )
    }

    pub(super) fn over_half(channel: Channel, samples: &[Sample]) -> Self {
        let bins = samples.first().map_or(0, |sample| sample.residence.len());
        let width = 0.5 * channel.width() / bins as f64;
        let area = 2.0 * width * channel.length();
        // Beyond the middle is the other half, and beyond the edge too, or mirror images: v_x is opposite.
        let around = (0..=bins).map(|face| beside_mirrors(face, bins)).collect();
        Self::over(samples, (width, area), around, Along { middle: bins, walls: walls(channel, [0, 0]) })
    }

    /// `around` names the bins left and right of each face, with the sign of the velocity there.
    fn over(
        samples: &[Sample],
        (width, area): (f64, f64),
        around: Vec<[(usize, f64); 2]>,
        Along { middle, walls }: Along,
    ) -> Self {
        let bins = samples.first().map_or(0, |sample| sample.residence.len());
        let over_bins = |pair: &dyn Fn(&Sample, usize) -> (f64, f64)| -> Vec<Estimate> {
            let series = |bin| samples.iter().map(|sample| pair(sample, bin)).collect::<Vec<_>>();
            (0..bins).map(|bin| Estimate::ratio(&series(bin))).collect()
        };
        let over_faces = |pair: &dyn Fn(&Sample, usize) -> (f64, f64)| -> Vec<Estimate> {
            let series = |face| samples.iter().map(|sample| pair(sample, face)).collect::<Vec<_>>();
            (0..around.len()).map(|face| Estimate::ratio(&series(face))).collect()
        };
        let there = |sample: &Sample, face: usize| {
            around[face].iter().map(|&(bin, _)| 0.5 * sample.residence[bin]).sum::<f64>()
        };
        let transport = |sample: &Sample, face: usize| {
            let between = |from: usize, to: usize| sample.displacement[1][from..to].iter().sum::<f64>();
            (if face <= middle { between(face, middle) } else { -between(middle, face) }) * width / area
        };
        // No shear stress and no torque at a wall: they are opposite in the mirror.
        let at_face = |value: &dyn Fn(usize) -> f64, face: usize| match walls {
            Some(walls) if walls.contains(&face) => 0.0,
            _ => 0.5 * (value(around[face][0].0) + value(around[face][1].0)) / area,
        };
        let from_middle =
            |value: &dyn Fn(usize) -> f64, face: usize| at_face(value, face) - at_face(value, middle);
        let flux = |sample: &Sample, face: usize| {
            let [left, right] = around[face].map(|(bin, sign)| sign * sample.displacement[0][bin]);
            (right - left) / width
        };
        Self {
            centres: (0..bins).map(|bin| (bin as f64 + 0.5) * width).collect(),
            density: over_bins(&|sample, bin| (sample.residence[bin] / area, sample.duration)),
            velocity: [0, 1].map(|axis| {
                over_bins(&move |sample: &Sample, bin| {
                    (sample.displacement[axis][bin], sample.residence[bin])
                })
            }),
            stress: [0, 1].map(|row| {
                [0, 1].map(|column| {
                    over_bins(&move |sample: &Sample, bin| {
                        (sample.virial[bin][row][column] / area, sample.duration)
                    })
                })
            }),
            birth_rate: over_bins(&|sample, bin| (sample.births[bin], sample.residence[bin])),
            death_rate: over_bins(&|sample, bin| (sample.deaths[bin], sample.residence[bin])),
            faces: (0..around.len()).map(|face| face as f64 * width).collect(),
            flux_rate: over_faces(&|sample, face| (flux(sample, face), there(sample, face))),
            net_rate: over_faces(&|sample, face| (sample.net_at_face[face], there(sample, face))),
            imbalance: over_faces(&|sample, face| {
                (flux(sample, face) - sample.net_at_face[face], there(sample, face))
            }),
            transport: over_faces(&|sample, face| (transport(sample, face), sample.duration)),
            shear_stress: over_faces(&|sample, face| {
                (-from_middle(&|bin| sample.virial[bin][1][0], face), sample.duration)
            }),
            torque: over_faces(&|sample, face| {
                let [xy, yx] = [[0, 1], [1, 0]]
                    .map(|[row, column]| from_middle(&|bin| sample.virial[bin][row][column], face));
                (0.5 * (xy - yx), sample.duration)
            }),
        }
    }
}

/// Bins left and right of a face, with the sign of v_x there, where v_x is opposite beyond both ends. Faces there are counted twice.
fn beside_mirrors(face: usize, bins: usize) -> [(usize, f64); 2] {
    match face {
        0 => [(0, -1.0), (0, 1.0)],
        face if face == bins => [(bins - 1, 1.0), (bins - 1, -1.0)],
        face => [(face - 1, 1.0), (face, 1.0)],
    }
}

/// What the balance of forces along a channel needs to know of its faces.
struct Along {
    middle: usize,
    /// The faces at walls.
    walls: Option<[usize; 2]>,
}

fn walls(channel: Channel, faces: [usize; 2]) -> Option<[usize; 2]> {
    channel.is_walled().then_some(faces)
}
