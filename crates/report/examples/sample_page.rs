//! Writes sample pages from synthetic data: `sample_page DIR` makes `page.html` (about 400 cells,
//! two frames), `large.html` (1700 cells) and `degenerate.html` (a few cells, unknown numbers).

#[path = "../tests/report/sample.rs"]
mod sample;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: sample_page DIR")?;
    std::fs::create_dir_all(&folder)?;
    let report = sample::report();
    let pages = [
        ("page.html", report.clone(), vec![sample::frame("frame 6", 20), sample::frame("frame 7", 20)]),
        ("large.html", report, vec![sample::frame("frame 0", 41)]),
        ("degenerate.html", sample::degenerate_report(), vec![sample::degenerate_frame()]),
    ];
    for (name, report, frames) in pages {
        let html = sample::page(&report, &frames).render()?;
        println!("{name}: {} kB", html.len() / 1000);
        std::fs::write(format!("{folder}/{name}"), html)?;
    }
    Ok(())
}
