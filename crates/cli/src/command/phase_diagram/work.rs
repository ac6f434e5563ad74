//! Runs on all threads, each on one, with a line in the journal for each that ended.

use super::point::{Record, Watch, cost, measure};
use super::request::{Job, Request};
use crate::failure::Failure;
use crate::progress::Progress;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;
use voronudge_io::Journal;

/// How often progress is shown.
const INTERVAL: Duration = Duration::from_millis(100);

/// Whether all runs were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ending {
    Finished,
    Interrupted,
}

/// Makes runs; what each came to is written to the journal at once and added to `records`.
pub(super) fn work(
    request: &Request,
    mut jobs: Vec<Job>,
    (journal, records): (&mut Journal, &mut Vec<Record>),
    progress: &mut Progress,
) -> Result<Ending, Failure> {
    // The longest first, so that no thread is left with one of them at the end.
    jobs.sort_by_key(|job| (std::cmp::Reverse(cost(request, job.point)), *job));
    let total: u64 = jobs.iter().map(|job| cost(request, job.point)).sum();
    let threads = rayon::current_num_threads().min(jobs.len());
    let (watch, next) = (Watch::default(), AtomicUsize::new(0));
    let (send, receive) = channel();
    let mut ending = Ending::Finished;
    let mut fault = None;
    thread::scope(|scope| {
        for _ in 0..threads {
            let send = send.clone();
            scope.spawn(|| one_thread(request, (&jobs, &next), &watch, send));
        }
        drop(send);
        loop {
            let message = match receive.recv_timeout(INTERVAL) {
                Ok(message) => message.map(Some),
                Err(RecvTimeoutError::Timeout) => Ok(None),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let written = message.and_then(|record| {
                let Some(record) = record else { return Ok(()) };
                journal.append(&serde_json::to_string(&record)?)?;
                records.push(record);
                Ok(())
            });
            if let Err(failure) = written {
                watch.stop.store(true, Ordering::Relaxed);
                fault.get_or_insert(failure);
            }
            let done = watch.steps.load(Ordering::Relaxed).min(total);
            if progress.step("phase-diagram, steps", done, total).is_break() {
                watch.stop.store(true, Ordering::Relaxed);
                ending = Ending::Interrupted;
            }
        }
    });
    progress.finish();
    match fault {
        Some(failure) => Err(failure),
        None => Ok(ending),
    }
}

/// Takes one run after another. Whatever is parallel within a run stays on this thread.
fn one_thread(
    request: &Request,
    (jobs, next): (&[Job], &AtomicUsize),
    watch: &Watch,
    send: Sender<Result<Record, Failure>>,
) {
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool,
        Err(error) => {
            let _ = send.send(Err(Failure::new(format!("cannot start a thread: {error}"))));
            return;
        }
    };
    while let Some(&job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
        // Nobody listens any more only if the program is about to end.
        let sent = pool.install(|| measure(request, job, watch)).map(|record| send.send(Ok(record)));
        if sent.is_none() || watch.stop.load(Ordering::Relaxed) {
            return;
        }
    }
}
