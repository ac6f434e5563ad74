//! Shear of the box, and walls.

use super::report::Request;
use crate::failure::Failure;
use clap::{Args, ValueEnum};
use ndarray::Axis;
use voronudge_geometry::PeriodicBox;
use voronudge_io::{DataSet, WalledSides};
use voronudge_simulate::{Shear, Walls};

#[derive(Debug, Args)]
#[command(next_help_heading = "Surroundings")]
pub(super) struct SurroundingsArguments {
    /// Simple shear of the periodic box by this strain, from the start (Lees–Edwards).
    #[arg(long, value_name = "STRAIN", conflicts_with_all = ["shear_rate", "shear_amplitude"], allow_negative_numbers = true)]
    shear_strain: Option<f64>,
    /// Steady simple shear at this rate, in 1/time.
    #[arg(long, value_name = "RATE", conflicts_with = "shear_amplitude", allow_negative_numbers = true)]
    shear_rate: Option<f64>,
    /// Oscillating simple shear with this largest strain; needs --shear-frequency.
    #[arg(long, value_name = "STRAIN", requires = "shear_frequency", allow_negative_numbers = true)]
    shear_amplitude: Option<f64>,
    /// Angular frequency of the oscillating shear, in 1/time; needs --shear-amplitude.
    #[arg(long, value_name = "OMEGA", requires = "shear_amplitude", allow_negative_numbers = true)]
    shear_frequency: Option<f64>,
    /// Put torque-free walls at the left and right sides of the box, or on all four sides.
    #[arg(long, value_enum, conflicts_with_all = ["shear_strain", "shear_rate", "shear_amplitude"])]
    walls: Option<WallsName>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum WallsName {
    /// Left and right: a channel, periodic in y.
    X,
    /// On all four sides.
    Both,
}

impl SurroundingsArguments {
    pub fn shear(&self) -> Result<Option<Shear>, Failure> {
        let numbers = [
            ("--shear-strain", self.shear_strain),
            ("--shear-rate", self.shear_rate),
            ("--shear-amplitude", self.shear_amplitude),
            ("--shear-frequency", self.shear_frequency),
        ];
        if let Some((name, value)) = numbers
            .iter()
            .find_map(|(name, value)| value.filter(|value| !value.is_finite()).map(|value| (name, value)))
        {
            return Err(Failure::new(format!("{name} is {value}, but it must be finite"))
                .with_hint("leave it out for no shear"));
        }
        let oscillatory = self.shear_amplitude.zip(self.shear_frequency);
        Ok(self
            .shear_strain
            .map(|strain| Shear::Step { strain })
            .or(self.shear_rate.map(|rate| Shear::Steady { rate }))
            .or(oscillatory
                .map(|(amplitude, angular_frequency)| Shear::Oscillatory { amplitude, angular_frequency })))
    }

    pub fn walls(&self) -> Option<Walls> {
        self.walls.map(|walls| match walls {
            WallsName::X => Walls::X,
            WallsName::Both => Walls::Both,
        })
    }
}

/// Tells in a data set without its frames what is around the cells in each of them.
pub(super) fn describe(
    data: &mut DataSet,
    request: &Request,
    from: PeriodicBox,
    interval: f64,
) -> Result<(), Failure> {
    data.walls = request.walls.map(|walls| match walls {
        Walls::X => WalledSides::X,
        Walls::Both => WalledSides::Both,
    });
    let shear = request.driving.shear;
    if shear.is_none() && from.offset() == 0.0 {
        return Ok(());
    }
    let strain = |frame: usize| shear.map_or(0.0, |shear| shear.strain((frame + 1) as f64 * interval));
    let offset = |frame| from.after_shear(strain(frame)).map(|cell_box| cell_box.offset());
    data.box_offset = Some((0..request.frames).map(offset).collect::<Result<_, _>>()?);
    data.unwrapped &= (0..request.frames).all(|frame| from.runs_on(strain(frame)));
    // One offset for each frame: the frames themselves are on disk already.
    let (one, cells) = (data.positions.index_axis(Axis(0), 0).to_owned(), data.cells());
    if let Some(all) = one.broadcast((request.frames, cells, 2)) {
        data.positions = all.to_owned();
    }
    Ok(())
}
