//! `report.json` of `import labels`, `import outlines` and `import field`.
//!
//! Field names are the interface that scripts use; [`schema_of`](crate::schema_of) describes them. Numbers that are not finite are
//! written as `null`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::infer_report::RunRecord;
use crate::units::Units;

/// Everything that `import labels` and `import outlines` report.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ShapeReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Each frame.
    pub frames: Vec<FrameAgreement>,
    /// All frames: contacts summed up, correlations and ratios averaged with the number of cells as weight.
    pub all: AgreementRecord,
    /// Length of the axis of cells.
    pub tracks: usize,
    /// Outlines over all frames.
    pub outlines: usize,
    /// Cells at the border of the image, over all frames.
    pub at_border: usize,
    /// Cells in more than one piece, over all frames.
    pub in_pieces: usize,
    /// Pixels of background across which cells touch; `null` for outlines.
    pub gap: Option<usize>,
    /// As `all`, of Voronoi polygons of the centroids of the outlines.
    pub of_centroids: AgreementRecord,
    /// How the sites were found.
    pub sites: SiteRecord,
    /// What was read, guessed and doubted of the files.
    pub notes: Vec<NoteRecord>,
}

/// Something that was understood of a file that does not say everything about itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NoteRecord {
    /// How it is known.
    #[schemars(extend("enum" = ["read", "guessed", "doubtful"]))]
    pub kind: String,
    /// What it is, for people.
    pub text: String,
}

/// Sites whose Voronoi polygons follow outlines best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SiteRecord {
    /// Root mean square distance of the lines along which cells touch from the bisectors of their centroids, in units of length; so below.
    #[schemars(range(min = 0.0))]
    pub misfit_of_centroids: f64,
    /// The same with the sites.
    #[schemars(range(min = 0.0))]
    pub misfit: f64,
    /// Root mean square distance of the sites from the centroids, over cells that do not touch the border of the image.
    #[schemars(range(min = 0.0))]
    pub offset: f64,
    /// Median of the standard deviations of coordinates.
    #[schemars(range(min = 0.0))]
    pub median_error: f64,
}

/// Agreement in one frame.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FrameAgreement {
    /// Index of the frame, zero-based.
    pub frame: usize,
    /// Cells in it.
    pub present: usize,
    /// How well Voronoi polygons stand for outlines.
    #[serde(flatten)]
    pub agreement: AgreementRecord,
}

/// How well the Voronoi polygons of positions stand for the true outlines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct AgreementRecord {
    /// Cells whose shapes are compared.
    pub cells: usize,
    /// Contacts of outlines with a compared cell.
    pub true_contacts: usize,
    /// Contacts of Voronoi polygons with a compared cell.
    pub voronoi_contacts: usize,
    /// Contacts in both.
    pub shared_contacts: usize,
    /// Share of the Voronoi contacts that are true.
    pub precision: f64,
    /// Share of the true contacts that Voronoi polygons have.
    pub recall: f64,
    /// Pearson's correlation of the areas.
    pub area_correlation: f64,
    /// Pearson's correlation of the perimeters.
    pub perimeter_correlation: f64,
    /// Sum of Voronoi areas over the sum of true areas.
    pub area_ratio: f64,
    /// Sum of Voronoi perimeters over the sum of true perimeters.
    pub perimeter_ratio: f64,
}

impl AgreementRecord {
    /// All frames together: contacts summed up, the rest averaged with the number of cells as weight over frames where it is known.
    #[must_use]
    pub fn pooled(frames: &[Self]) -> Self {
        let sum = |of: fn(&Self) -> usize| frames.iter().map(of).sum::<usize>();
        let mean = |of: fn(&Self) -> f64| {
            let known = frames.iter().filter(|frame| of(frame).is_finite());
            let (total, weight) = known.fold((0.0, 0.0), |(total, weight), frame| {
                (total + of(frame) * frame.cells as f64, weight + frame.cells as f64)
            });
            total / weight
        };
        let (truth, voronoi) = (sum(|frame| frame.true_contacts), sum(|frame| frame.voronoi_contacts));
        let shared = sum(|frame| frame.shared_contacts);
        Self {
            cells: sum(|frame| frame.cells),
            true_contacts: truth,
            voronoi_contacts: voronoi,
            shared_contacts: shared,
            precision: shared as f64 / voronoi as f64,
            recall: shared as f64 / truth as f64,
            area_correlation: mean(|frame| frame.area_correlation),
            perimeter_correlation: mean(|frame| frame.perimeter_correlation),
            area_ratio: mean(|frame| frame.area_ratio),
            perimeter_ratio: mean(|frame| frame.perimeter_ratio),
        }
    }
}

/// Everything that `import field` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FieldReport {
    /// The run, at the top level of the file.
    #[serde(flatten)]
    pub run: RunRecord,
    /// Units of all numbers that are not dimensionless.
    pub units: Units,
    /// Extrema in each frame.
    pub frames: Vec<usize>,
    /// Length of the axis of cells.
    pub tracks: usize,
    /// Cells linked to one of the frame before, over all frames.
    pub linked: usize,
    /// Columns and rows of pixels.
    #[schemars(inner(range(min = 1)))]
    pub size: [usize; 2],
    /// Length of a pixel, in units of length.
    pub pixel_size: f64,
    /// The least prominence of an extremum taken.
    pub smallest_prominence: f64,
    /// What was read, guessed and doubted of the files.
    pub notes: Vec<NoteRecord>,
}
