//! Frames of so many cells that what one does is finer than a picture shows: means over squares, or those in the middle.

use crate::figure::CellScalar;
use crate::map::{MOST_DRAWN, Viewport};
use crate::view::{CellStatus, CellView, FrameView, Segment, is_finite};

/// Cells of the part of a frame in which single cells can be looked at: of more, those in the middle.
pub const MOST_IN_FRAME: usize = 4000;

/// Squares that a frame of more is averaged over, about.
const SQUARES: f64 = 1600.0;

/// Which cells of a frame a picture of squares stands for.
#[derive(Debug, Clone)]
pub(crate) struct Squares {
    /// Used cells of each square; `None` where cells are drawn themselves.
    members: Option<Vec<Vec<usize>>>,
}

impl Squares {
    /// What is drawn of a frame: its cells, or, of many, squares with the mean velocities of the used cells in them.
    pub fn of(frame: &FrameView) -> (FrameView, Self) {
        let grid = (frame.cells.len() > MOST_DRAWN).then(|| Grid::over(frame)).flatten();
        let Some(grid) = grid else { return (frame.clone(), Self { members: None }) };
        let mut members = vec![Vec::new(); grid.counts[0] * grid.counts[1]];
        for (index, cell) in frame.cells.iter().enumerate() {
            if cell.is_used() && is_finite(cell.centre) {
                members[grid.square(cell.centre)].push(index);
            }
        }
        let own = |(square, members): (usize, &Vec<usize>)| grid.cell(frame, square, members);
        let cells = members.iter().enumerate().filter(|(_, own)| !own.is_empty()).map(own).collect();
        members.retain(|own| !own.is_empty());
        let squares = FrameView {
            label: frame.label.clone(),
            time: frame.time,
            cells,
            changed_edges: Default::default(),
            outline: frame.outline,
            region: frame.region.clone(),
        };
        (squares, Self { members: Some(members) })
    }

    /// One number for each thing drawn, from one for each cell.
    pub fn means(&self, scalar: CellScalar) -> CellScalar {
        let Some(members) = &self.members else { return scalar };
        let values = &scalar.values;
        let mean = |members: &Vec<usize>| {
            let known = members.iter().filter_map(|cell| values.get(*cell)).filter(|value| value.is_finite());
            let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
            sum / count
        };
        CellScalar { values: members.iter().map(mean).collect(), ..scalar }
    }

    /// The caption of a map, which says what is averaged.
    pub fn caption(&self, caption: &str) -> String {
        let Some(members) = &self.members else { return caption.to_owned() };
        let cells: usize = members.iter().map(Vec::len).sum();
        format!("{caption}, means over squares of about {} cells", cells / members.len().max(1))
    }
}

/// Squares, or nearly, that cover a frame.
struct Grid {
    corner: [f64; 2],
    sides: [f64; 2],
    counts: [usize; 2],
}

impl Grid {
    fn over(frame: &FrameView) -> Option<Self> {
        let [low, high] = Viewport::around(frame)?.corners();
        let extent = [high[0] - low[0], high[1] - low[1]];
        let side = (extent[0] * extent[1] / SQUARES).sqrt();
        let counts = extent.map(|length| ((length / side).round() as usize).clamp(1, MOST_DRAWN));
        let sides = [extent[0] / counts[0] as f64, extent[1] / counts[1] as f64];
        (is_finite(sides) && sides[0] > 0.0 && sides[1] > 0.0).then_some(Self { corner: low, sides, counts })
    }

    fn square(&self, at: [f64; 2]) -> usize {
        let place = |axis: usize| {
            let place = (at[axis] - self.corner[axis]) / self.sides[axis];
            (place.max(0.0) as usize).min(self.counts[axis] - 1)
        };
        place(1) * self.counts[0] + place(0)
    }

