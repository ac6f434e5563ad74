//! Frames and lives of the cells of a channel as a data set and a table.

use crate::failure::Failure;
use ndarray::Array3;
use std::fmt::Write as _;
use voronudge_geometry::Vector;
use voronudge_io::{Boundary, DataSet, OutputDirectory, WalledSides};
use voronudge_report::Units;
use voronudge_simulate::{ChannelSchedule, LivingTissue, Origin};

/// Frames kept on the way, evenly spaced, the last at the end.
pub(super) struct Frames {
    /// Steps between two frames.
    every: usize,
    first: usize,
    interval: f64,
    kept: Vec<Vec<Seen>>,
}

/// A cell in a frame: its life, position and velocity.
type Seen = (usize, Vector<f64>, Vector<f64>);

/// Numbers in positions and velocities that are kept at most: 8 GB.
const LARGEST: usize = 1_000_000_000;

impl Frames {
    pub fn new(frames: usize, schedule: &ChannelSchedule) -> Result<Self, Failure> {
        let ([relaxation, per_sample], time_step) = schedule.steps()?;
        let steps = per_sample * schedule.samples;
        if frames > steps {
            return Err(Failure::new(format!("--frames is {frames}, but the averages have {steps} steps"))
                .with_hint("keep fewer frames"));
        }
        let every = steps.checked_div(frames).unwrap_or(usize::MAX);
        let first = relaxation + steps - every.saturating_mul(frames.saturating_sub(1)).min(steps);
        Ok(Self { every, first, interval: every as f64 * time_step, kept: Vec::new() })
    }

    pub fn after_step(&mut self, step: usize, tissue: &LivingTissue) {
        if self.every == usize::MAX || step < self.first || !(step - self.first).is_multiple_of(self.every) {
            return;
        }
        let simulation = tissue.simulation();
        let vectors = simulation.positions().iter().zip(simulation.velocities());
        self.kept
            .push(tissue.identities().iter().zip(vectors).map(|(life, (r, v))| (*life, *r, *v)).collect());
    }

    /// Writes the data set, if frames were kept, and lineage.csv.
    pub fn write(
        &self,
        out: &mut OutputDirectory,
        tissue: &LivingTissue,
        units: &Units,
    ) -> Result<(), Failure> {
        let lives = tissue.lives();
        // Lives that are seen in a frame have a place on the axis of cells.
        let mut seen: Vec<Option<[usize; 2]>> = vec![None; lives.len()];
        for (frame, cells) in self.kept.iter().enumerate() {
            for (life, ..) in cells {
                let [first, _] = seen[*life].unwrap_or([frame, frame]);
                seen[*life] = Some([first, frame]);
            }
        }
        let mut columns = vec![None; lives.len()];
        let mut count = 0;
        for (column, _) in columns.iter_mut().zip(&seen).filter(|(_, seen)| seen.is_some()) {
            *column = Some(count);
            count += 1;
        }
        if !self.kept.is_empty() {
            self.write_data_set(out, tissue, units, (&columns, count))?;
        }
        // Where cells have no cycles none divides in two, and there is no column for it.
        let dividing = !tissue.cycles().is_empty();
        let column = if dividing { ",divided" } else { "" };
        let mut table = format!("life,origin,mother,born,extruded{column},cell,first_frame,last_frame\n");
        let text = |number: Option<usize>| number.map_or(String::new(), |number| number.to_string());
        for (number, life) in lives.iter().enumerate() {
            let origin = match life.origin {
                Origin::Founder => "founder",
                Origin::Vertex => "vertex",
                Origin::Division => "division",
            };
            let end = |end: Option<f64>| end.map_or(String::new(), |time| time.to_string());
            let mut ends = end(life.extruded);
            if dividing {
                let _ = write!(ends, ",{}", end(life.divided));
            }
            let [first, last] = [0, 1].map(|end| text(seen[number].map(|ends| ends[end])));
            let _ = writeln!(
                table,
                "{number},{origin},{},{},{ends},{},{first},{last}",
                text(life.mother),
                life.born,
                text(columns[number])
            );
        }
        out.write_text("lineage.csv", &table)?;
        Ok(())
    }

    fn write_data_set(
        &self,
        out: &mut OutputDirectory,
        tissue: &LivingTissue,
        units: &Units,
        (columns, count): (&[Option<usize>], usize),
    ) -> Result<(), Failure> {
        if self.kept.len() * count * 4 > LARGEST {
            return Err(Failure::new(format!(
                "{} frames of {count} cells are too many to keep",
                self.kept.len()
            ))
            .with_hint("keep fewer frames"));
        }
        let mut positions = Array3::from_elem((self.kept.len(), count, 2), f64::NAN);
        let mut velocities = positions.clone();
        for (frame, cells) in self.kept.iter().enumerate() {
            for (life, r, v) in cells {
                if let Some(cell) = columns[*life] {
                    for axis in [0, 1] {
                        positions[(frame, cell, axis)] = r[axis];
                        velocities[(frame, cell, axis)] = v[axis];
                    }
                }
            }
        }
        let data = DataSet {
            velocities: Some(velocities),
            walls: tissue.channel().is_walled().then_some(WalledSides::X),
            frame_interval: self.interval,
            length_unit: units.length.clone(),
            time_unit: units.time.clone(),
            unwrapped: true,
            ..DataSet::new(
                positions,
                Boundary::Periodic { lengths: tissue.simulation().cell_box().lengths() },
            )
        };
        Ok(data.save(out)?)
    }
}
