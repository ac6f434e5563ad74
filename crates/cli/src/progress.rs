//! Progress with time left on stderr, and Ctrl-C.

use crate::arguments::Verbosity;
use crate::failure::Failure;
use crate::terminal::note;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use voronudge_io::OutputFolder;

/// How long a command works in silence.
const PATIENCE: Duration = Duration::from_secs(1);

/// Time between lines where there is no terminal, at first and at most, and by what factor it grows.
const FIRST_GAP: Duration = Duration::from_secs(5);
const LONGEST_GAP: Duration = Duration::from_secs(60);
const GROWTH: f64 = 1.5;

/// Whether the user wants the command to stop, and whether the command looks at that.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static LISTENING: AtomicBool = AtomicBool::new(false);

/// Takes over Ctrl-C and SIGTERM for the whole command. One that does not look whether it is to stop ends at once, and so does any at the
/// second time, without anything left behind.
pub(crate) fn heed_signals() {
    // A second handler in one process is refused, which leaves the first in force: nothing is lost.
    let _ = ctrlc::set_handler(|| {
        let again = INTERRUPTED.swap(true, Ordering::SeqCst);
        if (again || !LISTENING.load(Ordering::SeqCst)) && OutputFolder::abandon_all() {
            note(&format!("error: {}", Failure::interrupted().message()));
            std::process::exit(130);
        }
    });
}

/// Shows how far a command has come once it takes longer than a second, and knows whether the user wants it to stop. Where there is no terminal
/// to draw a bar on, it says so in lines, ever more rarely.
pub(crate) struct Progress {
    /// Where there is no terminal, it counts but is not drawn.
    bar: Option<ProgressBar>,
    lines: Option<Lines>,
    begun: Instant,
    verbosity: Verbosity,
}

impl Progress {
    /// From now on the command looks whether it is to stop at each step, and ends there, cleanly.
    pub fn new(verbosity: Verbosity) -> Self {
        LISTENING.store(true, Ordering::SeqCst);
        let lines = (!std::io::stderr().is_terminal()).then(Lines::new);
        Self { bar: None, lines, begun: Instant::now(), verbosity }
    }

    /// Reports a step out of a total; tells whether to go on.
    pub fn step(&mut self, stage: &str, done: u64, total: u64) -> ControlFlow<()> {
        let elapsed = self.begun.elapsed();
        if self.verbosity == Verbosity::Normal && self.bar.is_none() && elapsed > PATIENCE {
            let bar = ProgressBar::new(total).with_elapsed(elapsed);
            let style =
                ProgressStyle::with_template("{msg:24} {bar:30} {pos}/{len}  {elapsed} elapsed{left}");
            if let Ok(style) = style {
                bar.set_style(style.with_key("left", time_left));
            }
            self.bar = Some(bar);
        }
        if let Some(bar) = &self.bar {
            // The time left is that of a stage; one that begins again is timed anew.
            if bar.message() != stage || done < bar.position() {
                bar.set_message(stage.to_owned());
                bar.set_position(done);
                bar.reset_eta();
            }
            bar.set_length(total);
            bar.set_position(done);
            if self.lines.as_mut().is_some_and(|lines| lines.are_due(elapsed)) {
                note(&line(stage, [done, total], elapsed, bar.eta()));
            }
        }
        if INTERRUPTED.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Ends a command that the user wants to stop, where nothing is left but to write.
    pub fn heed(&self) -> Result<(), Failure> {
        if INTERRUPTED.load(Ordering::SeqCst) { Err(Failure::interrupted()) } else { Ok(()) }
    }

    /// Reports how far a fit has come; tells whether to go on.
    pub fn tell(&mut self, state: voronudge_infer::Progress<'_>) -> ControlFlow<()> {
        self.step(state.stage, state.step.0, state.step.1)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Looks at a measurement that several threads make, each of which asks whether to go on.
pub(crate) struct Looks<'a> {
    progress: &'a Mutex<Progress>,
    stage: &'a str,
    done: AtomicU64,
    /// How many there are about, at most.
    most: u64,
}

impl<'a> Looks<'a> {
    pub fn new(progress: &'a Mutex<Progress>, stage: &'a str, most: u64) -> Self {
        Self { progress, stage, done: AtomicU64::new(0), most }
    }

    /// Counts a look and shows the progress; a thread that cannot show it goes on.
    pub fn look(&self) -> ControlFlow<()> {
        let done = self.done.fetch_add(1, Ordering::Relaxed).min(self.most);
        let shown = self.progress.try_lock();
        shown.map_or(ControlFlow::Continue(()), |mut shown| shown.step(self.stage, done, self.most))
    }
}

/// When the next line is due.
#[derive(Debug)]
struct Lines {
    next: Duration,
    gap: Duration,
}

impl Lines {
    fn new() -> Self {
        Self { next: FIRST_GAP, gap: FIRST_GAP }
    }

    /// Whether one is due so long after the beginning; then the next is due later.
    fn are_due(&mut self, elapsed: Duration) -> bool {
        if elapsed < self.next {
            return false;
        }
        self.gap = self.gap.mul_f64(GROWTH).min(LONGEST_GAP);
        self.next = elapsed + self.gap;
        true
    }
}

/// How far a command has come, in a line.
fn line(stage: &str, [done, total]: [u64; 2], elapsed: Duration, left: Duration) -> String {
    let mut line = format!("{stage} {done}/{total}, {:#} elapsed", HumanDuration(elapsed));
    if !left.is_zero() {
        let _ = write!(line, ", {:#} left", HumanDuration(left));
    }
    line
}

/// The time left, once a step has been seen.
fn time_left(state: &ProgressState, text: &mut dyn Write) {
    let left = state.eta();
    if !left.is_zero() {
        let _ = write!(text, ", {:#} left", HumanDuration(left));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_ever_rarer() {
        let mut lines = Lines::new();
        let due: Vec<u64> = (0..400).filter(|second| lines.are_due(Duration::from_secs(*second))).collect();
        assert_eq!(due[..5], [5, 13, 25, 42, 68]);
        assert!(due.windows(2).skip(6).all(|pair| pair[1] - pair[0] == 60), "{due:?}");
    }

    #[test]
    fn a_line_tells_stage_and_time() {
        let [elapsed, left] = [42, 130].map(Duration::from_secs);
        assert_eq!(line("tracks", [3, 8], elapsed, left), "tracks 3/8, 42s elapsed, 2m left");
        assert_eq!(line("tracks", [0, 8], elapsed, Duration::ZERO), "tracks 0/8, 42s elapsed");
    }
}
