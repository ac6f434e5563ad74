//! A frame while it is being completed: what was detected, what is thought to be wrong with it, and what follows.

use super::law::Law;
use super::{Change, ChangeKind};
use crate::{Error, Observation, Velocities};
use std::sync::OnceLock;
use voronudge_geometry::{Places, Vector};

/// Where a cell of a completed frame comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// A detection, by its number in the frame.
    Detected(usize),
    /// Put in by a change: which, and the place among its cells.
    Added(usize, usize),
}

/// A cell as it is thought to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub origin: Origin,
    pub position: Vector<f64>,
    /// What the model is to explain, for velocities of cells.
    pub target: Option<Vector<f64>>,
    /// `(σ_i / σ_r)²` of a measured position.
    pub variance: Option<f64>,
    pub label: Option<i64>,
}

/// A frame with its changes.
#[derive(Debug, Clone)]
pub(super) struct Scene<'a> {
    pub measured: &'a Observation,
    pub changes: Vec<Change>,
    /// The frame with the changes made.
    pub observation: Observation,
    /// Where its cells come from.
    pub origins: Vec<Origin>,
    /// The measured data without their background, as the model is to explain them.
    pub targets: Vec<Option<Vector<f64>>>,
    /// Squared residuals in units of their variance, of the data of the completed frame that count, and where they are.
    squares: (Places, Vec<f64>),
    /// Where its cells are, once that is asked for.
    places: OnceLock<Places>,
}

/// Distance, in ℓ₀, within which anything is looked for.
const REACH: f64 = 6.0;

/// What rounding may make of a distance.
const MARGIN: f64 = 1e-6;

impl<'a> Scene<'a> {
    /// A frame as detected.
    pub fn new(measured: &'a Observation) -> Self {
        Self {
            measured,
            changes: Vec::new(),
            observation: measured.clone(),
            origins: (0..measured.positions.len()).map(Origin::Detected).collect(),
            targets: Vec::new(),
            squares: (Places::new([], measured.tessellation.domain(), REACH), Vec::new()),
            places: OnceLock::new(),
        }
    }

    /// Makes other changes.
    pub fn change(&mut self, changes: Vec<Change>) -> Result<(), Error> {
        let taken = |cell: &usize| changes.iter().any(|change| change.removed.contains(cell));
        let kept: Vec<usize> = (0..self.measured.positions.len()).filter(|cell| !taken(cell)).collect();
        let added = changes.iter().enumerate().flat_map(|(index, change)| {
            change.added.iter().enumerate().map(move |(place, position)| (index, place, *position))
        });
        let mut origins: Vec<Origin> = kept.iter().copied().map(Origin::Detected).collect();
        let mut positions: Vec<Vector<f64>> =
            kept.iter().map(|cell| self.measured.positions[*cell]).collect();
        for (index, place, position) in added {
            origins.push(Origin::Added(index, place));
            positions.push(position);
        }
        let velocities = match &self.measured.velocities {
            Velocities::OnGrid(flow) => Velocities::OnGrid(flow.clone()),
            Velocities::OfCells(all) => {
                let of = |origin: &Origin| match *origin {
                    Origin::Detected(cell) => all[cell],
                    Origin::Added(index, _) => mean_velocity(&changes[index], all),
                };
                Velocities::OfCells(origins.iter().map(of).collect())
            }
        };
        let observation = self.measured.with_cells(&kept, positions, velocities)?;
        (self.origins, self.changes) = (origins, changes);
        self.observation = match self.has_labels() {
            true => {
                let labels = self.origins.iter().map(|origin| self.label(*origin)).collect();
                observation.with_labels(labels)?
            }
            false => observation,
        };
        self.places = OnceLock::new();
        Ok(())
    }

    /// Looks at the velocities with some coefficients.
    pub fn explain(&mut self, law: &Law<'_>) {
        let judged = law.judge(&self.observation);
        self.targets = vec![None; self.measured.velocities.values().len()];
        for row in &judged {
            let target = Some(row.predicted + row.residual);
            match (&self.measured.velocities, self.origins.get(row.datum)) {
                (Velocities::OnGrid(_), _) => self.targets[row.datum] = target,
                (Velocities::OfCells(_), Some(Origin::Detected(cell))) => self.targets[*cell] = target,
                _ => {}
            }
        }
        // What a change takes away is to be explained if the change is undone.
        if let Velocities::OfCells(all) = &self.measured.velocities {
            for cell in self.changes.iter().flat_map(|change| &change.removed) {
                self.targets[*cell] = all[*cell];
            }
        }
        let places = judged.iter().map(|row| self.observation.position_of_datum(row.datum));
        self.squares = (
            Places::new(places, self.measured.tessellation.domain(), REACH),
            judged.iter().map(|row| row.residual.norm_squared() / row.variance).collect(),
        );
    }

