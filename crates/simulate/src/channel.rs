//! The channel between two edges: a box seen across x.

use crate::{Error, Simulation, Walls};
use voronudge_geometry::{PeriodicBox, Vector};

/// A channel along y with its edges at `x = 0` and `x = W`.
///
/// The box is periodic in both directions, as in the paper: cells on both sides of an edge touch. What makes an edge is that rates
/// of extrusion and proliferation depend on the distance from it. Or there are [`Walls`] at the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    width: f64,
    length: f64,
    walled: bool,
}

impl Channel {
    /// The channel of a rectangular periodic box.
    ///
    /// # Errors
    /// [`Error::ShearedChannel`] for a sheared box.
    ///
    /// ```
    /// use voronudge_geometry::{PeriodicBox, Vector};
    /// use voronudge_simulate::Channel;
    /// let channel = Channel::new(&PeriodicBox::new([20.0, 10.0])?)?;
    /// assert_eq!(channel.edge_distance(Vector::new(18.5, 3.0)), 1.5);
    /// assert_eq!(channel.edge_distance(Vector::new(-1.0, 3.0)), 1.0); // unwrapped
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(cell_box: &PeriodicBox) -> Result<Self, Error> {
        if cell_box.offset() != 0.0 {
            return Err(Error::ShearedChannel { offset: cell_box.offset() });
        }
        let [width, length] = cell_box.lengths();
        Ok(Self { width, length, walled: false })
    }

    /// The channel of a simulation, with its walls.
    ///
    /// # Errors
    /// [`Error::ShearedChannel`] for a sheared box; [`Error::ClosedChannel`] between four walls.
    pub fn of(simulation: &Simulation) -> Result<Self, Error> {
        let channel = Self::new(&simulation.cell_box())?;
        match simulation.walls() {
            None => Ok(channel),
            Some(Walls::X) => Ok(channel.with_walls()),
            Some(Walls::Both) => Err(Error::ClosedChannel),
        }
    }

    /// The same with walls at its edges.
    pub fn with_walls(self) -> Self {
        Self { walled: true, ..self }
    }

    /// Whether there are walls at its edges. Places are between them, and the strips at both edges do not touch.
    pub fn is_walled(&self) -> bool {
        self.walled
    }

    /// Width `W` across x.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Length along y.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Whether a place between the edges is in the right half.
    pub(crate) fn is_right(&self, place: Vector<f64>) -> bool {
        place.x > 0.5 * self.width
    }

    /// Distance `d_b` of a place, wrapped or not, from the nearer edge.
    pub fn edge_distance(&self, place: Vector<f64>) -> f64 {
        let x = place.x.rem_euclid(self.width);
        x.min(self.width - x)
    }
}
