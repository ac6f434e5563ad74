//! What is read off the profiles: decays, conservation, the theory beside them, the chirality of the flow.

use super::request::ChannelRequest;
use crate::arguments::named;
use crate::command::estimate_chirality::{Tissue, line_points, slope};
use crate::failure::Failure;
use crate::run::Run;
use voronudge_infer::{DecayFit, DecayPoint, DecayShape, Intercept, fit_decay};
use voronudge_report::channel_report::{
    CellNumbers, ChannelReport, ConservationRecord, ContinuumRecord, DecayRecord, DisturbanceRecord,
    MomentumRecord, TurnoverRecord,
};
use voronudge_simulate::measure::{ChannelProfile, Estimate};
use voronudge_simulate::{ChannelRun, Injection, LivingTissue, Proliferation};
use voronudge_theory::{ChannelEvolution, ChannelMedium, ChannelTurnover, MeanField, Parameters};

/// The steady state of the continuum theory, in the units of the request: distances and `ρ`, distances and velocities.
pub(super) struct Continuum {
    pub record: ContinuumRecord,
    pub density: Vec<[f64; 2]>,
    pub velocity: [Vec<[f64; 2]>; 2],
}

/// Everything that is derived from the folded profile.
pub(super) struct Findings {
    pub report: ChannelReport,
    pub continuum: Option<Continuum>,
    pub fits: Vec<(&'static str, DecayFit, DecayShape)>,
    /// Distance from the edge from which on decays and the slope are fitted.
    pub from: f64,
}

/// Births come about within this many decay lengths of their weight; beyond, profiles decay.
const BIRTH_LAYER: f64 = 3.0;
/// Cells within this many cell sizes of a wall are in rows along it, and flow with the edge current.
const WALL_LAYER: f64 = 2.0;
/// Grid cells of the theory for the shorter of both decay lengths, and how many it has at most.
const RESOLUTION: f64 = 4.0;
const FINEST: usize = 400;

pub(super) fn findings(
    run: &Run,
    request: &ChannelRequest,
    (tissue, outcome): (&LivingTissue, &ChannelRun),
    folded: &ChannelProfile,
    disturbance: Option<DisturbanceRecord>,
) -> Result<Findings, Failure> {
    let width = request.cell_box.lengths()[0];
    // Founders are lives too; everything else was born.
    let lives = tissue.lives();
    let at_walls = request.walls.map_or(0.0, |_| WALL_LAYER * request.cell_size);
    let from = (BIRTH_LAYER * request.proliferation_length()).max(at_walls).min(0.25 * width);
    let profiles: [(&str, &[Estimate], DecayShape); 3] = [
        ("density", &folded.density, DecayShape::Even),
        ("velocity_x", &folded.velocity[0], DecayShape::Odd),
        ("velocity_y", &folded.velocity[1], DecayShape::Odd),
    ];
    let fits: Vec<_> = profiles
        .into_iter()
        .filter_map(|(name, profile, shape)| {
            let points = folded.centres.iter().zip(profile).filter(|(d, _)| **d >= from);
            let points: Vec<DecayPoint> = points
                .map(|(&distance, at)| DecayPoint {
                    distance,
                    value: at.value,
                    error: at.error.unwrap_or(f64::NAN),
                })
                .collect();
            fit_decay(&points, width, shape).map(|fit| (name, fit, shape))
        })
        .collect();
    let decays = fits.iter().map(|(name, fit, _)| (*name, decay(fit, from))).collect();
    let continuum = continuum(request, folded);
    let p = &request.parameters;
    let shape_index = p.preferred_perimeter / request.cell_size;
    let about = Tissue {
        shape_index: Some(shape_index),
        area_elasticity: p.area_elasticity * request.cell_size * request.cell_size / p.perimeter_elasticity,
    };
    let points = line_points(&folded.centres, &folded.velocity);
    let mut chirality_from_flow = slope(&points, [Some(from), None], Intercept::Zero, about).unwrap_or(None);
    // The edge current along a wall is no matter of the gradient of the density.
    if let Some(record) = chirality_from_flow.as_mut().filter(|_| tissue.channel().is_walled()) {
        (record.alpha, record.alpha_ci95) = (None, None);
    }
    let turnover = &request.turnover;
    let report = ChannelReport {
        run: run.record(None),
        units: request.units.clone(),
        width,
        length: request.cell_box.lengths()[1],
        walls: tissue.channel().is_walled().then_some("x"),
        cell_size: request.cell_size,
        parameters: named(p),
        turnover: TurnoverRecord {
            extrusion_rate: turnover.extrusion.rate,
            extrusion_length: turnover.extrusion.decay_length,
            proliferation: match turnover.proliferation {
                Proliferation::Replacing { .. } => "replacing",
                Proliferation::Independent(_) => "independent",
            },
            proliferation_rate: match turnover.proliferation {
                Proliferation::Replacing { .. } => None,
                Proliferation::Independent(rate) => Some(rate.rate),
            },
            proliferation_length: request.proliferation_length(),
            injection: match turnover.injection {
                Injection::Vertex => "vertex",
                Injection::Division { .. } => "division",
            },
            division_distance: match turnover.injection {
                Injection::Vertex => None,
                Injection::Division { distance } => Some(distance),
            },
        },
        relaxation: request.schedule.relaxation,
        time: request.schedule.time,
        dt: request.schedule.steps()?.1,
        samples: outcome.recorder.samples(),
        bins: request.schedule.bins,
        steps: outcome.steps,
        cells: CellNumbers {
            first: request.cells,
            last: tissue.identities().len(),
            fewest: outcome.cells[0],
            most: outcome.cells[1],
            births: lives.len() - request.cells,
            extrusions: lives.iter().filter(|life| life.extruded.is_some()).count(),
        },
        ended: outcome.ended.as_ref().map(ToString::to_string),
        decays,
        conservation: conservation(folded),
        momentum: momentum(folded, from),
        continuum: continuum.as_ref().map(|continuum| continuum.record),
        chirality_from_flow,
        birth_disturbance: disturbance,
    };
    Ok(Findings { report, continuum, fits, from })
}

fn decay(fit: &DecayFit, from: f64) -> DecayRecord {
    DecayRecord {
        length: fit.length,
        length_ci95: fit.length_interval,
        amplitude: fit.amplitude,
        amplitude_error: fit.amplitude_error,
        background: fit.background,
        reduced_chi_square: fit.reduced_chi_square,
        from,
    }
}

fn conservation(folded: &ChannelProfile) -> ConservationRecord {
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.filter(|x| x.is_finite()).fold(0.0, f64::max);
    let in_errors =
        |at: &Estimate| at.value.abs() / at.error.filter(|error| *error > 0.0).unwrap_or(f64::NAN);
    ConservationRecord {
        faces: folded.faces.len(),
        largest_difference: largest(&mut folded.imbalance.iter().map(|at| at.value.abs())),
        largest_in_errors: largest(&mut folded.imbalance.iter().map(in_errors)),
        largest_rate: largest(&mut folded.net_rate.iter().map(|at| at.value.abs())),
    }
}

fn momentum(folded: &ChannelProfile, from: f64) -> MomentumRecord {
    let beyond = folded.faces.iter().position(|distance| *distance >= from);
    let face = beyond.unwrap_or(folded.faces.len() - 1);
    let at = |profile: &[Estimate]| (profile[face].value, profile[face].error);
    MomentumRecord {
        distance: folded.faces[face],
        transport: at(&folded.transport),
        shear_stress: at(&folded.shear_stress),
        torque: at(&folded.torque),
    }
}

/// The theory has lengths in ℓ₀ and times in 1/K_P.
fn continuum(request: &ChannelRequest, folded: &ChannelProfile) -> Option<Continuum> {
    let Proliferation::Replacing { decay_length } = request.turnover.proliferation else {
        return None;
    };
    let (size, p) = (request.cell_size, &request.parameters);
    let theory = MeanField::new(Parameters {
        area_elasticity: p.area_elasticity * size * size / p.perimeter_elasticity,
        perimeter_elasticity: 1.0,
        preferred_perimeter: p.preferred_perimeter / size,
        chirality: p.chirality,
    });
    let medium = ChannelMedium::mean_field(&theory.ok()?).ok()?;
    let extrusion = request.turnover.extrusion;
    let width = request.cell_box.lengths()[0] / size;
    let turnover = ChannelTurnover {
        width,
        extrusion_rate: extrusion.rate / p.perimeter_elasticity,
        // Far longer than the channel is the same everywhere.
        extrusion_length: (extrusion.decay_length / size).min(1e6 * width),
        proliferation_length: (decay_length / size).min(1e6 * width),
    };
    let shortest = turnover.extrusion_length.min(turnover.proliferation_length);
    let cells = ((RESOLUTION * 0.5 * width / shortest).ceil() as usize).clamp(40, FINEST);
    let mut flow = ChannelEvolution::new(medium, turnover, cells).ok()?;
    flow.settle(1e-4 * turnover.extrusion_rate, 20.0 * width * width / medium.longitudinal);
    let speed = size * p.perimeter_elasticity;
    let mean = 1.0 / (size * size);
    let [v_x, v_y] = flow.velocities();
    let faces = flow.faces();
    let scaled =
        |v: &[f64]| -> Vec<[f64; 2]> { faces.iter().zip(v).map(|(d, v)| [d * size, v * speed]).collect() };
    let velocity = [scaled(&v_x), scaled(&v_y)];
    let centres = flow.centres();
    let density = centres.iter().zip(flow.density()).map(|(d, rho)| [d * size, rho * mean]).collect();
    let difference = |axis: usize, unit: f64| {
        let off = folded.centres.iter().zip(&folded.velocity[axis]);
        let squares: Vec<f64> =
            off.map(|(d, at)| ((at.value - interpolated(&velocity[axis], *d)) / unit).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let peak = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let record = ContinuumRecord {
        longitudinal: medium.longitudinal * size * size * p.perimeter_elasticity,
        transverse: medium.transverse * size * size * p.perimeter_elasticity,
        ratio: medium.transverse / medium.longitudinal,
        velocity_x_difference: difference(0, peak(&mut velocity[0].iter().map(|at| at[1]))),
        velocity_y_difference: difference(1, peak(&mut folded.velocity[1].iter().map(|at| at.value))),
    };
    Some(Continuum { record, density, velocity })
}

/// Between points of a curve with ascending places, on a line.
fn interpolated(curve: &[[f64; 2]], x: f64) -> f64 {
    let after = curve.partition_point(|at| at[0] < x).clamp(1, curve.len() - 1);
    let ([x0, y0], [x1, y1]) = (curve[after - 1], curve[after]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
