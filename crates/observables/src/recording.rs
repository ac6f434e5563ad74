//! Cells followed over frames.

use crate::Error;
use rayon::prelude::*;
use voronudge_geometry::{Domain, FieldOfView, Region, Tessellation, Vector};

/// Which image of a cell a position in a periodic box is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Images {
    /// Positions go on beyond the sides of the box.
    Followed,
    /// Positions may have been put back into the box: of the images, the one nearest to where the cell was last.
    Nearest,
}

/// The cells seen in one frame.
#[derive(Debug, Clone)]
pub struct Frame {
    /// When.
    pub time: f64,
    /// Which cell each is: its number among all of the recording, ascending.
    pub tracks: Vec<usize>,
    /// Where they are, going on beyond the sides of a periodic box.
    pub positions: Vec<Vector<f64>>,
    /// How fast they are, where that is known.
    pub velocities: Vec<Option<Vector<f64>>>,
    /// Who is next to whom.
    pub tessellation: Tessellation,
    /// Whether a cell and all its neighbours have the polygons that they would have if all cells had been seen.
    pub counted: Vec<bool>,
    /// Where every cell would have been seen; `None` if that is everywhere.
    pub region: Option<Region>,
    /// By how much what is common to all cells has moved them since the first frame.
    pub stage: Vector<f64>,
}

impl Frame {
    fn new(
        (frame, time): (usize, f64),
        places: &[Option<Vector<f64>>],
        domain: Domain,
        view: &FieldOfView,
    ) -> Result<Self, Error> {
        let (tracks, positions): (Vec<usize>, Vec<Vector<f64>>) =
            places.iter().enumerate().filter_map(|(track, r)| Some((track, (*r)?))).unzip();
        let tessellation = Tessellation::new(&positions, domain)
            .map_err(|source| Error::Tessellation { frame, source: numbered(source, &tracks) })?;
        let certificate = view.judge(&tessellation, &positions);
        let counted = (0..tracks.len()).map(|cell| certificate.counts(cell)).collect();
        let (_, region) = certificate.into_parts();
        let velocities = vec![None; tracks.len()];
        Ok(Self {
            time,
            tracks,
            positions,
            velocities,
            tessellation,
            counted,
            region,
            stage: Vector::zeros(),
        })
    }

    /// The number here of a cell, if it was seen.
    pub fn cell(&self, track: usize) -> Option<usize> {
        self.tracks.binary_search(&track).ok()
    }

    /// The numbers here of the cells that count.
    pub fn in_view(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.tracks.len()).filter(|cell| self.counted[*cell])
    }

    /// Where a cell is beside the stage, if it counts.
    pub fn position_of_track(&self, track: usize) -> Option<Vector<f64>> {
        let cell = self.cell(track).filter(|cell| self.counted[*cell])?;
        Some(self.positions[cell] - self.stage)
    }
}

/// An error of the geometry with cells numbered as in the recording.
fn numbered(error: voronudge_geometry::Error, tracks: &[usize]) -> voronudge_geometry::Error {
    use voronudge_geometry::Error;
    match error {
        Error::DuplicateCells { first, second, x, y } => {
            Error::DuplicateCells { first: tracks[first], second: tracks[second], x, y }
        }
        Error::Position { cell, x, y } => Error::Position { cell: tracks[cell], x, y },
        other => other,
    }
}

/// Cells followed over frames, in a periodic box or an open field of view.
#[derive(Debug, Clone)]
pub struct Recording {
    frames: Vec<Frame>,
    tracks: usize,
    /// Whether velocities were made from positions.
    derived: bool,
}

