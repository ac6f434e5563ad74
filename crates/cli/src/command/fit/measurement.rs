//! How cells were measured: what is declared, what a fit determines, and what a report says of it.

use super::flow::OrderedField;
use super::prepare::Prepared;
use super::scaling::factor;
use super::tracks::PreparedTracks;
use crate::progress::Progress;
use crate::run::Run;
use crate::snapshot::Snapshot;
use voronudge_infer::{
    Determined, Error, KnownMeasurement, Measurement, Quantity, Scale, Window, measure, measure_tracks,
};
use voronudge_io::DataSet;
use voronudge_report::infer_report::{self as told, MeasurementSource, PositionKind};
use voronudge_report::numbers::significant;

/// A rise of −2 log likelihood that one unknown exceeds by chance in 5 % of cases.
const NOTABLE: f64 = 3.84;

/// Standard deviations of the coordinates of the cells of a snapshot, where they are known.
pub(super) fn position_errors(data: &DataSet, snapshot: &Snapshot, frame: usize) -> Option<Vec<f64>> {
    let errors = data.position_errors.as_ref()?;
    Some(snapshot.cells.iter().map(|&cell| errors[(frame, cell)]).collect())
}

/// The root mean square of such errors.
pub(super) fn typical<'a>(errors: impl Iterator<Item = &'a f64>) -> Option<f64> {
    let (sum, count) = errors.fold((0.0, 0.0), |(sum, count), error| (sum + error * error, count + 1.0));
    (count > 0.0).then(|| (sum / count).sqrt())
}

/// What is declared, in the units of the fit.
pub(super) fn known(data: &DataSet, field: Option<&OrderedField>, scale: &Scale) -> KnownMeasurement {
    let declared = field.map(OrderedField::declared).unwrap_or_default();
    KnownMeasurement {
        share: data.positions_are.map(|are| are.share()),
        kind: declared.kind.map(super::flow::kind),
        width: declared.width.map(|width| width / scale.length),
    }
}

impl PreparedTracks {
    /// Determines what is not declared of the measurement.
    pub fn measure(&mut self, prepared: &mut Prepared, progress: &mut Progress) -> Result<(), Error> {
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        let (movie, measurement) =
            measure_tracks(&self.movie, &prepared.request, &prepared.known, &mut observe)?;
        self.movie = movie;
        prepared.measurement = measurement;
        Ok(())
    }
}

impl Prepared {
    /// Determines what is not declared of the measurement.
    pub fn measure(&mut self, progress: &mut Progress) -> Result<(), Error> {
        let mut observe = |state: voronudge_infer::Progress<'_>| progress.tell(state);
        let (observations, measurement) =
            measure(&self.observations, &self.request, &self.known, &mut observe)?;
        if let (Some(kind), Some(width), Some(field)) =
            (measurement.kind, measurement.width, self.velocities.flow_mut())
        {
            field.take(Window { kind, width: width.value * self.scale.length });
        }
        self.observations = observations;
        self.measurement = measurement;
        Ok(())
    }

    /// Says where what was found needs a word of caution.
    pub fn caution(&self, run: &mut Run) {
        let Measurement { rivals, width, .. } = &self.measurement;
        let Some((best, others)) = rivals.split_first() else { return };
        for other in others.iter().filter(|other| other.rise < NOTABLE) {
            let off = (other.chiral_coefficient / best.chiral_coefficient - 1.0).abs();
            run.warn(format!(
                "the data do not tell whether windows are {} or {}; K_P alpha differs by {} % between the two: declare window in \
                 dataset.toml if it is known",
                super::flow::name(best.window.kind),
                super::flow::name(other.window.kind),
                significant(100.0 * off, 2)
            ));
        }
        if let Some(Determined { value, interval: Some([low, high]) }) = width
            && high - low > *value
        {
            run.warn(
                "the width of the windows is hardly determined by the data; declare window_width in dataset.toml if it is known",
            );
        }
    }
}

/// What the report says of the positions.
pub(super) fn positions(prepared: &Prepared) -> told::MeasuredPositions {
    let share = prepared.measurement.share;
    told::MeasuredPositions {
        are: match share.value {
            0.0 => PositionKind::Sites,
            1.0 => PositionKind::Centroids,
            _ => PositionKind::Between,
        },
        share: share.value,
        ci95: share.interval,
        source: match (prepared.known.share, share.interval) {
            (Some(_), _) => MeasurementSource::Declared,
            (None, Some(_)) => MeasurementSource::Estimated,
            (None, None) => MeasurementSource::Assumed,
        },
        own_errors: prepared.own_errors.is_some(),
    }
}

/// What the report says of the windows of a flow field.
pub(super) fn window(prepared: &Prepared) -> Option<told::MeasuredWindow> {
    let Measurement { rivals, width, .. } = &prepared.measurement;
    let (length, grid) = (prepared.scale.length, prepared.velocities.flow()?.described());
    let rate = factor(&prepared.scale, Quantity::ChiralCoefficient);
    let tried = rivals.iter().map(|rival| told::TriedWindow {
        kind: super::flow::told(rival.window.kind),
        width: rival.window.width * length,
        rise: rival.rise,
        chiral_coefficient: rival.chiral_coefficient * rate,
    });
    Some(told::MeasuredWindow {
        kind: grid.window,
        width: grid.width,
        ci95: width.and_then(|width| width.interval).map(|ends| ends.map(|end| end * length)),
        declared: prepared.known.kind.is_some() && prepared.known.width.is_some(),
        tried: tried.collect(),
    })
}
