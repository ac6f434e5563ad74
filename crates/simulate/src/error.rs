use thiserror::Error;

/// Why a simulation cannot be made or go on.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The positions cannot be tessellated.
    #[error("at time {time}: {source}")]
    Tessellation {
        /// Time of the evaluation.
        time: f64,
        /// What the tessellation said.
        source: voronudge_geometry::Error,
    },
    /// Time integration needs the velocity of every cell, which an open field of view does not give.
    #[error("an open field of view cannot be simulated")]
    OpenDomain,
    /// No cells to place.
    #[error("0 cells, but a simulation needs at least 1")]
    NoCells,
    /// A least distance between starting positions that is negative or not finite.
    #[error(
        "the least distance between cells is {value} of their mean spacing, but it must be finite and not negative"
    )]
    LeastDistance {
        /// The distance given.
        value: f64,
    },
    /// A time step that is not a positive finite number.
    #[error("the time step is {time_step}, but it must be positive and finite")]
    TimeStep {
        /// The step given.
        time_step: f64,
    },
    /// A duration that is not a positive finite number.
    #[error("the duration is {time}, but it must be positive and finite")]
    Duration {
        /// The duration given.
        time: f64,
    },
    /// A schedule that nobody lives to see the end of.
    #[error("the duration has {steps:.3e} time steps, but {limit:.0e} are the most")]
    TooManySteps {
        /// Steps needed.
        steps: f64,
        /// The most possible.
        limit: f64,
    },
    /// A schedule that records nothing.
    #[error("0 frames, but a schedule records at least 1")]
    NoFrames,
    /// A tolerance of the adaptive method that is no small positive number.
    #[error(
        "the tolerance is {tolerance}, but it must be positive and finite, and at most 1, the mean spacing"
    )]
    Tolerance {
        /// The tolerance given.
        tolerance: f64,
    },
    /// An amount of self-propulsion or noise that is negative or not finite.
    #[error("the {name} is {value}, but it must be finite and not negative")]
    Driving {
        /// What it is.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// Cells that come and go have no speed of their own.
    #[error("cells whose speed of self-propulsion varies cannot be replaced by others")]
    FreeSpeed,
    /// Walls around cells that cannot have any.
    #[error("there can be no walls: {reason}")]
    Walls {
        /// Why.
        reason: &'static str,
    },
    /// A strain that is not small.
    #[error("the strain is {strain}, but it must be positive and at most {limit}")]
    Strain {
        /// The strain given.
        strain: f64,
        /// The largest that is taken.
        limit: f64,
    },
    /// An amount of a measurement under shear that is not a positive finite number.
    #[error("the {name} is {value}, but it must be positive and finite")]
    Rate {
        /// What it is.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// The linear response of a tissue cannot be solved for.
    #[error("the linear response at the angular frequency {frequency}: {source}")]
    Response {
        /// The angular frequency.
        frequency: f64,
        /// What the solver said.
        source: voronudge_linalg::Error,
    },
    /// Whoever watched a measurement broke it off.
    #[error("interrupted")]
    Interrupted,
    /// A run is to be differentiated by the position of a cell that is not there.
    #[error("there is no cell {cell} among {cells}")]
    NoSuchCell {
        /// Number of the cell asked for.
        cell: usize,
        /// How many cells there are.
        cells: usize,
    },
    /// A state of other cells.
    #[error("a state of {positions} positions and {headings} directions is not one of these {cells} cells")]
    State {
        /// Number of cells of the simulation.
        cells: usize,
        /// Number of positions of the state.
        positions: usize,
        /// Number of directions of the state.
        headings: usize,
    },
    /// Cells that no honeycomb of the box has.
    #[error("a honeycomb of {cells} cells does not fit a periodic box")]
    Honeycomb {
        /// Number of cells asked for.
        cells: usize,
    },
    /// Parameters of single cells that cannot be.
    #[error("{source}")]
    Environment {
        /// What the model said.
        source: voronudge_model::EnvironmentError,
    },
    /// A rate or a length of the turnover of cells that cannot be.
    #[error("the {name} is {value}, but it must be {required}")]
    Turnover {
        /// What it is.
        name: &'static str,
        /// The value given.
        value: f64,
        /// What it must be.
        required: &'static str,
    },
    /// A sheared box has no straight edges.
    #[error("the upper image of the box is displaced by {offset}, but a channel has straight edges along y")]
    ShearedChannel {
        /// The displacement.
        offset: f64,
    },
    /// Walls at its ends make a channel a box.
    #[error("there are walls on all four sides, but a channel has open ends")]
    ClosedChannel,
    /// All cells are gone.
    #[error("at time {time} the last cell is extruded")]
    Extinct {
        /// When.
        time: f64,
    },
    /// More cells than are allowed.
    #[error("at time {time} there would be {cells} cells (limit {limit})")]
    TooManyCells {
        /// When.
        time: f64,
        /// How many there would be.
        cells: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// More births in one step than there are places apart from each other.
    #[error("at time {time} there is no place left for one of {births} new cells in one step of {time_step}")]
    NoPlace {
        /// When.
        time: f64,
        /// New cells of the step.
        births: usize,
        /// The time step `Δt`.
        time_step: f64,
    },
    /// Bins that cannot be.
    #[error("{bins} bins across the channel, but the number must be even and at least 2")]
    Bins {
        /// The number given.
        bins: usize,
    },
    /// A cell that moves too far in one step: the time step is too large for the forces.
    #[error(
        "at time {time}, cell {cell} would move by {distance} in one step of {time_step} (limit {limit}): the time step \
         is too large"
    )]
    StepTooLarge {
        /// Time at the beginning of the step.
        time: f64,
        /// The first cell that moves too far.
        cell: usize,
        /// How far it would move; NaN or infinite if its velocity is.
        distance: f64,
        /// The mean spacing of the cells.
        limit: f64,
        /// The time step `Δt`.
        time_step: f64,
    },
}

