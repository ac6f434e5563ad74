//! A set as a folder that the program reads, with nothing declared that a user would not know.

use super::{MeasuredSet, Truth, Velocities, first_frame};
use ndarray::{Array1, Array3};
use std::error::Error;
use std::path::{Path, PathBuf};
use voronudge_io::{Error as IoError, OutputDirectory};

/// A set on the disk.
#[derive(Debug, Clone)]
pub struct Written {
    /// What the program is given.
    pub data: PathBuf,
    /// What it was made with.
    pub truth: Truth,
}

impl MeasuredSet {
    /// Writes `data/`, which the program reads, and `truth.json` beside it into a folder.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn write(self, folder: &Path) -> Result<Written, Box<dyn Error>> {
        let data = folder.join("data");
        self.save(&data)?;
        std::fs::write(folder.join("truth.json"), self.truth_text()?)?;
        Ok(Written { data, truth: self.truth })
    }

    /// Writes what the program reads into a folder.
    ///
    /// # Errors
    /// If the folder cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        let mut out = OutputDirectory::create(folder)?;
        self.stage(&mut out)?;
        out.commit()?;
        Ok(())
    }

    /// What made it, as JSON.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn truth_text(&self) -> Result<String, Box<dyn Error>> {
        Ok(serde_json::to_string_pretty(&self.truth)?)
    }

    fn stage(&self, out: &mut OutputDirectory) -> Result<(), IoError> {
        write_frames(out, "positions.npy", &self.positions)?;
        match &self.velocities {
            Velocities::None => {}
            Velocities::OfCells(velocities) => write_frames(out, "velocities.npy", velocities)?,
            Velocities::OnGrid(coordinates, flow) => {
                out.write_array("flow.npy", flow.view())?;
                let coordinates = Array1::from(coordinates.clone());
                out.write_array("flow_x.npy", coordinates.view())?;
                out.write_array("flow_y.npy", coordinates.view())?;
            }
        }
        let boundary = match self.cell_box {
            Some(side) => format!("boundary = \"periodic\"\nbox = [{side:?}, {side:?}]"),
            None => "boundary = \"open\"".into(),
        };
        let units = "length_unit = \"l\"\ntime_unit = \"t\"\ny_axis = \"up\"";
        let interval = match self.velocities {
            Velocities::None => format!("frame_interval = {:?}\n", self.interval),
            _ => String::new(),
        };
        out.write_text("dataset.toml", &format!("{boundary}\n{interval}{units}\n"))
    }
}

/// A single frame as (cells, 2).
fn write_frames(out: &mut OutputDirectory, name: &str, array: &Array3<f64>) -> Result<(), IoError> {
    if array.dim().0 == 1 {
        out.write_array(name, first_frame(array).view())
    } else {
        out.write_array(name, array.view())
    }
}
