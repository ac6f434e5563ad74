//! What cells of a movie can be coloured by, and which arrows they can have.

use crate::arrows::ArrowScale;
use crate::colour::{BLUE, ColourScale, INK, Palette, VERMILLION};
use crate::numbers::significant;
use crate::units::{Units, label_with_unit};
use crate::view::{CellView, FrameView, length};

/// What cells are coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Colouring {
    /// Area of the polygon.
    Area,
    /// Perimeter over the root of the area.
    Shape,
    /// Number of neighbours.
    Neighbours,
    /// Size of the measured velocity.
    Speed,
    /// Vorticity of the measured velocities.
    Vorticity,
    /// Size of what the model leaves of the measured velocity.
    Residual,
}

impl Colouring {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Shape, Self::Area, Self::Neighbours, Self::Speed, Self::Vorticity, Self::Residual];

    /// The word by which it is asked for, and what it is.
    #[must_use]
    pub fn word(self) -> [&'static str; 2] {
        match self {
            Self::Area => ["area", "Area"],
            Self::Shape => ["shape", "Perimeter over the root of the area"],
            Self::Neighbours => ["neighbours", "Number of neighbours"],
            Self::Speed => ["speed", "Size of the measured velocity"],
            Self::Vorticity => ["vorticity", "Vorticity of the measured velocities"],
            Self::Residual => ["residual", "Size of what the model leaves of the measured velocity"],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Area => "area",
            Self::Shape => "shape index",
            Self::Neighbours => "neighbours",
            Self::Speed => "speed",
            Self::Vorticity => "vorticity",
            Self::Residual => "residual",
        }
    }

    /// Powers of length and time.
    fn powers(self) -> [i32; 2] {
        match self {
            Self::Area => [2, 0],
            Self::Shape | Self::Neighbours => [0, 0],
            Self::Speed | Self::Residual => [1, -1],
            Self::Vorticity => [0, -1],
        }
    }

    pub(super) fn palette(self) -> Palette {
        match self {
            Self::Neighbours => Palette::Diverging { centre: 6.0 },
            Self::Vorticity => Palette::Diverging { centre: 0.0 },
            Self::Area | Self::Shape | Self::Speed | Self::Residual => Palette::Sequential,
        }
    }

    fn of(self, cell: &CellView) -> f64 {
        match self {
            Self::Area => cell.area,
            Self::Shape => cell.shape_index(),
            Self::Neighbours if cell.polygon.is_empty() => f64::NAN,
            Self::Neighbours => cell.polygon.len() as f64,
            Self::Speed => cell.measured.map_or(f64::NAN, length),
            Self::Vorticity => cell.vorticity.unwrap_or(f64::NAN),
            Self::Residual => cell.residual().map_or(f64::NAN, length),
        }
    }
}

/// A number of each cell in each frame, and its colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// What it is.
    pub colouring: Colouring,
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Values, frame by frame and cell by cell; not finite where unknown.
    pub values: Vec<Vec<f64>>,
    /// The same colours for all frames; limits are those of the used cells.
    pub colours: ColourScale,
}

impl Quantity {
    /// All that is known of the cells; residuals first, as they are what a fit is looked at for.
    pub(super) fn of_frames(frames: &[FrameView], units: &Units) -> Vec<Self> {
        let mut all: Vec<Self> = (Colouring::ALL.into_iter())
            .filter_map(|colouring| Self::new(colouring, colouring.name(), frames, units))
            .collect();
        all.sort_by_key(|own| own.colouring != Colouring::Residual);
        all
    }

    /// The residuals of a fit under a name of their own.
    pub(super) fn residual(name: &str, frames: &[FrameView], units: &Units) -> Option<Self> {
        Self::new(Colouring::Residual, name, frames, units)
    }

    fn new(colouring: Colouring, name: &str, frames: &[FrameView], units: &Units) -> Option<Self> {
        let used = frames.iter().flat_map(|frame| &frame.cells).filter(|cell| cell.is_used());
        let colours = ColourScale::robust(used.map(|cell| colouring.of(cell)), colouring.palette())?;
        let [length, time] = colouring.powers();
        let values = |frame: &FrameView| frame.cells.iter().map(|cell| colouring.of(cell)).collect();
        Some(Self {
            colouring,
            name: name.to_owned(),
            unit: units.powers(length, time),
            values: frames.iter().map(values).collect(),
            colours,
        })
    }

    /// Its name with its unit.
    #[must_use]
    pub fn label(&self) -> String {
        label_with_unit(&self.name, &self.unit)
    }
}

/// A vector of each cell in each frame, in the unit of velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrowField {
    /// Its name.
    pub name: String,
    /// Colour of the arrows.
    pub colour: &'static str,
    /// Vectors, frame by frame and cell by cell; `None` where unknown.
    pub vectors: Vec<Vec<Option<[f64; 2]>>>,
    /// What an arrow of [`ArrowScale::reference`] stands for, with its unit.
    pub reference: String,
    scale: ArrowScale,
}

impl ArrowField {
    /// Measured velocities, those of the model and what it leaves, as far as they are known.
    pub(super) fn of_frames(frames: &[FrameView], units: &Units) -> Vec<Self> {
        let velocities = ArrowScale::velocities(frames);
        let field = |name: &str, colour, of: fn(&CellView) -> Option<[f64; 2]>| {
            Self::new(name, colour, (frames, of), velocities?, units)
        };
        let fields = [
            field("velocity", INK, |cell| cell.measured),
            field("velocity of the model", BLUE, |cell| cell.predicted),
            field("polarity", crate::colour::GREEN, |cell| cell.polarity),
            Self::residual("residual", frames, units, None),
        ];
        fields.into_iter().flatten().collect()
    }

    /// What a model leaves, on a scale of its own or that of others.
    pub(super) fn residual(
        name: &str,
        frames: &[FrameView],
        units: &Units,
        scale: Option<ArrowScale>,
    ) -> Option<Self> {
        let scale = scale.or_else(|| ArrowScale::residuals(frames))?;
        Self::new(name, VERMILLION, (frames, CellView::residual), scale, units)
    }

    fn new(
        name: &str,
        colour: &'static str,
        (frames, of): (&[FrameView], impl Fn(&CellView) -> Option<[f64; 2]>),
        scale: ArrowScale,
        units: &Units,
    ) -> Option<Self> {
        let finite = |cell: &CellView| of(cell).filter(|&vector| crate::view::is_finite(vector));
        let vectors: Vec<Vec<_>> =
            frames.iter().map(|frame| frame.cells.iter().map(&finite).collect()).collect();
        let is_known = vectors.iter().flatten().any(Option::is_some);
        is_known.then(|| Self {
            name: name.to_owned(),
            colour,
            vectors,
            reference: format!("{} {}", significant(scale.reference, 1), units.velocity_text()),
            scale,
        })
    }

    /// How long its arrows are drawn.
    #[must_use]
    pub fn scale(&self) -> ArrowScale {
        self.scale
    }

    pub(super) fn is_residual(&self) -> bool {
        self.colour == VERMILLION
    }
}
