//! The computation in a thread of its own, so that progress is shown and Ctrl-C obeyed meanwhile.

use crate::failure::Failure;
use crate::progress::Progress;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};
use voronudge_spectrum::{Character, Error, LinearProblem, Modes, Request, Selection, modes};

/// How often progress is shown.
const INTERVAL: Duration = Duration::from_millis(100);

enum Message {
    Step(&'static str, usize, usize),
    Done(Box<Result<Modes, Error>>),
}

/// Computes modes. An interrupted computation is left behind; it ends with the program.
pub(super) fn compute(
    problem: &Arc<LinearProblem>,
    request: Request,
    progress: &mut Progress,
) -> Result<Modes, Failure> {
    let (send, receive) = channel();
    let own = Arc::clone(problem);
    thread::spawn(move || {
        let steps = send.clone();
        let found = modes(&own, &request, &mut |stage, step, total| {
            // Nobody listens any more after an interruption.
            let _ = steps.send(Message::Step(stage, step, total));
        });
        let _ = send.send(Message::Done(Box::new(found)));
    });
    let begun = Instant::now();
    let estimate = expected_seconds(problem.cells().len(), &request);
    let mut at = ("modes", 0, 1);
    loop {
        match receive.recv_timeout(INTERVAL) {
            Ok(Message::Step(stage, step, total)) => at = (stage, step, total),
            Ok(Message::Done(found)) => return (*found).map_err(Failure::from),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::new("the search for modes ended without a result")
                    .with_hint("there may be too little memory; ask for fewer modes by --largest"));
            }
        }
        let (stage, step, total) = at;
        // One call of the library computes all modes, so its progress is an estimate from its time.
        let (step, total) = match estimate {
            Some(seconds) => ((99.0 * begun.elapsed().as_secs_f64() / seconds).min(99.0) as u64, 100),
            None => (step as u64, total as u64),
        };
        if progress.step(stage, step, total).is_break() {
            return Err(Failure::interrupted());
        }
    }
}

/// About how long all modes take: nanoseconds times the cube of the order, as measured on one core.
fn expected_seconds(cells: usize, request: &Request) -> Option<f64> {
    let factor = match request.character {
        Character::None => 0.4e-9,
        Character::Shape => 0.6e-9,
        Character::Full => 0.7e-9,
    };
    (request.selection == Selection::All).then(|| factor * (2.0 * cells as f64).powi(3))
}
