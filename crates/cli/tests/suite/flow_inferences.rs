//! `infer` from velocities on a grid.

use crate::inferences::infer;
use crate::program::{assert_described, fixture};
use crate::refusal::assert_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array1, Array2, Array3};

/// Side of the periodic box of the chiral liquid.
const BOX: f64 = 10.0;
/// Grid points along an axis.
const POINTS: usize = 14;
/// Samples of a square along an axis.
const SAMPLES: usize = 24;

fn spacing() -> f64 {
    BOX / POINTS as f64
}

/// The velocity of the cell nearest to a place.
fn velocity_at(place: [f64; 2], positions: &Array2<f64>, velocities: &Array2<f64>) -> [f64; 2] {
    let across = |d: f64| d - BOX * (d / BOX).round();
    let distance = |cell: usize| {
        let [dx, dy] = [0, 1].map(|axis| across(positions[[cell, axis]] - place[axis]));
        dx * dx + dy * dy
    };
    let cells = 0..positions.nrows();
    let nearest = cells.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap();
    [velocities[[nearest, 0]], velocities[[nearest, 1]]]
}

/// Averages of the velocities of the clean chiral liquid over squares, from fine samples; rows from the top, as in
/// images.
fn flow_data() -> Folder {
    let data = Folder::copy_of("chiral-liquid-clean");
    let positions: Array2<f64> = read(&data.file("positions.npy"));
    let velocities: Array2<f64> = read(&data.file("velocities.npy"));
    let at = |index: usize| (index as f64 + 0.5) * spacing();
    let mut flow: Array3<f64> = Array3::zeros((POINTS, POINTS, 2));
    for row in 0..POINTS {
        for column in 0..POINTS {
            let centre = [at(column), at(POINTS - 1 - row)];
            for sample in 0..SAMPLES * SAMPLES {
                let within = [sample % SAMPLES, sample / SAMPLES]
                    .map(|index| ((index as f64 + 0.5) / SAMPLES as f64 - 0.5) * spacing());
                let v = velocity_at([0, 1].map(|axis| centre[axis] + within[axis]), &positions, &velocities);
                for axis in 0..2 {
                    flow[[row, column, axis]] += v[axis] / (SAMPLES * SAMPLES) as f64;
                }
            }
        }
    }
    data.write_array("flow.npy", &flow);
    data.write_array("flow_x.npy", &Array1::from_iter((0..POINTS).map(at)));
    data.write_array("flow_y.npy", &Array1::from_iter((0..POINTS).rev().map(at)));
    data.remove("velocities.npy");
    data
}

const FLAGS: &str = "--position-noise 0.5% --velocity-noise 1%";

#[test]
fn the_chirality_is_found_from_a_flow_field() {
    let data = flow_data();
    let mut flow: Array3<f64> = read(&data.file("flow.npy"));
    (flow[[2, 3, 0]], flow[[2, 3, 1]]) = (f64::NAN, f64::NAN);
    data.write_array("flow.npy", &flow);
    let settings = std::fs::read_to_string(data.file("dataset.toml")).unwrap();
    // The same files with y down are the mirror image, whose chirality is of the other sign.
    for (y_axis, truth) in [("up", 3.4), ("down", -3.4)] {
        data.write("dataset.toml", settings.replace("y_axis = \"up\"", &format!("y_axis = \"{y_axis}\"")));
        let out = infer(data.path(), FLAGS);
        assert_eq!(
            out.names(),
            [
                "latent_cells.npy",
                "nudged_positions.npy",
                "predicted_flow.npy",
                "predicted_velocities.npy",
                "report.html",
                "report.json",
                "residual_flow.npy"
            ]
        );
        let report = report(out.path());
        assert_described(&report);
        let found = number(&report, "/parameters/K_P_alpha/value");
        assert!((found - truth).abs() < 0.05 * 3.4, "{y_axis}: {found}");
        assert_eq!(report["flow"]["grid_points"], serde_json::json!([POINTS, POINTS]));
        assert!((number(&report, "/flow/spacing/0") - spacing()).abs() < 1e-12);
        assert_eq!(
            (&report["flow"]["window"], &report["measurement"]["window"]["declared"]),
            (&"square".into(), &false.into())
        );
        assert!((number(&report, "/flow/width") / spacing() - 1.0).abs() < 0.05);
        assert_eq!(report["measurement"]["window"]["tried"].as_array().unwrap().len(), 3);
        assert_eq!(report["cells"]["left_out"], serde_json::json!({"missing": 1}));
        assert_eq!(number(&report, "/cells/used"), (POINTS * POINTS - 1) as f64);
        let [predicted, residual]: [Array3<f64>; 2] =
            ["predicted_flow.npy", "residual_flow.npy"].map(|name| read(&out.file(name)));
        assert_eq!(predicted.dim(), flow.dim());
        for (place, &measured) in flow.indexed_iter() {
            let sum = predicted[place] + residual[place];
            assert!(predicted[place].is_finite(), "{place:?}");
            assert!(
                if measured.is_nan() { sum.is_nan() } else { (sum - measured).abs() < 1e-9 },
                "{place:?}"
            );
        }
        let page = std::fs::read_to_string(out.file("report.html")).unwrap();
        assert!(page.contains("grid points") && page.contains("no velocity (1)"));
    }
}

