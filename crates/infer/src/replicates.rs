//! Fits to synthetic data: independent of each other, so that they can be made in any order, at any time and in different places.

use crate::discover::Observer;
use crate::search::{AT_ONCE, Watch};
use crate::{Error, Inference};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

/// How long to wait for a fit before the caller is asked again whether to go on.
const PATIENCE: Duration = Duration::from_millis(50);

/// What a keeper has to say of one of the fits.
#[derive(Debug, Clone, PartialEq)]
pub enum Known {
    /// It was made; the numbers it came to, or `None` if it failed.
    Made(Option<Vec<f64>>),
    /// It is to be made.
    Missing,
    /// It is made somewhere else.
    Elsewhere,
}

/// Keeps what fits to synthetic data came to, so that they need not be made again, and shares them among machines.
///
/// Every set of synthetic data is made from the seed of the request and its own number, so it does not matter when or where it is fitted.
pub trait Keeper {
    /// So many fits begin to data that this one could have made. The caller may stop.
    fn begin(&mut self, made_from: &Inference, count: usize) -> ControlFlow<()>;

    /// What is known of one of the fits that began last, numbered from zero.
    fn known(&self, index: usize) -> Known;

    /// One of them was made. The caller may stop.
    fn keep(&mut self, index: usize, outcome: Option<&[f64]>) -> ControlFlow<()>;
}

/// Keeps nothing: all fits are made here and now.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unkept;

impl Keeper for Unkept {
    fn begin(&mut self, _: &Inference, _: usize) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn known(&self, _: usize) -> Known {
        Known::Missing
    }

    fn keep(&mut self, _: usize, _: Option<&[f64]>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// So many fits to data that one fit could have made.
pub(crate) struct Series<'a> {
    pub stage: &'a str,
    pub count: usize,
    pub made_from: &'a Inference,
}

/// The numbers of a fit; `None` if it failed.
type Outcome<const N: usize> = Option<[f64; N]>;

impl Series<'_> {
    /// Makes the fits that are not known, in parallel; `None` for those that fail.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if the caller stops, or some of the fits are made elsewhere: then all others are made and kept.
    pub fn make<const N: usize>(
        &self,
        fit: impl Fn(usize, Observer<'_>) -> Result<[f64; N], Error> + Sync,
        keeper: &mut dyn Keeper,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Outcome<N>>, Error> {
        if self.count == 0 {
            return Ok(Vec::new());
        }
        if keeper.begin(self.made_from, self.count).is_break() {
            return Err(Error::Interrupted);
        }
        let mut outcomes: Vec<Option<Outcome<N>>> = vec![None; self.count];
        let mut missing = Vec::new();
        let mut elsewhere = 0;
        for (index, outcome) in outcomes.iter_mut().enumerate() {
            match keeper.known(index) {
                Known::Made(None) => *outcome = Some(None),
                Known::Made(Some(values)) => match values.try_into() {
                    Ok(values) => *outcome = Some(Some(values)),
                    Err(_) => missing.push(index),
                },
                Known::Missing => missing.push(index),
                Known::Elsewhere => elsewhere += 1,
            }
        }
        let total = self.count - elsewhere;
        let done = total - missing.len();
        let mut heard = |index: Option<usize>, outcome: Option<Outcome<N>>, made: usize| {
            if let (Some(index), Some(outcome)) = (index, outcome) {
                outcomes[index] = Some(outcome);
                if keeper.keep(index, outcome.as_ref().map(<[f64; N]>::as_slice)).is_break() {
                    return ControlFlow::Break(());
                }
            }
            let step = ((done + made) as u64, total as u64);
            match watch.tell(self.stage, step, 1.0) {
                Ok(()) => ControlFlow::Continue(()),
                Err(_) => ControlFlow::Break(()),
            }
        };
        if in_parallel(&missing, &fit, &mut heard).is_break() {
            return Err(Error::Interrupted);
        }
        outcomes.into_iter().collect::<Option<_>>().ok_or(Error::Interrupted)
    }
}

/// A fit that has ended, or did not come to its end.
type Ended<const N: usize> = (usize, Option<Outcome<N>>);

/// Fits in parallel, a few at once, with the caller told of each that ends, and now and then, with how many have. It may stop, and then those
/// under way are given up.
fn in_parallel<const N: usize>(
    missing: &[usize],
    fit: &(impl Fn(usize, Observer<'_>) -> Result<[f64; N], Error> + Sync),
    heard: &mut dyn FnMut(Option<usize>, Option<Outcome<N>>, usize) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let stop = AtomicBool::new(false);
    let mut waiting = missing.iter().copied();
    let mut going_on = heard(None, None, 0);
    rayon::in_place_scope(|scope| {
        let (send, receive) = channel::<Ended<N>>();
        let (mut under_way, mut made) = (0, 0);
        loop {
            while under_way < AT_ONCE && going_on.is_continue() {
                let Some(index) = waiting.next() else { break };
                let (stop, message) = (&stop, Message { index, outcome: None, to: send.clone() });
                scope.spawn(move |_| message.after(|| outcome(index, fit, stop)));
                under_way += 1;
            }
            if under_way == 0 {
                return;
            }
            let (mut index, mut outcome) = (None, None);
            if let Some(ended) = next(&receive) {
                under_way -= 1;
                made += usize::from(ended.1.is_some());
                (index, outcome) = (Some(ended.0), ended.1);
            }
            if heard(index, outcome, made).is_break() {
                going_on = ControlFlow::Break(());
                stop.store(true, Ordering::Relaxed);
            }
        }
    });
    going_on
}

/// What a fit comes to; `None` if it was stopped.
fn outcome<const N: usize>(
    index: usize,
    fit: &impl Fn(usize, Observer<'_>) -> Result<[f64; N], Error>,
    stop: &AtomicBool,
) -> Option<Outcome<N>> {
    let mut observe = |_: crate::Progress<'_>| match stop.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    if stop.load(Ordering::Relaxed) {
        return None;
    }
    match fit(index, &mut observe) {
        Ok(values) => Some(Some(values)),
        Err(Error::Interrupted) => None,
        Err(_) => Some(None),
    }
}

/// Sent when it is dropped, so that nobody waits for a fit that came to a bad end.
struct Message<const N: usize> {
    index: usize,
    outcome: Option<Outcome<N>>,
    to: Sender<Ended<N>>,
}

impl<const N: usize> Message<N> {
    fn after(mut self, fit: impl FnOnce() -> Option<Outcome<N>>) {
        self.outcome = fit();
    }
}

impl<const N: usize> Drop for Message<N> {
    fn drop(&mut self) {
        // Nobody listens any more only if the scope has ended.
        let _ = self.to.send((self.index, self.outcome));
    }
}

/// The next message, if one comes soon. On a thread that is needed for the work itself this does some of it.
fn next<T>(receive: &Receiver<T>) -> Option<T> {
    match rayon::yield_now() {
        Some(rayon::Yield::Executed) => receive.try_recv().ok(),
        Some(rayon::Yield::Idle) | None => receive.recv_timeout(PATIENCE).ok(),
    }
}
