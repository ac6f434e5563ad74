//! Tracks as a graph: GEFF.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use ndarray::ArrayD;
use serde_json::Value;

use super::Fault;
use super::store::Store;
use crate::array::{parse_integers, parse_reals};
use crate::error::{Error, excerpt};
use crate::input::InputFile;
use crate::note::Note;
use crate::stated::Stated;
use crate::table::{Depths, Spot, SpotTable};

const BY: &str = "GEFF";
/// How far a time may be from a whole number.
const WHOLE: f64 = 1e-9;
/// Times beyond it are no numbers of frames.
const MOST_FRAMES: f64 = 1e9;

/// An axis: its name, what it is of, and its unit.
type Axis = (String, String, Option<String>);

/// Whether a store has a graph.
pub(crate) fn is_geff(root: &Path) -> bool {
    Store::new(root).attributes("").is_ok_and(|own| own.get("geff").is_some())
}

/// The nodes of a graph as spots. Nodes that follow each other without a branch are one track.
pub(crate) fn read_geff(root: &Path) -> Result<(SpotTable, InputFile), Error> {
    let mut store = Store::new(root);
    match read(&mut store, root) {
        Ok(table) => Ok((table, store.record())),
        Err(detail) => Err(store.error(detail)),
    }
}

fn read(store: &mut Store, root: &Path) -> Result<SpotTable, Fault> {
    let attributes = store.attributes("")?;
    let about = attributes
        .get("geff")
        .ok_or("it has no graph of GEFF; images are read by import labels and import field")?;
    let axes: Vec<Axis> =
        about.get("axes").and_then(Value::as_array).into_iter().flatten().filter_map(axis).collect();
    let of_kind = |kind: &'static str| axes.iter().filter(move |(_, own, _)| own == kind);
    let time = of_kind("time").next().ok_or("none of its axes is of time")?;
    let places: Vec<&Axis> = of_kind("space").collect();
    let named = |name: &str| places.iter().copied().find(|(own, ..)| own == name);
    // By their names, else the last is x and the one before y.
    let (x, y, deep) = match (named("x"), named("y"), places.as_slice()) {
        (Some(x), Some(y), _) => (x, y, named("z")),
        (_, _, [y, x]) => (*x, *y, None),
        (_, _, [z, y, x]) => (*x, *y, Some(*z)),
        _ => return Err(format!("it has {} axes of space, and two or three are needed", places.len())),
    };
    let ids = integers(store, root, "nodes/ids")?;
    let ids: Vec<i64> = ids.iter().copied().collect();
    let mut values = |axis: &Axis| {
        let own = reals(store, root, &format!("nodes/props/{}/values", axis.0))?;
        match own.len() == ids.len() {
            true => Ok(own.iter().copied().collect::<Vec<f64>>()),
            false => Err(format!("{} of its {} nodes have a {}", own.len(), ids.len(), excerpt(&axis.0))),
        }
    };
    let (t, across, down) = (values(time)?, values(x)?, values(y)?);
    let mut depths = Depths::default();
    if let Some(z) = deep {
        values(z)?.into_iter().for_each(|z| depths.include(Some(z)));
    }
    let edges = integers(store, root, "edges/ids")?;
    if !matches!(edges.shape(), [_, 2]) {
        return Err(format!("its edges have the shape {:?}, and (edges, 2) is needed", edges.shape()));
    }
    let edges: Vec<i64> = edges.iter().copied().collect();
    let (tracks, branches) = tracks(&ids, &t, &edges)?;
    let mut spots = Vec::with_capacity(ids.len());
    for (node, id) in ids.iter().enumerate() {
        let frame = t[node].round();
        let is_frame = frame.abs() <= MOST_FRAMES && (t[node] - frame).abs() <= WHOLE;
        if !is_frame {
            return Err(format!("node {id} has the time {}, and numbers of frames are needed", t[node]));
        }
        if !(across[node].is_finite() && down[node].is_finite()) {
            return Err(format!("node {id} has a coordinate that is not finite"));
        }
        spots.push(Spot { track: tracks[node], frame: frame as i64, x: across[node], y: down[node] });
    }
    if spots.is_empty() {
        return Err("its graph has no nodes".into());
    }
    let mut notes =
        vec![Note::read(format!("time is \"{}\", x is \"{}\", y is \"{}\" ({BY})", time.0, x.0, y.0))];
    if branches > 0 {
        notes.push(Note::read(format!("at {branches} branches of the graph other tracks begin")));
    }
    notes.extend(depths.note());
    let unit = x.2.clone().filter(|unit| unit != "pixel");
    let stated = Stated { is_scaled: unit.is_some(), length_unit: unit, by: BY, ..Stated::default() };
    Ok(SpotTable { spots, untracked: 0, stated, notes })
}

fn axis(own: &Value) -> Option<Axis> {
    let text = |key: &str| own.get(key).and_then(Value::as_str).map(str::to_owned);
    Some((text("name")?, text("type")?, text("unit")))
}

/// The number of the track of each node, from 1 in the order of nodes in which tracks begin, and how often a track branches.
fn tracks(ids: &[i64], time: &[f64], edges: &[i64]) -> Result<(Vec<i64>, usize), Fault> {
    let nodes: BTreeMap<i64, usize> = ids.iter().copied().zip(0..).collect();
    if nodes.len() != ids.len() {
        return Err("two of its nodes have the same number".into());
    }
    let mut after: Vec<Vec<usize>> = vec![Vec::new(); ids.len()];
    let mut before: Vec<Vec<usize>> = vec![Vec::new(); ids.len()];
    for pair in edges.chunks_exact(2) {
        let find = |id: i64| {
            nodes.get(&id).copied().ok_or_else(|| format!("an edge leads to node {id}, which is not there"))
        };
        let (mut from, mut to) = (find(pair[0])?, find(pair[1])?);
        if time[from] > time[to] {
            (from, to) = (to, from);
        }
        after[from].push(to);
        before[to].push(from);
    }
    let goes_on = |node: usize| match before[node].as_slice() {
        [one] => after[*one].len() == 1,
        _ => false,
    };
    let branches = after.iter().filter(|own| own.len() > 1).count();
    let mut numbers = vec![0; ids.len()];
    let mut given = 0;
    for start in (0..ids.len()).filter(|&node| !goes_on(node)) {
        given += 1;
        let mut node = start;
        loop {
            numbers[node] = given;
            match after[node].as_slice() {
                [next] if goes_on(*next) && numbers[*next] == 0 => node = *next,
                _ => break,
            }
        }
    }
    // In a ring each node goes on from another.
    let left: BTreeSet<usize> = (0..ids.len()).filter(|&node| numbers[node] == 0).collect();
    match left.first() {
        None => Ok((numbers, branches)),
        Some(node) => Err(format!("node {} comes after itself", ids[*node])),
    }
}

fn integers(store: &mut Store, root: &Path, place: &str) -> Result<ArrayD<i64>, Fault> {
    let array = store.array(place)?;
    parse_integers(root, &array.to_npy(&array.shape)).map_err(|error| format!("{place}: {error}"))
}

fn reals(store: &mut Store, root: &Path, place: &str) -> Result<ArrayD<f64>, Fault> {
    let array = store.array(place)?;
    parse_reals(root, &array.to_npy(&array.shape)).map_err(|error| format!("{place}: {error}"))
}
