//! Following cells that have places alone.

use crate::run::Run;
use clap::ValueEnum;
use voronudge_io::PlaceLinking;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Link {
    /// None: each frame has its own cells.
    None,
    /// The nearest point or extremum of the same kind in the next frame.
    Nearest,
}

impl Link {
    pub(super) fn linking(self, limit: Option<f64>) -> PlaceLinking {
        match self {
            Self::None => PlaceLinking::Separate,
            Self::Nearest => PlaceLinking::Nearest { limit },
        }
    }
}

/// Warns of cells that begin anew, and of films in which nothing moves.
pub(super) fn warn_of_breaks(run: &mut Run, link: Link, counts: &[usize], linked: usize, what: &str) {
    let expected: usize = counts.iter().skip(1).sum();
    if link == Link::Nearest && linked < expected {
        run.warn(format!(
            "{} of {expected} {what} after the first frame continue none of the frame before; each begins a cell of its own",
            expected - linked
        ));
    }
}
