//! The result as a report.

use super::pattern::TrackedPattern;
use crate::run::Run;
use voronudge_infer::phase_diffusion::{
    DiffusivityEstimate, Fluctuations, PhaseDiffusion, PhaseRequest, RateOrder, ReferencePlaces,
};
use voronudge_io::DataSet;
use voronudge_report::Units;
use voronudge_report::infer_report::Quantity;
use voronudge_report::phase_diffusion_report::{
    Diffusivities, Diffusivity, ImpliedModuli, PhaseDiffusionReport, WaveVectorRecord,
};
use voronudge_theory::PhaseDiffusivities;

pub(super) fn report(
    run: &Run,
    data: &DataSet,
    request: &PhaseRequest,
    tracked: &TrackedPattern,
    frames: &[usize],
    found: &PhaseDiffusion,
) -> PhaseDiffusionReport {
    let units = Units { length: data.length_unit.clone(), time: data.time_unit.clone() };
    let unit = units.powers(2, -1);
    let area = tracked.pattern.domain.area() / cells_in(data, frames.first().copied().unwrap_or(0)) as f64;
    let estimate = |estimate: &DiffusivityEstimate| Diffusivity {
        value: estimate.value,
        standard_error: estimate.standard_error,
        ci95: estimate.interval,
        unit: unit.clone(),
    };
    // Friction of a cell is one, so ζ = 1/ℓ₀² and moduli are rates.
    let moduli = PhaseDiffusivities {
        parallel: found.parallel.value,
        perpendicular: found.perpendicular.value,
        parallel_cross: found.parallel_cross.value,
        perpendicular_cross: found.perpendicular_cross.value,
    }
    .moduli(1.0 / area);
    let modulus = |value: f64| Quantity { value, unit: units.powers(0, -1) };
    PhaseDiffusionReport {
        run: run.record(Some(data)),
        frames: frames.to_vec(),
        cells: tracked.cells.len(),
        length_scale: Quantity { value: area.sqrt(), unit: units.length.clone() },
        reference: match request.reference {
            ReferencePlaces::Given => "given",
            ReferencePlaces::Free => "free",
        },
        fluctuations: match request.fluctuations {
            Fluctuations::Measurement => "measurement",
            Fluctuations::Driving => "driving",
        },
        order: match request.order {
            RateOrder::Second => "second",
            RateOrder::Fourth => "fourth",
        },
        diffusivities: Diffusivities {
            D_parallel: estimate(&found.parallel),
            D_perp: estimate(&found.perpendicular),
            D_parallel_cross: estimate(&found.parallel_cross),
            D_perp_cross: estimate(&found.perpendicular_cross),
        },
        moduli: ImpliedModuli {
            B: modulus(moduli.bulk),
            A: modulus(moduli.odd_bulk),
            mu: modulus(moduli.shear),
            K_o: modulus(moduli.odd_shear),
        },
        chirality_significance: found.chirality.max(0.0).sqrt(),
        residual: found.residual,
        explained: found.explained,
        residual_correlation: found.residual_correlation,
        wave_vectors: found
            .waves
            .iter()
            .zip(&found.own)
            .map(|(wave, own)| WaveVectorRecord {
                q: [wave.q.x, wave.q.y],
                amplitude: wave.amplitude(),
                matrix: own.map(|own| own.matrix),
                standard_errors: own.map(|own| own.standard_errors),
            })
            .collect(),
        units,
    }
}

/// Cells present in a frame, tracked throughout or not: together they fill the box.
fn cells_in(data: &DataSet, frame: usize) -> usize {
    (0..data.cells()).filter(|&cell| data.positions[(frame, cell, 0)].is_finite()).count()
}
