//! `dataset.toml`: reading it with the line of every complaint, and writing it.

use std::path::{Path, PathBuf};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::boundary::Boundary;
use crate::dataset::DataSet;
use crate::error::{Error, SettingFault, TomlFault};
use crate::field_of_view::SeenArea;
use crate::measurement::{DeclaredWindow, PositionsAre, WindowKind};
use crate::noise::Noise;
use crate::positive;
use crate::toml_value::{kind, number, text, truth};
use crate::walled_sides::WalledSides;
use crate::y_axis::YAxis;

const KEYS: &[&str] = &[
    "boundary",
    "box",
    "box_offset",
    "walls",
    "frame_interval",
    "length_unit",
    "time_unit",
    "y_axis",
    "unwrapped",
    "position_noise",
    "velocity_noise",
    "field_of_view",
    "positions_are",
    "window",
    "window_width",
];

/// What a `dataset.toml` says; everything is optional.
#[derive(Debug, Default)]
pub(crate) struct Settings {
    path: PathBuf,
    boundary: Option<(BoundaryName, u64)>,
    lengths: Option<([f64; 2], u64)>,
    pub(crate) box_offset: Option<Vec<f64>>,
    pub(crate) walls: Option<WalledSides>,
    pub(crate) frame_interval: Option<f64>,
    pub(crate) length_unit: Option<String>,
    pub(crate) time_unit: Option<String>,
    pub(crate) y_axis: Option<YAxis>,
    pub(crate) unwrapped: Option<bool>,
    pub(crate) position_noise: Option<Noise>,
    pub(crate) velocity_noise: Option<Noise>,
    field_of_view: Option<(SeenArea, u64)>,
    pub(crate) positions_are: Option<PositionsAre>,
    window: Option<WindowKind>,
    window_width: Option<(f64, u64)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BoundaryName {
    Periodic,
    Open,
}

impl Settings {
    pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let failure = |line, fault| Error::Toml { path: path.to_path_buf(), line, fault };
        let text = std::str::from_utf8(bytes).map_err(|_| failure(None, TomlFault::NotText))?;
        let line_of = |offset| line_number(text, offset);
        let table = DeTable::parse(text).map_err(|error| {
            let line = error.span().map(|span| line_of(span.start));
            failure(line, TomlFault::Syntax(error.message().to_owned()))
        })?;

        let mut settings = Self { path: path.to_path_buf(), ..Self::default() };
        let mut entries: Vec<_> = table.get_ref().iter().collect();
        // The table is sorted by key; complaints should come in reading order.
        entries.sort_by_key(|(key, _)| key.span().start);
        for (key, value) in entries {
            let line = line_of(key.span().start);
            settings.take(key.get_ref(), value, line).map_err(|fault| failure(Some(line), fault))?;
        }
        Ok(settings)
    }

    fn take(&mut self, key: &str, value: &Spanned<DeValue<'_>>, line: u64) -> Result<(), TomlFault> {
        let value = value.get_ref();
        match key {
            "boundary" => self.boundary = Some((boundary(value)?, line)),
            "box" => self.lengths = Some((lengths(value)?, line)),
            "box_offset" => self.box_offset = Some(offsets(value)?),
            "walls" => {
                self.walls = Some(walls(value)?);
            }
            "frame_interval" => {
                let interval = positive("frame_interval", value, "a number such as 10.0")?;
                self.frame_interval = Some(interval);
            }
            "length_unit" => self.length_unit = Some(text("length_unit", value)?.to_owned()),
            "time_unit" => self.time_unit = Some(text("time_unit", value)?.to_owned()),
            "y_axis" => {
                let y_axis = YAxis::parse(text("y_axis", value)?);
                self.y_axis = Some(y_axis.map_err(TomlFault::Setting)?);
            }
            "unwrapped" => self.unwrapped = Some(truth("unwrapped", value)?),
            "position_noise" => self.position_noise = Some(noise("position_noise", value)?),
            "velocity_noise" => self.velocity_noise = Some(noise("velocity_noise", value)?),
            "field_of_view" => self.field_of_view = Some((SeenArea::parse(value)?, line)),
            "positions_are" => self.positions_are = Some(positions_are(value)?),
            "window" => {
                let window = WindowKind::parse(text("window", value)?);
                self.window = Some(window.map_err(TomlFault::Setting)?);
            }
            "window_width" => {
                self.window_width = Some((positive("window_width", value, "a length such as 6.5")?, line));
            }
            _ => {
                return Err(TomlFault::UnknownKey { key: key.to_owned(), known: KEYS });
            }
        }
        Ok(())
    }

