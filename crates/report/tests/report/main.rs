//! Figures, pages and report files from synthetic data.

mod figures;
mod pages;
mod sample;
