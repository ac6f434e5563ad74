//! `--dry-run`: what a command would read, compute and write.

use crate::arguments::Format;
use crate::command::phase_diagram::points;
use crate::command::replicates;
use crate::command_line::typed;
use crate::failure::Failure;
use crate::program::description;
use serde_json::json;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that commands write whatever their options are, beside `report.json`.
const WRITTEN: [(&str, &[&str]); 23] = [
    ("infer", &["report.html", "nudged_positions.npy", "predicted_velocities.npy"]),
    ("discover", &["report.html", "before_nudged_positions.npy", "after_nudged_positions.npy"]),
    ("evaluate", &["velocities.npy", "areas.npy", "perimeters.npy", "stress.npy"]),
    ("spectrum", &["report.html", "eigenvalues.npy"]),
    ("observe", &["report.html"]),
    ("simulate", &["report.html", "positions.npy", "velocities.npy", "dataset.toml"]),
    ("phase-diagram", &["report.html", "points.jsonl", "P_0.npy", "alpha.npy"]),
    ("merge", &["report.html"]),
    ("moduli", &["report.html"]),
    ("channel", &["report.html", "x.npy", "face.npy", "density.npy", "folded_profile.csv"]),
    ("equation-of-state", &["report.html", "density.npy", "pressure.npy", "torque.npy"]),
    ("estimate-chirality", &["report.html"]),
    ("check-gradients", &[]),
    ("import trackmate", &["positions.npy", "dataset.toml"]),
    ("import tracks", &["positions.npy", "dataset.toml"]),
    ("import points", &["positions.npy", "dataset.toml"]),
    ("import flow", &["flow.npy", "flow_x.npy", "flow_y.npy", "dataset.toml"]),
    ("import labels", &["report.html", "positions.npy", "position_errors.npy", "dataset.toml"]),
    ("import outlines", &["report.html", "positions.npy", "position_errors.npy", "dataset.toml"]),
    ("import field", &["report.html", "positions.npy", "heights.npy", "dataset.toml"]),
    ("phase-diffusion", &["report.html"]),
    ("rheology", &["report.html"]),
    ("waves", &["report.html", "dynamical_matrix.npy"]),
];

/// What is not known before the work is done.
const UNCHECKED: &str =
    "what shows in the course of the work; whether the disk has room; a run that --resume would go on with";

/// The end of the command that runs, which has read and checked these files.
pub(crate) fn end(inputs: &[PathBuf], out: Option<&Path>, format: Format) -> Failure {
    let (name, about) = command();
    let files = if out.is_some() { written(&name) } else { Vec::new() };
    let replaced: Vec<&str> =
        files.iter().copied().filter(|name| out.is_some_and(|out| out.join(name).exists())).collect();
    if format == Format::Json {
        let told = json!({
            "dry_run": true,
            "command": name,
            "command_line": typed().join(" "),
            "inputs": inputs,
            "computes": about,
            "out": out,
            "writes": files,
            "replaces": replaced,
            "not_checked": UNCHECKED,
        });
        return Failure::rehearsed(format!("{told:#}\n"));
    }
    let mut told = format!("dry run of voronudge {name}: nothing is computed or written\n");
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(told, "{name:<15}{text}");
    };
    match inputs {
        [] => line("would read", "no files"),
        _ => inputs.iter().for_each(|input| line("would read", &sized(input))),
    }
    line("would compute", &about);
    match out {
        None => line("would write", "nothing, without --out"),
        Some(out) => {
            let state = match (out.is_dir(), replaced.as_slice()) {
                (false, _) => "a new folder".to_owned(),
                (true, []) => "a folder that has none of these".to_owned(),
                (true, replaced) => format!("where it would replace {}", replaced.join(", ")),
            };
            let place = out.display();
            line(
                "would write",
                &format!("{} and what else belongs to it, to {place}, {state}", files.join(", ")),
            );
        }
    }
    line("not checked", UNCHECKED);
    Failure::rehearsed(told)
}

/// The files that a command writes whatever its options are; of a part of its work, the lines of that part.
fn written(name: &str) -> Vec<&'static str> {
    let is_part = typed().iter().any(|word| word == "--shard" || word.starts_with("--shard="));
    match (is_part, name) {
        (true, "phase-diagram") => vec!["report.json", points::FILE],
        (true, _) => vec![replicates::FILE],
        (false, name) => {
            let always = WRITTEN.iter().find(|(own, _)| *own == name).map_or(&[][..], |(_, files)| files);
            std::iter::once("report.json").chain(always.iter().copied()).collect()
        }
    }
}

/// The words of the command that was typed, and what it does.
fn command() -> (String, String) {
    let program = description();
    let (mut own, mut words) = (&program, Vec::new());
    for word in typed().iter().skip(1) {
        let Some(below) = own.find_subcommand(word) else { break };
        words.push(below.get_name());
        own = below;
    }
    let about = own.get_about().map(ToString::to_string).unwrap_or_default();
    (words.join(" "), about.trim_end_matches('.').to_owned())
}

/// A file with its size.
fn sized(path: &Path) -> String {
    let bytes = fs::metadata(path).ok().filter(fs::Metadata::is_file).map(|metadata| metadata.len());
    match bytes {
        Some(bytes) => format!("{}, {bytes} bytes, read and checked", path.display()),
        None => path.display().to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::WRITTEN;
    use crate::program::description;
    use clap::Command;

    /// The names of the commands that write results.
    fn writers(command: &Command, words: &str, found: &mut Vec<String>) {
        if command.get_arguments().any(|argument| argument.get_id() == "dry_run") {
            found.push(words.trim_start().to_owned());
        }
        for own in command.get_subcommands() {
            writers(own, &format!("{words} {}", own.get_name()), found);
        }
    }

    #[test]
    fn what_every_command_writes_is_told() {
        let mut found = Vec::new();
        writers(&description(), "", &mut found);
        let mut told: Vec<String> = WRITTEN.iter().map(|(name, _)| (*name).to_owned()).collect();
        found.sort();
        told.sort();
        assert_eq!(found, told);
    }
}
