//! The modes of one frame.

use super::request::ModeRequest;
use super::search::compute;
use super::tissue::{Localised, Tissue};
use crate::arguments::{ChosenEffects, OwnParameters, environment};
use crate::failure::Failure;
use crate::memory::{OF_A_CELL_WITH_MODES, refuse_beyond};
use crate::progress::Progress;
use std::sync::Arc;
use voronudge_io::{DataSet, Snapshot};
use voronudge_model::{Model, Parameters};
use voronudge_spectrum::{LinearProblem, Modes, Scope, Selection, TransitionDistance, dense_memory};

/// Sides shorter than this share of the cell size are near a T1 transition.
pub(super) const SHORT_SIDE: f64 = 0.01;

/// A frame and its modes.
pub(super) struct Solved {
    pub frame: usize,
    pub snapshot: Snapshot,
    pub tissue: Tissue,
    pub problem: Arc<LinearProblem>,
    pub modes: Modes,
    /// Where between walls they are.
    pub localised: Option<Localised>,
    /// The cell size ℓ₀.
    pub length: f64,
    pub transition: Option<TransitionDistance>,
    /// Root mean square velocity of the model over the cells that move.
    pub speed: f64,
}

impl Solved {
    /// The modes of a frame in which cells for which `held` holds stay where they are.
    pub fn new(
        (data, frame): (&DataSet, usize),
        (parameters, own, effects): (&Parameters<f64>, &OwnParameters, &ChosenEffects),
        request: &ModeRequest,
        held: impl Fn(usize) -> bool,
        progress: &mut Progress,
    ) -> Result<Self, Failure> {
        let snapshot = Snapshot::new(data, frame);
        let tissue = Tissue::new(data, frame, &snapshot)?;
        let (tessellation, positions) = (&tissue.tessellation, &tissue.positions);
        let view = data.view()?.judge(tessellation, positions);
        let moves = |cell: usize| cell < tissue.cells && view.counts(cell) && !held(cell);
        if !(0..tissue.cells).any(moves) {
            return Err(voronudge_spectrum::Error::NoCells.into());
        }
        let surroundings = environment(tessellation, positions, &view)?;
        let surroundings = own.of_cells(surroundings, &snapshot.cells, data.labels_of(&snapshot, frame))?;
        let length = surroundings.cell_size();
        let model = effects.add_to(Model::chiral_voronoi(parameters), surroundings, tessellation.domain())?;
        tissue.check(&model)?;
        let problem = tissue.problem(&model, moves).map_err(|error| in_file_numbers(&snapshot, error))?;
        let problem = Arc::new(problem);
        let (cells, dense) = (problem.cells().len(), request.request.dense_limit);
        match request.request.selection {
            Selection::All if cells <= dense => {
                refuse_beyond(format!("all modes of {cells} cells"), 1, dense_memory(cells) as usize)?;
            }
            // More than the limit is refused with better advice.
            Selection::All => {}
            _ => refuse_beyond(format!("modes of {cells} cells"), cells, OF_A_CELL_WITH_MODES)?,
        }
        let modes = compute(&problem, request.request, progress)?;
        let all = tissue.velocities(&model);
        let squares: f64 = problem.cells().iter().map(|&cell| all[cell].norm_squared()).sum();
        let short = SHORT_SIDE * length;
        let transition = TransitionDistance::new(tessellation, positions, tissue.cells, moves, short);
        Ok(Self {
            frame,
            speed: (squares / problem.cells().len() as f64).sqrt(),
            localised: tissue.localisations(&modes),
            problem,
            modes,
            length,
            transition,
            tissue,
            snapshot,
        })
    }

    /// Whether the parameters can be meant for cells of this size.
    pub fn doubtful_units(&self, parameters: &Parameters<f64>) -> Option<String> {
        let index = parameters.preferred_perimeter / self.length;
        (!(1.0..=10.0).contains(&index)).then(|| {
            format!(
                "P_0 is {index:.2e} cell sizes, where 3 to 5 is usual: parameters are in the units of the data, and the defaults \
                 are for cells of unit size"
            )
        })
    }

    /// Whether only some modes are known.
    pub fn is_partial(&self) -> bool {
        self.modes.scope != Scope::All
    }

    /// What should be known before using the modes.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let near = self.transition.filter(|transition| transition.short_sides > 0);
        if let Some(near) = near {
            let [first, second] = near.cells.map(|cell| self.snapshot.cells[cell]);
            warnings.push(format!(
                "frame {}: {} of {} sides are shorter than a hundredth of the cell size, the shortest, between cells {first} and \
                 {second}, by a factor of {:.1e}: neighbours are about to change there, so the modes hold for tiny \
                 displacements only, and the stiffest of them belong to such sides",
                self.frame,
                near.short_sides,
                near.sides,
                near.shortest_side / self.length
            ));
        }
        warnings
    }
}

fn in_file_numbers(snapshot: &Snapshot, error: voronudge_spectrum::Error) -> Failure {
    use voronudge_spectrum::Error;
    match error {
        Error::NotFinite { cell } => Error::NotFinite { cell: snapshot.cells[cell] }.into(),
        other => other.into(),
    }
}
