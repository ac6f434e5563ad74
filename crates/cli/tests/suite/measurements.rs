//! What a data set says of how its cells were measured.

use crate::inferences::infer;
use crate::program::{fixture, voronudge};
use crate::refusal::assert_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3};
use std::ffi::OsStr;
use voronudge_geometry::{CellPolygon, Domain, PeriodicBox, Tessellation, Vector};

/// The clean chiral liquid with centroids for positions.
fn centroids() -> Folder {
    let data = Folder::copy_of("chiral-liquid-clean");
    let sites: Array2<f64> = read(&data.file("positions.npy"));
    let positions: Vec<Vector<f64>> = sites.outer_iter().map(|r| Vector::new(r[0], r[1])).collect();
    let domain = Domain::Periodic(PeriodicBox::new([10.0, 10.0]).unwrap());
    let tessellation = Tessellation::new(&positions, domain).unwrap();
    let mut polygon = CellPolygon::default();
    let centroids = Array2::from_shape_fn(sites.dim(), |(cell, axis)| {
        polygon.fill(&tessellation, &positions, cell);
        (positions[cell] + polygon.centroid())[axis]
    });
    data.write_array("positions.npy", &centroids);
    data
}

const NOISE: &str = "--position-noise 0.5% --velocity-noise 1%";

/// Declared or not, centroids are taken for what they are; taken for sites they spoil the fit.
#[test]
fn centroids_give_the_chirality_too() {
    let data = centroids();
    let truth = 3.4;
    let off = |flags: &str| {
        let found = report(infer(data.path(), &format!("{NOISE} {flags}")).path());
        (
            number(&found, "/parameters/K_P_alpha/value") / truth - 1.0,
            found["measurement"]["positions"].clone(),
        )
    };
    let (error, positions) = off("--positions-are centroids");
    assert!(error.abs() < 0.03, "{error}");
    assert_eq!((&positions["source"], &positions["are"]), (&"declared".into(), &"centroids".into()));
    let (error, positions) = off("");
    assert!(error.abs() < 0.03, "{error}");
    assert_eq!((&positions["source"], &positions["are"]), (&"estimated".into(), &"centroids".into()));
    // A fit that nobody should trust.
    let out = Folder::new();
    let line = format!("infer {NOISE} --positions-are sites --max-steps 20");
    let mut arguments: Vec<&OsStr> = line.split_whitespace().map(OsStr::new).collect();
    arguments.extend([data.path().as_os_str(), "--out".as_ref(), out.path().as_os_str()]);
    assert_eq!(voronudge(arguments).code, Some(1));
    let found = report(out.path());
    assert_eq!(found["fit"]["trustworthy"], false);
    let error = number(&found, "/parameters/K_P_alpha/value") / truth - 1.0;
    assert!(error.abs() > 0.05, "{error}");
}

/// Errors of single cells are the noise of the positions, and say which positions move.
#[test]
fn cells_have_errors_of_their_own() {
    let data = Folder::copy_of("chiral-liquid-clean");
    let positions: Array2<f64> = read(&data.file("positions.npy"));
    let errors =
        ndarray::Array1::from_shape_fn(positions.nrows(), |cell| if cell % 2 == 0 { 0.03 } else { 0.003 });
    data.write_array("position_errors.npy", &errors);
    let out = infer(data.path(), "--positions-are sites");
    let found = report(out.path());
    assert_eq!(found["measurement"]["positions"]["own_errors"], true);
    // The median.
    assert!((number(&found, "/noise/sigma_r") / 0.03 - 1.0).abs() < 1e-9);
    let nudged: Array2<f64> = read(&out.file("nudged_positions.npy"));
    let mut moved = [0.0; 2];
    for (cell, step) in (&nudged - &positions).outer_iter().enumerate() {
        moved[cell % 2] += step.dot(&step);
    }
    assert!(moved[0] > 5.0 * moved[1], "{moved:?}");
}

#[test]
fn what_cannot_be_said_of_a_measurement_is_refused() {
    let data = fixture("chiral-liquid");
    let refused = |flags: &[&str], facts: &[&str]| assert_refused("infer", &data, flags, facts);
    refused(&["--positions-are", "1.5"], &["positions_are is 1.5", "between 0 and 1"]);
    refused(&["--positions-are", "nuclei"], &["nuclei", "centroids"]);
    refused(&["--position-errors", "nowhere.npy"], &["nowhere.npy"]);
}

/// A cell that no frame shows, and one that is lost on the way, are put back into their tracks.
#[test]
#[ignore = "slow"]
fn cells_that_tracks_lack_are_found() {
    let data = Folder::copy_of("open-field");
    let mut positions: Array3<f64> = read(&data.file("positions.npy"));
    let truth = positions.clone();
    let (hidden, lost) = (114, 143);
    for ((frame, cell, _), place) in positions.indexed_iter_mut() {
        if cell == hidden || cell == lost && frame >= 3 {
            *place = f64::NAN;
        }
    }
    data.write_array("positions.npy", &positions);
    let out = infer(data.path(), "");
    let found = report(out.path());
    let measured = &found["measurement"];
    assert_eq!((&measured["latent"]["inserted"], &measured["tracks"]["ended"]), (&5.into(), &0.into()));
    let error = number(&found, "/parameters/K_P_alpha/value") / 0.02 - 1.0;
    assert!(error.abs() < 0.02, "{error}");
    let latent: Array2<f64> = read(&out.file("latent_cells.npy"));
    let trajectories: Array3<f64> = read(&out.file("trajectories.npy"));
    for frame in 0..5 {
        let miss =
            |x: f64, y: f64, cell: usize| (x - truth[(frame, cell, 0)]).hypot(y - truth[(frame, cell, 1)]);
        assert_eq!(latent[(frame, 2)], frame as f64);
        assert!(miss(latent[(frame, 0)], latent[(frame, 1)], hidden) < 0.5);
        assert!(miss(trajectories[(frame, lost, 0)], trajectories[(frame, lost, 1)], lost) < 0.5);
    }
    // Without them the fit says so.
    let out = infer(data.path(), "--complete false");
    let found = report(out.path());
    assert!(found["measurement"]["latent"].is_null());
    assert_eq!(found["verdict"]["kind"], "measurement_misfit");
}
