//! Space-time nudging: the model fitted to cells followed from frame to frame, without velocities.
//!
//! ```text
//! minimise over β, x:   Σ ‖y_f − x_f‖² / σ_r²  +  Σ ‖x_{f+1} − x_f − ∫F_β(x) dt‖² / σ_d²
//! ```
//!
//! Positions x of the cells at the frames are unknowns. What moves a cell from one frame to the next is the integral of the model's
//! velocities along its way, so that no velocity is ever derived from positions. The problem has the form of the nudged fit of snapshots and is solved by the same means.

mod alignment;
mod anchors;
mod begun;
mod beside;
mod block;
mod course;
mod drive;
mod driven;
mod ends;
mod first;
mod fit;
mod fitted_movie;
mod held;
mod held_out;
mod hint;
mod inference;
mod instants;
mod integrated;
mod join;
mod jump;
mod laid;
mod lasting;
mod likely;
mod linearised;
mod look;
mod measurement;
mod memory;
mod missed;
mod motions;
mod movie;
mod neighbours;
mod objective;
mod observations;
mod obstacles;
mod outset;
mod own_motion;
mod part;
mod passage;
mod place;
mod placed;
mod polarities;
mod polarity;
mod present;
mod prospects;
mod pushes;
mod result;
mod ridge;
mod row_builder;
mod rule;
#[cfg(test)]
pub(crate) mod sample;
mod scatter;
mod seen_motions;
mod settling;
mod stages;
mod states;
mod surface;
mod surroundings;
mod tangent;
#[cfg(test)]
mod tests;
mod turn;
mod unseen;
mod value;

pub(crate) use alignment::weighted;
pub(crate) use beside::Beside;
pub use driven::Drive;
pub(crate) use driven::HintsOfDrives;
pub use inference::infer_tracks;
pub(crate) use inference::{Followed, follow};
pub use jump::Jump;
pub use measurement::measure_tracks;
pub(crate) use memory::Memory;
pub use missed::{Latent, complete_tracks};
pub use movie::{Drift, Movie, Sighting, Track};
pub use polarity::{Alignment, Polarity};
pub(crate) use present::{Dynamics, Present};
pub use result::{Integration, Tracked};
pub(crate) use scatter::Scatter;
