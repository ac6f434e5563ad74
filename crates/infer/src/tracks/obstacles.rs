//! Where a step fails: the cells at which the linearised problem does not hold, because contacts change there.

use super::objective::MovieObjective;
use super::states::Place;
use crate::levenberg_marquardt::Obstacles;
use crate::position_rows::squares;

/// Share of the promised decrease that the rest of the tissue must keep.
const KEPT: f64 = 0.5;

/// Share of all cells that may be obstacles: what fails at more of them fails as a whole.
const FEW: f64 = 0.1;

/// Neighbours over so many rings make the velocity of a cell.
const RINGS: usize = 2;

/// What a term of Φ belongs to.
#[derive(Debug, Clone, Copy)]
enum Owner {
    /// The motion of this number.
    Motion(usize),
    /// The measured position of a cell at a frame.
    Position(usize, usize),
}

impl MovieObjective<'_> {
    /// The terms of Φ that belong to cells.
    fn terms(&self, parameters: &[f64]) -> Option<Vec<(Owner, f64)>> {
        let placed = self.place(parameters).ok()?;
        let residuals = self.residuals(&placed, parameters);
        let motions = residuals.iter().enumerate();
        let mut terms: Vec<(Owner, f64)> =
            motions.map(|(number, rest)| (Owner::Motion(number), self.counted(rest))).collect();
        let spring = self.levels.spring();
        let of_frames = self.of_seen(&placed, self.split(parameters).1, |frame, cells, nudged, nudges| {
            let all = squares(cells, &nudged.tessellation, &nudged.positions, nudges).enumerate();
            all.map(|(cell, square)| (Owner::Position(frame, cell), spring * square)).collect::<Vec<_>>()
        });
        terms.extend(of_frames.into_iter().flatten());
        terms.iter().all(|(_, term)| term.is_finite()).then_some(terms)
    }

    /// Marks the places of a cell at a frame and of its neighbours.
    fn mark(&self, frame: usize, cell: usize, marked: &mut [bool]) {
        let instant = &self.states.instants[frame];
        let mut within = vec![cell];
        let mut last = 0;
        for _ in 0..RINGS {
            let ring = last..within.len();
            last = ring.end;
            for k in ring {
                for &neighbour in instant.cells.tessellation.neighbours(within[k]) {
                    if !within.contains(&(neighbour as usize)) {
                        within.push(neighbour as usize);
                    }
                }
            }
        }
        for cell in within {
            if let Place::Own(place) = instant.place[cell] {
                marked[place as usize] = true;
            }
        }
    }
}

impl Obstacles for &MovieObjective<'_> {
    fn obstacles(&self, at: &[f64], trial: &[f64], promised: f64) -> Option<Vec<usize>> {
        let (before, after) = (self.terms(at)?, self.terms(trial)?);
        let mut changes: Vec<(Owner, f64)> = after
            .into_iter()
            .zip(before)
            .map(|((owner, after), (_, before))| (owner, after - before))
            .collect();
        changes.sort_unstable_by(|one, other| other.1.total_cmp(&one.1));
        let mut rest: f64 = changes.iter().map(|change| change.1).sum();
        let most = (FEW * self.states.anchors.len() as f64) as usize;
        let mut marked = vec![false; self.states.blocks()];
        for (owner, change) in changes.iter().take(most) {
            if rest <= -KEPT * promised {
                break;
            }
            rest -= change;
            match *owner {
                Owner::Motion(number) => {
                    let motion = &self.states.motions[number];
                    for (end, cell) in motion.cells.iter().enumerate() {
                        self.mark(motion.interval + end, *cell as usize, &mut marked);
                    }
                }
                Owner::Position(frame, cell) => self.mark(frame, cell, &mut marked),
            }
        }
        let places = (0..marked.len()).filter(|place| marked[*place]);
        (rest <= -KEPT * promised).then(|| places.collect())
    }
}