    /// The cells around a place, and the ways to them, with some of the changes undone, without some further detections.
    pub fn cells_around(
        &self,
        centre: Vector<f64>,
        distance: f64,
        undone: &[usize],
        without: &[usize],
    ) -> Vec<(Cell, Vector<f64>)> {
        let positions = &self.observation.positions;
        let places = self.places.get_or_init(|| {
            Places::new(positions.iter().copied(), self.measured.tessellation.domain(), REACH)
        });
        // Rounding may put a cell on either side; in a small box one may be met twice.
        let mut near: Vec<usize> = places.within(centre, distance + MARGIN).map(|(cell, _)| cell).collect();
        near.sort_unstable();
        near.dedup();
        let own = near.into_iter().filter(|cell| match &self.origins[*cell] {
            Origin::Detected(cell) => !without.contains(cell),
            Origin::Added(index, _) => !undone.contains(index),
        });
        let restored = undone.iter().flat_map(|index| &self.changes[*index].removed);
        let restored = restored.filter(|cell| !without.contains(cell));
        own.map(|cell| self.cell(self.origins[cell], positions[cell]))
            .chain(restored.map(|cell| self.cell(Origin::Detected(*cell), self.measured.positions[*cell])))
            .map(|cell| (cell, self.between(centre, cell.position)))
            .filter(|(_, way)| way.norm_squared() < distance * distance)
            .collect()
    }

    /// Whether cells have labels.
    pub fn has_labels(&self) -> bool {
        !self.measured.environment().labels().is_empty()
    }

    fn label(&self, origin: Origin) -> Option<i64> {
        match origin {
            Origin::Detected(cell) => self.measured.environment().label(cell),
            Origin::Added(index, place) => self.changes[index].labels.get(place).copied().flatten(),
        }
    }

    fn cell(&self, origin: Origin, position: Vector<f64>) -> Cell {
        let label = self.label(origin);
        match origin {
            Origin::Detected(cell) => Cell {
                origin,
                position,
                target: self.cells_target(cell),
                variance: Some(self.measured.stiffness(cell)).filter(|m| *m > 0.0).map(f64::recip),
                label,
            },
            Origin::Added(index, _) => Cell {
                origin,
                position,
                target: self.joint_target(&self.changes[index].removed, self.changes[index].added.len()),
                variance: None,
                label,
            },
        }
    }

    /// The velocity to be explained of a detection.
    pub fn cells_target(&self, detection: usize) -> Option<Vector<f64>> {
        let of_cells = matches!(self.measured.velocities, Velocities::OfCells(_));
        self.targets.get(detection).copied().flatten().filter(|_| of_cells)
    }

    /// The velocity to be explained of a cell that stands for several detections.
    pub fn joint_target(&self, removed: &[usize], added: usize) -> Option<Vector<f64>> {
        if removed.len() < 2 || added != 1 {
            return None;
        }
        mean(removed.iter().map(|cell| self.cells_target(*cell)))
    }

    /// The shortest way from one place to another.
    pub fn between(&self, from: Vector<f64>, to: Vector<f64>) -> Vector<f64> {
        self.measured.tessellation.domain().shortest(to - from)
    }

    /// Share of squared residuals near a place, each counted by its logarithm.
    pub fn unexplained(&self, place: Vector<f64>, radius: f64) -> f64 {
        let (places, squares) = &self.squares;
        let mut near: Vec<usize> = places.within(place, radius).map(|(datum, _)| datum).collect();
        near.sort_unstable();
        near.dedup();
        near.iter().map(|datum| (squares[*datum] / super::law::FREEDOM).ln_1p()).sum()
    }
}

/// The velocity of a cell that stands for several detections: their mean.
fn mean_velocity(change: &Change, all: &[Option<Vector<f64>>]) -> Option<Vector<f64>> {
    match change.kind {
        ChangeKind::Merged => mean(change.removed.iter().map(|cell| all[*cell])),
        _ => None,
    }
}

/// The mean of velocities that are all there.
fn mean(velocities: impl Iterator<Item = Option<Vector<f64>>>) -> Option<Vector<f64>> {
    let all: Vec<Vector<f64>> = velocities.collect::<Option<_>>()?;
    Some(all.iter().sum::<Vector<f64>>() / all.len().max(1) as f64)
}
