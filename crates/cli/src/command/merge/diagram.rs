//! The parts of a phase diagram put together.

use super::{Arguments, check, read, refuse_incomplete, refuse_other};
use crate::arguments::{CommonArguments, Shard};
use crate::command::phase_diagram::finish;
use crate::command::phase_diagram::points::{FILE, Header, Points};
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use std::collections::BTreeSet;
use std::path::Path;
use voronudge_report::PhaseReport;

/// What was asked for, of parts of a diagram.
pub(super) struct Diagram(pub Arguments);

impl Reporting for Diagram {
    const NAME: &'static str = "merge";
    type Report = PhaseReport;

    fn common(&self) -> &CommonArguments {
        &self.0.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<PhaseReport>, Failure> {
        let Self(arguments) = self;
        let scaling = arguments.scaling.resolve()?;
        let parsed = |folder: &Path| Points::parse(read(folder, FILE)?.lines(), folder.join(FILE).display());
        let parts: Vec<(&Path, Points)> = (arguments.parts.iter())
            .map(|folder| Ok((folder.as_path(), parsed(folder)?)))
            .collect::<Result<_, Failure>>()?;
        let points = merged(parts)?;
        run.seed_is(points.header.request.seed);
        let results = arguments.common.output(&arguments.parts)?;
        finish(run, &points, &scaling, results)
    }
}

/// All runs in order, if the parts belong together and none is missing or there twice.
fn merged(mut parts: Vec<(&Path, Points)>) -> Result<Points, Failure> {
    let shards: Vec<_> = parts.iter().map(|(folder, points)| (*folder, points.header.shard)).collect();
    if let Some((first_folder, first)) = parts.first() {
        for (folder, points) in &parts {
            let same = Header { shard: first.header.shard, ..points.header.clone() };
            if let Some(name) = first.header.difference(&same)? {
                return Err(refuse_other(first_folder, folder, &name));
            }
        }
    }
    check(&shards)?;
    for (folder, points) in &parts {
        let shard = points.header.shard;
        let made: BTreeSet<_> = points.records.iter().map(|record| (record.point, record.replica)).collect();
        let asked = points.header.request.jobs(shard);
        if made.len() != points.records.len()
            || made.len() != asked.len()
            || !asked.iter().all(|job| made.contains(&(job.point, job.replica)))
        {
            return Err(refuse_incomplete(folder, shard, [points.records.len(), asked.len()]));
        }
    }
    let mut whole = parts.swap_remove(0).1;
    whole.header.shard = Shard::WHOLE;
    whole.records.extend(parts.into_iter().flat_map(|(_, points)| points.records));
    whole.sort();
    Ok(whole)
}
