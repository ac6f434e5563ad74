//! What the commands share that fit the model to snapshots.
//!
//! | file | what |
//! |---|---|
//! | `arguments`, `constraints`, `flow`, `search` | options: which data, what is known of the parameters, velocities on a grid, how long to search |
//! | `measured`, `prepare` | from options to the problem, and faults of the data |
//! | `latent`, `measurement`, `tracks`, `spreads`, `units` | what was found out, in the units of the data |
//! | `outcome`, `implied`, `prospects`, `words` | a fitted model as reports tell it |
//! | `arrays`, `export`, `views` | arrays, cells for other programs, frames to be drawn |

mod arguments;
pub(crate) mod arrays;
mod constraints;
pub(crate) mod export;
pub(crate) mod flow;
pub(crate) mod implied;
pub(crate) mod latent;
pub(crate) mod measured;
pub(crate) mod measurement;
pub(crate) mod outcome;
mod prepare;
pub(crate) mod prospects;
mod search;
pub(crate) mod spreads;
pub(crate) mod tracks;
pub(crate) mod units;
pub(crate) mod views;
pub(crate) mod words;

pub(crate) use arguments::{MeanToRemove, SnapshotArguments, Stated, check_largest_area};
pub(crate) use constraints::{ConstraintArguments, quantity};
pub(crate) use prepare::{Inquiry, place_of_data, with_location};
pub(crate) use search::SearchArguments;