impl Error {
    /// Advice on what to change, if there is any.
    ///
    /// ```
    /// use voronudge_simulate::Error;
    /// assert!(Error::TimeStep { time_step: -1.0 }.hint().is_some());
    /// ```
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Tessellation { source, .. } => source.hint(),
            Self::OpenDomain => Some("give a periodic box"),
            Self::NoCells => Some("ask for one cell or more"),
            Self::LeastDistance { .. } => Some("0.7 is usual; above about 0.8 cells do not fit at random"),
            Self::TimeStep { .. } | Self::StepTooLarge { .. } => Some(
                "take a smaller time step: K_P Δt ≤ 0.01 for |α| ≤ 1, K_P |α| Δt ≤ 0.01 above; halve it until the result \
                 does not change",
            ),
            Self::TooManySteps { .. } => Some("shorten the duration, or take a larger time step"),
            Self::Duration { .. } => Some("give the duration in units of time, about 1/K_P"),
            Self::Tolerance { .. } => Some("1e-4 of the mean spacing is usual"),
            Self::Walls { .. } => {
                Some("give a rectangular box and a model without such effects, or no walls")
            }
            Self::Strain { .. } => Some("1e-5 is usual for a tissue at rest, 0.1 for one that flows"),
            Self::Driving { .. } => Some("give zero or more, or leave it out"),
            Self::FreeSpeed => Some("let all have one speed"),
            Self::Rate { .. } => Some("leave it out for the default"),
            Self::Response { .. } => Some("another frequency may be away from a mode of the tissue"),
            Self::Interrupted => None,
            Self::Environment { .. } => Some("give one finite multiple for each cell"),
            Self::Turnover { .. } => Some("give rates per cell and time, and lengths in the unit of the box"),
            Self::ShearedChannel { .. } => Some("give a box with a right angle"),
            Self::ClosedChannel => Some("give walls left and right only"),
            Self::Extinct { .. } => Some("lower the rate of extrusion, or raise that of proliferation"),
            Self::TooManyCells { .. } => {
                Some("lower the rate of proliferation, raise that of extrusion, or allow more cells")
            }
            Self::NoPlace { .. } => Some(
                "take a smaller time step, lower the rates, or widen a channel of one or two cells between walls",
            ),
            Self::Bins { .. } => Some("take an even number, such as two for each cell size"),
            Self::NoSuchCell { .. } => Some("cells are numbered from zero"),
            Self::State { .. } => Some("go on with the run that the state was taken from"),
            Self::Honeycomb { .. } => Some("take a multiple of four, such as 100"),
            Self::NoFrames => Some("ask for one frame to get the end of the run"),
        }
    }
}
