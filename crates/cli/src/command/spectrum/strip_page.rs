//! A strip as a record and in words.

use super::strip::{Bands, EndedLattice, EndsName};
use std::fmt::Write as _;
use voronudge_report::figure::StripSide;
use voronudge_report::numbers::significant;
use voronudge_report::spectrum_report::StripRecord;
use voronudge_spectrum::{Complex64, Strip, StripMode};

/// Rates of growth below this are those of translations.
const GROWING: f64 = 1e-8;

/// Growth across the strip, as a power of e, beyond which rounding moves values: they depend on both ends.
const TOO_LOCALISED: f64 = 14.0;

impl Bands {
    /// The strip in the report.
    pub fn record(&self, ended: &EndedLattice) -> StripRecord {
        let (strip, modes) = (&ended.strip, &self.shown);
        let side = |wanted: StripSide| modes.iter().filter(|mode| side_of(mode, strip) == wanted).count();
        let of_edge = |mode: &&StripMode| mode.is_of_edge(strip.places().len());
        let steepest = self.steepest(strip).filter(|mode| side_of(mode, strip) != StripSide::Neither);
        let growth = steepest.map(|mode| mode.localisation.growth.abs());
        StripRecord {
            ends: ended.ends.name(),
            rows: ended.rows,
            moving_rows: strip.places().len(),
            spacing: strip.spacing(),
            period: strip.period(),
            speed: ended.speed,
            wave_numbers: self.wave_numbers.len(),
            fastest: self.fastest(),
            wave_number: self.shown_at,
            modes: modes.len(),
            left: side(StripSide::Left),
            right: side(StripSide::Right),
            of_edges: modes.iter().filter(of_edge).count(),
            winding: modes.iter().filter(|mode| mode.winding != 0).count(),
            largest_growth: growth,
            difference_from_zone: self.difference(strip),
        }
    }

    /// The largest rate of growth in time, and its wave number, the first of those not below zero.
    fn fastest(&self) -> [f64; 2] {
        let rates = self.wave_numbers.iter().zip(&self.modes).filter(|(q, _)| **q >= 0.0);
        let rates = rates.filter_map(|(q, modes)| Some([modes.first()?.value.re, *q]));
        rates.reduce(|most, own| if own[0] > most[0] { own } else { most }).unwrap_or([f64::NAN; 2])
    }

    /// The mode that grows fastest across the strip, other than those of an edge.
    fn steepest(&self, strip: &Strip) -> Option<&StripMode> {
        let size = |mode: &&StripMode| mode.localisation.growth.abs();
        let own = self.shown.iter().filter(|mode| !mode.is_of_edge(strip.places().len()));
        own.max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Root mean square difference of the growth of the modes from the generalised Brillouin zone, over the root mean square of the latter; none
    /// where nothing grows by a factor e across the strip.
    fn difference(&self, strip: &Strip) -> Option<f64> {
        let rows = strip.places().len();
        let (mut off, mut size, mut count) = (0.0, 0.0, 0.0);
        for mode in &self.shown {
            let expected = mode.expected_growth(rows)?;
            off += (mode.localisation.growth * strip.spacing() - expected).powi(2);
            size += expected.powi(2);
            count += 1.0;
        }
        (size * (rows * rows) as f64 > count).then(|| (off / size).sqrt())
    }

    /// What should be known before using the modes.
    pub fn warnings(&self, ended: &EndedLattice) -> Vec<String> {
        let rows = ended.strip.places().len() as f64;
        let growth = self.modes.iter().flatten().filter_map(|mode| mode.middle_roots);
        let steepest = growth.map(|roots| roots.growth().abs()).fold(0.0, f64::max);
        let mut warnings = Vec::new();
        let [rate, q] = self.fastest();
        if rate > GROWING {
            warnings.push(format!(
                "a mode of the strip grows at the rate {} at the wave number {}: the lattice gives way to it, where it is long enough along its rows",
                significant(rate, 3),
                significant(q, 3)
            ));
        }
        if steepest * rows > TOO_LOCALISED && ended.ends != EndsName::Periodic {
            warnings.push(format!(
                "modes grow by up to a factor {:.0e} across the strip: rounding then moves values at such wave numbers; take fewer rows than {}",
                (steepest * rows).exp(),
                ended.rows
            ));
        }
        warnings
    }
}

/// The end at which a mode is.
pub(super) fn side_of(mode: &StripMode, strip: &Strip) -> StripSide {
    match mode.piles_up_right(strip.places()) {
        None => StripSide::Neither,
        Some(true) => StripSide::Right,
        Some(false) => StripSide::Left,
    }
}

pub(super) fn parts(value: Complex64) -> [f64; 2] {
    [value.re, value.im]
}

/// The strip in words, for the page.
pub(super) fn paragraph(record: &StripRecord) -> String {
    let at = format!("At the wave number {} along the strip", significant(record.wave_number, 3));
    if record.left + record.right == 0 {
        return format!(
            "{at} no mode grows by a factor e from one end to the other: there is no skin effect."
        );
    }
    let mut text = format!(
        "{at} {} of {} modes pile up at the left end and {} at the right; the spectrum of the periodic tissue winds around {} of them",
        record.left, record.modes, record.right, record.winding
    );
    if let Some(growth) = record.largest_growth.filter(|growth| *growth > 0.0) {
        let _ = write!(text, ". The shortest localisation length is {} ℓ₀", significant(1.0 / growth, 2));
    }
    if record.of_edges > 0 {
        let _ = write!(text, ". {} are modes of an edge", record.of_edges);
    }
    text.push('.');
    text
}

/// The strip as lines of the summary.
pub(super) fn lines(record: &StripRecord) -> String {
    let mut text = format!(
        "strip of {} rows that move, at q = {}: of {} modes {} pile up left, {} right, {} at an edge; periodic spectrum winds around {}\n",
        record.moving_rows,
        significant(record.wave_number, 4),
        record.modes,
        record.left,
        record.right,
        record.of_edges,
        record.winding
    );
    if let Some(growth) = record.largest_growth {
        let _ = writeln!(text, "  {:20} {} ℓ₀", "localisation length", significant(1.0 / growth, 3));
    }
    if let Some(difference) = record.difference_from_zone {
        let _ = writeln!(
            text,
            "  {:20} {} of it, root mean square, from the generalised Brillouin zone",
            "growth of modes",
            significant(difference, 2)
        );
    }
    text
}
