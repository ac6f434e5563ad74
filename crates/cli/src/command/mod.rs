//! The commands: arguments as typed, a checked request, one library call, and its result rendered.

pub(crate) mod channel;
pub(crate) mod check_gradients;
pub(crate) mod completions;
pub(crate) mod discover;
mod drawing;
pub(crate) mod equation_of_state;
pub(crate) mod estimate_chirality;
pub(crate) mod evaluate;
mod fit;
pub(crate) mod import;
pub(crate) mod infer;
pub(crate) mod info;
pub(crate) mod man;
pub(crate) mod merge;
pub(crate) mod moduli;
pub(crate) mod observe;
pub(crate) mod phase_diagram;
pub(crate) mod phase_diffusion;
mod recorded;
pub(crate) mod replicates;
pub(crate) mod rheology;
pub(crate) mod schema;
pub(crate) mod simulate;
pub(crate) mod spectrum;
pub(crate) mod waves;
