//! Figures, pages and report files from synthetic data.

mod browser;
mod chromium;
mod discover_figures;
mod discover_pages;
mod discover_sample;
mod figure_sample;
mod figures;
mod inference_figures;
mod movies;
mod onward_sample;
mod pages;
mod parameters_sample;
mod phase_figures;
mod sample;
mod spectrum_figures;