    /// The field of view that is given besides, or else the stated one, which must suit the boundary.
    pub(crate) fn field_of_view(
        &mut self,
        given: Option<&SeenArea>,
        boundary: Boundary,
    ) -> Result<Option<SeenArea>, Error> {
        match (given, self.field_of_view.take()) {
            (Some(given), _) => given.check(boundary).map_err(Error::Setting).map(|()| Some(given.clone())),
            (None, Some((stated, line))) => match stated.check(boundary) {
                Ok(()) => Ok(Some(stated)),
                Err(fault) => Err(Error::Toml {
                    path: self.path.clone(),
                    line: Some(line),
                    fault: TomlFault::Setting(fault),
                }),
            },
            (None, None) => Ok(None),
        }
    }

    /// Puts what is declared of the window together with what is given besides, which wins.
    pub(crate) fn window(&self, given: DeclaredWindow, boundary: Boundary) -> Result<DeclaredWindow, Error> {
        let stored = self.window_width.filter(|_| given == DeclaredWindow::default());
        let kind = given.kind.or(self.window);
        let width = given.width.or(stored.map(|(width, _)| width));
        let window = DeclaredWindow { kind, width };
        window.check(boundary).map_err(|fault| match stored {
            Some((_, line)) => {
                Error::Toml { path: self.path.clone(), line: Some(line), fault: TomlFault::Setting(fault) }
            }
            None => Error::Setting(fault),
        })?;
        Ok(window)
    }

    /// Puts `boundary` and `box` together.
    pub(crate) fn boundary(&self) -> Result<Option<Boundary>, Error> {
        let failure = |line, fault| Error::Toml {
            path: self.path.clone(),
            line: Some(line),
            fault: TomlFault::Setting(fault),
        };
        match (self.boundary, self.lengths) {
            (None, None) => Ok(None),
            (Some((BoundaryName::Open, _)), None) => Ok(Some(Boundary::Open)),
            (Some((BoundaryName::Periodic, _)), Some((lengths, _))) => {
                Ok(Some(Boundary::Periodic { lengths }))
            }
            (Some((BoundaryName::Periodic, line)), None) => Err(failure(line, SettingFault::MissingBox)),
            (name, Some((_, line))) => {
                let boundary = match name {
                    Some(_) => "open",
                    None => "not given",
                };
                Err(failure(line, SettingFault::BoxNotPeriodic { boundary }))
            }
        }
    }
}

/// The text of the `dataset.toml` that describes a data set.
pub(crate) fn render(data: &DataSet) -> String {
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let number = |value: f64| toml::Value::from(value).to_string();
    let mut lines = Vec::new();
    match data.boundary {
        Boundary::Open => lines.push("boundary = \"open\"".to_owned()),
        Boundary::Periodic { lengths: [x, y] } => {
            lines.push("boundary = \"periodic\"".to_owned());
            lines.push(format!("box = [{}, {}]", number(x), number(y)));
        }
    }
    if let Some(offsets) = &data.box_offset {
        let mut offsets = offsets.clone();
        data.y_axis.turn_offsets(&mut offsets);
        let offsets: Vec<String> = offsets.into_iter().map(number).collect();
        lines.push(format!("box_offset = [{}]", offsets.join(", ")));
    }
    if let Some(walls) = data.walls {
        lines.push(format!("walls = \"{walls}\""));
    }
    lines.push(format!("frame_interval = {}", number(data.frame_interval)));
    lines.push(format!("length_unit = {}", quoted(&data.length_unit)));
    lines.push(format!("time_unit = {}", quoted(&data.time_unit)));
    lines.push(format!("y_axis = \"{}\"", data.y_axis));
    if data.unwrapped {
        lines.push("unwrapped = true".to_owned());
    }
    for (key, noise) in [("position_noise", data.position_noise), ("velocity_noise", data.velocity_noise)] {
        match noise {
            Some(Noise::Absolute(value)) => lines.push(format!("{key} = {}", number(value))),
            Some(relative) => lines.push(format!("{key} = \"{relative}\"")),
            None => {}
        }
    }
    if let Some(area) = &data.field_of_view {
        let mut area = area.clone();
        area.turn(data.y_axis);
        lines.push(format!("field_of_view = {}", area.rendered()));
    }
    match data.positions_are {
        Some(known @ (PositionsAre::SITES | PositionsAre::CENTROIDS)) => {
            lines.push(format!("positions_are = \"{known}\""));
        }
        Some(between) => lines.push(format!("positions_are = {}", number(between.share()))),
        None => {}
    }
    if let Some(kind) = data.window.kind {
        lines.push(format!("window = \"{kind}\""));
    }
    if let Some(width) = data.window.width {
        lines.push(format!("window_width = {}", number(width)));
    }
    lines.push(String::new());
    lines.join("\n")
}

