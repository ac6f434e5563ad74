//! Which columns of a table matter, and what their fields say.

use std::borrow::Cow;

use csv::ByteRecord;

use super::header::{bare, plain, unit_in};
use super::known::{Known, LABEL};
use super::spot::{Layout, Spot};
use crate::error::{TableFault, excerpt};
use crate::note::Note;

/// Names of the columns, where they are not to be recognised automatically.
///
/// A name is looked up as written, then ignoring case, blanks, hyphens and underscores, then also units in brackets.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ColumnNames {
    /// The column that says which track a spot belongs to.
    pub track: Option<String>,
    /// The column that counts images.
    pub frame: Option<String>,
    /// The x coordinate.
    pub x: Option<String>,
    /// The y coordinate.
    pub y: Option<String>,
}

/// A column found in the header.
pub(super) struct Column {
    pub(super) index: usize,
    pub(super) name: String,
}

/// The columns of a table that matter.
pub(super) struct Columns {
    /// Absent for points, which are numbered in the order of their rows.
    track: Option<Column>,
    frame: Option<Column>,
    x: Column,
    y: Column,
    z: Option<Column>,
}

impl Columns {
    pub(super) fn find(header: &ByteRecord, layout: Layout, names: &ColumnNames) -> Result<Self, TableFault> {
        let found: Vec<String> = header
            .iter()
            .map(|field| {
                let text = String::from_utf8_lossy(field);
                text.trim_start_matches(['\u{feff}', '#', ' ']).trim().to_owned()
            })
            .collect();
        let known = Known::of(layout, &found);
        let example = match layout {
            Layout::TrackMate => {
                "--track-column id --frame-column t; for another table format use import tracks"
            }
            Layout::Tracks => {
                "--track-column id --frame-column t; import points follows cells that have no tracks"
            }
            Layout::Outlines => "--cell-column id --frame-column t",
            Layout::Points => "--x-column cx --y-column cy --frame-column t",
        };
        let find = |role, given: &Option<String>, known: &[&str]| {
            Column::find(&found, role, given, known, plain, example)
                .or_else(|fault| Column::find(&found, role, given, known, bare, example).map_err(|_| fault))
        };
        let may_be_still = matches!(layout, Layout::Outlines | Layout::Points);
        Ok(Self {
            track: match layout {
                Layout::Points => None,
                _ => Some(find("track", &names.track, known.track)?),
            },
            frame: match find("frame", &names.frame, known.frame) {
                Err(_) if may_be_still && names.frame.is_none() => None,
                found => Some(found?),
            },
            x: find("x coordinate", &names.x, known.x)?,
            y: find("y coordinate", &names.y, known.y)?,
            z: find("z coordinate", &None, known.z).ok(),
        })
    }

    /// What is to be said of how columns were found.
    pub(super) fn notes(&self, names: &ColumnNames) -> Vec<Note> {
        let roles = [
            ("track", self.track.as_ref(), &names.track),
            ("frame", self.frame.as_ref(), &names.frame),
            ("x", Some(&self.x), &names.x),
            ("y", Some(&self.y), &names.y),
        ];
        let found = roles.into_iter().filter(|(.., given)| given.is_none());
        let found = found.filter_map(|(role, column, _)| Some((role, excerpt(&column?.name))));
        let found: Vec<String> = found.map(|(role, name)| format!("{role} is \"{name}\"")).collect();
        let mut notes = Vec::new();
        if !found.is_empty() {
            notes.push(Note::guessed(format!("of the columns {}", found.join(", "))));
        }
        if let Some(track) = self.guessed_label(names) {
            notes.push(Note::doubtful(format!(
                "\"{}\" is taken for the track: the same number is the same cell in all frames; import points follows cells whose \
                 numbers are those of each image",
                excerpt(&track.name)
            )));
        }
        notes
    }

    /// The column of the track, if it is one of numbers of regions that nobody named.
    fn guessed_label(&self, names: &ColumnNames) -> Option<&Column> {
        self.track.as_ref().filter(|track| names.track.is_none() && plain(&track.name) == LABEL)
    }

