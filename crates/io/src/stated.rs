//! What a file says of its own units, and what becomes of it beside what the user says.

use crate::image_scale::ImageScale;
use crate::note::Note;

/// Two lengths or times are the same to this share of them: files round.
const SAME: f64 = 1e-3;

/// Units that a file states.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Stated {
    /// Length of a pixel in `length_unit`; `None` also where coordinates are in that unit already.
    pub(crate) pixel_size: Option<f64>,
    pub(crate) length_unit: Option<String>,
    pub(crate) frame_interval: Option<f64>,
    pub(crate) time_unit: Option<String>,
    /// Who says so, such as `ImageJ`.
    pub(crate) by: &'static str,
    /// Whether lengths of the file are in `length_unit` as they stand.
    pub(crate) is_scaled: bool,
    /// Whether there is one frame only, so that times do not matter.
    pub(crate) is_still: bool,
}

impl Stated {
    /// What the user says, and where that is nothing, what the file says.
    pub(crate) fn settle(&self, given: &ImageScale, notes: &mut Vec<Note>) -> ImageScale {
        let mut scale = given.clone();
        self.settle_length(given, &mut scale, notes);
        self.settle_time(given, &mut scale, notes);
        if given.y_axis.is_none() {
            notes.push(Note::guessed("y points down, as in images"));
        }
        scale
    }

    fn settle_length(&self, given: &ImageScale, scale: &mut ImageScale, notes: &mut Vec<Note>) {
        let unit = self.length_unit.as_deref();
        match (given.pixel_size, self.pixel_size) {
            (Some(own), _) if self.is_scaled && own != 1.0 => {
                if let Some(unit) = unit.filter(|unit| !is_pixel(unit)) {
                    notes.push(Note::doubtful(format!(
                        "the file is in {unit} already, and --pixel-size {own} multiplies that; leave the option out unless the file is wrong"
                    )));
                }
                return;
            }
            (Some(own), Some(stated)) if !same(own, stated) => {
                notes.push(Note::doubtful(format!(
                    "--pixel-size {own} is taken, but the file says {} ({})",
                    measure(stated, unit),
                    self.by
                )));
                return;
            }
            (None, Some(stated)) => {
                scale.pixel_size = Some(stated);
                notes.push(Note::read(format!("pixels of {} ({})", measure(stated, unit), self.by)));
            }
            (None, None) if self.is_scaled && unit.is_some() => {}
            (None, None) if given.length_unit.is_none() => {
                notes.push(Note::guessed("no unit of length is stated"));
            }
            _ => {}
        }
        match (&given.length_unit, unit) {
            (Some(own), Some(stated)) if canonical(own) != canonical(stated) && !is_pixel(stated) => {
                notes.push(Note::doubtful(format!(
                    "--length-unit {own} is taken, but the file says {stated} ({})",
                    self.by
                )));
            }
            (None, Some(stated)) => {
                scale.length_unit = Some(stated.to_owned());
                if self.pixel_size.is_none() {
                    notes.push(Note::read(format!("lengths in {stated} ({})", self.by)));
                }
            }
            _ => {}
        }
    }

    fn settle_time(&self, given: &ImageScale, scale: &mut ImageScale, notes: &mut Vec<Note>) {
        let unit = self.time_unit.as_deref();
        match (given.frame_interval, self.frame_interval) {
            (Some(own), Some(stated)) => {
                // 600 s against 10 min is no contradiction.
                let seconds =
                    |value: f64, unit: Option<&str>| unit.and_then(seconds).map(|second| value * second);
                let (of_own, of_stated) =
                    (seconds(own, given.time_unit.as_deref().or(unit)), seconds(stated, unit));
                let is_same = match (of_own, of_stated) {
                    (Some(own), Some(stated)) => same(own, stated),
                    _ => same(own, stated),
                };
                if is_same {
                    if given.time_unit.is_none() {
                        scale.time_unit = unit.map(str::to_owned);
                    }
                } else {
                    notes.push(Note::doubtful(format!(
                        "--frame-interval {own} is taken, but the file says {} ({})",
                        measure(stated, unit),
                        self.by
                    )));
                }
            }
            (None, Some(stated)) => {
                scale.frame_interval = Some(stated);
                notes.push(Note::read(format!("{} between frames ({})", measure(stated, unit), self.by)));
                match (&given.time_unit, unit) {
                    (Some(own), Some(stated)) if canonical(own) != canonical(stated) => {
                        notes.push(Note::doubtful(format!(
                            "--time-unit {own} is taken, but the file says {stated} ({})",
                            self.by
                        )));
                    }
                    (None, Some(stated)) => scale.time_unit = Some(stated.to_owned()),
                    _ => {}
                }
            }
            (None, None) if self.is_still => {}
            (None, None) => notes.push(Note::guessed("frames follow each other at a time of 1")),
            (Some(_), None) => {}
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

fn measure(value: f64, unit: Option<&str>) -> String {
    // Six digits: resolutions are ratios of whole numbers.
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    match unit {
        Some(unit) => format!("{rounded} {unit}"),
        None => format!("{rounded} without a unit"),
    }
}

/// Whether a unit of length is that of the image itself.
pub(crate) fn is_pixel(unit: &str) -> bool {
    let unit = unit.to_lowercase();
    unit == "px" || unit.starts_with("pix")
}

/// Whether two names are those of one unit.
pub(crate) fn same_unit(a: &str, b: &str) -> bool {
    canonical(a) == canonical(b)
}

/// One name for the names of one unit.
fn canonical(unit: &str) -> String {
    let plain = unit.trim().to_lowercase();
    match plain.as_str() {
        "um" | "µm" | "μm" | "micron" | "microns" | "micrometer" | "micrometre" => "um".into(),
        "s" | "sec" | "secs" | "second" | "seconds" => "s".into(),
        "min" | "mins" | "minute" | "minutes" => "min".into(),
        "h" | "hr" | "hrs" | "hour" | "hours" => "h".into(),
        "px" | "pixel" | "pixels" => "px".into(),
        "frame" | "frames" => "frame".into(),
        _ => plain,
    }
}

/// Seconds in a unit of time.
fn seconds(unit: &str) -> Option<f64> {
    match canonical(unit).as_str() {
        "ms" => Some(1e-3),
        "s" => Some(1.0),
        "min" => Some(60.0),
        "h" => Some(3600.0),
        "d" | "day" | "days" => Some(86_400.0),
        _ => None,
    }
}
