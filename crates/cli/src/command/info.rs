//! `voronudge info`: what is in a data set or a file, and which command reads it.

use crate::command::import::records;
use crate::failure::Failure;
use crate::reporting::{Answer, Command, Described};
use crate::terminal::legible;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;
use voronudge_io::{Boundary, InputKind, Inspection, NoteKind, inspect};
use voronudge_report::numbers::significant;
use voronudge_report::schema_of;
use voronudge_report::shape_report::NoteRecord;

/// Reports what is in a data set or in a file of another program: shape, units, frames, cells, and what was guessed.
///
/// Nothing is written.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A data set, a file of any kind that `import` reads, or a folder of images.
    path: PathBuf,
    /// Print JSON instead of lines of text.
    #[arg(long)]
    json: bool,
}

/// What `--json` prints; what does not apply is `null` or empty.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Record {
    /// Path as given.
    path: String,
    /// What the path is taken for, in words.
    kind: String,
    /// Shape of an array, or frames, rows and columns of images; `null` for other files.
    shape: Option<Vec<usize>>,
    /// Number of frames; `null` where it is not known.
    frames: Option<usize>,
    /// Number of cells, which is the length of the axis of cells or the number of different labels; `null` where it is not known.
    cells: Option<usize>,
    /// Number of cells that are present in each frame.
    present: Vec<usize>,
    /// Smallest x, smallest y, largest x and largest y of the cells, in units of the data; `null` where they are not known.
    extent: Option<[f64; 4]>,
    /// Side of a pixel, in units of length; `null` where it is not known.
    pixel_size: Option<f64>,
    /// Unit of length; `null` where it is not known.
    length_unit: Option<String>,
    /// Time between frames, in units of time; `null` where it is not known.
    frame_interval: Option<f64>,
    /// Unit of time; `null` where it is not known.
    time_unit: Option<String>,
    /// Direction in which y grows, `up` or `down`; `null` where it is not known.
    y_axis: Option<String>,
    /// Sides of the box of a periodic data set; `null` for all others.
    #[serde(rename = "box")]
    cell_box: Option<[f64; 2]>,
    /// Files that were read.
    files: Vec<String>,
    /// What was read from the files, what was guessed, and what is doubtful.
    notes: Vec<NoteRecord>,
    /// Command line that reads it.
    command: String,
    /// Words of this command before the path.
    arguments: Vec<&'static str>,
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        let found = inspect(&self.path)?;
        let path = self.path.display().to_string();
        Answer::printed(&match self.json {
            true => format!("{}\n", serde_json::to_string_pretty(&record(path, &found))?),
            false => legible(&text(&path, &found)),
        })
    }

    fn described() -> Vec<Described> {
        vec![("info", schema_of::<Record>)]
    }
}

fn record(path: String, found: &Inspection) -> Record {
    Record {
        command: next(&path, found),
        arguments: words(found),
        path,
        kind: found.kind.to_string(),
        shape: found.shape.clone(),
        frames: found.frames,
        cells: found.cells,
        present: found.present.clone(),
        extent: found.extent,
        pixel_size: found.pixel_size,
        length_unit: found.length_unit.clone(),
        frame_interval: found.frame_interval,
        time_unit: found.time_unit.clone(),
        y_axis: found.y_axis.map(|axis| axis.to_string()),
        cell_box: match found.boundary {
            Some(Boundary::Periodic { lengths }) => Some(lengths),
            _ => None,
        },
        files: found.files.iter().map(|file| file.display().to_string()).collect(),
        notes: records(&found.notes),
    }
}

/// The command that reads it, in words: cells of several label images are followed by their overlap.
fn words(found: &Inspection) -> Vec<&'static str> {
    let follows = found.kind == InputKind::Labels && found.frames.is_some_and(|frames| frames > 1);
    let link: &[&str] = if follows { &["--link", "overlap"] } else { &[] };
    found.kind.command().split(' ').chain(link.iter().copied()).collect()
}

fn next(path: &str, found: &Inspection) -> String {
    format!("voronudge {} {path} --out DIR", words(found).join(" "))
}

fn text(path: &str, found: &Inspection) -> String {
    let mut text = format!("{path}: {}\n", found.kind);
    let mut line = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            let _ = writeln!(text, "  {name:<11} {value}");
        }
    };
    let unit = found.length_unit.as_deref().unwrap_or_default();
    let list = |lengths: &[usize]| lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
    line("files", (found.files.len() > 1).then(|| found.files.len().to_string()));
    line("shape", found.shape.as_deref().map(list));
    line("frames", found.frames.map(|frames| frames.to_string()));
    let range = found.present.iter().min().zip(found.present.iter().max());
    line(
        "cells",
        match (found.cells, range) {
            (Some(cells), Some((low, high))) if low == high => Some(format!("{cells}, {low} in each frame")),
            (Some(cells), Some((low, high))) => Some(format!("{cells}, {low} to {high} in a frame")),
            (None, Some((low, high))) if low == high => Some(format!("{low} in each frame")),
            (None, Some((low, high))) => Some(format!("{low} to {high} in a frame")),
            (cells, None) => cells.map(|cells| cells.to_string()),
        },
    );
    line("pixels", found.pixel_size.map(|size| format!("{size} {unit}")));
    line(
        "extent",
        found.extent.map(|corners| {
            let [x0, y0, x1, y1] = corners.map(|length| significant(length, 4));
            format!("x {x0} to {x1}, y {y0} to {y1} {unit}")
        }),
    );
    line(
        "surrounding",
        found.boundary.map(|boundary| match boundary {
            Boundary::Periodic { lengths: [x, y] } => format!("a periodic box of {x} × {y} {unit}"),
            Boundary::Open => "an open field of view".into(),
        }),
    );
    line("y", found.y_axis.map(|axis| axis.to_string()));
    let many = found.frames.is_some_and(|frames| frames > 1);
    let interval = found.frame_interval.filter(|_| many);
    line(
        "interval",
        interval.map(|step| format!("{step} {}", found.time_unit.as_deref().unwrap_or_default())),
    );
    for kind in [NoteKind::Read, NoteKind::Guessed, NoteKind::Doubtful] {
        let of = found.notes.iter().filter(|note| note.kind == kind);
        let texts: Vec<&str> = of.map(|note| note.text.as_str()).collect();
        if !texts.is_empty() {
            let _ = writeln!(text, "{kind}: {}", texts.join("; "));
        }
    }
    let _ = writeln!(text, "next: {}", next(path, found));
    text
}
