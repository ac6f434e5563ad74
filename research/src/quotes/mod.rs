//! The numbers that pages quote, beside what the program says now: consoles are run and compared line by line, and what else stands in
//! `docs/quotes.toml` number by number.

mod compare;
mod expression;
mod found;
mod list;
mod number;
mod page;
mod scratch;
mod tally;

use crate::Outcome;
use list::List;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use tally::{Tally, Work};
use xtask::pages::Pages;

/// Letters of a job that are shown in the course of the work.
const WIDTH: usize = 120;
/// Jobs at once.
const AT_ONCE: usize = 2;

#[derive(clap::Args)]
pub struct Arguments {
    /// Only pages whose path contains one of these.
    #[arg(long, value_name = "PAGE", num_args = 1..)]
    only: Vec<String>,
    /// Processor time after which a console, or the commands of a quote, are stopped and left out.
    #[arg(long, default_value_t = 60.0, value_name = "SECONDS")]
    limit: f64,
    /// Folder with the files that readers of the guide bring, under the names they have there.
    #[arg(long, value_name = "DIR")]
    brought: Option<PathBuf>,
    /// Says what would be run.
    #[arg(long)]
    list: bool,
}

/// What is run in one folder.
enum Job<'a> {
    /// The consoles of a page.
    Consoles(&'a Path),
    /// Commands of the list.
    Run(&'a list::Run),
}

pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    let (pages, list) = (Pages::read(root)?, List::read(root)?);
    let faults = list.faults(&pages);
    if !faults.is_empty() {
        return Err(format!("{}\n{}", list::PATH, faults.join("\n")).into());
    }
    let is_asked = |page: &Path| {
        arguments.only.is_empty()
            || arguments.only.iter().any(|part| page.display().to_string().contains(part))
    };
    let jobs = jobs(&pages, &list, &is_asked);
    if arguments.list {
        jobs.iter().for_each(|job| println!("{}", job.told(&pages)));
        return Ok(());
    }
    let work = Work {
        root,
        pages: &pages,
        list: &list,
        limit: arguments.limit,
        brought: arguments.brought.as_deref(),
        is_asked: &is_asked,
    };
    let tally = made(&jobs, &work);
    tally.tell();
    if tally.off.is_empty() { Ok(()) } else { Err(format!("{} quotes are off", tally.off.len()).into()) }
}

/// The jobs of the pages that are asked for.
fn jobs<'a>(pages: &'a Pages, list: &'a List, is_asked: &dyn Fn(&Path) -> bool) -> Vec<Job<'a>> {
    let has_console = |text: &str| page::blocks(text).iter().any(|block| block.kind == "console");
    let consoles = (pages.texts.iter())
        .filter(|(page, text)| is_asked(page) && has_console(text))
        .map(|(page, _)| Job::Consoles(page));
    let runs = list.run.iter().filter(|run| run.pages().any(is_asked)).map(Job::Run);
    consoles.chain(runs).collect()
}

impl Job<'_> {
    /// What is run, a line for each command.
    fn told(&self, pages: &Pages) -> String {
        match self {
            Self::Consoles(page) => {
                let blocks = page::blocks(list::text_of(pages, page));
                let typed = blocks.iter().flat_map(page::Block::typed);
                let lines =
                    typed.map(|typed| format!("{}:{}: {}", page.display(), typed.line, typed.command));
                lines.collect::<Vec<_>>().join("\n")
            }
            Self::Run(run) => format!("{}: {}", run.page.display(), run.told()),
        }
    }

    fn make(&self, work: &Work<'_>) -> Tally {
        let (made, what) = match self {
            Self::Consoles(page) => (work.consoles(page), page.display().to_string()),
            Self::Run(run) => (work.run(run), run.told()),
        };
        made.unwrap_or_else(|error| Tally { off: vec![format!("{what}: {error}")], ..Tally::default() })
    }
}

/// All jobs, some at once; what came of them in their order.
fn made(jobs: &[Job<'_>], work: &Work<'_>) -> Tally {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
    let serve = || {
        while let Some((place, job)) =
            { Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| jobs.get(k).map(|job| (k, job))) }
        {
            let tally = job.make(work);
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            let told = job.told(work.pages);
            let first: String = told.lines().next().unwrap_or_default().chars().take(WIDTH).collect();
            eprintln!(
                "{}/{}  {:5.1} s  {} off  {first}",
                done.len() + 1,
                jobs.len(),
                tally.seconds,
                tally.off.len()
            );
            done.insert(place, tally);
        }
    };
    std::thread::scope(|scope| (0..AT_ONCE).for_each(|_| drop(scope.spawn(serve))));
    let mut all = Tally::default();
    done.into_inner().unwrap_or_else(PoisonError::into_inner).into_values().for_each(|tally| all.add(tally));
    all
}
