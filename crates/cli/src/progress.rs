//! Progress with time left on stderr, and Ctrl-C.

use crate::arguments::Verbosity;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a command works in silence.
const PATIENCE: Duration = Duration::from_secs(1);

/// Shows how far a command has come once it takes longer than a second, and knows whether the user wants it to stop.
pub(crate) struct Progress {
    bar: ProgressBar,
    begun: Instant,
    interrupted: Arc<AtomicBool>,
    verbosity: Verbosity,
}

impl Progress {
    /// Takes over Ctrl-C: from now on the command ends at its next step, cleanly.
    pub fn new(verbosity: Verbosity) -> Self {
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        // A second handler in one process is refused, which leaves the first in force: nothing is lost.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
        });
        Self { bar: ProgressBar::hidden(), begun: Instant::now(), interrupted, verbosity }
    }

    /// Reports a step out of a total; tells whether to go on.
    pub fn step(&mut self, stage: &str, done: u64, total: u64) -> ControlFlow<()> {
        if self.verbosity == Verbosity::Normal && self.bar.is_hidden() && self.begun.elapsed() > PATIENCE {
            self.bar = ProgressBar::new(total).with_elapsed(self.begun.elapsed());
            let style =
                ProgressStyle::with_template("{msg:24} {bar:30} {pos}/{len}  {elapsed} elapsed{left}");
            if let Ok(style) = style {
                self.bar.set_style(style.with_key("left", time_left));
            }
        }
        // The time left is that of a stage; one that begins again is timed anew.
        if self.bar.message() != stage || done < self.bar.position() {
            self.bar.set_message(stage.to_owned());
            self.bar.set_position(done);
            self.bar.reset_eta();
        }
        self.bar.set_length(total);
        self.bar.set_position(done);
        if self.interrupted.load(Ordering::SeqCst) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Reports how far a fit has come; tells whether to go on.
    pub fn tell(&mut self, state: voronudge_infer::Progress<'_>) -> ControlFlow<()> {
        self.step(state.stage, state.step.0, state.step.1)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// The time left, once a step has been seen.
fn time_left(state: &ProgressState, text: &mut dyn Write) {
    let left = state.eta();
    if !left.is_zero() {
        let _ = write!(text, ", {:#} left", HumanDuration(left));
    }
}
