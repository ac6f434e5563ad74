//! Cells that were not detected: what is asked, and how the frames are completed.

use super::prepare::Prepared;
use super::tracks::PreparedTracks;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::snapshot::y_sign;
use clap::{ArgAction, Args};
use ndarray::Array2;
use voronudge_geometry::Vector;
use voronudge_infer::{ChangeKind, Error, Inference, Origin, complete};
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_report::infer_report::LatentCells;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Detections")]
pub(crate) struct LatentArguments {
    /// Look for cells that were not detected, and for detections that are no cells, before the fit.
    #[arg(long, value_name = "true|false", action = ArgAction::Set, default_value_t = true)]
    complete: bool,
    /// Share of the cells that is not detected [default: estimated].
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

    /// Finds out how the cells of a problem were measured: which were not detected, what a position is, over which windows velocities are
    /// averaged. Windows make the data of a flow field; what a position is can be told of complete cells only. Cells are looked for unless that
    /// was said to be needless.
    pub fn understand(
        &self,
        tracks: Option<&mut PreparedTracks>,
        prepared: &mut Prepared,
        progress: &mut Progress,
    ) -> Result<(), Error> {
        match tracks {
            Some(tracks) => {
                if self.complete {
                    tracks.complete(&prepared.request, self.missed_rate, progress)?;
                }
                tracks.measure(prepared, progress)?;
                tracks.show(prepared)
            }
            None if prepared.velocities.flow().is_some() => {
                prepared.measure(progress)?;
                self.complete(prepared, progress)
            }
            None => {
                self.complete(prepared, progress)?;
                prepared.measure(progress)
            }
        }
    }

    /// Completes the frames of a problem, if that was not said to be needless.
    fn complete(&self, prepared: &mut Prepared, progress: &mut Progress) -> Result<(), Error> {
        if !self.complete {
            return Ok(());
        }
        let completion =
            complete(&prepared.observations, &prepared.request, self.missed_rate, &mut |state| {
                progress.tell(state)
            })?;
        prepared.observations = completion.frames.iter().map(|frame| frame.observation.clone()).collect();
        prepared.completion = Some(completion);
        Ok(())
    }
}

impl Prepared {
    /// A field over the cells of a frame as the fit has them, in the order of those that were detected; not a number where a
    /// detection is no cell. A cell that was detected twice speaks for the first detection.
    pub fn of_detections(&self, index: usize, of_cells: Vec<Vector<f64>>) -> Vec<Vector<f64>> {
        let Some(completion) = &self.completion else {
            return of_cells;
        };
        let frame = &completion.frames[index];
        let mut field = vec![Vector::new(f64::NAN, f64::NAN); self.snapshots[index].cells.len()];
        for (origin, v) in frame.origins.iter().zip(of_cells) {
            match *origin {
                Origin::Detected(cell) => field[cell] = v,
                Origin::Added(change, _) if frame.changes[change].kind == ChangeKind::Merged => {
                    if let Some(cell) = frame.changes[change].removed.first() {
                        field[*cell] = v;
                    }
                }
                Origin::Added(..) => {}
            }
        }
        field
    }

    /// What belongs to the detections of a frame, for its cells as the fit has them: a cell that was detected twice has that of the first
    /// detection, one that was put in has nothing.
    pub fn of_cells<T: Clone>(&self, index: usize, of_detections: Vec<T>, nothing: &T) -> Vec<T> {
        let Some(completion) = &self.completion else {
            return of_detections;
        };
        let frame = &completion.frames[index];
        let detection = |origin: &Origin| match *origin {
            Origin::Detected(cell) => Some(cell),
            Origin::Added(change, _) => match frame.changes[change].kind {
                ChangeKind::Merged => frame.changes[change].removed.first().copied(),
                _ => None,
            },
        };
        let own = |cell: usize| of_detections.get(cell).unwrap_or(nothing).clone();
        frame.origins.iter().map(|origin| detection(origin).map_or_else(|| nothing.clone(), own)).collect()
    }

    /// What was found, for the report; `None` if it was not looked for.
    pub fn latent_cells(&self) -> Option<LatentCells> {
        let completion = self.completion.as_ref()?;
        Some(LatentCells {
            inserted: completion.count(ChangeKind::Inserted),
            deleted: completion.count(ChangeKind::Deleted),
            split: completion.count(ChangeKind::Split),
            merged: completion.count(ChangeKind::Merged),
            missed_rate: completion.missed_rate,
        })
    }
}

/// Writes the cells that were put in where none was detected, or one for two: x, y, frame, standard error, evidence (K, 5).
pub(crate) fn write(
    out: &mut OutputDirectory,
    data: &DataSet,
    prepared: &Prepared,
    result: &Inference,
) -> Result<(), Failure> {
    let Some(completion) = &prepared.completion else {
        return Ok(());
    };
    let (flip, length) = (y_sign(data), prepared.scale.length);
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