#[test]
fn a_gaussian_window_and_velocities_of_cells_can_be_chosen() {
    let data = flow_data();
    // These are averages over squares, which a Gaussian only comes near to.
    let gaussian = report(infer(data.path(), "--window gaussian --max-steps 20").path());
    assert_described(&gaussian);
    assert_eq!(gaussian["flow"]["window"], "gaussian");
    assert!((0.25..0.6).contains(&(number(&gaussian, "/flow/width") / spacing())));
    let wide = "--window gaussian --window-width 0.5 --max-steps 20";
    let wide = report(infer(data.path(), wide).path());
    assert_eq!(number(&wide, "/flow/width"), 0.5);
    assert!(
        wide["measurement"]["window"]["declared"] == true && wide["measurement"]["window"]["ci95"].is_null()
    );
    std::fs::copy(fixture("chiral-liquid-clean/velocities.npy"), data.file("velocities.npy")).unwrap();
    let of_cells = report(infer(data.path(), FLAGS).path());
    assert!(of_cells["flow"].is_null());
    assert_eq!(number(&of_cells, "/cells/used"), 100.0);
    let on_grid = report(infer(data.path(), "--data flow --max-steps 20").path());
    assert_eq!(number(&on_grid, "/cells/used"), (POINTS * POINTS) as f64);
}

#[test]
fn flow_options_without_a_flow_field_are_refused() {
    let data = fixture("chiral-liquid");
    let refused = |flags: &str, facts: &[&str]| {
        let flags: Vec<&str> = flags.split_whitespace().collect();
        assert_refused("infer", &data, &flags, facts);
    };
    refused("--data flow", &["flow.npy", "no flow field"]);
    refused("--window gaussian", &["--window is for flow fields"]);
    refused("--window-width 1", &["window_width is given but window is not"]);
    refused("--data sound", &["--data", "sound"]);
    let flow = flow_data();
    let path = flow.file("flow.npy");
    let flags = ["--flow", path.to_str().unwrap()];
    assert_refused("infer", &data, &flags, &["flow"]);
}

#[test]
fn flow_fields_that_cannot_be_used_are_refused() {
    let data = flow_data();
    let refused = |flags: &str, facts: &[&str]| {
        let flags: Vec<&str> = flags.split_whitespace().collect();
        assert_refused("infer", data.path(), &flags, facts);
    };
    refused("--window-width 1", &["window_width is given but window is not"]);
    refused("--window gaussian --window-width 0", &["window_width is 0", "above zero"]);
    refused("--window gaussian --window-width nan", &["window_width is NaN"]);
    refused("--window square --window-width 11", &["window_width is 11, but the box is 10 wide"]);
    refused("--window disc", &["disc", "gaussian-area"]);
    refused("--frames 3", &["frame 3 does not exist"]);
    refused("--data cells", &["there is one frame and no velocities"]);
    refused("--data cells --difference central", &["central differences need 3 frames"]);
    let mut flow: Array3<f64> = read(&data.file("flow.npy"));
    flow.fill(0.0);
    data.write_array("flow.npy", &flow);
    refused("", &["flow.npy", "velocities are zero"]);
    flow.fill(f64::NAN);
    data.write_array("flow.npy", &flow);
    refused("", &["flow.npy", "0 grid points"]);
    refused("--frames 0", &["flow.npy, frame 0", "no grid point has a velocity"]);
}
