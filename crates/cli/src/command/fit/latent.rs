//! Cells that were not detected: what is asked, and what was found.

use crate::failure::Failure;
use crate::problem::{Detections, Problem};
use clap::{ArgAction, Args};
use ndarray::Array2;
use voronudge_infer::{ChangeKind, Inference, Origin};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::LatentCells;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Detections")]
pub(crate) struct LatentArguments {
    /// Before the fit, look for cells that were not detected and for detections that are not cells.
    #[arg(long, value_name = "true|false", action = ArgAction::Set, default_value_t = true)]
    complete: bool,
    /// Share of the cells that is not detected, between 0 and 1 [default: estimated].
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    missed_rate: Option<f64>,
}

impl LatentArguments {
    /// Refuses what needs no data to be seen wrong.
    pub fn check(&self) -> Result<(), Failure> {
        match self.missed_rate {
            Some(rate) if !(rate > 0.0 && rate < 1.0) => {
                Err(Failure::new(format!("--missed-rate is {rate}, but it must lie between 0 and 1"))
                    .with_hint(match rate {
                        0.0 => "where no cell was missed, say --complete false instead",
                        _ => "it is a share of the cells, 0.03 for 3 %; leave it out and it is estimated",
                    }))
            }
            Some(_) if !self.complete => Err(Failure::new("--missed-rate without a search for missed cells")
                .with_hint("leave out --complete false, or --missed-rate")),
            _ => Ok(()),
        }
    }

    /// What is done about the detections.
    pub fn detections(&self) -> Detections {
        match self.complete {
            true => Detections::Completed { missed_rate: self.missed_rate },
            false => Detections::AsTheyAre,
        }
    }
}

/// What was found, for the report; `None` if it was not looked for.
pub(super) fn found(prepared: &Problem) -> Option<LatentCells> {
    let completion = prepared.completion.as_ref()?;
    Some(LatentCells {
        inserted: completion.count(ChangeKind::Inserted),
        deleted: completion.count(ChangeKind::Deleted),
        split: completion.count(ChangeKind::Split),
        merged: completion.count(ChangeKind::Merged),
        missed_rate: completion.missed_rate,
    })
}
/// Writes the cells that were put in where none was detected, or one for two: x, y, frame, standard error, evidence (K, 5).
pub(crate) fn write(
    out: &mut OutputDirectory,
    data: &DataSet,
    prepared: &Problem,
    result: &Inference,
) -> Result<(), Failure> {
    let Some(completion) = &prepared.completion else {
        return Ok(());
    };
    let (flip, length) = (data.y_sign(), prepared.scale.length);
    let mut table: Vec<[f64; 5]> = Vec::new();
    for (index, completed) in completion.frames.iter().enumerate() {
        for (origin, r) in completed.origins.iter().zip(&result.frames[index].nudged_positions) {
            let Origin::Added(change, _) = *origin else { continue };
            let change = &completed.changes[change];
            if change.kind != ChangeKind::Merged {
                let place = prepared.observations[index].tessellation.domain().wrap(*r) * length;
                let error = change.standard_error * length;
                table.push([place.x, flip * place.y, prepared.frames[index] as f64, error, change.evidence]);
            }
        }
    }
    let array = Array2::from_shape_fn((table.len(), 5), |(row, column)| table[row][column]);
    out.write_array("latent_cells.npy", array.view())?;
    Ok(())
}
