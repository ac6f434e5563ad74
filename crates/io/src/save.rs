//! Saving a data set so that loading it gives it back.

use ndarray::{Array, Array1, ArrayView, RemoveAxis};

use crate::dataset::DataSet;
use crate::error::Error;
use crate::flow::FlowField;
use crate::output::OutputDirectory;
use crate::settings::render;
use crate::y_axis::YAxis;

impl DataSet {
    /// Stages `positions.npy`; `velocities.npy`, `flow.npy` with `flow_x.npy` and `flow_y.npy`, and
    /// `labels.npy` and `position_errors.npy` where there are any; and `dataset.toml`.
    ///
    /// y is written in the direction that `y_axis` states, so loading the directory gives back
    /// this data set, apart from `inputs`.
    ///
    /// # Errors
    /// Those of [`DataSet::check`], so that nothing is written that could not be read again, and
    /// [`Error::Output`] where a file cannot be written.
    pub fn save(&self, out: &mut OutputDirectory) -> Result<(), Error> {
        self.check()?;
        write_vectors(out, "positions.npy", &self.positions, self.y_axis)?;
        if let Some(velocities) = &self.velocities {
            write_vectors(out, "velocities.npy", velocities, self.y_axis)?;
        }
        if let Some(flow) = &self.flow {
            write_flow(out, flow, self.y_axis)?;
        }
        if let Some(labels) = &self.labels {
            out.write_integers("labels.npy", labels.view())?;
        }
        if let Some(errors) = &self.position_errors {
            out.write_array("position_errors.npy", errors.view())?;
        }
        self.save_settings(out)
    }

    /// Stages `dataset.toml` alone, for arrays that are written in another way.
    ///
    /// # Errors
    /// As [`DataSet::save`].
    pub fn save_settings(&self, out: &mut OutputDirectory) -> Result<(), Error> {
        self.check()?;
        out.write_text("dataset.toml", &render(self))
    }
}

/// Stages a flow field with its coordinates, y in the direction stated.
pub(crate) fn write_flow(out: &mut OutputDirectory, flow: &FlowField, y_axis: YAxis) -> Result<(), Error> {
    let mut turned = flow.clone();
    turned.turn(y_axis);
    out.write_array("flow.npy", turned.velocities.view())?;
    out.write_array("flow_x.npy", Array1::from(turned.x).view())?;
    out.write_array("flow_y.npy", Array1::from(turned.y).view())
}

fn write_vectors<D: RemoveAxis>(
    out: &mut OutputDirectory,
    name: &str,
    vectors: &Array<f64, D>,
    y_axis: YAxis,
) -> Result<(), Error> {
    let mut write = |view: ArrayView<'_, f64, D>| out.write_array(name, view);
    match y_axis {
        YAxis::Up => write(vectors.view()),
        YAxis::Down => {
            let mut turned = vectors.clone();
            y_axis.turn(&mut turned);
            write(turned.view())
        }
    }
}
