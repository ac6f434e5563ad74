//! Pages in a browser, where there is one: nothing is wider than its window, no label lies on another, words stand out, no script fails, movies play.

use std::path::Path;
use std::process::Command;

/// Loads pages in frames of some widths and as on paper and uses them; what is wrong is put into the element `faults`.
const HARNESS: &str = include_str!("browser.js");
/// Catches what fails in a page.
const WATCH: &str = "<head><script>window.faults = []; addEventListener(\"error\", (event) => faults.push(event.message));</script>";

/// The names under which Chromium may be installed.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Light and dark, and the widths of windows: dark pages differ in their colours alone.
const SCHEMES: [(&str, &[u32]); 2] = [
    ("--blink-settings=preferredColorScheme=1", &[400, 800, 1400]),
    ("--blink-settings=preferredColorScheme=0", &[1400]),
];

/// Looks at pages, each of a name and its text; the areas of cells in their movies have this unit, a pattern.
pub fn assert_sound<N: AsRef<str>>(pages: &[(N, String)], area: &str) -> std::io::Result<()> {
    let runs =
        |name: &&&str| Command::new(name).arg("--version").output().is_ok_and(|own| own.status.success());
    let Some(browser) = BROWSERS.iter().find(runs) else {
        eprintln!("skipped: there is no Chromium");
        return Ok(());
    };
    let folder = tempfile::tempdir()?;
    for (name, html) in pages {
        std::fs::write(folder.path().join(name.as_ref()), html.replacen("<head>", WATCH, 1))?;
    }
    let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_ref()).collect();
    let harness = folder.path().join("harness.html");
    for (scheme, widths) in SCHEMES {
        let script = HARNESS
            .replace("PAGES", &format!("{names:?}"))
            .replace("WIDTHS", &format!("{widths:?}"))
            .replace("AREA", area);
        std::fs::write(&harness, format!("<!DOCTYPE html><body><script>{script}</script></body>"))?;
        let found = found(browser, &harness, scheme, &folder.path().join("profile"))?;
        // Paper is one more.
        let windows = (widths.len() + 1) * pages.len();
        assert_eq!(found, format!("{windows} windows, none with a fault"), "{scheme}");
    }
    Ok(())
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
