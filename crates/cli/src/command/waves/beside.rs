//! D(q) of a model beside what was measured: of its Jacobian on the cells of the recording, and of the mean-field theory.

use crate::command::spectrum::mean_field;
use crate::failure::Failure;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, Tessellation, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_observables::{Fluctuations, Plan, Recording, WaveField};
use voronudge_report::ModelParameters;
use voronudge_report::waves_report::Rates;
use voronudge_spectrum::LinearProblem;

/// Frames whose Jacobians are averaged, at most, where cells do not keep their places.
const SNAPSHOTS: usize = 5;

/// Points of the lines of the theory.
const LINE: usize = 80;

/// What stands beside the measurement.
pub(super) struct Beside {
    /// Parameters of the model, if there is one.
    pub parameters: Option<ModelParameters>,
    /// For each shell.
    pub shells: Vec<OfShell>,
    /// Wave numbers and D(q) of the theory.
    pub line: Vec<(f64, Rates)>,
}

/// D(q) of a shell.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OfShell {
    pub projected: Option<Rates>,
    pub relaxed: Option<Rates>,
    pub theory: Option<Rates>,
}

/// Cells at one time.
struct Snapshot {
    tessellation: Tessellation,
    positions: Vec<Vector<f64>>,
    counted: Vec<bool>,
    stage: Vector<f64>,
}

impl Beside {
    pub fn nothing(found: &Fluctuations) -> Self {
        Self { parameters: None, shells: vec![OfShell::default(); found.shells.len()], line: Vec::new() }
    }

    pub fn new(
        recording: &Recording,
        plan: &Plan,
        found: &Fluctuations,
        parameters: &Parameters<f64>,
        tell: &mut dyn FnMut(usize, usize) -> ControlFlow<()>,
    ) -> Result<Self, Failure> {
        let model = Model::chiral_voronoi(parameters);
        let snapshots = snapshots(recording, found.field)?;
        let waves: Vec<Vec<Vector<f64>>> =
            found.shells.iter().map(|shell| shell.wave_vectors.clone()).collect();
        let mut projected = vec![[[0.0; 2]; 2]; waves.len()];
        let mut relaxed = projected.clone();
        let mut sound = true;
        for (done, own) in snapshots.iter().enumerate() {
            if tell(done, snapshots.len()).is_break() {
                return Err(Failure::interrupted());
            }
            let problem =
                LinearProblem::new(&own.tessellation, &own.positions, &model, |cell| own.counted[cell])?;
            let tapers: Vec<Vec<f64>> = match own.tessellation.domain() {
                Domain::Periodic(_) => vec![vec![1.0; problem.cells().len()]],
                Domain::Open => {
                    let weights: Vec<_> = problem
                        .cells()
                        .iter()
                        .map(|cell| plan.tapers(own.positions[*cell] - own.stage))
                        .collect();
                    let count = weights.first().map_or(0, |weights| weights.len());
                    (0..count).map(|k| weights.iter().map(|weights| weights[k]).collect()).collect()
                }
            };
            let share = 1.0 / (snapshots.len() * tapers.len()) as f64;
            for (mean, waves) in projected.iter_mut().zip(&waves) {
                tapers.iter().for_each(|taper| add(mean, problem.projected(waves, taper), share));
            }
            match own.tessellation.domain() {
                Domain::Periodic(_) => match problem.relaxed(&waves) {
                    Ok(all) => {
                        let share = 1.0 / snapshots.len() as f64;
                        relaxed.iter_mut().zip(all).for_each(|(mean, one)| add(mean, one, share));
                    }
                    Err(_) => sound = false,
                },
                // Cells at the rim are held, which long waves would feel.
                Domain::Open => sound = false,
            }
        }
        let length = plan.spacing();
        let theory = mean_field(parameters, length);
        let of_theory =
            |q: f64| theory.as_ref().and_then(|theory| theory.isotropic_dynamical_matrix(q * length).ok());
        let shells = (found.shells.iter().zip(&projected).zip(&relaxed))
            .map(|((shell, projected), relaxed)| OfShell {
                projected: Some(*projected),
                relaxed: sound.then_some(*relaxed),
                theory: of_theory(shell.wave_number),
            })
            .collect();
        let end = found.shells.last().map_or(0.0, |shell| shell.wave_number);
        let line = (0..=LINE)
            .map(|k| end * k as f64 / LINE as f64)
            .filter_map(|q| Some((q, of_theory(q)?)))
            .collect();
        Ok(Self { parameters: Some(crate::arguments::named(parameters)), shells, line })
    }
}

fn add(mean: &mut Rates, one: Rates, share: f64) {
    for (mean, one) in mean.as_flattened_mut().iter_mut().zip(one.as_flattened()) {
        *mean += share * one;
    }
}

/// Cells at their mean places where they keep them in a periodic box and are always seen, else some frames.
fn snapshots(recording: &Recording, field: WaveField) -> Result<Vec<Snapshot>, Failure> {
    let frames = recording.frames();
    let whole = frames.iter().all(|frame| frame.tracks.len() == recording.tracks());
    let domain = frames.first().map(|frame| frame.tessellation.domain());
    if let (WaveField::Displacements, true, Some(domain @ Domain::Periodic(_))) = (field, whole, domain) {
        let mut positions = vec![Vector::zeros(); recording.tracks()];
        for frame in frames {
            for (mean, r) in positions.iter_mut().zip(&frame.positions) {
                *mean += (r - frame.stage) / frames.len() as f64;
            }
        }
        let tessellation = Tessellation::new(&positions, domain)?;
        let counted = vec![true; positions.len()];
        return Ok(vec![Snapshot { tessellation, positions, counted, stage: Vector::zeros() }]);
    }
    let count = frames.len().min(SNAPSHOTS);
    let chosen = (0..count).map(|k| &frames[k * (frames.len() - 1) / (count - 1).max(1)]);
    Ok(chosen
        .map(|frame| Snapshot {
            tessellation: frame.tessellation.clone(),
            positions: frame.positions.clone(),
            counted: frame.counted.clone(),
            stage: frame.stage,
        })
        .collect())
}
