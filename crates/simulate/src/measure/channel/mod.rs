//! Profiles across a channel, averaged over time and its length.

mod estimate;
mod profile;
mod recorder;
mod shapes;

pub use estimate::Estimate;
pub use profile::ChannelProfile;
pub use recorder::ChannelRecorder;
pub use shapes::{ShapeRecorder, ShapesByAge};
