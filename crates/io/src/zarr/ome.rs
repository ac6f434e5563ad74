//! Images of OME-Zarr, and arrays of Zarr by themselves.

use std::path::Path;

use serde_json::Value;

use super::Fault;
use super::store::Store;
use crate::error::{Error, excerpt};
use crate::image::{Described, Wanted};
use crate::input::InputFile;
use crate::note::Note;
use crate::stated::Stated;

const BY: &str = "OME-Zarr";
/// Axes of the first versions, which do not name them.
const ALL_AXES: [&str; 5] = ["t", "c", "z", "y", "x"];
/// Pixels that differ by more than this share along x and y are not square.
const SQUARE: f64 = 1e-3;

/// An image in its finest resolution as a file of NumPy, (frames, rows, columns), and what is said of it. Of an image with labels these are
/// taken where labels are wanted.
pub(crate) fn read_ome(root: &Path, wanted: Wanted) -> Result<(Vec<u8>, Described, InputFile), Error> {
    let mut store = Store::new(root);
    match read(&mut store, wanted) {
        Ok((bytes, described)) => Ok((bytes, described, store.record())),
        Err(detail) => Err(store.error(detail)),
    }
}

fn read(store: &mut Store, wanted: Wanted) -> Result<(Vec<u8>, Described), Fault> {
    let mut notes = Vec::new();
    let mut place = String::new();
    if wanted == Wanted::Labels
        && let Some(name) = labels(store)?
    {
        place = format!("labels/{name}");
        notes.push(Note::read(format!("the labels {} ({BY})", excerpt(&name))));
    }
    let attributes = store.attributes(&place)?;
    let image = ome(&attributes).get("multiscales").and_then(|own| own.get(0)).cloned();
    let Some(image) = image else {
        if !store.has_array(&place)? {
            return Err("it holds neither an image nor an array".into());
        }
        let array = store.array(&place)?;
        let shape = squeezed(&array.shape)?;
        return Ok((array.to_npy(&shape), Described { notes, ..Described::default() }));
    };
    let finest = image.pointer("/datasets/0").ok_or("its image has no resolutions")?;
    let path = finest.get("path").and_then(Value::as_str).ok_or("its image has no resolutions")?;
    let array = store.array(&format!("{place}{}{path}", if place.is_empty() { "" } else { "/" }))?;
    let axes = axes(&image, array.shape.len())?;
    let mut shape = [1_usize; 3];
    for ((name, _), length) in axes.iter().zip(&array.shape) {
        match (name.as_str(), *length) {
            ("t", length) => shape[0] = length,
            ("y", length) => shape[1] = length,
            ("x", length) => shape[2] = length,
            (_, 1) => {}
            (name, length) => {
                let name = match name {
                    "c" => "channels",
                    "z" => "slices",
                    other => other,
                };
                return Err(format!("it has {length} {name}, and one is needed"));
            }
        }
    }
    let names: String = axes
        .iter()
        .filter(|(name, _)| "tyx".contains(name.as_str()))
        .map(|(name, _)| name.as_str())
        .collect();
    if !matches!(names.as_str(), "tyx" | "yx") {
        return Err(format!("its axes are {names}, and t, y, x are needed in this order"));
    }
    let stated = stated(&image, finest, &axes, &mut notes);
    Ok((array.to_npy(&shape), Described { stated, notes }))
}

/// What OME says, which newer versions have under a name of its own.
fn ome(attributes: &Value) -> &Value {
    attributes.get("ome").unwrap_or(attributes)
}

/// The name of the one label image of an image.
fn labels(store: &mut Store) -> Result<Option<String>, Fault> {
    let attributes = store.attributes("labels")?;
    let names = ome(&attributes).get("labels").and_then(Value::as_array);
    let names: Vec<&str> = names.into_iter().flatten().filter_map(Value::as_str).collect();
    match names.as_slice() {
        [] => Ok(None),
        [one] => Ok(Some((*one).to_owned())),
        several => Err(format!(
            "it has several label images ({}), name one as in x.zarr/labels/{}",
            several.join(", "),
            several[0]
        )),
    }
}

/// The names and units of the axes.
fn axes(image: &Value, count: usize) -> Result<Vec<(String, Option<String>)>, Fault> {
    let named = |own: &Value| {
        let name = own.get("name").and_then(Value::as_str).or(own.as_str())?.to_lowercase();
        Some((name, own.get("unit").and_then(Value::as_str).map(str::to_owned)))
    };
    let axes: Option<Vec<_>> = match image.get("axes").and_then(Value::as_array) {
        Some(axes) => axes.iter().map(named).collect(),
        None => Some(ALL_AXES.map(|name| (name.to_owned(), None)).to_vec()),
    };
    axes.filter(|axes| axes.len() == count)
        .ok_or_else(|| format!("its axes are not those of an array of {count} dimensions"))
}

/// Pixel size and interval by the scale of an image.
fn stated(image: &Value, finest: &Value, axes: &[(String, Option<String>)], notes: &mut Vec<Note>) -> Stated {
    let scale_of = |own: &Value, axis: usize| {
        let steps = own.get("coordinateTransformations").and_then(Value::as_array);
        let scale = steps.into_iter().flatten().find_map(|own| own.get("scale")?.get(axis)?.as_f64());
        scale.unwrap_or(1.0)
    };
    let along = |name: &str| {
        let axis = axes.iter().position(|(own, _)| own == name)?;
        let scale = scale_of(finest, axis) * scale_of(image, axis);
        Some((scale, axes[axis].1.as_deref().map(unit)))
    };
    let mut stated = Stated { by: BY, ..Stated::default() };
    // Without a unit a scale of one says nothing.
    let says = |(scale, unit): &(f64, Option<String>)| {
        *scale > 0.0 && scale.is_finite() && (unit.is_some() || *scale != 1.0)
    };
    if let (Some((x, unit)), Some((y, _))) = (along("x").filter(says), along("y").filter(says)) {
        match (x - y).abs() <= SQUARE * x {
            true => (stated.pixel_size, stated.length_unit) = (Some(x), unit),
            false => notes.push(Note::doubtful(format!(
                "pixels are {x} × {y} ({BY}), but square ones are needed: their size is not taken"
            ))),
        }
    }
    if let Some((interval, unit)) = along("t").filter(says) {
        (stated.frame_interval, stated.time_unit) = (Some(interval), unit);
    }
    stated
}

/// The symbol of a unit, which OME-Zarr spells out.
fn unit(name: &str) -> String {
    match name {
        "micrometer" => "µm",
        "nanometer" => "nm",
        "millimeter" => "mm",
        "second" => "s",
        "millisecond" => "ms",
        "minute" => "min",
        "hour" => "h",
        other => other,
    }
    .to_owned()
}

/// Frames, rows and columns of an array whose axes have no names.
fn squeezed(shape: &[usize]) -> Result<Vec<usize>, Fault> {
    let axes = shape.len();
    let long: Vec<usize> = shape
        .iter()
        .enumerate()
        .filter(|(axis, length)| **length != 1 || axis + 2 >= axes)
        .map(|(_, own)| *own)
        .collect();
    match long.as_slice() {
        [_, _] | [_, _, _] => Ok(long),
        _ => Err(format!("its array has the shape {shape:?}, and (frames, rows, columns) is needed")),
    }
}
