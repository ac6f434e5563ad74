//! The cells of a frame in their surroundings.

use crate::boundary::domain_at;
use crate::failure::Failure;
use voronudge_geometry::{PeriodicBox, Tessellation, Vector};
use voronudge_io::{Boundary, DataSet, Snapshot, WalledSides};
use voronudge_model::{HalfEdgeForces, Model, velocities};
use voronudge_simulate::Walls;
use voronudge_spectrum::{Error, LinearProblem, Localisation, Modes, Rows};

/// The cells of a frame; between walls with their mirror images.
pub(super) struct Tissue {
    pub tessellation: Tessellation,
    /// Positions of the cells, then of their images.
    pub positions: Vec<Vector<f64>>,
    /// Number of cells.
    pub cells: usize,
    /// The walls, and the box between them.
    pub walls: Option<(Walls, PeriodicBox)>,
}

impl Tissue {
    pub fn new(data: &DataSet, frame: usize, snapshot: &Snapshot) -> Result<Self, Failure> {
        let (positions, cells) = (&snapshot.positions, snapshot.positions.len());
        if let (Some(sides), Boundary::Periodic { lengths }) = (data.walls, data.boundary) {
            let walls = match sides {
                WalledSides::X => Walls::X,
                WalledSides::Both => Walls::Both,
            };
            let cell_box = PeriodicBox::new(lengths)?;
            let all = walls.with_images(&cell_box, positions, &[])?;
            let (tessellation, positions) = (all.tessellation, all.positions);
            return Ok(Self { tessellation, positions, cells, walls: Some((walls, cell_box)) });
        }
        let tessellation = Tessellation::new(positions, domain_at(data, frame)?)
            .map_err(|error| snapshot.in_file_numbers(error))?;
        Ok(Self { tessellation, positions: positions.clone(), cells, walls: None })
    }

    /// Refuses models under which nothing is known of cells between walls.
    pub fn check(&self, model: &Model<f64>) -> Result<(), Failure> {
        match self.walls {
            Some((walls, _)) if !walls.admit(model) => {
                Err(Failure::new("--effect: cells between walls are moved by functions of their shapes only")
                    .with_hint("leave the effect out"))
            }
            _ => Ok(()),
        }
    }

    /// The eigenvalue problem of the cells that move; between walls all do.
    pub fn problem(&self, model: &Model<f64>, moves: impl Fn(usize) -> bool) -> Result<LinearProblem, Error> {
        let (tessellation, positions) = (&self.tessellation, &self.positions);
        match self.walls {
            Some((walls, _)) => {
                LinearProblem::with_images(tessellation, positions, model, walls.mirrors(), self.cells)
            }
            None => LinearProblem::new(tessellation, positions, model, moves),
        }
    }

    /// Velocities of the cells under a model.
    pub fn velocities(&self, model: &Model<f64>) -> Vec<Vector<f64>> {
        let Some((walls, _)) = self.walls else {
            return velocities(&self.tessellation, &self.positions, model);
        };
        let mut own = vec![Vector::zeros(); self.cells];
        let mut forces = HalfEdgeForces::default();
        let mirrors = walls.mirrors();
        forces.evaluate_with_images(&self.tessellation, &self.positions, model, mirrors, &mut own);
        own
    }

    /// Where between the walls each mode is; none without walls or vectors.
    pub fn localisations(&self, modes: &Modes) -> Option<Localised> {
        let (walls, cell_box) = self.walls?;
        let size = (walls.mirrors(), self.cells);
        let rows = Rows::between_walls(&self.tessellation, &self.positions, size, cell_box.lengths());
        let of_mode = |index: usize| modes.vector(index).map(|u| rows.localisation(&u));
        let modes = (0..modes.modes.len()).map(of_mode).collect::<Option<Vec<_>>>()?;
        Some(Localised { walls, share: rows.share_at_ends(), modes })
    }
}

/// Where between walls the modes are.
pub(super) struct Localised {
    pub walls: Walls,
    /// Share of the cells within two rows of a wall.
    pub share: f64,
    /// Of each mode.
    pub modes: Vec<Localisation>,
}
