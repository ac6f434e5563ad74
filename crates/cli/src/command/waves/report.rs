//! The result as a report.

use super::beside::{Beside, OfShell};
use crate::command::recorded::Recorded;
use voronudge_observables::{Fluctuations, Plan, Relaxation, ShellFluctuations, WaveField, together};
use voronudge_report::Units;
use voronudge_report::infer_report::{Quantity, RunRecord};
use voronudge_report::waves_report::{
    LongWavesRecord, Measured, RelaxationRecord, SpectraRecord, WaveShellRecord, WavesReport,
};

/// Probability below which waves are said not to relax linearly.
pub(super) const NOT_LINEAR: f64 = 0.01;

/// Probability of the differences between D from τ and from 2τ in all shells together, if waves relax linearly.
pub(super) fn linear(found: &Fluctuations) -> Option<f64> {
    together(relaxations(found).map(|own| own.linear))
}

/// Those that were long enough to be told.
fn relaxations(found: &Fluctuations) -> impl Iterator<Item = &Relaxation> {
    found.shells.iter().filter_map(|shell| shell.relaxation.as_ref()).filter(|own| own.is_reliable())
}

pub(super) fn report(
    run: RunRecord,
    units: &Units,
    frames: &[usize],
    (recorded, plan): (&Recorded, &Plan),
    (found, beside): (&Fluctuations, &Beside),
    linear: Option<f64>,
) -> WavesReport {
    WavesReport {
        run,
        units: units.clone(),
        frames: frames.to_vec(),
        frame_interval: Quantity { value: found.interval, unit: units.time.clone() },
        seen: recorded.recording.frames().iter().map(|frame| frame.tracks.len()).collect(),
        length_scale: Quantity { value: plan.spacing(), unit: units.length.clone() },
        velocities: recorded.velocities.name(),
        common_motion_removed: recorded.common_motion_removed,
        field: match found.field {
            WaveField::Displacements => "displacements",
            WaveField::Velocities => "velocities",
        },
        first_lag: found.first_lag,
        parameters: beside.parameters,
        linear,
        verdict: match linear {
            Some(p) if p < NOT_LINEAR => "not_linear",
            Some(_) => "linear",
            None => "unknown",
        },
        achiral: together(relaxations(found).map(|own| own.achiral)),
        localisation: localisation(found, units),
        long_waves: found.long_waves.map(|long| {
            let measured = |i: usize, j: usize| Measured {
                value: long.matrix[i][j],
                standard_error: long.standard_errors[i][j],
                unit: units.powers(2, -1),
            };
            LongWavesRecord {
                B_plus_mu: measured(0, 0),
                mu: measured(1, 1),
                K_o: measured(0, 1),
                A_minus_K_o: measured(1, 0),
                shells: long.shells,
            }
        }),
        spectra: found.structure.as_ref().map(|own| SpectraRecord {
            segment: own.segment,
            segments: own.segments,
            frequencies: own.frequencies.clone(),
        }),
        shells: found.shells.iter().zip(&beside.shells).map(shell).collect(),
    }
}

/// σ_r from the weighted mean over shells of the variance that relaxation does not explain; none where it is not positive.
fn localisation(found: &Fluctuations, units: &Units) -> Option<Measured> {
    if found.field != WaveField::Displacements || found.first_lag == 0 {
        return None;
    }
    let (mut sum, mut weights) = (0.0, 0.0);
    for own in relaxations(found).filter(|own| own.noise_error.is_finite() && own.noise_error > 0.0) {
        let weight = own.noise_error.powi(-2);
        sum += weight * own.noise;
        weights += weight;
    }
    let (variance, error) = (sum / weights, 1.0 / weights.sqrt());
    (variance > 2.0 * error).then(|| {
        let value = variance.sqrt();
        Measured { value, standard_error: 0.5 * error / value, unit: units.powers(1, 0) }
    })
}

fn shell((shell, beside): (&ShellFluctuations, &OfShell)) -> WaveShellRecord {
    WaveShellRecord {
        wave_number: shell.wave_number,
        wave_vectors: shell.wave_vectors.len(),
        relaxation: shell.relaxation.as_ref().map(|own| RelaxationRecord {
            lag: own.lag,
            matrix: own.matrix,
            standard_errors: own.standard_errors,
            matrix_at_twice_the_lag: own.twice,
            uncorrected: own.uncorrected,
            linear: own.linear,
            achiral: own.achiral,
            decay_rates: own.decay_rates,
            decay_errors: own.decay_errors,
            frequency: own.frequency,
            frequency_ci95: own.frequency_interval,
            stretches: own.stretches,
            relaxations: own.relaxations,
            reliable: own.is_reliable(),
        }),
        jacobian: beside.projected,
        jacobian_relaxed: beside.relaxed,
        mean_field: beside.theory,
    }
}
