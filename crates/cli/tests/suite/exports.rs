//! Cells for other programs: what is written agrees with the arrays, and comes back.

use crate::program::{fixture, succeed};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, read};
use ndarray::{Array1, Array2, Array3};
use serde_json::Value;
use std::fs;

/// Signed area of a ring of GeoJSON, and whether it ends where it begins.
fn area(ring: &[Value]) -> (f64, bool) {
    let at = |k: usize| [0, 1].map(|axis| ring[k][axis].as_f64().unwrap());
    let cross = |k: usize| at(k)[0] * at(k + 1)[1] - at(k)[1] * at(k + 1)[0];
    ((0..ring.len() - 1).map(cross).sum::<f64>() / 2.0, ring.first() == ring.last())
}

#[test]
fn polygons_velocities_and_neighbours_are_those_of_the_arrays() {
    let out = Folder::new();
    let data = fixture("reference-small");
    let line = "evaluate --alpha 0.3 --export csv,geojson,vtk,napari";
    succeed(line, &[("", &data), ("--out", out.path())]);
    let (areas, v): (Array1<f64>, Array2<f64>) =
        (read(&out.file("areas.npy")), read(&out.file("velocities.npy")));
    let text = fs::read_to_string(out.file("cells.geojson")).unwrap();
    let collection: Value = serde_json::from_str(&text).unwrap();
    let features = collection["features"].as_array().unwrap();
    assert_eq!(features.len(), areas.len());
    let neighbours = |cell: usize| -> Vec<usize> {
        let list = features[cell]["properties"]["neighbours"].as_array().unwrap().iter();
        list.map(|own| own.as_u64().unwrap() as usize).collect()
    };
    for (cell, feature) in features.iter().enumerate() {
        let properties = &feature["properties"];
        assert_eq!(properties["cell"], cell);
        let (found, is_closed) = area(feature["geometry"]["coordinates"][0].as_array().unwrap());
        assert!(is_closed && (found - areas[cell]).abs() < 1e-9, "{found} {}", areas[cell]);
        assert_eq!(properties["area"].as_f64(), Some(areas[cell]));
        assert_eq!(properties["velocity_y"].as_f64(), Some(v[(cell, 1)]));
        for other in neighbours(cell) {
            assert!(neighbours(other).contains(&cell));
        }
    }
    // The same cells in the other files.
    let table = fs::read_to_string(out.file("cells.csv")).unwrap();
    assert_eq!(table.lines().count(), areas.len() + 1);
    let head = "frame,time,cell,x,y,area,perimeter,counts,velocity_x,velocity_y,neighbours";
    assert_eq!(table.lines().next(), Some(head));
    let polygons = fs::read_to_string(out.file("cells_0000.vtp")).unwrap();
    assert!(polygons.contains(&format!("NumberOfPolys=\"{}\"", areas.len())));
    let after = polygons.split_once("Name=\"area\"").unwrap().1.split_once('>').unwrap().1;
    let found: Vec<f64> =
        after.split_once('<').unwrap().0.split_whitespace().map(|word| word.parse().unwrap()).collect();
    assert_eq!(found, areas.to_vec());
    assert!(fs::read_to_string(out.file("cells.pvd")).unwrap().contains("file=\"cells_0000.vtp\""));
}

/// Of an open field, where y points down, with polygons that are open.
#[test]
fn tracks_for_napari_come_back_as_they_were() {
    let (out, back) = (Folder::new(), Folder::new());
    let data = fixture("open-field");
    succeed("evaluate --K_P 0.02 --P_0 78 --export napari,geojson", &[("", &data), ("--out", out.path())]);
    succeed("import tracks", &[("", &out.file("napari-tracks.csv")), ("--out", back.path())]);
    let given: Array3<f64> = read(&data.join("positions.npy"));
    let found: Array3<f64> = read(&back.file("positions.npy"));
    assert_eq!(given.dim(), found.dim());
    let same = |a: f64, b: f64| a.is_nan() && b.is_nan() || a == b;
    assert!(given.iter().zip(&found).all(|(&a, &b)| same(a, b)));
    let text = fs::read_to_string(out.file("cells.geojson")).unwrap();
    let collection: Value = serde_json::from_str(&text).unwrap();
    let features = collection["features"].as_array().unwrap();
    let are = |kind: &str| features.iter().filter(|own| own["geometry"]["type"] == kind).count();
    assert!(are("Point") > 0 && are("Polygon") > 0 && are("Point") + are("Polygon") == features.len());
    let has_area = |own: &Value| own["properties"]["area"].is_number();
    assert!(features.iter().all(|own| has_area(own) == (own["geometry"]["type"] == "Polygon")));
    // A polygon is around its cell.
    let closed = features.iter().find(|own| own["geometry"]["type"] == "Polygon").unwrap();
    let ring = closed["geometry"]["coordinates"][0].as_array().unwrap();
    let centre = [0, 1].map(|axis| closed["properties"]["centre"][axis].as_f64().unwrap());
    let mean = [0, 1].map(|axis| {
        ring[1..].iter().map(|r| r[axis].as_f64().unwrap()).sum::<f64>() / (ring.len() - 1) as f64
    });
    assert!((0..2).all(|axis| (mean[axis] - centre[axis]).abs() < 10.0), "{mean:?} {centre:?}");
}

#[test]
fn a_fit_writes_its_cells_with_what_it_says_of_them() {
    let out = Folder::new();
    succeed("infer --fix K_A=0.1 --export csv", &[("", &fixture("chiral-liquid")), ("--out", out.path())]);
    let nudged: Array2<f64> = read(&out.file("nudged_positions.npy"));
    let rest: Array2<f64> = read(&out.file("residual_velocities.npy"));
    let table = fs::read_to_string(out.file("cells.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column = |name: &str| head.iter().position(|own| *own == name).unwrap();
    let [x, residual] = ["x", "residual_velocity_y"].map(column);
    for (cell, row) in lines.enumerate() {
        assert_eq!(row[x].parse(), Ok(nudged[(cell, 0)]));
        assert_eq!(row[residual].parse(), Ok(rest[(cell, 1)]));
    }
}

#[test]
fn formats_that_are_none_are_refused() {
    assert_arguments_refused(["evaluate", "--export", "shp"], &["shp", "csv, geojson, vtk and napari"]);
}
