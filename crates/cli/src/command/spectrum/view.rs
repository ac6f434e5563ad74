//! A frame and its modes as figures show them.

use super::frame::Solved;
use crate::command::drawing::cells_view;
use std::f64::consts::TAU;
use voronudge_report::FrameView;
use voronudge_report::figure::{DrawnMode, SpectrumPoint};
use voronudge_spectrum::Complex64;

/// The cells of a frame; those that are held in the modes are left out, and mirror images behind walls are not shown.
pub(super) fn frame_view(solved: &Solved) -> FrameView {
    let (label, tissue) = (format!("frame {}", solved.frame), &solved.tissue);
    let moves = |cell: usize| solved.problem.cells().binary_search(&cell).is_ok();
    let mut view = cells_view(label, &tissue.tessellation, &tissue.positions, moves);
    view.cells.truncate(tissue.cells);
    if let Some((_, cell_box)) = tissue.walls {
        view.outline = Some([[0.0; 2], cell_box.lengths()]);
    }
    view
}

/// A mode on the cells of its frame, with the phase at which its real part is largest.
pub(super) fn drawn(solved: &Solved, index: usize, title: &str) -> Option<DrawnMode> {
    let u = solved.modes.vector(index)?;
    let square: Complex64 = u.iter().map(|u| u * u).sum();
    let phase = Complex64::from_polar(1.0, -0.5 * square.arg().rem_euclid(TAU));
    let mut displacements = vec![[[f64::NAN; 2]; 2]; solved.snapshot.cells.len()];
    for (number, &cell) in solved.problem.cells().iter().enumerate() {
        let [x, y] = [u[2 * number] * phase, u[2 * number + 1] * phase];
        displacements[cell] = [[x.re, y.re], [x.im, y.im]];
    }
    let mode = solved.modes.modes[index];
    let frequency = if mode.oscillates(solved.modes.tolerance) { mode.value.im } else { 0.0 };
    Some(DrawnMode { title: title.to_owned(), displacements, frequency })
}

/// The eigenvalues of a frame.
pub(super) fn points(solved: &Solved) -> Vec<SpectrumPoint> {
    let point = |mode: &voronudge_spectrum::Mode| SpectrumPoint {
        rate: mode.value.re,
        // Rounding is no wave.
        frequency: if mode.oscillates(solved.modes.tolerance) { mode.value.im } else { 0.0 },
        participation: mode.participation,
    };
    solved.modes.modes.iter().map(point).collect()
}
