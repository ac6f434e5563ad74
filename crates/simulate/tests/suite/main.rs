//! The simulator against limits known on paper, other ways to the same numbers, and itself.
#![allow(clippy::unwrap_used)]

mod collapse;
mod driving;
mod heterogeneity;
mod integration;
mod measures;
mod moduli;
mod phases;
mod placement;
mod sensitivity;
mod spatial_order;
mod turnover;
mod uniform;
mod walls;
