//! The figures of the paper that can be computed, made anew: `cargo xtask figures NAME`.
//!
//! Each figure says what the paper states and what came out here. `docs/gallery.md` is written from the record of the
//! runs, `docs/figures/gallery/record.json`.

mod command;
mod decays;
mod flows;
mod landscapes;
mod moduli;
mod mosaics;
mod page;
mod phases;
mod pinching;
mod rheology;
mod slices;
mod structure;

use crate::Outcome;
use clap::Args;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREEN, VERMILLION};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves, row_colours,
};
use voronudge_report::markers::Marker;

/// What to make.
#[derive(Args)]
pub struct Arguments {
    /// Names of figures; all of them if none is given.
    names: Vec<String>,
    /// Small systems and short runs: to see that it works, not to be shown.
    #[arg(long)]
    quick: bool,
    /// Folder for pictures and their record, in place of those of the gallery, which then stays as it is.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Lists the names.
    #[arg(long)]
    list: bool,
}

/// Which settings a figure is made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Seconds.
    Quick,
    /// Those of the gallery: minutes.
    Full,
}

impl Size {
    /// One of two settings.
    fn pick<T>(self, quick: T, full: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// A figure of the paper.
#[derive(Clone, Copy)]
struct Figure {
    /// Name on the command line: the paper's number, small letters.
    name: &'static str,
    /// What it shows.
    title: &'static str,
    /// What the paper states about it.
    stated: &'static str,
    make: fn(Size) -> Result<Made, Box<dyn std::error::Error>>,
}

/// A figure made.
struct Made {
    /// The settings, in words.
    settings: String,
    /// What came out, a sentence each.
    found: Vec<String>,
    panels: Vec<Panel>,
}

/// One picture.
struct Panel {
    /// What tells it from the other panels, in file names; empty if there is one only.
    name: &'static str,
    caption: String,
    svg: String,
}

/// All figures, in the order of the paper.
fn all() -> Vec<Figure> {
    [
        landscapes::FIGURES,
        slices::FIGURES,
        phases::FIGURES,
        mosaics::FIGURES,
        moduli::FIGURES,
        rheology::FIGURES,
        flows::FIGURES,
        pinching::FIGURES,
        structure::FIGURES,
    ]
    .concat()
}

/// What a series is drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drawn {
    /// Marks with error bars.
    Marks,
    /// The same, joined by a line.
    JoinedMarks,
    /// A broken line: what a theory says.
    BrokenLine,
}

/// Values against one variable.
struct Series {
    /// Name in the key; none if it is empty.
    name: String,
    drawn: Drawn,
    points: Vec<ErrorPoint>,
}

/// Series on common axes. Series of marks, and broken lines, have colours by their place; the first of both share one.
fn chart(title: &str, labels: [&str; 2], scales: [AxisScale; 2], series: &[Series]) -> String {
    let is_line = |series: &Series| series.drawn == Drawn::BrokenLine;
    let colours = |lines: bool| {
        let count = series.iter().filter(|series| is_line(series) == lines).count();
        if count <= 3 { [BLUE, VERMILLION, GREEN].map(String::from).to_vec() } else { row_colours(count) }
    };
    let palettes = [colours(false), colours(true)];
    let mut places = [0; 2];
    let coloured: Vec<(&Series, &str)> = (series.iter())
        .map(|series| {
            let kind = usize::from(is_line(series));
            places[kind] += 1;
            (series, palettes[kind][places[kind] - 1].as_str())
        })
        .collect();
    let markers = [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond];
    let points: Vec<PointSeries<'_>> = (coloured.iter().filter(|(series, _)| !is_line(series)).enumerate())
        .map(|(place, (series, colour))| PointSeries {
            label: &series.name,
            colour,
            marker: markers[place % 4],
            points: series.points.clone(),
        })
        .collect();
    let curves: Vec<CurveSeries<'_>> = (coloured.iter().filter(|(series, _)| series.drawn != Drawn::Marks))
        .map(|(series, colour)| CurveSeries {
            label: if is_line(series) { &series.name } else { "" },
            colour,
            stroke: if is_line(series) { Stroke::Dashed } else { Stroke::Solid },
            points: series.points.iter().map(|point| point.at).collect(),
        })
        .collect();
    points_and_curves(&PointsAndCurves { title, labels, scales, series: &points, curves: &curves })
}

/// What is kept of a run: everything but the pictures.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
struct Entry {
    settings: String,
    found: Vec<String>,
    /// File and caption.
    panels: Vec<[String; 2]>,
}

/// Even axes.
const EVEN: [AxisScale; 2] = [AxisScale::Linear; 2];

/// Entries by the name of the figure.
type Record = BTreeMap<String, Entry>;

/// Where pictures and the record stand, from the root.
pub(crate) const FOLDER: &str = "docs/figures/gallery";

pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    let figures = all();
    if arguments.list {
        figures.iter().for_each(|figure| println!("{:12} {}", figure.name, figure.title));
        return Ok(());
    }
    let unknown = arguments.names.iter().find(|name| figures.iter().all(|figure| figure.name != **name));
    if let Some(name) = unknown {
        return Err(format!("there is no figure {name}; `cargo xtask figures --list` lists them").into());
    }
    let gallery = root.join(FOLDER);
    let folder = match &arguments.out {
        Some(out) => out.clone(),
        None if arguments.quick => root.join("target/figures"),
        None => gallery.clone(),
    };
    std::fs::create_dir_all(&folder)?;
    let asked =
        |figure: &&Figure| arguments.names.is_empty() || arguments.names.iter().any(|n| n == figure.name);
    let size = if arguments.quick { Size::Quick } else { Size::Full };
    for figure in figures.iter().filter(asked) {
        let begun = Instant::now();
        let made = (figure.make)(size)?;
        let entry = keep(figure, made, &folder)?;
        println!("## {}, {} ({:.0} s)", figure.name, figure.title, begun.elapsed().as_secs_f64());
        println!("stated: {}\nsettings: {}", figure.stated, entry.settings);
        entry.found.iter().for_each(|found| println!("found: {found}"));
        entry.panels.iter().for_each(|[file, _]| println!("{}", folder.join(file).display()));
        if size == Size::Full {
            let mut record = record(&folder)?;
            record.insert(figure.name.into(), entry);
            let text = serde_json::to_string_pretty(&record)? + "\n";
            std::fs::write(folder.join("record.json"), text)?;
            if folder == gallery {
                std::fs::write(root.join("docs/gallery.md"), page::render(&figures, &record))?;
            }
        }
    }
    Ok(())
}

