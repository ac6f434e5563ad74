//! Cells as polygons of GeoJSON, in the plane of the data.

use super::{CellFrame, numbers};
use serde_json::{Map, Value, json};
use voronudge_geometry::Vector;

/// A feature for each cell and frame; cells with an open polygon are points.
pub(super) fn collection(frames: &[CellFrame], y_sign: f64, time: impl Fn(usize) -> f64) -> String {
    let at = |r: &Vector<f64>| json!([r.x, y_sign * r.y]);
    let feature = |frame: &CellFrame, cell: usize| {
        let polygon = &frame.polygons[cell];
        let geometry = match polygon.first() {
            // A ring of GeoJSON ends where it begins.
            Some(first) => {
                let ring: Vec<Value> = polygon.iter().chain([first]).map(at).collect();
                json!({"type": "Polygon", "coordinates": [ring]})
            }
            None => json!({"type": "Point", "coordinates": at(&frame.positions[cell])}),
        };
        let mut properties = Map::new();
        properties.insert("frame".into(), frame.frame.into());
        properties.insert("time".into(), time(frame.frame).into());
        properties.insert("cell".into(), frame.cells[cell].into());
        properties.insert("centre".into(), at(&frame.positions[cell]));
        for (name, value) in numbers(frame, cell, y_sign) {
            // What is no number is null.
            properties.insert(name, value.into());
        }
        properties.insert("neighbours".into(), frame.neighbours[cell].clone().into());
        json!({"type": "Feature", "geometry": geometry, "properties": properties})
    };
    let features: Vec<Value> = frames
        .iter()
        .flat_map(|frame| (0..frame.cells.len()).map(move |cell| feature(frame, cell)))
        .collect();
    json!({"type": "FeatureCollection", "features": features}).to_string() + "\n"
}
