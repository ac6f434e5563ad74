//! `voronudge merge`: the parts of a phase diagram put together.

use super::phase_diagram::points::{FILE, Header, Points};
use super::phase_diagram::request::Shard;
use super::phase_diagram::{ScalingArguments, finish};
use crate::Answer;
use crate::arguments::CommonArguments;
use crate::failure::Failure;
use crate::run::Run;
use clap::Args;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use voronudge_io::{Journal, OutputDirectory};

/// Puts together the parts of a phase diagram that were made with --shard.
///
/// The result is that of `phase-diagram` without --shard, byte for byte, apart from the record of the run in report.json.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Output folders of all parts, in any order.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    #[command(flatten)]
    scaling: ScalingArguments,
    #[command(flatten)]
    common: CommonArguments,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("merge", &arguments.common)?;
    let out = arguments.common.required_out()?;
    let scaling = arguments.scaling.resolve()?;
    let parts: Vec<(&PathBuf, Points)> =
        arguments.parts.iter().map(|folder| Ok((folder, read(folder)?))).collect::<Result<_, Failure>>()?;
    let points = merged(parts)?;
    run.seed_is(points.header.request.seed);
    let mut results = OutputDirectory::create(out)?;
    let (json, summary) = finish(&mut run, &points, &scaling, &mut results)?;
    run.finish(Some(results), &json, &summary)?;
    Ok(Answer::Positive)
}

fn read(folder: &Path) -> Result<Points, Failure> {
    let path = folder.join(FILE);
    let text = std::fs::read_to_string(&path).map_err(|error| {
        let failure = Failure::new(format!("{}: {error}", path.display()));
        match Journal::find(folder) {
            Ok(Some(_)) => failure.with_hint("this part was interrupted: finish it with --resume"),
            _ => failure.with_hint("give the output folders of phase-diagram --shard"),
        }
    })?;
    Points::parse(text.lines(), path.display())
}

/// All runs in order, if the parts belong together and none is missing or there twice.
fn merged(parts: Vec<(&PathBuf, Points)>) -> Result<Points, Failure> {
    const HINT: &str = "merge the parts 1/n to n/n of one diagram, each once";
    let Some((first_folder, first)) = parts.first() else {
        return Err(Failure::new("no parts are given").with_hint(HINT));
    };
    let (request, of) = (first.header.request.clone(), first.header.shard.of);
    let mut found: Vec<Option<&PathBuf>> = vec![None; of];
    for (folder, points) in &parts {
        let same = Header { shard: first.header.shard, ..points.header.clone() };
        if let Some(name) = first.header.difference(&same)? {
            return Err(Failure::new(format!(
                "{} and {} are parts of different diagrams: they have another \"{name}\"",
                first_folder.display(),
                folder.display()
            ))
            .with_hint(HINT));
        }
        let shard = points.header.shard;
        if shard.of != of {
            return Err(Failure::new(format!(
                "{} is part {} of {}, but {} is one of {of}",
                folder.display(),
                shard.part,
                shard.of,
                first_folder.display()
            ))
            .with_hint(HINT));
        }
        if let Some(other) = found[shard.part - 1].replace(folder) {
            return Err(Failure::new(format!(
                "{} and {} are both part {} of {of}",
                other.display(),
                folder.display(),
                shard.part
            ))
            .with_hint(HINT));
        }
        let made: BTreeSet<_> = points.records.iter().map(|record| (record.point, record.replica)).collect();
        let asked = request.jobs(shard);
        if made.len() != points.records.len()
            || made.len() != asked.len()
            || !asked.iter().all(|job| made.contains(&(job.point, job.replica)))
        {
            return Err(Failure::new(format!(
                "{} has {} runs, but part {} of {of} has {} others",
                folder.display(),
                points.records.len(),
                shard.part,
                asked.len()
            ))
            .with_hint("make this part again"));
        }
    }
    if let Some(missing) = found.iter().position(Option::is_none) {
        return Err(Failure::new(format!("part {} of {of} is missing", missing + 1)).with_hint(HINT));
    }
    let records = parts.into_iter().flat_map(|(_, points)| points.records).collect();
    let mut points = Points { header: Header { request, shard: Shard::WHOLE }, records };
    points.sort();
    Ok(points)
}
