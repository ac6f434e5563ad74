//! The search for what the base model misses.

use super::{Observer, Problem};
use voronudge_infer::discover::{Discovery, Search, discover, discover_in_tracks};
use voronudge_infer::{Error, Keeper};
use voronudge_io::Snapshot;

/// The name of a cell that is no detection.
const NOT_TRACKED: i64 = -1;

impl Problem {
    /// A search for any effect of the catalogue after the fit that is asked for.
    pub fn search(&self) -> Search {
        Search {
            identities: self.identities(),
            determined: self.determined(),
            ..Search::new(self.request.clone())
        }
    }

    /// The tracks of the cells of each frame, where there are several frames.
    fn identities(&self) -> Option<Vec<Vec<i64>>> {
        let tracked = self.frames.len() > 1 && self.velocities.flow().is_none();
        let of_frame = |(index, snapshot): (usize, &Snapshot)| {
            let names = snapshot.cells.iter().map(|&cell| cell as i64).collect();
            self.of_cells(index, names, &NOT_TRACKED)
        };
        tracked.then(|| self.snapshots.iter().enumerate().map(of_frame).collect())
    }

    /// Effects of the catalogue that are determined with the measurement, and are no candidates.
    fn determined(&self) -> Vec<&'static str> {
        let share = self.known.share.is_none().then_some("centroid_bias");
        let declared = self.known.kind.is_some() && self.known.width.is_some();
        let width = (self.velocities.flow().is_some() && !declared).then_some("flow_blur");
        share.into_iter().chain(width).collect()
    }

    /// Fits the base model, finds what it leaves unexplained and adds the effects that explain it. `keeper` keeps what fits to synthetic
    /// data come to.
    ///
    /// # Errors
    /// Those of [`discover`] and [`discover_in_tracks`].
    pub fn discover(
        &self,
        search: &Search,
        keeper: &mut dyn Keeper,
        observe: Observer<'_>,
    ) -> Result<Discovery, Error> {
        match &self.tracks {
            Some(tracks) => discover_in_tracks(&tracks.movie, search, observe),
            None => discover(&self.observations, search, keeper, observe),
        }
    }
}
