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
    /// Agreement in each frame.
    pub frames: Vec<FrameAgreement>,
    /// Agreement over all frames: contacts are summed; correlations and ratios are averaged with the number of cells as weight.
    pub all: AgreementRecord,
    /// Number of tracks, which is the length of the axis of cells.
    pub tracks: usize,
    /// Number of outlines, over all frames.
    pub outlines: usize,
    /// Number of cells at the border of the image, over all frames.
    pub at_border: usize,
    /// Number of cells in more than one piece, over all frames.
    pub in_pieces: usize,
    /// Largest number of background pixels between two cells that still count as touching; `null` for outlines.
    pub gap: Option<usize>,
    /// The same as `all`, but for the Voronoi polygons of the centroids of the outlines.
    pub of_centroids: AgreementRecord,
    /// How well the Voronoi sites could be fitted to the outlines.
    pub sites: SiteRecord,
    /// What was read from the files, what was guessed, and what is doubtful.
    pub notes: Vec<NoteRecord>,
}

/// Something that was read from, or assumed about, a file that does not describe itself completely.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NoteRecord {
    /// Whether it was read from the file, was guessed, or is doubtful.
    #[schemars(extend("enum" = ["read", "guessed", "doubtful"]))]
    pub kind: String,
    /// The note in words.
    pub text: String,
}

/// The sites whose Voronoi polygons follow the outlines best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SiteRecord {
    /// Root mean square distance of the lines along which cells touch from the perpendicular bisectors between their centroids, in units of length.
    #[schemars(range(min = 0.0))]
    pub misfit_of_centroids: f64,
    /// The same for the bisectors between the sites, in units of length.
    #[schemars(range(min = 0.0))]
    pub misfit: f64,
    /// Root mean square distance of the sites from the centroids, over cells that do not touch the border of the image, in units of length.
    #[schemars(range(min = 0.0))]
    pub offset: f64,
    /// Median over the positions of the standard deviation of a coordinate, in units of length.
    #[schemars(range(min = 0.0))]
    pub median_error: f64,
}

/// Agreement in one frame.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FrameAgreement {
    /// Index of the frame, zero-based.
    pub frame: usize,
    /// Number of cells in the frame.
    pub present: usize,
    /// How well the Voronoi polygons agree with the outlines.
    #[serde(flatten)]
    pub agreement: AgreementRecord,
}

/// How well the Voronoi polygons of the positions agree with the true outlines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct AgreementRecord {
    /// Number of cells whose shapes are compared.
    pub cells: usize,
    /// Number of contacts between outlines that involve a compared cell.
    pub true_contacts: usize,
    /// Number of contacts between Voronoi polygons that involve a compared cell.
    pub voronoi_contacts: usize,
    /// Number of contacts that occur in both.
    pub shared_contacts: usize,
    /// Share of the Voronoi contacts that are true.
    pub precision: f64,
    /// Share of the true contacts that the Voronoi polygons have, too.
    pub recall: f64,
    /// Pearson correlation between Voronoi areas and true areas.
    pub area_correlation: f64,
    /// Pearson correlation between Voronoi perimeters and true perimeters.
    pub perimeter_correlation: f64,
    /// Sum of the Voronoi areas divided by the sum of the true areas.
    pub area_ratio: f64,
    /// Sum of the Voronoi perimeters divided by the sum of the true perimeters.
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
    /// Number of extrema in each frame.
    pub frames: Vec<usize>,
    /// Number of tracks, which is the length of the axis of cells.
    pub tracks: usize,
    /// Number of cells that were linked to a cell of the frame before, over all frames.
    pub linked: usize,
    /// Number of columns and number of rows of pixels.
    #[schemars(inner(range(min = 1)))]
    pub size: [usize; 2],
    /// Side of a pixel, in units of length.
    pub pixel_size: f64,
    /// Smallest prominence of the extrema that were accepted, in units of the field.
    pub smallest_prominence: f64,
    /// What was read from the files, what was guessed, and what is doubtful.
    pub notes: Vec<NoteRecord>,
}