/// Writes the pictures.
fn keep(figure: &Figure, made: Made, folder: &Path) -> std::io::Result<Entry> {
    let mut panels = Vec::new();
    for panel in made.panels {
        let separator = if panel.name.is_empty() { "" } else { "-" };
        let file = format!("{}{separator}{}.svg", figure.name, panel.name);
        std::fs::write(folder.join(&file), panel.svg)?;
        panels.push([file, panel.caption]);
    }
    Ok(Entry { settings: made.settings, found: made.found, panels })
}

fn record(folder: &Path) -> Result<Record, Box<dyn std::error::Error>> {
    match std::fs::read_to_string(folder.join("record.json")) {
        Ok(text) => Ok(serde_json::from_str(&text)?),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Record::new()),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_can_be_made() {
        for figure in all() {
            let made = (figure.make)(Size::Quick).unwrap();
            assert!(!made.found.is_empty() && !made.panels.is_empty(), "{}", figure.name);
            for panel in made.panels {
                let picture = roxmltree::Document::parse(&panel.svg);
                assert!(picture.is_ok() && !panel.svg.contains("no data"), "{}: {picture:?}", figure.name);
            }
        }
    }

    /// The page is never edited by hand, and has no figure that is gone.
    #[test]
    fn the_page_is_that_of_the_record() {
        let root = crate::root();
        let record = record(&root.join(FOLDER)).unwrap();
        let page = std::fs::read_to_string(root.join("docs/gallery.md")).unwrap();
        assert_eq!(page, page::render(&all(), &record));
        for [file, _] in record.values().flat_map(|entry| &entry.panels) {
            assert!(root.join(FOLDER).join(file).is_file(), "{file}");
        }
        assert!(record.keys().all(|name| all().iter().any(|figure| figure.name == name)));
    }
}
