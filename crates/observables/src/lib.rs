//! What is measured on tissues, simulated or seen under a microscope.
//!
//! Measurements of one state are functions of positions and tessellation. A [`Recording`] is cells followed over frames, in a periodic box or an open field of
//! view, with gaps in their tracks, and [`observe`] measures all that can be measured on one, with standard errors. A simulated movie in
//! which the same cells are seen as in a measured one is measured by the same [`Plan`], so that the two can be compared point by point. [`nematic`] asks of the shapes of
//! cells as a nematic: order and half-integer defects, and what cells do around these; [`exchanges`] of T1 transitions one by one, [`avalanches()`] of those that come together; [`fluctuations()`] by which matrix waves relax.

mod avalanches;
mod block_average;
mod contacts;
mod curve;
mod displacement;
mod error;
mod exchanges;
mod fluctuations;
mod hexatic;
mod motion;
mod nematic;
mod observe;
mod pairs;
mod plan;
mod quantity;
mod rate_matrix;
mod recording;
mod shape;
mod spectra;
mod structure_factor;
mod tapers;
mod transitions;
mod velocity;
mod vorticity;
mod wave_shells;
mod window;

pub use avalanches::{Avalanche, Avalanches, avalanches, drops};
pub use block_average::BlockAverage;
pub use curve::Curve;
pub use displacement::mean_square_displacement;
pub use error::Error;
pub use exchanges::{Exchange, exchange_statistics, exchanges};
pub use fluctuations::{
    DynamicStructure, FluctuationRequest, Fluctuations, LongWaves, Relaxation, ShellFluctuations,
    StructurePart, Tell, WaveField, fluctuations, relaxation_of_waves, together,
};
pub use hexatic::{Hexatic, hexatic, hexatic_among};
pub use nematic::{
    Around, Defect, Nematic, SQUARES, Stresses, around_defects, defects_of_shapes, largest_width, nematic,
};
pub use observe::{correlations, observe};
pub use plan::Plan;
pub use quantity::{Dimensions, Quantity};
pub use rate_matrix::RateMatrix;
pub use recording::{Frame, Images, Recording};
pub use shape::shape_indices;
pub use structure_factor::{StructureFactor, structure_factor};
pub use transitions::TransitionCounter;
pub use velocity::mean_square_velocity;
pub use vorticity::vorticities;