    /// A square as a cell of its own.
    fn cell(&self, frame: &FrameView, square: usize, members: &[usize]) -> CellView {
        let low = [square % self.counts[0], square / self.counts[0]];
        let at = |right: f64, up: f64| {
            [
                self.corner[0] + (low[0] as f64 + right) * self.sides[0],
                self.corner[1] + (low[1] as f64 + up) * self.sides[1],
            ]
        };
        let mean = |of: fn(&CellView) -> Option<[f64; 2]>| {
            let known =
                members.iter().filter_map(|cell| of(&frame.cells[*cell])).filter(|own| is_finite(*own));
            let add = |(sum, count): ([f64; 2], f64), own: [f64; 2]| {
                ([sum[0] + own[0], sum[1] + own[1]], count + 1.0)
            };
            let (sum, count) = known.fold(([0.0; 2], 0.0), add);
            (count > 0.0).then(|| sum.map(|sum| sum / count))
        };
        CellView {
            number: None,
            centre: at(0.5, 0.5),
            polygon: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            area: self.sides[0] * self.sides[1],
            perimeter: 2.0 * (self.sides[0] + self.sides[1]),
            status: CellStatus::Used,
            measured: mean(|cell| cell.measured),
            vorticity: None,
            predicted: mean(|cell| cell.predicted),
            polarity: mean(|cell| cell.polarity),
            held_out: None,
            nudge: [0.0; 2],
        }
    }
}

/// A frame, or of one of many cells those in the middle, of which each can be told from the others.
pub(crate) fn middle(frame: &FrameView) -> FrameView {
    let mut own = frame.clone();
    if own.cells.len() > MOST_DRAWN {
        keep_middle(std::slice::from_mut(&mut own), frame.cells.len());
    }
    own
}

/// Keeps about [`MOST_IN_FRAME`] cells of each of some frames, of which none has more than `cells`: those around the middle of all.
pub(crate) fn keep_middle(frames: &mut [FrameView], cells: usize) {
    if cells <= MOST_IN_FRAME {
        return;
    }
    let share = (MOST_IN_FRAME as f64 / cells as f64).sqrt();
    let Some(view) = Viewport::around_all(frames) else { return };
    let [low, high] = view.corners();
    let is_near = |at: [f64; 2]| {
        (0..2).all(|axis| {
            (at[axis] - 0.5 * (low[axis] + high[axis])).abs() <= 0.5 * share * (high[axis] - low[axis])
        })
    };
    for frame in frames {
        frame.cells.retain(|cell| is_near(cell.centre));
        let edges = &mut frame.changed_edges;
        [&mut edges.lost, &mut edges.gained]
            .into_iter()
            .for_each(|edges| edges.retain(|ends: &Segment| ends.iter().all(|end| is_near(*end))));
        // It would lie outside.
        frame.outline = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Palette;

    /// Cells of a square lattice, their velocities a shear, every seventh left out with a velocity that is none.
    fn frame(side: usize) -> FrameView {
        let cell = |index: usize| {
            let at = [(index % side) as f64, (index / side) as f64];
            CellView {
                number: Some(index),
                centre: at,
                polygon: vec![at; 4],
                area: 1.0,
                perimeter: 4.0,
                status: if index.is_multiple_of(7) { CellStatus::LeftOut } else { CellStatus::Used },
                measured: Some(if index.is_multiple_of(7) { [1e6, 1e6] } else { [0.1 * at[1], 0.0] }),
                vorticity: None,
                predicted: Some([0.0, 0.0]),
                polarity: None,
                held_out: None,
                nudge: [0.0; 2],
            }
        };
        FrameView { cells: (0..side * side).map(cell).collect(), ..FrameView::default() }
    }

    #[test]
    fn squares_have_the_means_of_the_used_cells_in_them() {
        let whole = frame(200);
        let (squares, of) = Squares::of(&whole);
        assert!((1500..=1700).contains(&squares.cells.len()), "{}", squares.cells.len());
        let numbers = CellScalar {
            values: whole.cells.iter().map(|cell| cell.centre[0]).collect(),
            label: String::new(),
            palette: Palette::Sequential,
            limits: None,
        };
        let means = of.means(numbers).values;
        assert_eq!(means.len(), squares.cells.len());
        for (cell, mean) in squares.cells.iter().zip(means) {
            // A square of five by five cells has a middle.
            assert!((cell.residual().unwrap()[0] - 0.1 * cell.centre[1]).abs() < 0.06);
            assert!((mean - cell.centre[0]).abs() < 0.6);
        }
        let few = frame(20);
        assert_eq!(Squares::of(&few).0, few);
    }

    #[test]
    fn the_middle_keeps_its_own_contacts_only() {
        let mut whole = frame(200);
        whole.changed_edges.lost = vec![[[100.0, 100.0], [101.0, 100.0]], [[1.0, 1.0], [2.0, 1.0]]];
        let middle = middle(&whole);
        assert!((3600..=4400).contains(&middle.cells.len()));
        assert_eq!(middle.changed_edges.lost.len(), 1);
    }
}
