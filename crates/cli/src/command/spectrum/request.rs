//! Which modes are asked for.

use crate::failure::Failure;
use clap::Args;
use voronudge_report::spectrum_report::SelectionRecord;
use voronudge_spectrum::{Character, Complex64, Request, Selection};

#[derive(Debug, Args)]
#[command(next_help_heading = "Modes")]
pub(super) struct SelectionArguments {
    /// Compute only this many modes, those with the largest growth rates; for any number of cells.
    #[arg(long, value_name = "COUNT", conflicts_with_all = ["near", "band"], allow_negative_numbers = true)]
    largest: Option<usize>,
    /// Compute only the modes whose eigenvalues are nearest to this point of the complex plane; see --count.
    #[arg(long, num_args = 2, value_names = ["RE", "IM"], conflicts_with = "band", allow_negative_numbers = true)]
    near: Option<Vec<f64>>,
    /// Compute only modes with an angular frequency in this band, those that decay or grow least; see --count.
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], allow_negative_numbers = true)]
    band: Option<Vec<f64>>,
    /// Number of modes that --near and --band compute [default: 8].
    #[arg(long, value_name = "COUNT", conflicts_with = "largest", allow_negative_numbers = true)]
    count: Option<usize>,
    /// Compute only the eigenvalues, in half the time and without maps of modes.
    #[arg(long)]
    values_only: bool,
    /// Largest number of cells for which all modes are computed.
    #[arg(long, value_name = "CELLS", default_value_t = 3000, allow_negative_numbers = true)]
    dense_limit: usize,
}

/// Modes looked at where nothing is said.
const COUNT: usize = 8;

impl SelectionArguments {
    pub fn resolve(&self) -> Result<ModeRequest, Failure> {
        let count = self.count.unwrap_or(COUNT);
        let selection = match (self.largest, self.near.as_deref(), self.band.as_deref()) {
            (Some(count), ..) => Selection::Largest(count),
            (_, Some(&[re, im]), _) => Selection::Near { shift: Complex64::new(re, im), count },
            (.., Some(&[low, high])) => Selection::Band { frequencies: [low, high], count },
            _ if self.count.is_some() => {
                return Err(Failure::new(
                    "--count says how many modes --near or --band look at, but neither is given",
                )
                .with_hint(
                    "give --near RE IM or --band LOW HIGH; --largest COUNT for those that grow fastest",
                ));
            }
            _ => Selection::All,
        };
        let character = match (self.values_only, selection) {
            (false, _) => Character::Full,
            (true, Selection::All) => Character::None,
            // A search finds vectors in any case.
            (true, _) => Character::Shape,
        };
        Ok(ModeRequest {
            request: Request { character, dense_limit: self.dense_limit, ..Request::new(selection) },
        })
    }
}

/// A checked request.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModeRequest {
    pub request: Request,
}

impl ModeRequest {
    pub fn has_vectors(&self) -> bool {
        self.request.character != Character::None
    }

    pub fn record(&self) -> SelectionRecord {
        match self.request.selection {
            Selection::All => SelectionRecord::All,
            Selection::Largest(count) => SelectionRecord::Largest { count },
            Selection::Near { shift, count } => SelectionRecord::Near { shift: [shift.re, shift.im], count },
            Selection::Band { frequencies, count } => SelectionRecord::Band { frequencies, count },
        }
    }
}
