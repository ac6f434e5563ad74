//! Figures, pages and report files from synthetic data.

mod figure_sample;
mod figures;
mod inference_figures;
mod pages;
mod sample;
