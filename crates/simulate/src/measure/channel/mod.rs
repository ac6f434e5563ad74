//! Profiles across a channel, averaged over time and its length.

mod decay;
mod estimate;
mod profile;
mod recorder;

pub use decay::{DecayFit, DecayPoint, DecayShape, fit_decay};
pub use estimate::Estimate;
pub use profile::ChannelProfile;
pub use recorder::ChannelRecorder;
