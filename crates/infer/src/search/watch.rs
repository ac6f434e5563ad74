//! Progress told while a search is going on.

use crate::{Error, Progress};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Tasks at once between two reports of progress, whatever the number of threads.
pub(crate) const AT_ONCE: usize = 8;

/// Tells the caller of progress, and hears whether to stop.
pub(crate) struct Watch<'w> {
    pub observe: &'w mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
}

impl Watch<'_> {
    pub fn tell(&mut self, stage: &str, step: (u64, u64), objective: f64) -> Result<(), Error> {
        match (self.observe)(Progress { stage, step, objective }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Error::Interrupted),
        }
    }

    /// Independent tasks in parallel, told of by their number done.
    pub fn each<T: Sync, R: Send>(
        &mut self,
        stage: &str,
        tasks: &[T],
        objective: f64,
        task: impl Fn(&T) -> Result<R, Error> + Sync,
    ) -> Result<Vec<R>, Error> {
        let mut results = Vec::with_capacity(tasks.len());
        for chunk in tasks.chunks(AT_ONCE) {
            self.tell(stage, (results.len() as u64, tasks.len() as u64), objective)?;
            results.extend(chunk.par_iter().map(&task).collect::<Result<Vec<R>, Error>>()?);
        }
        Ok(results)
    }
}