impl Recording {
    /// Tessellates the frames and judges their cells. `places[frame][cell]` is where a cell was seen (F, N); times (F) ascend.
    ///
    /// # Errors
    /// [`Error::Frames`], [`Error::Cells`], [`Error::Tessellation`].
    ///
    /// ```
    /// use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, honeycomb};
    /// use voronudge_observables::{Images, Plan, Quantity, Recording, observe};
    /// let (cells, lengths) = honeycomb(6, 6);
    /// let domain = Domain::Periodic(PeriodicBox::new(lengths)?);
    /// let frame = cells.into_iter().map(Some).collect();
    /// let recording = Recording::new(&[0.0], vec![frame], &[domain], &FieldOfView::default(), Images::Nearest)?;
    /// let measured = observe(&recording, &Plan::of(&recording)?);
    /// let order = measured.iter().find(|curve| curve.of == Quantity::HexaticOrder).unwrap();
    /// assert!((order.value[0] - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        times: &[f64],
        mut places: Vec<Vec<Option<Vector<f64>>>>,
        domains: &[Domain],
        view: &FieldOfView,
        images: Images,
    ) -> Result<Self, Error> {
        let count = places.len();
        for (what, found) in [("times", times.len()), ("domains", domains.len())] {
            if found != count {
                return Err(Error::Frames { what, frames: count, found });
            }
        }
        let tracks = places.first().map_or(0, Vec::len);
        let other = places.iter().position(|frame| frame.len() != tracks);
        if let Some(frame) = other {
            return Err(Error::Cells { frame, cells: tracks, found: places[frame].len() });
        }
        if images == Images::Nearest {
            follow(&mut places, domains);
        }
        let frames = (0..count)
            .into_par_iter()
            .map(|frame| Frame::new((frame, times[frame]), &places[frame], domains[frame], view))
            .collect::<Result<_, _>>()?;
        Ok(Self { frames, tracks, derived: false })
    }

    /// With velocities `[frame][cell]` (F, N); those of cells that are not there are of no concern.
    ///
    /// # Errors
    /// [`Error::Frames`], [`Error::Cells`].
    pub fn with_velocities(mut self, velocities: &[Vec<Option<Vector<f64>>>]) -> Result<Self, Error> {
        let frames = self.frames.len();
        if velocities.len() != frames {
            return Err(Error::Frames { what: "frames of velocities", frames, found: velocities.len() });
        }
        for (frame, (own, all)) in self.frames.iter_mut().zip(velocities).enumerate() {
            if all.len() != self.tracks {
                return Err(Error::Cells { frame, cells: self.tracks, found: all.len() });
            }
            own.velocities = own.tracks.iter().map(|track| all[*track]).collect();
        }
        Ok(self)
    }

    /// With mean velocities until the next frame, of the cells that are seen in both.
    #[must_use]
    pub fn with_mean_velocities(mut self) -> Self {
        self.derived = true;
        for frame in 1..self.frames.len() {
            let (before, after) = self.frames.split_at_mut(frame);
            let (own, next) = (&mut before[frame - 1], &after[0]);
            let time = next.time - own.time;
            let moved = |(cell, track): (usize, &usize)| {
                let to = next.positions[next.cell(*track)?] - next.stage;
                Some((to - own.positions[cell] + own.stage) / time)
            };
            own.velocities = own.tracks.iter().enumerate().map(moved).collect();
        }
        self
    }

    /// Takes the median motion of the cells from frame to frame for one of the stage, and the median of velocities out of them.
    #[must_use]
    pub fn without_common_motion(mut self) -> Self {
        let mut stage = Vector::zeros();
        for frame in 0..self.frames.len() {
            if let Some(before) = frame.checked_sub(1) {
                let (before, own) = (&self.frames[before], &self.frames[frame]);
                let moved = |track: &usize| {
                    let from = before.positions[before.cell(*track)?];
                    Some(own.positions[own.cell(*track)?] - from)
                };
                stage += median(own.tracks.iter().filter_map(moved));
            }
            let own = &mut self.frames[frame];
            let common = median(own.velocities.iter().flatten().copied());
            own.velocities.iter_mut().flatten().for_each(|v| *v -= common);
            own.stage = stage;
        }
        self
    }

    /// Lets those cells count that count in another recording of the same cells, where they are seen in both.
    #[must_use]
    pub fn counted_as(mut self, other: &Self) -> Self {
        for (own, other) in self.frames.iter_mut().zip(&other.frames) {
            let counts = |track: &usize| other.cell(*track).is_some_and(|cell| other.counted[cell]);
            own.counted = own.tracks.iter().map(counts).collect();
            own.region.clone_from(&other.region);
        }
        self
    }

    /// The frames, in the order of time.
    pub fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Whether velocities are displacements until the next frame.
    pub fn velocities_are_displacements(&self) -> bool {
        self.derived
    }

    /// Number of cells that are followed, at whatever time they are there.
    pub fn tracks(&self) -> usize {
        self.tracks
    }

    /// Whether cells are there of which a velocity is known.
    pub fn has_velocities(&self) -> bool {
        self.frames.iter().any(|frame| frame.in_view().any(|cell| frame.velocities[cell].is_some()))
    }
}

/// Of the images of a cell in a periodic box, takes the one nearest to where it was last.
fn follow(places: &mut [Vec<Option<Vector<f64>>>], domains: &[Domain]) {
    let mut last: Vec<Option<Vector<f64>>> = vec![None; places.first().map_or(0, Vec::len)];
    for (frame, domain) in places.iter_mut().zip(domains) {
        for (own, last) in frame.iter_mut().zip(&mut last) {
            let Some(r) = own else { continue };
            if let Some(last) = last {
                *r = *last + domain.shortest(*r - *last);
            }
            *last = *own;
        }
    }
}

/// The median of each component; nought of none.
fn median(all: impl Iterator<Item = Vector<f64>>) -> Vector<f64> {
    let all: Vec<Vector<f64>> = all.collect();
    let of_axis = |axis: usize| {
        let mut values: Vec<f64> = all.iter().map(|v| v[axis]).collect();
        values.sort_unstable_by(f64::total_cmp);
        let middle = values.len() / 2;
        match values.len() {
            0 => 0.0,
            even if even % 2 == 0 => 0.5 * (values[middle - 1] + values[middle]),
            _ => values[middle],
        }
    };
    Vector::new(of_axis(0), of_axis(1))
}
