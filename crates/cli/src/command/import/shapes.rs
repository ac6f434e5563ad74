//! True outlines beside the Voronoi polygons of the positions: the comparison, its report and its page.

use super::notes::{records, told};
use super::sites::{Positions, place_at_sites};
use crate::command::drawing::cells_view;
use crate::failure::Failure;
use crate::reporting::Rendered;
use crate::run::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use voronudge_geometry::{Domain, FieldOfView, Seen, Tessellation, areas, perimeters};
use voronudge_io::{OutputDirectory, ShapeImport, Snapshot};
use voronudge_report::figure::{ShapeMeasure, outline_map, shape_scatter};
use voronudge_report::numbers::significant;
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table};
use voronudge_report::shape_report::{AgreementRecord, FrameAgreement, ShapeReport};
use voronudge_report::{FrameView, Units};
use voronudge_segmentation::{MeasuredShape, agreement, comparable};

const GUIDE: &[[&str; 2]] = &[
    [
        "Precision and recall",
        "The share of the contacts of Voronoi polygons that are contacts of outlines too, and the share of the contacts of outlines that \
         Voronoi polygons have. A contact counts if one of its cells is compared.",
    ],
    [
        "Cells that are compared",
        "Their Voronoi polygon and those of their neighbours are closed and of plausible size, and their outlines are seen as a whole.",
    ],
    [
        "What it means for a fit",
        "The model knows cells by their centres only. Where contacts or areas are often wrong, forces that are computed from Voronoi \
         polygons are not those of the tissue.",
    ],
];

/// Where the shapes come from.
pub(super) struct Source<'a> {
    pub file: &'a Path,
    pub gap: Option<usize>,
    pub positions: Positions,
}

/// One frame compared.
struct Compared {
    view: FrameView,
    record: AgreementRecord,
    /// True and Voronoi measure of the cells compared.
    areas: Vec<[f64; 2]>,
    perimeters: Vec<[f64; 2]>,
}

/// Compares, writes and prints.
pub(super) fn finish(
    run: &mut Run,
    mut out: OutputDirectory,
    source: &Source<'_>,
    mut import: ShapeImport,
) -> Result<Rendered<ShapeReport>, Failure> {
    let of_centroids = pooled(&compare_all(&import, source.file)?);
    let (sites, centroids) = place_at_sites(&mut import)?;
    let compared = compare_all(&import, source.file)?;
    if source.positions == Positions::Centroids {
        centroids.apply_to(&mut import.dataset);
    }
    let import = &import;
    let all = pooled(&compared);
    if all.cells == 0 {
        run.warn(
            "no cell can be compared: all are at the rim, at the border of the image, or next to one that is",
        );
    }
    let understood = told(run, &import.notes);
    import.save(&mut out)?;
    let data = &import.dataset;
    let report = ShapeReport {
        run: run.record(Some(data)),
        units: Units { length: data.length_unit.clone(), time: data.time_unit.clone() },
        frames: compared
            .iter()
            .enumerate()
            .map(|(frame, one)| FrameAgreement {
                frame,
                present: one.view.cells.len(),
                agreement: one.record,
            })
            .collect(),
        all,
        tracks: data.cells(),
        outlines: import.summary.outlines,
        at_border: import.summary.at_border,
        in_pieces: import.summary.in_pieces,
        gap: source.gap,
        of_centroids,
        sites,
        notes: records(&import.notes),
    };
    let page = page(source, import, &compared, &report);
    let length = |x: f64| format!("{} {}", significant(x, 2), data.length_unit);
    let described = format!(
        "sites {} from centroids; outlines {} from the sides of their polygons, {} with centroids",
        length(sites.offset),
        length(sites.misfit),
        length(sites.misfit_of_centroids)
    );
    let text = format!(
        "{} outlines in {} frames, {} cells\n{described}\n\
         Voronoi polygons of {} cells against their outlines: precision {}, recall {} of {} contacts; correlation of areas {}, of \
         perimeters {}\n{understood}written to {}\n",
        report.outlines,
        report.frames.len(),
        report.tracks,
        all.cells,
        significant(all.precision, 3),
        significant(all.recall, 3),
        all.true_contacts,
        significant(all.area_correlation, 3),
        significant(all.perimeter_correlation, 3),
        out.path().display()
    );
    Rendered::with_page(out, &report, page, text)
}

fn compare_all(import: &ShapeImport, file: &Path) -> Result<Vec<Compared>, Failure> {
    (0..import.frames.len()).map(|frame| compare(import, frame, file)).collect()
}

fn pooled(compared: &[Compared]) -> AgreementRecord {
    AgreementRecord::pooled(&compared.iter().map(|one| one.record).collect::<Vec<_>>())
}

