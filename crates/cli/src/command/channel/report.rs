//! What is read off the profiles: decays, conservation, the theory beside them, the chirality of the flow.

use super::continuum::{Continuum, Liquid, Theory};
use super::request::ChannelRequest;
use crate::arguments::named;
use crate::command::estimate_chirality::{Tissue, line_points, slope};
use crate::failure::Failure;
use crate::run::Run;
use voronudge_infer::{DecayFit, DecayPoint, DecayShape, Intercept, fit_decay};
use voronudge_report::channel_report::{
    CellNumbers, ChannelReport, ConservationRecord, CycleRecord, DecayRecord, DisturbanceRecord,
    MomentumRecord, TurnoverRecord,
};
use voronudge_report::infer_report::InputFile;
use voronudge_simulate::measure::{ChannelProfile, Estimate};
use voronudge_simulate::{ChannelRun, Injection, LivingTissue, Proliferation};

/// Everything that is derived from the folded profile.
pub(super) struct Findings {
    pub report: ChannelReport,
    pub continuum: Option<Continuum>,
    pub liquid: Option<Liquid>,
    pub fits: Vec<(&'static str, DecayFit, DecayShape)>,
    /// Distance from the edge from which on decays and the slope are fitted.
    pub from: f64,
}

/// Births come about within this many decay lengths of their weight; beyond, profiles decay.
const BIRTH_LAYER: f64 = 3.0;
/// Cells within this many cell sizes of a wall are in rows along it, and flow with the edge current.
const WALL_LAYER: f64 = 2.0;

pub(super) fn findings(
    run: &mut Run,
    request: &ChannelRequest,
    (tissue, outcome): (&LivingTissue, &ChannelRun),
    folded: &ChannelProfile,
    (disturbance, cycles): (Option<DisturbanceRecord>, Option<CycleRecord>),
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
    let theory = Theory::of(request, folded);
    let continuum = theory.as_ref().and_then(Theory::mean_field);
    let liquid = (theory.as_ref().zip(request.equation.as_ref()))
        .map(|(theory, own)| theory.liquid(&own.equation, from))
        .transpose()?;
    if let Some(beyond) = liquid.as_ref().map(|own| own.record.places_beyond).filter(|count| *count > 0) {
        run.warn(format!(
            "in {beyond} of {} strips the density is beyond the equation of state, which goes on there as a straight line",
            folded.centres.len()
        ));
    }
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
    let mut record = run.record(None);
    record.inputs = (request.equation.iter())
        .map(|own| InputFile { path: own.input.path.display().to_string(), sha256: own.input.sha256.clone() })
        .collect();
    let report = ChannelReport {
        run: record,
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
                Injection::Cycle(_) => "cycle",
            },
            division_distance: match turnover.injection {
                Injection::Vertex => None,
                Injection::Division { distance } => Some(distance),
                Injection::Cycle(cycle) => cycle.distance,
            },
            cycle: cycles,
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
            // Of the two lives that a division begins one goes on for the mother's.
            births: lives.len() - request.cells - lives.iter().filter(|life| life.divided.is_some()).count(),
            extrusions: lives.iter().filter(|life| life.extruded.is_some()).count(),
        },
        ended: outcome.ended.as_ref().map(ToString::to_string),
        decays,
        conservation: conservation(folded),
        momentum: momentum(folded, from),
        continuum: continuum.as_ref().map(|continuum| continuum.record),
        liquid: liquid.as_ref().map(|liquid| liquid.record),
        chirality_from_flow,
        birth_disturbance: disturbance,
    };
    Ok(Findings { report, continuum, liquid, fits, from })
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
