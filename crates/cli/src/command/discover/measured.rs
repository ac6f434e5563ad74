//! What was found out about the measurement before the search: it stands beside what the tissue may do, and goes first.

use super::phrases::{listed, percent};
use crate::problem::Problem;
use voronudge_infer::discover::Fitted;
use voronudge_infer::{ChangeKind, NoiseSource};
use voronudge_report::Units;
use voronudge_report::discover_report::{CandidateStatus, EffectKind, RankedEffect};
use voronudge_report::infer_report::{FlowWindow, Measurement, MeasurementSource, PositionKind};
use voronudge_report::numbers::significant;
use voronudge_report::units::unit_text;

/// A fault or a habit of the measurement that the fits take into account.
struct Finding {
    /// Its id in the ranking; that of the effect it stands for, where there is one.
    id: &'static str,
    /// What was found, to follow "5 cells".
    statement: String,
    /// What to do about it.
    advice: &'static str,
    /// Unknowns that it took.
    dimension: usize,
    /// By how much −2 log likelihood falls, beyond what the unknowns cost; not a number where there is no single one.
    evidence: f64,
}

/// What was found out, for the reports of a search.
pub(super) struct Findings {
    all: Vec<Finding>,
}

impl Findings {
    /// Everything that nobody declared and that is not as usual.
    pub fn new(prepared: &Problem, measurement: &Measurement) -> Self {
        let tracks = measurement.tracks.as_ref();
        let times = |count: usize, id, what: &str, advice| {
            let statement = format!("{count} times a track {what}");
            (count > 0).then_some(Finding { id, statement, advice, dimension: count, evidence: f64::NAN })
        };
        let swapped = times(
            tracks.map_or(0, |tracks| tracks.cut),
            "swapped_identities",
            "jumps to another cell",
            "Tracks that jump: look at the linking of the tracker, whose tracks the fit cuts there.",
        );
        let broken = times(
            tracks.map_or(0, |tracks| tracks.joined),
            "broken_tracks",
            "goes on under another name",
            "Tracks that break: look at the linking of the tracker, whose names the joins of the fit replace.",
        );
        let all = [
            missed(prepared),
            faulty(prepared),
            centroids(measurement),
            window(measurement),
            swapped,
            broken,
        ];
        Self { all: all.into_iter().flatten().collect() }
    }

    /// What was found, in words; `None` if nothing was.
    pub fn statement(&self) -> Option<String> {
        let statements: Vec<&str> = self.all.iter().map(|own| own.statement.as_str()).collect();
        (!statements.is_empty()).then(|| listed(&statements, "and"))
    }

    /// What to do about it.
    pub fn advice(&self) -> impl Iterator<Item = String> {
        self.all.iter().map(|own| own.advice.to_owned())
    }

    /// The ranking with what was found in front, and the errors of positions, which are always there, behind what is named.
    pub fn ahead_of(&self, ranking: Vec<RankedEffect>, noise: &PositionNoise) -> Vec<RankedEffect> {
        let is_found = |own: &RankedEffect| self.all.iter().any(|found| found.id == own.effect);
        let others = ranking.into_iter().filter(|own| !is_found(own));
        let mut all: Vec<RankedEffect> = self.all.iter().map(Finding::ranked).chain(others).collect();
        let is_named = |own: &RankedEffect| {
            matches!(own.status, CandidateStatus::Measurement | CandidateStatus::Selected)
        };
        let behind = all.iter().position(|own| !is_named(own)).unwrap_or(all.len());
        all.insert(behind, noise.ranked());
        all
    }
}

impl Finding {
    fn ranked(&self) -> RankedEffect {
        self.ranked_with(f64::NAN)
    }

    /// With the root mean square velocity that it makes, relative to all.
    fn ranked_with(&self, size: f64) -> RankedEffect {
        RankedEffect {
            effect: self.id.into(),
            kind: EffectKind::Observation,
            dimension: self.dimension,
            statistic: self.evidence,
            p: f64::NAN,
            p_adjusted: f64::NAN,
            detection_limit: f64::NAN,
            size: 100.0 * size,
            size_ci95: None,
            gain: None,
            status: CandidateStatus::Measurement,
            reason: format!("{}, which all fits take into account", self.statement),
        }
    }
}

/// Errors of positions, beside what the tissue does.
pub(super) struct PositionNoise {
    /// σ_r in units of the data.
    level: String,
    estimated: bool,
    /// Share of the squared velocities that it makes.
    share: f64,
}

