//! The parts of a search or of a bootstrap put together: their command line is followed to its end with all fits that they made.

use super::{Arguments, HINT, check, read, refuse_incomplete, refuse_other};
use crate::arguments::{CommonArguments, Shard};
use crate::command::replicates::{Agreement, FILE, Made, Parts, ReplicateArguments};
use crate::failure::Failure;
use crate::program::{self, AnyCommand};
use crate::reporting::{Answer, Command};
use std::path::Path;

pub(super) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let parsed = |folder: &Path| Made::parse(read(folder, FILE)?.lines(), folder.join(FILE).display());
    let parts: Vec<(&Path, Made)> = (arguments.parts.iter())
        .map(|folder| Ok((folder.as_path(), parsed(folder)?)))
        .collect::<Result<_, Failure>>()?;
    let made = merged(parts)?;
    let line = made.header.command_line.clone();
    let typed = program::parse(line.words())?;
    // Where an interrupted merge has made fits itself, it goes on.
    let replicates = ReplicateArguments { resume: true, shard: None, parts: Some(Parts { line, made }) };
    let common = |own: CommonArguments| arguments.common.with_seed(own.seed);
    match typed {
        AnyCommand::Discover(own) => own.merged(common, replicates).run(),
        AnyCommand::Infer(own) => own.merged(common, replicates).run(),
        _ => Err(Failure::new("the parts are of no command that is shared among machines").with_hint(HINT)),
    }
}

/// All fits, if the parts belong together and none is missing or there twice.
fn merged(mut parts: Vec<(&Path, Made)>) -> Result<Made, Failure> {
    let shards: Vec<_> = parts.iter().map(|(folder, made)| (*folder, made.header.shard)).collect();
    if let Some((first_folder, first)) = parts.first() {
        for (folder, made) in &parts {
            if let Some(name) = first.header.difference(&made.header) {
                return Err(refuse_other(first_folder, folder, &name));
            }
            let series = first.series.iter().zip(&made.series);
            let same = |(one, other)| Agreement::of(one, other) != Agreement::None;
            if first.series.len() != made.series.len() || !series.into_iter().all(same) {
                return Err(refuse_other(first_folder, folder, "fit"));
            }
        }
    }
    check(&shards)?;
    for (folder, made) in &parts {
        let shard = made.header.shard;
        for series in &made.series {
            let asked = (0..series.count).filter(|index| shard.has(*index));
            if !series.outcomes.keys().copied().eq(asked.clone()) {
                return Err(refuse_incomplete(folder, shard, [series.outcomes.len(), asked.count()]));
            }
        }
    }
    let mut whole = parts.swap_remove(0).1;
    whole.header.shard = Shard::WHOLE;
    parts.into_iter().for_each(|(_, made)| whole.add(made.series));
    Ok(whole)
}
