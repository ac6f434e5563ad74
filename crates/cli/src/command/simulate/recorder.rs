//! Frames and checkpoints on disk.

use super::report::Request;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};
use voronudge_geometry::Vector;
use voronudge_io::{OutputDirectory, OutputFolder, Recording};
use voronudge_simulate::{RunState, Simulation, State};

/// A run that is being recorded.
pub(super) struct Recorder {
    recording: Recording,
    request: Value,
    every: Duration,
    last: Instant,
    row: Vec<f64>,
}

/// The first line of a checkpoint; coordinates, directions and speeds follow as 64-bit floats.
#[derive(Serialize, Deserialize)]
struct Header {
    request: Value,
    run: RunState,
    state: State,
    cells: usize,
    headings: usize,
    #[serde(default)]
    speeds: usize,
}

/// The point at which a run goes on.
pub(super) struct Kept {
    pub run: RunState,
    pub state: State,
}

impl Recorder {
    /// Begins, or with `resume` goes on with, the recording of a request in an output directory.
    pub fn open(
        folder: &OutputFolder,
        request: &Request,
        steps_per_frame: usize,
        every: Duration,
        resume: bool,
    ) -> Result<(Self, Option<Kept>), Failure> {
        let out = folder.path();
        let request_value = serde_json::to_value(request)?;
        let found = Recording::find(out)?;
        if found.is_some() && !resume {
            return Err(Failure::new(format!("{} holds a run that was interrupted", out.display()))
                .with_hint("add --resume to go on with it, or remove its folder .voronudge-run"));
        }
        let shape = [request.frames, request.cells, 2];
        let arrays = [("positions.npy", shape), ("velocities.npy", shape)];
        let (recording, kept) = match found {
            None => (Recording::begin(folder, &arrays)?, None),
            Some(bytes) => {
                let (header, state) = parse(&bytes).ok_or_else(|| unreadable(out))?;
                if let Some(name) = first_difference(&header.request, &request_value) {
                    return Err(Failure::new(format!("the interrupted run has another {name}"))
                        .at(out.display())
                        .with_hint("repeat the options of the interrupted run, or give another --out"));
                }
                let recording = Recording::resume(folder, &arrays, header.run.steps / steps_per_frame)?;
                (recording, Some(Kept { run: header.run, state }))
            }
        };
        let row = Vec::with_capacity(2 * request.cells);
        Ok((Self { recording, request: request_value, every, last: Instant::now(), row }, kept))
    }

    /// Writes a frame.
    pub fn frame(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        for (array, vectors) in [simulation.positions(), simulation.velocities()].into_iter().enumerate() {
            self.row.clear();
            self.row.extend(vectors.iter().flat_map(|v: &Vector<f64>| [v.x, v.y]));
            self.recording.append(array, &self.row)?;
        }
        Ok(())
    }

    /// Writes a checkpoint if the last is old enough.
    pub fn after_step(&mut self, simulation: &Simulation, run: &RunState) -> Result<(), Failure> {
        if self.last.elapsed() < self.every {
            return Ok(());
        }
        self.checkpoint(simulation, run)
    }

    /// Writes a checkpoint.
    pub fn checkpoint(&mut self, simulation: &Simulation, run: &RunState) -> Result<(), Failure> {
        let state = simulation.state();
        let header = Header {
            request: self.request.clone(),
            run: run.clone(),
            state: State { positions: Vec::new(), headings: Vec::new(), speeds: Vec::new(), ..state.clone() },
            cells: state.positions.len(),
            headings: state.headings.len(),
            speeds: state.speeds.len(),
        };
        let mut bytes = serde_json::to_vec(&header)?;
        bytes.push(b'\n');
        let coordinates = state.positions.iter().flat_map(|r| [r.x, r.y]);
        let polarities = state.headings.iter().chain(&state.speeds).copied();
        bytes.extend(coordinates.chain(polarities).flat_map(f64::to_le_bytes));
        self.recording.checkpoint(&bytes)?;
        self.last = Instant::now();
        Ok(())
    }

    /// Positions (N) of a frame that was written, unwrapped.
    pub fn positions(&mut self, frame: usize) -> Result<Vec<Vector<f64>>, Failure> {
        Ok(vectors(&self.recording.frame(0, frame)?))
    }

    /// Velocities (N) of a frame that was written.
    pub fn velocities(&mut self, frame: usize) -> Result<Vec<Vector<f64>>, Failure> {
        Ok(vectors(&self.recording.frame(1, frame)?))
    }

    /// The results, with the frames among them.
    pub fn results(self) -> Result<OutputDirectory, Failure> {
        Ok(self.recording.results()?)
    }

    /// Frames so far.
    pub fn frames(&self) -> usize {
        self.recording.frames()
    }

    /// Writes them as arrays of their own.
    pub fn write_so_far(&mut self, out: &mut OutputDirectory) -> Result<(), Failure> {
        Ok(self.recording.write_so_far(out)?)
    }

    /// Removes what is only needed to go on.
    pub fn discard(self) -> Result<(), Failure> {
        Ok(self.recording.discard()?)
    }
}

fn vectors(row: &[f64]) -> Vec<Vector<f64>> {
    row.chunks_exact(2).map(|r| Vector::new(r[0], r[1])).collect()
}

fn unreadable(out: &Path) -> Failure {
    Failure::new("the checkpoint of the interrupted run cannot be read").at(out.display()).with_hint(
        "remove its folder .voronudge-run and begin again; another version of the program may have made it",
    )
}

fn parse(bytes: &[u8]) -> Option<(Header, State)> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let header: Header = serde_json::from_slice(&bytes[..end]).ok()?;
    let (chunks, rest) = bytes[end + 1..].as_chunks::<8>();
    let numbers: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
    if !rest.is_empty() || numbers.len() != 2 * header.cells + header.headings + header.speeds {
        return None;
    }
    let (coordinates, polarities) = numbers.split_at(2 * header.cells);
    let (headings, speeds) = polarities.split_at(header.headings);
    let state = State {
        positions: coordinates.chunks_exact(2).map(|r| Vector::new(r[0], r[1])).collect(),
        headings: headings.to_vec(),
        speeds: speeds.to_vec(),
        ..header.state.clone()
    };
    Some((header, state))
}

/// The name of the first entry in which two requests differ.
fn first_difference(kept: &Value, asked: &Value) -> Option<String> {
    if kept == asked {
        return None;
    }
    let (Value::Object(kept), Value::Object(asked)) = (kept, asked) else {
        return Some("request".into());
    };
    let names = asked.keys().chain(kept.keys());
    let name = names.into_iter().find(|name| kept.get(*name) != asked.get(*name));
    Some(name.map_or_else(|| "request".into(), |name| format!("\"{name}\"")))
}
