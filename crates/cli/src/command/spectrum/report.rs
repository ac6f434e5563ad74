//! The modes as a report.

use super::frame::Solved;
use super::lattice::Waves;
use super::request::ModeRequest;
use super::strip::{Bands, EndedLattice};
use super::theory::mean_field;
use crate::arguments::{ChosenEffects, OfCells, named};
use crate::run::Run;
use voronudge_io::DataSet;
use voronudge_model::Parameters;
use voronudge_report::Units;
use voronudge_report::spectrum_report::{
    FrameSpectrum, LatticeRecord, MeanFieldRecord, ModeRecord, SpectrumReport, TransitionRecord, WallsRecord,
};
use voronudge_simulate::Walls;
use voronudge_spectrum::Scope;
use voronudge_theory::{Phase, hexagon_perimeter};

/// Wave vectors along each direction for averages over the Brillouin zone.
const MESH: usize = 60;

pub(super) fn report(
    run: &Run,
    data: &DataSet,
    (parameters, own, effects): (&Parameters<f64>, OfCells, &ChosenEffects),
    request: &ModeRequest,
    solved: &[Solved],
    (waves, strip): (Option<&Waves>, Option<(&EndedLattice, &Bands)>),
) -> SpectrumReport {
    let length = solved.first().map_or(1.0, |one| one.length);
    let theory = if effects.is_empty() && own.is_empty() { mean_field(parameters, length) } else { None };
    SpectrumReport {
        run: run.record(Some(data)),
        units: Units { length: data.length_unit.clone(), time: data.time_unit.clone() },
        selection: request.record(),
        parameters: named(parameters),
        cell_parameters: own.0,
        effects: effects.named(),
        mean_field: theory.map(|theory| MeanFieldRecord {
            phase: match theory.phase() {
                Phase::Solid => "solid",
                Phase::OddElasticSolid => "odd_elastic_solid",
                Phase::Unstable => "unstable",
            },
            stability_limit: hexagon_perimeter() * length,
            exceptional_chirality: theory.exceptional_chirality(),
            mean_square_frequency: theory.mean_square_frequency(MESH),
        }),
        frames: solved.iter().map(|one| frame(one, parameters.perimeter_elasticity)).collect(),
        lattice: waves.map(|waves| LatticeRecord {
            size: waves.size,
            points: waves.points.len(),
            largest_difference: waves.largest_difference,
        }),
        strip: strip.map(|(ended, bands)| bands.record(ended)),
    }
}

fn frame(solved: &Solved, k_p: f64) -> FrameSpectrum {
    let modes = &solved.modes;
    let counts = modes.counts();
    let square = modes.mean_square_frequency();
    let record = |index: Option<usize>| {
        index.map(|index| {
            let mode = modes.modes[index];
            ModeRecord {
                index,
                rate: mode.value.re,
                frequency: mode.value.im,
                participation: mode.participation,
                longitudinal: mode.longitudinal,
                condition: mode.condition,
                overlap: mode.overlap,
            }
        })
    };
    let (shift, reach) = match modes.scope {
        Scope::All => (None, None),
        Scope::Part { shift, reach } => (Some([shift.re, shift.im]), Some(reach)),
    };
    FrameSpectrum {
        frame: solved.frame,
        present: solved.snapshot.cells.len(),
        counted: solved.problem.cells().len(),
        length_scale: solved.length,
        modes: modes.modes.len(),
        decaying: counts.decaying,
        growing: counts.growing,
        neutral: counts.neutral,
        zero: counts.zero,
        oscillating: counts.oscillating,
        tolerance: modes.tolerance,
        mean_square_frequency: square,
        mean_square_frequency_over_k_p: square.filter(|_| k_p != 0.0).map(|square| square / (k_p * k_p)),
        largest_growth: record(modes.most_unstable()),
        fastest_oscillation: record(modes.fastest_oscillation()),
        exceptional: record(modes.nearest_exceptional()),
        shift,
        reach,
        largest_residual: modes.modes.iter().filter_map(|mode| mode.residual).reduce(f64::max),
        transition: solved.transition.map(|t| TransitionRecord {
            shortest_side: t.shortest_side,
            cells: t.cells.map(|cell| solved.snapshot.cells[cell]),
            smallest_gap: t.smallest_gap,
            short_sides: t.short_sides,
            sides: t.sides,
        }),
        walls: solved.localised.as_ref().map(|own| {
            let shares = || own.modes.iter().map(|mode| mode.edge);
            WallsRecord {
                sides: if own.walls == Walls::X { "x" } else { "both" },
                cells: own.share,
                mean_share: shares().sum::<f64>() / own.modes.len() as f64,
                mostly: shares().filter(|share| *share > 0.5).count(),
            }
        }),
    }
}
