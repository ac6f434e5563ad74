//! Pages in a browser, where there is one: nothing is wider than the window, no script fails, and movies play.

use crate::{discover_sample, movies, sample};
use std::error::Error;
use std::path::Path;
use std::process::Command;
use voronudge_report::page::Figure;
use voronudge_report::{DiscoverFigures, DiscoverPage, FrameView, InferPage, SimulatePage, Uncertainty};

/// Loads pages in frames of three widths and uses them; what is wrong is put into the element `faults`.
const HARNESS: &str = include_str!("browser.js");
/// Catches what fails in a page.
const WATCH: &str = "<head><script>window.faults = []; addEventListener(\"error\", (event) => faults.push(event.message));</script>";

/// The names under which Chromium may be installed.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Light and dark, and the widths of windows.
const SCHEMES: [(&str, &[u32]); 2] = [
    ("--blink-settings=preferredColorScheme=1", &[400, 800, 1400]),
    ("--blink-settings=preferredColorScheme=0", &[400]),
];

#[test]
fn pages_fit_their_window_and_movies_play() {
    let runs =
        |name: &&&str| Command::new(name).arg("--version").output().is_ok_and(|own| own.status.success());
    let Some(browser) = BROWSERS.iter().find(runs) else {
        eprintln!("skipped: there is no Chromium");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let pages = pages().unwrap();
    for (name, html) in &pages {
        std::fs::write(folder.path().join(name), html.replacen("<head>", WATCH, 1)).unwrap();
    }
    let names: Vec<&str> = pages.iter().map(|(name, _)| *name).collect();
    let harness = folder.path().join("harness.html");
    for (scheme, widths) in SCHEMES {
        let script =
            HARNESS.replace("PAGES", &format!("{names:?}")).replace("WIDTHS", &format!("{widths:?}"));
        std::fs::write(&harness, format!("<!DOCTYPE html><body><script>{script}</script></body>")).unwrap();
        let found = found(browser, &harness, scheme, &folder.path().join("profile")).unwrap();
        assert_eq!(found, format!("{} windows, none with a fault", widths.len() * pages.len()), "{scheme}");
    }
}

/// What the harness says in the end.
fn found(browser: &str, harness: &Path, scheme: &str, profile: &Path) -> std::io::Result<String> {
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--disable-background-networking",
        ])
        .args(["--allow-file-access-from-files", "--virtual-time-budget=60000", "--dump-dom", scheme])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", harness.display()))
        .output()?;
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = dom.split_once("<pre id=\"faults\">").and_then(|(_, after)| after.split_once("</pre>"));
    Ok(told.map_or_else(|| format!("no answer: {dom}"), |(told, _)| told.to_owned()))
}

/// Pages of all kinds: a movie of a fit, one frame, unknown numbers, a search, a simulation.
fn pages() -> Result<Vec<(&'static str, String)>, Box<dyn Error>> {
    let uncertainty = Uncertainty::default();
    let (report, bad) = (sample::report(), sample::degenerate_report());
    let (frames, degenerate) = (movies::frames(2, 10), [sample::degenerate_frame()]);
    let (movie, single) = (movies::movie(5, 10)?, movies::movie(1, 10)?);
    let infer = sample::page(&report, &frames, &uncertainty);
    let doubtful: &[FrameView] = &degenerate;
    let before_after = [discover_sample::frames("frame 6", 10)];
    let search = discover_sample::attributed();
    let mut after = movies::frames(5, 10);
    let cells = after.iter_mut().flat_map(|frame| &mut frame.cells);
    cells.for_each(|cell| cell.predicted = cell.predicted.map(|[x, y]| [0.9 * x, y + 0.1]));
    let movie_of_both = movies::movie(5, 10)?.with_residuals(["residual before", "residual after"], after);
    let figures = DiscoverFigures { movie: Some(movie_of_both), ..discover_sample::figures() };
    let discover = DiscoverPage {
        title: "embryo",
        report: &search,
        frames: &before_after,
        flows: &[],
        figures: &figures,
    };
    let figure = Figure::new(movie.still(), "Cells.");
    let simulate = SimulatePage {
        title: "100 cells",
        headline: "The cells move at 2.75 ℓ₀ K_P.",
        summary: &[],
        cards: &[],
        configuration: &figure,
        movie: Some(&movie),
        course: std::slice::from_ref(&figure),
        structure: std::slice::from_ref(&figure),
        run: &report.run,
    };
    Ok(vec![
        ("infer.html", InferPage { movie: Some(&movie), ..infer }.render()?),
        ("one-frame.html", InferPage { movie: Some(&single), ..infer }.render()?),
        ("degenerate.html", sample::page(&bad, doubtful, &uncertainty).render()?),
        ("discover.html", discover.render()?),
        ("simulate.html", simulate.render()?),
    ])
}
