//! What surrounds and preceded the cells of each frame, in the units of the fit.

use super::history::History;
use crate::command::fit::SnapshotArguments;
use crate::failure::Failure;
use crate::problem::{OrderedField, Problem};
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;
use voronudge_geometry::Vector;
use voronudge_io::{DataSet, DeclaredWindow};
use voronudge_model::{EnvironmentError, VectorMap};

#[derive(Debug, Args)]
#[command(next_help_heading = "Data")]
pub(super) struct FieldArguments {
    /// External field that cells may follow, vectors in any unit: .npy file of shape (ny, nx, 2) or (frames, ny, nx,
    /// 2). Needs --field-x and --field-y.
    #[arg(long, value_name = "FILE", requires = "field_x", requires = "field_y")]
    field: Option<PathBuf>,
    /// x of the columns of the external field: .npy file of shape (nx,).
    #[arg(long, value_name = "FILE", requires = "field")]
    field_x: Option<PathBuf>,
    /// y of the rows of the external field: .npy file of shape (ny,).
    #[arg(long, value_name = "FILE", requires = "field")]
    field_y: Option<PathBuf>,
}

/// An external field: one map, or one for each frame.
pub(super) struct ExternalMap {
    field: OrderedField,
    frames: usize,
}

impl FieldArguments {
    /// Whether a field is given.
    pub fn is_asked(&self) -> bool {
        self.field.is_some()
    }

    /// The external field, if one is given; its files count as inputs of the data set.
    pub fn load(&self, data: &mut DataSet) -> Result<Option<ExternalMap>, Failure> {
        let (Some(file), Some(x), Some(y)) = (&self.field, &self.field_x, &self.field_y) else {
            return Ok(None);
        };
        let field = data.read_field(file, x, y)?;
        let missing = field.missing();
        if missing > 0 {
            return Err(Failure::new(format!(
                "{missing} vectors are missing, but the field must be known everywhere"
            ))
            .with_hint("fill the gaps, or cut the field down to where it is known")
            .at(file.display()));
        }
        let frames = field.frames();
        if frames != 1 && frames != data.frames() {
            return Err(Failure::new(format!(
                "the field has {frames} frames, but the data set has {}",
                data.frames()
            ))
            .with_hint("give one field for all frames, (ny, nx, 2), or one for each")
            .at(file.display()));
        }
        Ok(Some(ExternalMap { field: OrderedField::new(&field, DeclaredWindow::default())?, frames }))
    }
}

impl ExternalMap {
    /// The map of a frame.
    fn of(&self, frame: usize, prepared: &Problem) -> Result<VectorMap, Failure> {
        let flow = self.field.frame(if self.frames == 1 { 0 } else { frame });
        let flow = flow.scaled(&prepared.scale)?;
        let vectors =
            flow.velocities.into_iter().map(|vector| vector.unwrap_or_else(Vector::zeros)).collect();
        VectorMap::new(flow.grid, vectors).map_err(fault)
    }
}

fn fault(error: EnvironmentError) -> Failure {
    Failure::new(error.to_string()).with_hint("check the data")
}

/// Puts the observations into their environments.
pub(super) fn surround(
    prepared: &mut Problem,
    (arguments, data): (&SnapshotArguments, &DataSet),
    map: Option<&ExternalMap>,
    history: Option<&History>,
) -> Result<(), Failure> {
    let mut surrounded = Vec::new();
    for (index, observation) in prepared.observations.iter().enumerate() {
        let (snapshot, frame) = (&prepared.snapshots[index], prepared.frames[index]);
        let mut environment = prepared.surroundings(data, index).map_err(fault)?;
        if let Some(map) = map {
            environment = environment.with_map(map.of(frame, prepared)?);
        }
        if let Some(history) = history {
            let earlier = history.earlier((arguments, data), (snapshot, frame), prepared.mean_removed)?;
            let scaled = earlier.into_iter().map(|v| v.map(|v| v / prepared.scale.velocity())).collect();
            let scaled = prepared.of_cells(index, scaled, &None);
            environment = environment.with_earlier(scaled).map_err(fault)?;
        }
        surrounded.push(observation.clone().within(Arc::new(environment)));
    }
    prepared.observations = surrounded;
    Ok(())
}
