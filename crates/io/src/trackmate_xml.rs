//! TrackMate's own files: the model with its spots and links, and the tracks that it exports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use roxmltree::{Document, Node};

use crate::error::{Error, TableFault, excerpt};
use crate::note::Note;
use crate::stated::Stated;
use crate::table::{Depths, ROW_LIMIT, Spot, SpotTable, text_in_utf8};

/// Whether a file begins like XML.
pub(crate) fn is_xml(bytes: &[u8]) -> bool {
    let begin = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    begin.starts_with(b"<?xml") || begin.starts_with(b"<TrackMate") || begin.starts_with(b"<Tracks")
}

/// Reads spots, tracks and units; `path` only names the place.
pub(crate) fn read_trackmate(path: &Path, bytes: &[u8]) -> Result<SpotTable, Error> {
    let failure = |line, fault| Error::Table { path: path.to_path_buf(), line, fault };
    let text = text_in_utf8(bytes).map_err(|fault| failure(None, fault))?;
    let document = Document::parse(&text).map_err(|error| {
        let line = Some(u64::from(error.pos().row));
        failure(line, TableFault::Xml(excerpt(&error.to_string())))
    })?;
    let root = document.root_element();
    let read = match root.tag_name().name() {
        "TrackMate" => of_model(root),
        "Tracks" => of_tracks(root),
        name => Err((root, TableFault::OtherXml { root: excerpt(name) })),
    };
    let table = read.map_err(|(node, fault)| {
        let line = document.text_pos_at(node.range().start).row;
        failure(Some(u64::from(line)), fault)
    })?;
    match (table.spots.len(), table.untracked) {
        (0, 0) => Err(failure(None, TableFault::NoRows)),
        (0, spots) => Err(failure(None, TableFault::NoTracks { spots, column: "TRACK_ID".into() })),
        _ => Ok(table),
    }
}

/// A fault and the element that it is in.
type Located<'a, 'input> = (Node<'a, 'input>, TableFault);

/// The exported tracks: an element for each track and in it one for each spot.
fn of_tracks<'a, 'input>(root: Node<'a, 'input>) -> Result<SpotTable, Located<'a, 'input>> {
    let mut table = SpotTable {
        spots: Vec::new(),
        untracked: 0,
        stated: Stated {
            length_unit: unit(root, "spaceUnits"),
            frame_interval: positive(root, "frameInterval"),
            time_unit: unit(root, "timeUnits"),
            by: "TrackMate",
            is_scaled: true,
            ..Stated::default()
        },
        notes: vec![Note::read("the tracks that TrackMate exports; they are numbered in their order")],
    };
    let mut depths = Depths::default();
    for (track, particle) in (0..).zip(children(root, "particle")) {
        for spot in children(particle, "detection") {
            let (x, y) = (finite(spot, "x")?, finite(spot, "y")?);
            depths.include(spot.attribute("z").and_then(|z| z.parse().ok()));
            push(&mut table, spot, Spot { track, frame: whole(spot, "t")?, x, y })?;
        }
    }
    table.notes.extend(depths.note());
    Ok(table)
}

