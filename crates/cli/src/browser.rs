//! The page on the screen.

use std::process::Stdio;
use std::time::Duration;

/// Time in which an opener shows whether it works.
const OPENING: Duration = Duration::from_millis(700);

/// Shows a page in the user's browser, where there is one.
pub(crate) fn open(page: &std::path::Path) {
    let opener = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let started = std::process::Command::new(opener)
        .arg(page)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    // An opener that fails does so at once; one that stays is the browser itself.
    let failed = started.map_or(true, |mut child| {
        std::thread::sleep(OPENING);
        matches!(child.try_wait(), Ok(Some(status)) if !status.success())
    });
    if failed {
        crate::terminal::note(&format!("no browser could be started; open {} yourself", page.display()));
    }
}
