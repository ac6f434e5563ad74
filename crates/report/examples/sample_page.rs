//! Writes samples from synthetic data: `sample_page DIR` makes `page.html` (about 400 cells, two
//! frames), `large.html` (1700 cells), `degenerate.html` (a few cells, unknown numbers), one page of
//! `discover` for each of three verdicts and `<figure>.svg` for the figures that stand by themselves.

#[path = "../tests/report/discover_sample.rs"]
mod discover_sample;
#[path = "../tests/report/figure_sample.rs"]
mod figure_sample;
#[path = "../tests/report/onward_sample.rs"]
mod onward_sample;
#[path = "../tests/report/parameters_sample.rs"]
mod parameters_sample;
#[path = "../tests/report/sample.rs"]
mod sample;

use voronudge_report::chart::AxisScale;
use voronudge_report::figure::{
    FlowMap, NudgeHistogram, VelocityField, bootstrap_histogram, flow_map, landscape, method_comparison,
    nudge_histogram, parameter_intervals, profile,
};
use voronudge_report::{DiscoverFigures, DiscoverPage, DiscoverReport, ReportError, Uncertainty, Units};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: sample_page DIR")?;
    std::fs::create_dir_all(&folder)?;
    let mut report = sample::report();
    report.bootstrap = sample::degenerate_report().bootstrap;
    let pages = [
        ("page.html", report.clone(), vec![sample::frame("frame 6", 20), sample::frame("frame 7", 20)]),
        ("large.html", report, vec![sample::frame("frame 0", 41)]),
        ("degenerate.html", sample::degenerate_report(), vec![sample::degenerate_frame()]),
    ];
    let slice = figure_sample::landscape();
    let uncertainty = Uncertainty {
        profiles: vec![figure_sample::profile()],
        bootstrap: vec![figure_sample::bootstrap()],
        landscapes: vec![[slice.clone(), slice]],
    };
    for (name, report, frames) in pages {
        let html = sample::page(&report, &frames, &uncertainty).render()?;
        println!("{name}: {} kB", html.len() / 1000);
        std::fs::write(format!("{folder}/{name}"), html)?;
    }
    for (name, html) in discover_pages()? {
        println!("{name}: {} kB", html.len() / 1000);
        std::fs::write(format!("{folder}/{name}"), html)?;
    }
    for (name, svg) in figures() {
        std::fs::write(format!("{folder}/{name}.svg"), svg)?;
    }
    Ok(())
}

fn discover_pages() -> Result<Vec<(&'static str, String)>, ReportError> {
    let frames = [discover_sample::frames("frame 6", 20), discover_sample::frames("frame 7", 20)];
    let [figures, none] = [discover_sample::figures(), DiscoverFigures::default()];
    let page = |report: &DiscoverReport, frames, figures| {
        DiscoverPage { title: "embryo <3>", report, frames, flows: &[], figures }.render()
    };
    Ok(vec![
        ("attributed.html", page(&discover_sample::attributed(), &frames, &figures)?),
        ("nothing-missing.html", page(&discover_sample::nothing_missing(), &frames[..1], &none)?),
        ("not-testable.html", page(&discover_sample::not_testable(), &[], &none)?),
    ])
}

fn figures() -> Vec<(&'static str, String)> {
    let units = Units { length: "um".into(), time: "min".into() };
    let frames = [sample::frame("frame 6", 16)];
    let flows = [figure_sample::flow(&frames[0])];
    let scale = FlowMap::scale(&flows);
    let flow = |field| flow_map(&flows[0], field, scale.as_ref(), &units);
    vec![
        ("landscape", landscape(&figure_sample::landscape())),
        ("profile", profile(&figure_sample::profile())),
        ("bootstrap", bootstrap_histogram(&figure_sample::bootstrap())),
        ("comparison", method_comparison(&figure_sample::comparison(AxisScale::Linear))),
        ("comparison-log", method_comparison(&figure_sample::comparison(AxisScale::Logarithmic))),
        ("flow-measured", flow(VelocityField::Measured)),
        ("flow-predicted", flow(VelocityField::Predicted)),
        ("flow-residual", flow(VelocityField::Residual)),
        ("intervals", parameter_intervals(&figure_sample::parameter_rows())),
        ("nudges", nudge_histogram(&NudgeHistogram::new(&frames, 11.0, 0.013))),
    ]
}
