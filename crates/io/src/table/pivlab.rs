//! The vectors that PIVlab saves for MATLAB.

use std::collections::BTreeMap;
use std::path::Path;

use super::vector_table::{FlowColumnNames, Vector, VectorTable};
use crate::error::{Error, TableFault, excerpt};
use crate::mat::{Variable, variables};

/// Displacements, the last treatment first: smoothed, without what was found wrong, as measured.
const DISPLACEMENTS: [[&str; 3]; 3] = [
    ["u_smoothed", "v_smoothed", "typevector_filtered"],
    ["u_filtered", "v_filtered", "typevector_filtered"],
    ["u_original", "v_original", "typevector_original"],
];

/// One variable as a matrix for each frame.
type Frames<'a> = Vec<(usize, usize, &'a [f64])>;

/// Reads a file of version 5 or 7; `path` only names the place.
pub(super) fn read_pivlab(path: &Path, bytes: &[u8], names: &FlowColumnNames) -> Result<VectorTable, Error> {
    parse(bytes, names).map_err(|fault| Error::Table { path: path.to_path_buf(), line: None, fault })
}

fn parse(bytes: &[u8], names: &FlowColumnNames) -> Result<VectorTable, TableFault> {
    let all = variables(bytes).map_err(TableFault::Matlab)?;
    let known: Vec<String> = all.keys().map(|name| excerpt(name)).collect();
    let find = |role, given: &Option<String>, usual: &str| {
        let name = given.as_deref().unwrap_or(usual);
        let own = all.get(name).and_then(frames);
        own.map(|own| (name.to_owned(), own)).ok_or_else(|| TableFault::MissingColumn {
            role,
            looked: vec![name.to_owned()],
            found: known.clone(),
            example: "--u-column u_original --v-column v_original",
        })
    };
    let has_numbers = |name: &str| {
        all.get(name).and_then(frames).is_some_and(|own| own.iter().any(|(_, _, values)| !values.is_empty()))
    };
    let treated = DISPLACEMENTS.into_iter().find(|[u, v, _]| has_numbers(u) && has_numbers(v));
    let [usual_u, usual_v, usual_kinds] = treated.unwrap_or(DISPLACEMENTS[1]);
    let (x_name, x) = find("x coordinate", &names.x, "x")?;
    let (y_name, y) = find("y coordinate", &names.y, "y")?;
    let (u_name, u) = find("displacement along x", &names.u, usual_u)?;
    let (v_name, v) = find("displacement along y", &names.v, usual_v)?;
    if let Some(name) = &names.frame {
        find("frame", &Some(name.clone()), "")?;
    }
    let kinds = match &names.mask {
        Some(_) => Some(find("mask", &names.mask, "")?.1),
        None => all.get(usual_kinds).and_then(frames),
    };
    let is_masked = |frame: usize, place: usize| {
        let kind = kinds.as_ref().and_then(|kinds| kinds.get(frame)?.2.get(place));
        // PIVlab marks what is masked with 0, and who names a mask means what is not 0.
        kind.is_some_and(|kind| (*kind == 0.0) == names.mask.is_none())
    };
    let mut vectors = Vec::new();
    for frame in 0..u.len() {
        let [x, y, u, v] = [&x, &y, &u, &v].map(|own| own.get(frame).copied().unwrap_or((0, 0, &[])));
        let differs = |own: &(usize, usize, &[f64])| (own.0, own.1) != (u.0, u.1);
        if let Some((name, other)) =
            [(&x_name, x), (&y_name, y), (&v_name, v)].into_iter().find(|(_, own)| differs(own))
        {
            return Err(TableFault::Matlab(format!(
                "frame {frame} of {name} is {} × {}, but that of {u_name} {} × {}",
                other.0, other.1, u.0, u.1
            )));
        }
        for (place, ((x, y), (u, v))) in x.2.iter().zip(y.2).zip(u.2.iter().zip(v.2)).enumerate() {
            if !(x.is_finite() && y.is_finite()) || u.is_infinite() || v.is_infinite() {
                return Err(TableFault::Matlab(format!(
                    "frame {frame}, place {place}: a number is not finite"
                )));
            }
            let is_missing = u.is_nan() || v.is_nan() || is_masked(frame, place);
            let displacement = if is_missing { [f64::NAN; 2] } else { [*u, *v] };
            vectors.push(Vector { line: 0, frame: frame as i64, x: *x, y: *y, displacement });
        }
    }
    if vectors.is_empty() {
        return Err(TableFault::NoRows);
    }
    let [place_unit, unit] = units(&all);
    let described = format!("variables x is {x_name}, y is {y_name}, u is {u_name}, v is {v_name} (PIVlab)");
    Ok(VectorTable { vectors, unit, place_unit, columns: described, notes: Vec::new() })
}

/// A variable as one matrix, or as one for each frame.
fn frames(variable: &Variable) -> Option<Frames<'_>> {
    let is_matrix = |own: &Variable| matches!(own, Variable::Numbers { .. });
    match variable {
        Variable::Cells(cells) if cells.iter().all(is_matrix) => {
            Some(cells.iter().filter_map(|own| frames(own)?.first().copied()).collect())
        }
        Variable::Numbers { rows, columns, values } => Some(vec![(*rows, *columns, values)]),
        _ => None,
    }
}

/// The units of places and of displacements in "[px] respectively [px/frame]".
fn units(all: &BTreeMap<String, Variable>) -> [Option<String>; 2] {
    let Some(Variable::Text(text)) = all.get("units") else { return [None, None] };
    let mut units = text.split('[').skip(1).filter_map(|part| part.split_once(']'));
    [(); 2].map(|()| units.next().map(|(unit, _)| unit.trim().to_owned()))
}