    /// That a guessed column of tracks holds names, as ImageJ's `Label` does.
    pub(super) fn check_label(&self, row: &ByteRecord, names: &ColumnNames) -> Result<(), TableFault> {
        match self.guessed_label(names) {
            Some(track) if !track.text(row).is_empty() && track.finite(row).is_err() => {
                Err(TableFault::Untracked { column: track.name.clone(), text: excerpt(&track.text(row)) })
            }
            _ => Ok(()),
        }
    }

    /// The unit of length that the header states in brackets.
    pub(super) fn length_unit(&self) -> Option<String> {
        unit_in(&self.x.name)
    }

    /// What a row has under z.
    pub(super) fn depth(&self, row: &ByteRecord) -> Option<f64> {
        self.z.as_ref()?.finite(row).ok()
    }

    /// Whether a row repeats names or units rather than giving a spot.
    pub(super) fn all_texts(&self, row: &ByteRecord) -> bool {
        self.frame.iter().chain([&self.x, &self.y]).all(|column| column.text(row).parse::<f64>().is_err())
    }

    /// What a row has under x, where TrackMate's extra header rows put the unit of length.
    pub(super) fn length_unit_text<'a>(&self, row: &'a ByteRecord) -> Cow<'a, str> {
        self.x.text(row)
    }

    /// The name of the column of the track.
    pub(super) fn track_name(self) -> String {
        self.track.map_or_else(String::new, |track| track.name)
    }

    /// The spot of a row; `None` where it belongs to no track.
    pub(super) fn spot(&self, row: &ByteRecord) -> Result<Option<Spot>, TableFault> {
        const UNTRACKED: [&str; 6] = ["", "-", "none", "nan", "na", "null"];
        let text = self.track.as_ref().map(|track| track.text(row).to_lowercase());
        if text.is_some_and(|text| UNTRACKED.contains(&text.as_str())) {
            return Ok(None);
        }
        Ok(Some(Spot {
            track: self.track.as_ref().map_or(Ok(0), |track| track.whole(row))?,
            frame: self.frame.as_ref().map_or(Ok(0), |frame| frame.whole(row))?,
            x: self.x.finite(row)?,
            y: self.y.finite(row)?,
        }))
    }
}

impl Column {
    /// The column of the given name, or of the first of the known names that is there.
    ///
    /// A name is looked for as written, then by what `plain` leaves of it; `example` shows how to
    /// name columns.
    pub(super) fn find(
        found: &[String],
        role: &'static str,
        given: &Option<String>,
        known: &[&str],
        plain: fn(&str) -> String,
        example: &'static str,
    ) -> Result<Self, TableFault> {
        let looked: Vec<String> = match given {
            Some(name) => vec![name.clone()],
            None => known.iter().map(|&name| name.to_owned()).collect(),
        };
        let index = looked.iter().find_map(|name| {
            let exact = found.iter().position(|column| column == name);
            let like = || found.iter().position(|column| plain(column) == plain(name));
            exact.or_else(like)
        });
        match index {
            Some(index) => Ok(Self { index, name: found[index].clone() }),
            None => {
                let found = found.iter().map(|name| excerpt(name)).collect();
                Err(TableFault::MissingColumn { role, looked, found, example })
            }
        }
    }

    pub(super) fn text<'a>(&self, row: &'a ByteRecord) -> Cow<'a, str> {
        String::from_utf8_lossy(row.get(self.index).unwrap_or_default().trim_ascii())
    }

    pub(super) fn finite(&self, row: &ByteRecord) -> Result<f64, TableFault> {
        let text = self.text(row);
        let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
        number.ok_or_else(|| self.fault(&text, "a finite number"))
    }

    /// A whole number, possibly written as `12.0`.
    pub(super) fn whole(&self, row: &ByteRecord) -> Result<i64, TableFault> {
        // Beyond this an f64 no longer holds every whole number.
        const EXACT: f64 = 9_007_199_254_740_992.0;
        let text = self.text(row);
        let exact = |value: &f64| value.fract() == 0.0 && value.abs() < EXACT;
        let from_real = || text.parse::<f64>().ok().filter(exact);
        let number = text.parse().ok();
        number
            .or_else(|| from_real().map(|value| value as i64))
            .ok_or_else(|| self.fault(&text, "a whole number"))
    }

    pub(super) fn fault(&self, text: &str, expected: &'static str) -> TableFault {
        TableFault::NotANumber { column: self.name.clone(), text: excerpt(text), expected }
    }
}
