//! Which cell of a frame is which of the frame before, by place alone.

use voronudge_geometry::{Domain, Vector};
use voronudge_segmentation::link_nearest;

/// How far a cell may move from frame to frame by default, as a share of the mean distance of cells.
const LINK_LIMIT: f64 = 0.5;

/// How cells of different frames are taken for one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum PlaceLinking {
    /// Not at all: each frame has cells of its own.
    #[default]
    Separate,
    /// The nearest of the same kind, if it is within a limit in units of length; default half the mean distance of cells.
    Nearest {
        /// The farthest that a cell moves between frames.
        limit: Option<f64>,
    },
}

/// A cell of a frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) position: Vector<f64>,
    /// Only cells of one kind are taken for one.
    pub(crate) kind: i64,
}

/// Gives numbers along the axis of cells, frame by frame.
pub(crate) struct Follower {
    linking: PlaceLinking,
    domain: Domain,
    before: Vec<(Place, usize)>,
    /// Cells so far.
    pub(crate) given: usize,
    /// Cells that are known from the frame before, so far.
    pub(crate) linked: usize,
}

impl Follower {
    pub(crate) fn new(linking: PlaceLinking, domain: Domain) -> Self {
        Self { linking, domain, before: Vec::new(), given: 0, linked: 0 }
    }

    /// The number of each cell of the next frame; `spacing` is the mean distance of cells.
    pub(crate) fn follow(&mut self, places: &[Place], spacing: f64) -> Vec<usize> {
        let mut known = vec![None; places.len()];
        if let PlaceLinking::Nearest { limit } = self.linking {
            let limit = limit.unwrap_or(default_limit(spacing));
            for kind in [0, 1] {
                let from: Vec<&(Place, usize)> =
                    self.before.iter().filter(|(place, _)| place.kind == kind).collect();
                let to: Vec<usize> = (0..places.len()).filter(|&k| places[k].kind == kind).collect();
                let before: Vec<_> = from.iter().map(|(place, _)| place.position).collect();
                let after: Vec<_> = to.iter().map(|&k| places[k].position).collect();
                for ((_, track), j) in from.iter().zip(link_nearest(&before, &after, limit, self.domain)) {
                    if let Some(j) = j {
                        known[to[j]] = Some(*track);
                    }
                }
            }
        }
        self.linked += known.iter().flatten().count();
        let tracks: Vec<usize> = known
            .into_iter()
            .map(|known| {
                known.unwrap_or_else(|| {
                    self.given += 1;
                    self.given - 1
                })
            })
            .collect();
        self.before = places.iter().copied().zip(tracks.iter().copied()).collect();
        tracks
    }
}

/// The farthest that a cell moves, where nobody says.
pub(crate) fn default_limit(spacing: f64) -> f64 {
    LINK_LIMIT * spacing
}
