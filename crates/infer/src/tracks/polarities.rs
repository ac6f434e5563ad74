//! The unknown polarities of a movie: which cells have one in which frames, and what may hold or drive them.

use super::instants::Instant;
use super::motions::Motion;
use super::movie::Movie;
use crate::Drives;

/// Marks a cell without a polarity.
pub(super) const NONE: u32 = u32::MAX;

/// The neighbours, as blocks, of each polarity in its frame, with their weights in L; none at all where cells do not align.
pub(super) type Ties = Vec<Vec<(u32, f64)>>;

/// A polarity and that before, and where in the frames before it is expected from: frame, cell and share.
#[derive(Debug, Clone)]
pub(super) struct Driven {
    pub block: u32,
    pub from: Vec<(usize, usize, f64)>,
}

/// The unknown polarities of a movie: of each cell at the frames at which motions begin or end that are explained.
#[derive(Debug, Clone, Default)]
pub(crate) struct Polarities {
    /// Block of each cell of each frame; [`NONE`] where there is none.
    pub block: Vec<Vec<u32>>,
    /// First block.
    first: usize,
    /// The neighbours of each in its frame.
    pub(super) ties: Ties,
    /// The first ones of the tracks.
    pub firsts: Vec<First>,
    /// Number of the terms on which first polarities are regressed: the first ones of the model. Their γ stand behind (see [`super::outset`]).
    pub terms: usize,
    /// The time since the polarity before of the same cell, in usual intervals; one for each block.
    pub(super) since: Vec<Option<f64>>,
    /// What may drive them, and those that are.
    pub drives: Drives,
    pub(super) driven: Vec<Driven>,
}

/// The first polarity of a track.
#[derive(Debug, Clone, Copy)]
pub(crate) struct First {
    pub frame: usize,
    /// Index among the cells of the frame.
    pub cell: usize,
    pub block: usize,
}

impl Polarities {
    /// Behind all other blocks, for a model of so many terms.
    pub fn new(movie: &Movie, instants: &[Instant], motions: &[Motion], first: usize, terms: usize) -> Self {
        let mut block: Vec<Vec<u32>> =
            instants.iter().map(|instant| vec![NONE; instant.tracks.len()]).collect();
        let mut of_tracks: Vec<Vec<(usize, u32)>> = vec![Vec::new(); movie.tracks.len()];
        for motion in motions {
            for (end, cell) in motion.cells.iter().enumerate() {
                let at = (motion.interval + end, *cell);
                let own = &mut of_tracks[motion.track as usize];
                if own.last() != Some(&at) {
                    own.push(at);
                }
            }
        }
        let (mut since, mut firsts) = (Vec::new(), Vec::new());
        for all in of_tracks {
            let mut before = None;
            for (frame, cell) in all {
                let own = first + since.len();
                if before.is_none() {
                    firsts.push(First { frame, cell: cell as usize, block: own });
                }
                block[frame][cell as usize] = own as u32;
                let time = movie.times[frame] / movie.interval();
                since.push(before.map(|before| time - before));
                before = Some(time);
            }
        }
        Self { block, first, firsts, since, terms, ..Self::default() }
    }

    /// Number of polarities.
    pub fn count(&self) -> usize {
        self.since.len()
    }

    /// Blocks of the polarities.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count()
    }

    /// Number of polarities, of blocks of γ and of those of drives.
    pub fn blocks(&self) -> usize {
        self.count() + self.terms.div_ceil(2) + usize::from(self.drives.any())
    }

    /// Blocks of γ.
    pub fn gamma(&self) -> std::ops::Range<usize> {
        let first = self.first + self.count();
        first..first + self.terms.div_ceil(2)
    }

    /// Whether neighbours may hold each other.
    pub fn align(&self) -> bool {
        !self.ties.is_empty()
    }

    /// The block of what drives them, if there are drives.
    pub fn of_drives(&self) -> Option<usize> {
        self.drives.any().then(|| self.gamma().end)
    }

    /// The polarities before those that are driven.
    pub(super) fn before_driven(&self) -> impl Iterator<Item = u32> {
        self.driven.iter().map(|driven| driven.block - 1)
    }
}
