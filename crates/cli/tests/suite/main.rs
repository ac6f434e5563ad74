//! What the program promises to those who type or script its commands.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bad_arguments;
mod bad_arrays;
mod bad_discoveries;
mod bad_fits;
mod bad_folders;
mod bad_places;
mod browser;
mod channels;
mod configurations;
mod discoveries;
mod equations_of_state;
mod evaluations;
mod exports;
#[cfg(target_os = "linux")]
mod faults;
mod fields_of_view;
mod flow_imports;
mod flow_inferences;
mod forecasts;
mod gradient_checks;
mod import_formats;
mod import_images;
mod imports;
mod inferences;
mod information;
#[cfg(unix)]
mod interruption;
mod kinds;
mod layouts;
mod limits;
mod measured_sets;
mod measurements;
mod moduli;
mod movies;
mod observations;
mod phase_diagrams;
mod phase_diffusions;
mod program;
mod refusal;
mod reliability;
mod replicates;
mod resumption;
mod rheology;
mod scratch;
mod sensitivities;
mod shape_imports;
mod simulations;
mod spectra;
mod stdout;
mod surroundings;
mod uncertainties;
mod undeclared;
mod waves;
