//! What the commands share that fit the model to snapshots.
//!
//! | file | what |
//! |---|---|
//! | `arguments`, `constraints`, `flow`, `search` | options: which data, what is known of the parameters, velocities on a grid, how long to search |
//! | `measured`, `measurement`, `prepare`, `scaling` | from the data set to the problem in scaled units, and back |
//! | `tracks` | tracks as a movie, and what came of them |
//! | `outcome`, `implied`, `prospects`, `words` | a fitted model as reports tell it |
//! | `arrays`, `views`, `browser` | arrays, frames to be drawn, the page on the screen |

mod arguments;
pub(crate) mod arrays;
pub(crate) mod browser;
mod constraints;
mod flow;
pub(crate) mod implied;
pub(crate) mod latent;
mod measured;
pub(crate) mod measurement;
pub(crate) mod outcome;
mod prepare;
pub(crate) mod prospects;
pub(crate) mod scaling;
mod search;
pub(crate) mod spreads;
mod tracks;
pub(crate) mod views;
pub(crate) mod words;

pub(crate) use arguments::{MeanToRemove, SnapshotArguments, check_largest_area};
pub(crate) use constraints::{ConstraintArguments, quantity};
pub(crate) use flow::{OrderedField, scaled as scaled_flow};
pub(crate) use measured::Measured;
pub(crate) use prepare::{Prepared, Question, observe, remove_median};
pub(crate) use search::SearchArguments;
pub(crate) use tracks::PreparedTracks;