/// The model: all spots, the links between them, and which tracks were kept by the filters.
fn of_model<'a, 'input>(root: Node<'a, 'input>) -> Result<SpotTable, Located<'a, 'input>> {
    let lacks = |node, element| (node, TableFault::NoElement { element });
    let model = child(root, "Model").ok_or_else(|| lacks(root, "Model"))?;
    let all = child(model, "AllTracks").ok_or_else(|| lacks(model, "AllTracks"))?;
    let kept: Option<BTreeSet<&str>> = child(model, "FilteredTracks")
        .map(|kept| children(kept, "TrackID").filter_map(|track| track.attribute("TRACK_ID")).collect());
    let mut tracks: BTreeMap<i64, i64> = BTreeMap::new();
    let mut filtered = 0;
    for track in children(all, "Track") {
        let number = whole(track, "TRACK_ID")?;
        let name = track.attribute("TRACK_ID").unwrap_or_default();
        if kept.as_ref().is_some_and(|kept| !kept.contains(name)) {
            filtered += 1;
            continue;
        }
        for link in children(track, "Edge") {
            tracks.insert(whole(link, "SPOT_SOURCE_ID")?, number);
            tracks.insert(whole(link, "SPOT_TARGET_ID")?, number);
        }
    }
    let image = child(root, "Settings").and_then(|settings| child(settings, "ImageData"));
    let length_unit = unit(model, "spatialunits");
    let mut notes = vec![Note::read("the model of TrackMate")];
    if filtered > 0 {
        notes.push(Note::read(format!("{filtered} tracks that its filters hide are left out")));
    }
    notes.extend(image.and_then(|image| image_note(image, length_unit.as_deref())));
    let mut table = SpotTable {
        spots: Vec::new(),
        untracked: 0,
        stated: Stated {
            length_unit,
            frame_interval: image.and_then(|image| positive(image, "timeinterval")),
            time_unit: unit(model, "timeunits"),
            by: "TrackMate",
            is_scaled: true,
            ..Stated::default()
        },
        notes,
    };
    let spots = child(model, "AllSpots").ok_or_else(|| lacks(model, "AllSpots"))?;
    let mut depths = Depths::default();
    for spot in children(spots, "SpotsInFrame").flat_map(|frame| children(frame, "Spot")) {
        let Some(&track) = tracks.get(&whole(spot, "ID")?) else {
            table.untracked += 1;
            continue;
        };
        let frame = whole(spot, "FRAME")?;
        let (x, y) = (finite(spot, "POSITION_X")?, finite(spot, "POSITION_Y")?);
        depths.include(spot.attribute("POSITION_Z").and_then(|z| z.parse().ok()));
        push(&mut table, spot, Spot { track, frame, x, y })?;
    }
    table.notes.extend(depths.note());
    Ok(table)
}

fn push<'a, 'input>(
    table: &mut SpotTable,
    node: Node<'a, 'input>,
    spot: Spot,
) -> Result<(), Located<'a, 'input>> {
    if table.spots.len() == ROW_LIMIT {
        return Err((node, TableFault::TooManyRows { limit: ROW_LIMIT }));
    }
    table.spots.push(spot);
    Ok(())
}

/// How large the image is, which may be the field of view.
fn image_note(image: Node<'_, '_>, unit: Option<&str>) -> Option<Note> {
    let side = |size, pixel| Some(positive(image, size)? * positive(image, pixel)?);
    let (width, height) = (side("width", "pixelwidth")?, side("height", "pixelheight")?);
    // Single precision leaves out the digits that rounding made.
    let (width, height) = (width as f32, height as f32);
    Some(Note::read(format!(
        "the image is {width} × {height} {}; if cells were looked for in all of it, --image-size {width} {height} says so",
        unit.unwrap_or_default()
    )))
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn children<'a, 'input: 'a, 'name: 'a>(
    node: Node<'a, 'input>,
    name: &'name str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    node.children().filter(move |child| child.has_tag_name(name))
}

fn unit(node: Node<'_, '_>, attribute: &str) -> Option<String> {
    let unit = node.attribute(attribute)?.trim();
    (!unit.is_empty()).then(|| excerpt(unit))
}

fn positive(node: Node<'_, '_>, attribute: &str) -> Option<f64> {
    let value: f64 = node.attribute(attribute)?.trim().parse().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

fn finite<'a, 'input>(node: Node<'a, 'input>, attribute: &str) -> Result<f64, Located<'a, 'input>> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    value(node, attribute, "a finite number", number)
}

fn whole<'a, 'input>(node: Node<'a, 'input>, attribute: &str) -> Result<i64, Located<'a, 'input>> {
    // Older versions write 3.0.
    value(node, attribute, "a whole number", |text| {
        let text = text.trim();
        text.strip_suffix(".0").unwrap_or(text).parse().ok()
    })
}

fn value<'a, 'input, T>(
    node: Node<'a, 'input>,
    attribute: &str,
    expected: &'static str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<T, Located<'a, 'input>> {
    let text = node.attribute(attribute).unwrap_or_default();
    parse(text).ok_or_else(|| {
        (node, TableFault::NotANumber { column: attribute.to_owned(), text: excerpt(text), expected })
    })
}
