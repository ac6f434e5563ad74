//! `import field`: extrema of a stream function or of an intensity.

use super::ImageArguments;
use super::linking::{Link, warn_of_breaks};
use super::notes::{records, told};
use crate::arguments::CommonArguments;
use crate::boundary::domain;
use crate::command::drawing::cells_view;
use crate::failure::Failure;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use voronudge_geometry::Tessellation;
use voronudge_io::{FieldImport, FieldOptions, Snapshot, WantedExtrema, import_field_series};
use voronudge_report::figure::{ExtremaMap, extrema_map};
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Card, Figure, Page, Section};
use voronudge_report::{FieldReport, Units};
use voronudge_segmentation::Edge;

const GUIDE: &[[&str; 2]] = &[
    [
        "Cells",
        "Maxima or minima of the smoothed field, refined by a quadratic through the nine pixels around.",
    ],
    [
        "Prominence",
        "How far one must go down from a maximum to get to a higher one. Extrema of less prominence than was asked for are taken for noise.",
    ],
];

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The field, of shape (ny, nx) or (frames, ny, nx): a .npy array, a grey .tif of one or several pages, or a grey
    /// .png. Several files, or the files of a folder, are frames in the order of the numbers in their names.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    image: ImageArguments,
    /// Which extrema of the field are cells.
    #[arg(long, value_enum, default_value_t = Kind::Maxima)]
    extrema: Kind,
    /// Standard deviation of a Gaussian filter applied first, in units of length after scaling; 0 for none.
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    smoothing: f64,
    /// Smallest prominence of an extremum, in units of the field [default: a tenth of the range of the smoothed
    /// field].
    #[arg(long, value_name = "HEIGHT", allow_negative_numbers = true)]
    prominence: Option<f64>,
    /// Smallest distance between two extrema of the same kind, in units of length after scaling; 0 for none.
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    distance: f64,
    /// The field is periodic, and the image is the periodic box.
    #[arg(long)]
    periodic: bool,
    /// Which cells of different frames are the same cell.
    #[arg(long, value_enum, default_value_t = Link::Nearest)]
    link: Link,
    /// Largest displacement of a cell between frames, in units of length after scaling [default: half the mean
    /// distance between cells].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    link_limit: Option<f64>,
    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Maxima.
    Maxima,
    /// Minima.
    Minima,
    /// Both; maxima get the label 0, minima the label 1.
    Both,
}

impl Reporting for Arguments {
    const NAME: &'static str = "import";
    type Report = FieldReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let out = self.common.reserve(&self.files)?;
        let options = FieldOptions {
            scale: self.image.scale(),
            extrema: match self.extrema {
                Kind::Maxima => WantedExtrema::Maxima,
                Kind::Minima => WantedExtrema::Minima,
                Kind::Both => WantedExtrema::Both,
            },
            smoothing: self.smoothing,
            prominence: self.prominence,
            distance: self.distance,
            edge: if self.periodic { Edge::Periodic } else { Edge::Open },
            linking: self.link.linking(self.link_limit),
        };
        let import = import_field_series(&self.files, &options)?;
        let mut out = out.begin()?;
        let data = &import.dataset;
        warn_of_breaks(run, self.link, &import.counts, import.linked, "extrema");
        let understood = told(run, &import.notes);
        data.save(&mut out)?;
        out.write_array("heights.npy", import.heights.view())?;
        out.write_array("prominences.npy", import.prominences.view())?;
        let (rows, columns) = import.first.dim();
        let report = FieldReport {
            run: run.record(Some(data)),
            units: Units { length: data.length_unit.clone(), time: data.time_unit.clone() },
            frames: import.counts.clone(),
            tracks: data.cells(),
            linked: import.linked,
            size: [columns, rows],
            pixel_size: import.pixel_size,
            smallest_prominence: import
                .prominences
                .iter()
                .copied()
                .filter(|x| x.is_finite())
                .fold(f64::INFINITY, f64::min),
            notes: records(&import.notes),
        };
        let page = page(&self.files[0], &import, &report)?;
        let extrema: usize = report.frames.iter().sum();
        let text = format!(
            "{extrema} extrema in {} frames, {} cells ({} followed from the frame before)\n{understood}written to {}\n",
            report.frames.len(),
            report.tracks,
            report.linked,
            out.path().display()
        );
        Rendered::with_page(out, &report, page, text)
    }
}

fn page(file: &Path, import: &FieldImport, report: &FieldReport) -> Result<Page, Failure> {
    let data = &import.dataset;
    let snapshot = Snapshot::new(data, 0);
    let tessellation = Tessellation::new(&snapshot.positions, domain(data)?)
        .map_err(|error| Failure::from(snapshot.in_file_numbers(error)).at(file.display()))?;
    let view = data.view()?.judge(&tessellation, &snapshot.positions);
    let mut frame =
        cells_view("frame 0".into(), &tessellation, &snapshot.positions, |cell| view.counts(cell));
    let up = data.y_sign();
    let values: Vec<f64> = import.first.iter().copied().collect();
    let height = report.size[1] as f64 * import.pixel_size;
    if let (Some(_), true) = (frame.outline, up < 0.0) {
        // The image lies below the axis where y points down; its cells were wrapped above it.
        frame.outline = Some([[0.0, -height], [report.size[0] as f64 * import.pixel_size, 0.0]]);
        for cell in &mut frame.cells {
            cell.centre[1] -= height;
            cell.polygon.iter_mut().for_each(|vertex| vertex[1] -= height);
        }
    }
    let field = ExtremaMap {
        values: &values,
        size: report.size,
        corner: [0.0, 0.0],
        step: [import.pixel_size, up * import.pixel_size],
    };
    let first = report.frames.first().copied().unwrap_or(0);
    let headline =
        format!("{first} cells are found in the first frame, {} in all frames together.", report.tracks);
    let found = Figure::new(
        extrema_map(&frame, &field, &report.units),
        "The field in the first frame, with the extrema taken for cells (dots) and their Voronoi polygons.",
    );
    Ok(Page {
        summary: vec![Block::summary(format!(
            "{} frames; {} extrema were followed from the frame before.",
            report.frames.len(),
            report.linked
        ))],
        cards: vec![
            Card::new("cells", first.to_string(), "in the first frame"),
            Card::new("least prominence", significant(report.smallest_prominence, 3), "of an extremum taken"),
        ],
        guide: vec![Block::terms(GUIDE)],
        sections: vec![Section::new("The field and its cells").with(Block::pairs([found]))],
        ..Page::new(file.display().to_string(), headline, &report.run)
    })
}
