//! Shapes of cells by age and distance from the edge, on the way.

use super::request::ChannelRequest;
use crate::failure::Failure;
use ndarray::{Array1, Array3};
use voronudge_io::OutputDirectory;
use voronudge_simulate::LivingTissue;
use voronudge_simulate::measure::{ShapeRecorder, ShapesByAge};

/// Upper ends of distances from the edge, in cell sizes, and of ages, in units of 1/K_P; all beyond are the last.
pub(super) const DISTANCES: [f64; 5] = [0.5, 1.0, 1.8, 2.4, 4.0];
const AGES: [f64; 9] = [0.03125, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Time between two looks, in units of 1/K_P.
const APART: f64 = 0.1;

/// Looks at the cells every now and then during the averages.
pub(super) struct Shapes {
    recorder: ShapeRecorder,
    every: usize,
    relaxation: usize,
    per_sample: usize,
    /// Sum of the sizes of cells, if these have cycles, and number of cells.
    sizes: [f64; 2],
}

impl Shapes {
    pub fn new(request: &ChannelRequest) -> Result<Self, Failure> {
        let ([relaxation, per_sample], time_step) = request.schedule.steps()?;
        let unit = 1.0 / request.parameters.perimeter_elasticity;
        let recorder = ShapeRecorder::new(
            &DISTANCES.map(|distance| distance * request.cell_size),
            &AGES.map(|age| age * unit),
        );
        let every = ((APART * unit / time_step).round() as usize).max(1);
        Ok(Self { recorder, every, relaxation, per_sample, sizes: [0.0; 2] })
    }

    pub fn after_step(&mut self, step: usize, request: &ChannelRequest, tissue: &LivingTissue) {
        let Some(step) = step.checked_sub(self.relaxation).filter(|step| *step > 0) else {
            return;
        };
        if step.is_multiple_of(self.every) {
            self.recorder.look(tissue);
            if let Some(cycle) = &request.cycle {
                self.sizes[0] += tissue.cycles().iter().map(|own| cycle.size(*own)).sum::<f64>();
                self.sizes[1] += tissue.cycles().len() as f64;
            }
        }
        if step.is_multiple_of(self.per_sample) {
            self.recorder.end_sample();
        }
    }

    /// Mean size of the cells.
    pub fn mean_size(&self) -> f64 {
        self.sizes[0] / self.sizes[1]
    }

    pub fn found(&self) -> ShapesByAge {
        self.recorder.shapes()
    }
}

/// Writes (distances, ages, 3): mean P/√A, standard error, cells seen; and the upper ends of both.
pub(super) fn write(out: &mut OutputDirectory, shapes: &ShapesByAge) -> Result<(), Failure> {
    let table =
        Array3::from_shape_fn((shapes.distances.len(), shapes.ages.len(), 3), |(row, age, column)| {
            let estimate = &shapes.shape_index[row][age];
            match column {
                0 => estimate.value,
                1 => estimate.error.unwrap_or(f64::NAN),
                _ => shapes.seen[row][age],
            }
        });
    out.write_array("shape_by_age.npy", table.view())?;
    out.write_array("age.npy", Array1::from(shapes.ages.clone()).view())?;
    out.write_array("distance.npy", Array1::from(shapes.distances.clone()).view())?;
    Ok(())
}