impl PositionNoise {
    /// As it is in the fit of the last model: what an effect explains is no error of positions.
    pub fn new(prepared: &Problem, after: &Fitted, units: &Units) -> Self {
        let sigma = after.inference.noise.position * prepared.scale.length;
        Self {
            level: format!("{} {}", significant(sigma, 3), unit_text(&units.length)),
            estimated: after.inference.noise_source == NoiseSource::Estimated,
            share: after.budget.position_noise,
        }
    }

    fn ranked(&self) -> RankedEffect {
        let source = if self.estimated { "as estimated" } else { "as stated" };
        let makes = match self.share.is_finite() {
            true => format!(", which make {} of the squared velocities", percent(self.share)),
            false => String::new(),
        };
        Finding {
            id: "position_noise",
            statement: format!("errors of positions of {} {source}{makes}", self.level),
            advice: "",
            dimension: 1,
            evidence: f64::NAN,
        }
        .ranked_with(self.share.sqrt())
    }
}

fn cells(count: usize) -> String {
    format!("{count} cell{}", if count == 1 { "" } else { "s" })
}

/// The changes of some kinds: how many, and their evidence.
fn changes(prepared: &Problem, kinds: &[ChangeKind]) -> (usize, f64) {
    let frames = prepared.completion.iter().flat_map(|completion| &completion.frames);
    let changes = frames.flat_map(|frame| &frame.changes).filter(|change| kinds.contains(&change.kind));
    changes.fold((0, 0.0), |(count, evidence), change| (count + 1, evidence + change.evidence))
}

fn missed(prepared: &Problem) -> Option<Finding> {
    let (count, evidence) = changes(prepared, &[ChangeKind::Inserted]);
    (count > 0).then(|| Finding {
        id: "missed_cells",
        statement: format!("{} that {} not detected", cells(count), if count == 1 { "was" } else { "were" }),
        advice: "Cells that were not detected: look at the images at the places in latent_cells.npy.",
        dimension: 2 * count,
        evidence,
    })
}

fn faulty(prepared: &Problem) -> Option<Finding> {
    let kinds = [ChangeKind::Deleted, ChangeKind::Split, ChangeKind::Merged];
    let (count, evidence) = changes(prepared, &kinds);
    let names = ["no cell", "two cells", "one of two of the same cell"];
    let told: Vec<String> = kinds
        .iter()
        .zip(names)
        .map(|(kind, name)| (changes(prepared, &[*kind]).0, name))
        .filter(|(count, _)| *count > 0)
        .map(|(count, name)| {
            format!("{count} detection{} {name}", if count == 1 { " that is" } else { "s that are" })
        })
        .collect();
    let told: Vec<&str> = told.iter().map(String::as_str).collect();
    (count > 0).then(|| Finding {
        id: "faulty_detections",
        statement: listed(&told, "and"),
        advice: "Detections that are no cells, or two: look at the images where the map marks them.",
        dimension: 2 * count,
        evidence,
    })
}

fn centroids(measurement: &Measurement) -> Option<Finding> {
    let positions = &measurement.positions;
    let is_found = positions.source == MeasurementSource::Estimated && positions.share != 0.0;
    is_found.then(|| Finding {
        id: "centroid_bias",
        statement: match positions.are {
            PositionKind::Centroids => {
                "positions that are centroids of cells instead of the sites of their polygons".into()
            }
            _ => format!(
                "positions that are {} of the way from a cell's site to its centroid",
                significant(positions.share, 3)
            ),
        },
        advice: "What a position is: declare positions_are in dataset.toml if it is known.",
        dimension: 1,
        evidence: f64::NAN,
    })
}

fn window(measurement: &Measurement) -> Option<Finding> {
    let window = measurement.window.as_ref().filter(|window| !window.declared)?;
    let kind = match window.kind {
        FlowWindow::Square => "square windows",
        FlowWindow::Gaussian => "Gaussian windows over cells",
        FlowWindow::GaussianArea => "Gaussian windows",
    };
    Some(Finding {
        id: "flow_blur",
        statement: format!(
            "velocities that are averages over {kind} of width {}",
            significant(window.width, 3)
        ),
        advice: "Over which windows the flow was averaged: declare window and window_width in dataset.toml if they are known.",
        dimension: 1,
        evidence: f64::NAN,
    })
}
