//! The checks that every change must pass.

mod layers;
pub mod pages;
mod tidy;

use crate::{Outcome, fields};
use clap::ValueEnum;
use std::path::Path;
use std::process::Command;

/// One of the checks, in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Check {
    /// Formatting.
    Fmt,
    /// Which crate may import which, against the manifests.
    Layers,
    /// Whitespace, length and names of files; sources of packages.
    Tidy,
    /// Links in pages, and the table of contents.
    Pages,
    /// Lints, where a warning is an error.
    Clippy,
    /// Lints of the library without the program.
    Library,
    /// All tests.
    Test,
    /// Tables of the fields of reports in pages, against the types; with the program as the tests built it.
    Fields,
    /// Documentation, where a warning is an error.
    Doc,
}

/// Runs the checks in `only`, or all if there are none.
pub fn run(root: &Path, only: &[Check]) -> Outcome {
    for check in Check::value_variants() {
        if only.is_empty() || only.contains(check) {
            let name =
                check.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
            eprintln!("check {name}");
            check.run(root).map_err(|failure| format!("check {name} failed\n{failure}"))?;
        }
    }
    eprintln!("all good");
    Ok(())
}

impl Check {
    fn run(self, root: &Path) -> Outcome {
        match self {
            Self::Fmt => cargo(root, "fmt --all --check", &[]),
            Self::Layers => report(&layers::violations(root)?),
            Self::Tidy => report(&tidy::violations(root)?),
            Self::Pages => report(&pages::violations(root)?),
            Self::Clippy => cargo(root, "clippy --workspace --all-targets --release -- -D warnings", &[]),
            Self::Library => cargo(
                root,
                "clippy --release --package voronudge --lib --no-default-features --features infer,io -- -D warnings",
                &[],
            ),
            Self::Test => cargo(root, "test --workspace --release", &[]),
            Self::Fields => report(&fields::violations(root)?),
            Self::Doc => {
                cargo(root, "doc --release --workspace --no-deps", &[("RUSTDOCFLAGS", "-D warnings")])
            }
        }
    }
}

fn cargo(root: &Path, arguments: &str, environment: &[(&str, &str)]) -> Outcome {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(program)
        .args(arguments.split(' '))
        .envs(environment.iter().copied())
        .current_dir(root)
        .status()?;
    if status.success() { Ok(()) } else { Err(format!("`cargo {arguments}` ended with {status}").into()) }
}

fn report(violations: &[String]) -> Outcome {
    if violations.is_empty() { Ok(()) } else { Err(violations.join("\n").into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_workspace_keeps_its_layers_and_is_tidy() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for check in [Check::Layers, Check::Tidy] {
            check.run(&root).unwrap();
        }
    }
}