fn compare(import: &ShapeImport, frame: usize, file: &Path) -> Result<Compared, Failure> {
    let snapshot = Snapshot::new(&import.dataset, frame);
    let positions = &snapshot.positions;
    let tessellation = Tessellation::new(positions, Domain::Open).map_err(|error| {
        Failure::from(snapshot.in_file_numbers(error)).at(format!("{}, frame {frame}", file.display()))
    })?;
    // The outlines themselves show which cells were seen as a whole.
    let view =
        FieldOfView { seen: Seen::Everywhere, ..FieldOfView::default() }.judge(&tessellation, positions);
    let known = &import.frames[frame];
    let shapes: Vec<Option<MeasuredShape>> = snapshot
        .cells
        .iter()
        .map(|&cell| {
            let at = (frame, cell);
            let shape = MeasuredShape { area: import.areas[at], perimeter: import.perimeters[at] };
            (!known.cut.contains(&cell)).then_some(shape)
        })
        .collect();
    let present: BTreeMap<usize, usize> = snapshot.cells.iter().copied().zip(0..).collect();
    let contacts: BTreeSet<[usize; 2]> = known
        .contacts
        .iter()
        .filter_map(|[a, b]| Some([*present.get(a)?, *present.get(b)?]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let found = agreement(&tessellation, positions, &view, &shapes, &contacts);
    let used = comparable(&tessellation, &view, &shapes);
    let pairs = |voronoi: Vec<f64>, of: fn(&MeasuredShape) -> f64| {
        let cells = (0..used.len()).filter(|&cell| used[cell]);
        cells.filter_map(|cell| Some([of(shapes[cell].as_ref()?), voronoi[cell]])).collect()
    };
    Ok(Compared {
        record: AgreementRecord {
            cells: found.cells,
            true_contacts: found.true_contacts,
            voronoi_contacts: found.voronoi_contacts,
            shared_contacts: found.shared_contacts,
            precision: found.precision(),
            recall: found.recall(),
            area_correlation: found.area_correlation,
            perimeter_correlation: found.perimeter_correlation,
            area_ratio: found.area_ratio,
            perimeter_ratio: found.perimeter_ratio,
        },
        areas: pairs(areas(&tessellation, positions), |shape| shape.area),
        perimeters: pairs(perimeters(&tessellation, positions), |shape| shape.perimeter),
        view: cells_view(format!("frame {frame}"), &tessellation, positions, |cell| used[cell]),
    })
}

fn page(source: &Source<'_>, import: &ShapeImport, compared: &[Compared], report: &ShapeReport) -> Page {
    let all = &report.all;
    let percent = |share: f64| format!("{} %", significant(100.0 * share, 3));
    let headline = format!(
        "The Voronoi polygons of the sites have {} of the true contacts, and {} of theirs are true; their areas correlate with the \
         true ones by {}.",
        percent(all.recall),
        percent(all.precision),
        significant(all.area_correlation, 2)
    );
    let mut summary = vec![format!(
        "{} outlines in {} frames; {} cells are compared. {} outlines lie at the border of the image, and {} in several pieces.",
        report.outlines,
        report.frames.len(),
        all.cells,
        report.at_border,
        report.in_pieces
    )];
    let (found, length) = (report.sites, |x: f64| format!("{} {}", significant(x, 2), report.units.length));
    summary.push(format!(
        "Sites are the points whose Voronoi polygons follow the outlines best. They lie {} from the centroids (root mean square), and \
         outlines {} from the sides of their polygons; with centroids it would be {}.",
        length(found.offset),
        length(found.misfit),
        length(found.misfit_of_centroids)
    ));
    summary.push(
        match source.positions {
            Positions::Centroids => {
                "The data set has centroids for positions, each with its error, and sites where cells beyond the image count."
            }
            Positions::Sites => "The data set has sites for positions, each with its error.",
        }
        .to_owned(),
    );
    if let Some(gap) = report.gap {
        summary.push(format!(
            "Cells touch if the way from one to the other, from side to side of pixels, crosses at most {gap} pixels of background. \
             Areas count pixels; perimeters are Crofton's in eight directions."
        ));
    }
    let card = |label: &str, value: f64, note: &str| Card::new(label, significant(value, 3), note);
    let cards = vec![
        card("precision", all.precision, "of Voronoi contacts"),
        card("recall", all.recall, "of true contacts"),
        card("area correlation", all.area_correlation, "Voronoi against true"),
        card("perimeter ratio", all.perimeter_ratio, "Voronoi over true"),
    ];
    let row = |name: String, present: String, record: &AgreementRecord| {
        let numbers = [
            record.precision,
            record.recall,
            record.area_correlation,
            record.perimeter_correlation,
            record.area_ratio,
            record.perimeter_ratio,
        ];
        let counts = [present, record.cells.to_string(), record.true_contacts.to_string()];
        std::iter::once(name).chain(counts).chain(numbers.map(|x| significant(x, 3))).collect::<Vec<_>>()
    };
    let mut rows: Vec<Vec<String>> = report
        .frames
        .iter()
        .map(|one| row(format!("frame {}", one.frame), one.present.to_string(), &one.agreement))
        .collect();
    rows.push(row("all".into(), report.frames.iter().map(|one| one.present).sum::<usize>().to_string(), all));
    rows.push(row("all, with centroids".into(), String::new(), &report.of_centroids));
    let header = "|cells|compared|contacts|precision|recall|corr. of areas|corr. of perimeters|area ratio|perimeter ratio";
    let mut figures = Vec::new();
    if let (Some(first), Some(known)) = (compared.first(), import.frames.first()) {
        figures.push(Figure::new(
            outline_map(&first.view, &known.outlines, &report.units),
            "True outlines over the Voronoi polygons, first frame. Cells on grey are not compared.",
        ));
    }
    let pooled = |of: fn(&Compared) -> &Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        compared.iter().flat_map(|one| of(one).iter().copied()).collect()
    };
    figures.push(Figure::new(
        shape_scatter(&pooled(|one| &one.areas), ShapeMeasure::Area, all.area_correlation, &report.units),
        "Voronoi against true areas of the cells compared, all frames. Dashed: equal.",
    ));
    figures.push(Figure::new(
        shape_scatter(
            &pooled(|one| &one.perimeters),
            ShapeMeasure::Perimeter,
            all.perimeter_correlation,
            &report.units,
        ),
        "The same of perimeters.",
    ));
    let agreement = Section::new("Voronoi polygons against outlines")
        .with(Block::table(Table::new(header.split('|')).rows(rows)))
        .with(Block::pairs(figures));
    Page {
        summary: summary.into_iter().map(Block::summary).collect(),
        cards,
        guide: vec![Block::terms(GUIDE)],
        sections: vec![agreement],
        ..Page::new(source.file.display().to_string(), headline, &report.run)
    }
}
