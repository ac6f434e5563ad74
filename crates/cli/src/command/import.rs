//! `voronudge import`: tables of other programs into data sets.

use crate::Answer;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::run::Run;
use clap::{Args, Subcommand};
use serde::Serialize;
use std::path::PathBuf;
use voronudge_io::{
    Boundary, ColumnNames, Import, ImportOptions, OutputDirectory, YAxis, import_trackmate, import_tracks,
};
use voronudge_report::infer_report::RunRecord;

/// Turns tracks of other programs into a data set.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// TrackMate's spots table (.csv or .csv.gz).
    Trackmate(TableArguments),
    /// Any table with a row for each cell and frame (.csv or .csv.gz): track, frame, x, y.
    Tracks(TableArguments),
}

#[derive(Debug, Args)]
struct TableArguments {
    /// The table.
    file: PathBuf,
    /// Length of a pixel: coordinates are multiplied by it.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pixel_size: Option<f64>,
    /// Time between frames.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    frame_interval: Option<f64>,
    /// Unit of length after scaling.
    #[arg(long, value_name = "UNIT")]
    length_unit: Option<String>,
    /// Unit of time.
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<String>,
    /// Direction of y in the table [default: down, as in images].
    #[arg(long, value_name = "up|down")]
    y_axis: Option<YAxis>,
    /// Periodic box (default: an open field of view).
    #[arg(long = "box", num_args = 2, value_names = ["LX", "LY"], allow_negative_numbers = true)]
    box_lengths: Option<Vec<f64>>,
    /// Name of the column with the track's number.
    #[arg(long, value_name = "NAME")]
    track_column: Option<String>,
    /// Name of the column with the frame's number.
    #[arg(long, value_name = "NAME")]
    frame_column: Option<String>,
    /// Name of the column with x.
    #[arg(long, value_name = "NAME")]
    x_column: Option<String>,
    /// Name of the column with y.
    #[arg(long, value_name = "NAME")]
    y_column: Option<String>,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    run: RunRecord,
    frames: usize,
    first_frame: i64,
    empty_frames: usize,
    tracks: usize,
    spots: usize,
    left_out_untracked: usize,
    left_out_duplicate: usize,
    track_ids: Vec<i64>,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let (table, read): (_, fn(&std::path::Path, &ImportOptions) -> _) = match arguments.what {
        What::Trackmate(table) => (table, import_trackmate),
        What::Tracks(table) => (table, import_tracks),
    };
    let mut run = Run::begin("import", &table.common)?;
    let mut out = OutputDirectory::create(table.common.required_out()?)?;
    let options = ImportOptions {
        columns: ColumnNames {
            track: table.track_column,
            frame: table.frame_column,
            x: table.x_column,
            y: table.y_column,
        },
        pixel_size: table.pixel_size,
        length_unit: table.length_unit,
        time_unit: table.time_unit,
        frame_interval: table.frame_interval,
        y_axis: table.y_axis,
        boundary: table.box_lengths.map(|l| Boundary::Periodic { lengths: [l[0], l[1]] }),
    };
    let Import { dataset, track_ids, summary } = read(&table.file, &options)?;
    if summary.left_out_duplicate > 0 {
        run.warn(format!(
            "{} spots share track and frame with another (a split track); the first of each was kept",
            summary.left_out_duplicate
        ));
    }
    dataset.save(&mut out)?;
    let report = Report {
        run: run.record(Some(&dataset)),
        frames: summary.frames,
        first_frame: summary.first_frame,
        empty_frames: summary.empty_frames,
        tracks: summary.tracks,
        spots: summary.spots,
        left_out_untracked: summary.left_out_untracked,
        left_out_duplicate: summary.left_out_duplicate,
        track_ids,
    };
    let json = serde_json::to_string_pretty(&report)?;
    out.write_text("report.json", &json)?;
    let text = format!(
        "{} spots of {} tracks in {} frames ({} without a track left out)\nwritten to {}\n",
        report.spots,
        report.tracks,
        report.frames,
        report.left_out_untracked,
        out.path().display()
    );
    run.finish(Some(out), &json, &text)?;
    Ok(Answer::Positive)
}
