//! Profiles across a channel, averaged over time and its length.

mod estimate;
mod profile;
mod recorder;

pub use estimate::Estimate;
pub use profile::ChannelProfile;
pub use recorder::ChannelRecorder;
