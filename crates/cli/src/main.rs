//! `voronudge`: which forces move these cells, and what does the model of them miss?

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(voronudge::program::run(std::env::args_os()))
}
