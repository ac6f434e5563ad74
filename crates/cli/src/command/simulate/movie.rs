//! The cells of the frames of a run.

use super::recorder::Recorder;
use super::report::Request;
use crate::command::drawing::cell_view;
use crate::failure::Failure;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, Tessellation, Vector};
use voronudge_observables::vorticities;
use voronudge_report::movie::{CellMovie, chosen};
use voronudge_report::{ChangedEdges, FrameView, Units};
use voronudge_simulate::CellsAndImages;

/// The cells of frames spread over the run, those of a box that was `start` at its beginning; `None` without cells.
pub(super) fn movie(
    recorder: &mut Recorder,
    (request, start): (&Request, PeriodicBox),
    interval: f64,
    units: &Units,
) -> Result<Option<CellMovie>, Failure> {
    let mut frames = Vec::new();
    for frame in chosen(request.frames, request.cells) {
        let cells = (recorder.positions(frame)?, recorder.velocities(frame)?);
        frames.push(frame_view((request, start), (frame, (frame + 1) as f64 * interval), cells)?);
    }
    Ok(CellMovie::new(frames, request.frames, units))
}

fn frame_view(
    (request, start): (&Request, PeriodicBox),
    (frame, time): (usize, f64),
    (positions, mut velocities): (Vec<Vector<f64>>, Vec<Vector<f64>>),
) -> Result<FrameView, Failure> {
    let cells = positions.len();
    let shear = request.driving.shear;
    let cell_box = start.after_shear(shear.map_or(0.0, |shear| shear.strain(time)))?;
    // Neighbours across the boundary stream at another velocity: streaming is taken off, and added where cells are shown.
    let rate = shear.map_or(0.0, |shear| shear.rate(time));
    velocities.iter_mut().zip(&positions).for_each(|(v, r)| v.x -= rate * r.y);
    let CellsAndImages { tessellation, positions, velocities } = match request.walls {
        Some(walls) => walls.with_images(&PeriodicBox::new(request.box_lengths)?, &positions, &velocities)?,
        None => {
            let tessellation = Tessellation::new(&positions, Domain::Periodic(cell_box))?;
            CellsAndImages { tessellation, positions, velocities }
        }
    };
    let known: Vec<Option<Vector<f64>>> = velocities.iter().copied().map(Some).collect();
    let vorticities = vorticities(&tessellation, &positions, &known);
    let mut polygon = CellPolygon::default();
    let view = |cell: usize| {
        let mut view = cell_view(&tessellation, &positions, cell, &mut polygon);
        let v = velocities[cell];
        view.measured = Some([v.x + rate * view.centre[1], v.y]);
        view.vorticity = vorticities[cell].map(|own| own - rate);
        view
    };
    Ok(FrameView {
        label: format!("frame {frame}"),
        time: Some(time),
        cells: (0..cells).map(view).collect(),
        changed_edges: ChangedEdges::default(),
        outline: Some([[0.0; 2], cell_box.lengths()]),
        region: Vec::new(),
    })
}