fn boundary(value: &DeValue<'_>) -> Result<BoundaryName, TomlFault> {
    match text("boundary", value)? {
        "periodic" => Ok(BoundaryName::Periodic),
        "open" => Ok(BoundaryName::Open),
        found => Err(TomlFault::Setting(SettingFault::Unknown {
            key: "boundary",
            found: found.to_owned(),
            expected: "\"periodic\" or \"open\"",
        })),
    }
}

fn walls(value: &DeValue<'_>) -> Result<WalledSides, TomlFault> {
    match text("walls", value)? {
        "x" => Ok(WalledSides::X),
        "both" => Ok(WalledSides::Both),
        found => Err(TomlFault::Setting(SettingFault::Unknown {
            key: "walls",
            found: found.to_owned(),
            expected: "\"x\" or \"both\"",
        })),
    }
}

fn lengths(value: &DeValue<'_>) -> Result<[f64; 2], TomlFault> {
    let wrong =
        |found| TomlFault::WrongType { key: "box", found, expected: "two lengths such as [20.0, 20.0]" };
    let DeValue::Array(items) = value else {
        return Err(wrong(kind(value)));
    };
    let numbers: Vec<f64> = items
        .iter()
        .map(|item| number(item.get_ref()).ok_or_else(|| wrong("an array with other things")))
        .collect::<Result<_, _>>()?;
    let lengths = <[f64; 2]>::try_from(numbers).map_err(|_| wrong("an array of another length"))?;
    let checked = Boundary::Periodic { lengths }.check();
    checked.map_err(TomlFault::Setting)?;
    Ok(lengths)
}

fn offsets(value: &DeValue<'_>) -> Result<Vec<f64>, TomlFault> {
    let wrong = |found| TomlFault::WrongType {
        key: "box_offset",
        found,
        expected: "a number for each frame, such as [0.0, 0.5]",
    };
    let DeValue::Array(items) = value else {
        return Err(wrong(kind(value)));
    };
    items
        .iter()
        .map(|item| number(item.get_ref()).ok_or_else(|| wrong("an array with other things")))
        .collect()
}

fn positive(key: &'static str, value: &DeValue<'_>, expected: &'static str) -> Result<f64, TomlFault> {
    let wrong = || TomlFault::WrongType { key, found: kind(value), expected };
    let number = number(value).ok_or_else(wrong)?;
    positive::positive(key, number).map_err(TomlFault::Setting)?;
    Ok(number)
}

fn positions_are(value: &DeValue<'_>) -> Result<PositionsAre, TomlFault> {
    let read = match (value, number(value)) {
        (DeValue::String(text), _) => PositionsAre::parse(text),
        (_, Some(share)) => PositionsAre::checked(share),
        (_, None) => {
            return Err(TomlFault::WrongType {
                key: "positions_are",
                found: kind(value),
                expected: "\"sites\", \"centroids\" or a number from 0 to 1",
            });
        }
    };
    read.map_err(TomlFault::Setting)
}

fn noise(key: &'static str, value: &DeValue<'_>) -> Result<Noise, TomlFault> {
    let noise = match (value, number(value)) {
        (DeValue::String(text), _) => Noise::parse(key, text),
        (_, Some(value)) => {
            let noise = Noise::Absolute(value);
            noise.check(key).map(|()| noise)
        }
        (_, None) => {
            return Err(TomlFault::WrongType { key, found: kind(value), expected: Noise::EXPECTED });
        }
    };
    noise.map_err(TomlFault::Setting)
}

/// The line, counted from 1, of a byte offset.
fn line_number(text: &str, offset: usize) -> u64 {
    let before = text.as_bytes().iter().take(offset);
    1 + before.filter(|&&byte| byte == b'\n').count() as u64
}
