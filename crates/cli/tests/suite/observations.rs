//! `observe`: the same measurements on simulated and on measured cells.

use crate::program::{assert_described, fixture, succeed};
use crate::refusal::assert_refused;
use crate::scratch::{Folder, number, read, report};
use ndarray::{Array2, Array3, Array4, Axis, Slice};

/// A run is measured while it goes, by `simulate`, and afterwards from its files: displacements and ⟨v²⟩ are the same to rounding, T1 transitions but for those that
/// come and go between frames.
#[test]
fn what_is_measured_on_a_run_is_measured_on_its_files() {
    let (run, out) = (Folder::new(), Folder::new());
    let line = "simulate --cells 64 --P_0 4 --alpha 1 --time 8 --frames 400 --seed 3";
    succeed(line, &[("--out", run.path())]);
    succeed("observe", &[("", run.path()), ("--out", out.path())]);
    let (during, after) = (report(run.path()), report(out.path()));
    assert_described(&after);
    let told: Array2<f64> = read(&run.file("mean_square_displacement.npy"));
    let found: Array2<f64> = read(&out.file("mean_square_displacement.npy"));
    let mut compared = 0;
    for row in found.rows() {
        if let Some(same) = told.rows().into_iter().find(|other| (other[0] - row[0]).abs() < 1e-9) {
            // `simulate` takes every other frame.
            assert!((same[1] / row[1] - 1.0).abs() < 0.05, "{row} and {same}");
            compared += 1;
        }
    }
    assert!(compared > 5, "{compared} lags in both");
    let squares: Array2<f64> = read(&run.file("mean_square_velocity.npy"));
    let mean = squares.column(1).mean().unwrap();
    assert!((number(&after, "/numbers/mean_square_velocity/value") / mean - 1.0).abs() < 1e-9);
    // Most contacts that are made belong to one transition that can be told.
    let transitions: Array2<f64> = read(&out.file("t1.npy"));
    let told = transitions.nrows() as f64 / (64.0 * 8.0) / number(&after, "/numbers/t1_rate/value");
    assert!((0.7..1.01).contains(&told), "{told} of the transitions");
    succeed("observe --frames 200..400", &[("", run.path()), ("--out", out.path())]);
    let (steps, frames) =
        (number(&during, "/t1_rate"), number(&report(out.path()), "/numbers/t1_rate/value"));
    assert!((0.8..1.02).contains(&(frames / steps)), "{frames} of {steps}");
}

/// Seen through a window, a part of the cells missing for a frame, what is measured is that of the whole within its errors.
#[test]
fn a_field_of_view_shows_what_the_whole_is_like() {
    let (run, whole, part, seen) = (Folder::new(), Folder::new(), Folder::new(), Folder::new());
    let line = "simulate --cells 576 --P_0 3.9 --alpha 0.5 --time 12 --frames 24 --seed 5";
    succeed(line, &[("--out", run.path())]);
    succeed("observe", &[("", run.path()), ("--out", whole.path())]);
    let mut positions: Array3<f64> = read(&run.file("positions.npy"));
    // Cells in the middle of the box, in their own frame, each missing in one frame of twenty.
    for ((frame, cell, _), value) in positions.indexed_iter_mut() {
        if (frame * 7 + cell * 13) % 20 == 0 {
            *value = f64::NAN;
        }
    }
    for mut frame in positions.outer_iter_mut() {
        for mut r in frame.outer_iter_mut() {
            if !r.iter().all(|x| (1.0..23.0).contains(x)) {
                r.fill(f64::NAN);
            }
        }
    }
    let velocities: Array3<f64> = read(&run.file("velocities.npy"));
    part.write_array("positions.npy", &positions);
    part.write_array("velocities.npy", &velocities);
    part.write("dataset.toml", "boundary = \"open\"\nframe_interval = 0.5\nunwrapped = true\n");
    succeed("observe", &[("", part.path()), ("--out", seen.path())]);
    let (all, some) = (report(whole.path()), report(seen.path()));
    assert_described(&some);
    assert!(number(&some, "/counted/0") < 0.8 * number(&some, "/seen/0"));
    for name in ["mean_square_velocity", "mean_shape_index", "hexatic_mean_modulus"] {
        let [truth, found, error] = [
            number(&all, &format!("/numbers/{name}/value")),
            number(&some, &format!("/numbers/{name}/value")),
            number(&some, &format!("/numbers/{name}/standard_error")),
        ];
        // Missing cells make their neighbours larger and longer: a bias beside the error.
        assert!((found - truth).abs() < 4.0 * error + 0.02 * truth, "{name}: {found} ± {error}, {truth}");
    }
    for name in ["velocity_correlation", "velocity_autocorrelation"] {
        let [truth, found]: [Array2<f64>; 2] =
            [&whole, &seen].map(|folder| read(&folder.file(&format!("{name}.npy"))));
        for (found, truth) in found.rows().into_iter().zip(truth.rows()).take(6) {
            if found[3] > 300.0 {
                assert!((found[1] - truth[1]).abs() < 5.0 * found[2] + 0.05, "{name}: {found}, {truth}");
            }
        }
    }
}

/// Every transition belongs to one avalanche and to one burst; a longer threshold makes fewer of both, larger ones; a file whose y points down has the same.
#[test]
fn avalanches_of_transitions_are_told() {
    let (run, out, longer) = (Folder::new(), Folder::new(), Folder::new());
    let line = "simulate --cells 100 --P_0 3.9 --alpha 0.3 --shear-rate 0.05 --time 6 --frames 120 --seed 4";
    succeed(line, &[("--out", run.path())]);
    let parameters = run.file("report.json");
    let stress = ("--parameters", parameters.as_path());
    succeed("observe --stress", &[("", run.path()), stress, ("--out", out.path())]);
    succeed("observe --burst-time 0.5", &[("", run.path()), ("--out", longer.path())]);
    let (found, later) = (report(out.path()), report(longer.path()));
    assert_described(&found);
    assert_described(&later);
    let transitions: Array2<f64> = read(&out.file("t1.npy"));
    let counts = |folder: &Folder| {
        let all: Array2<f64> = read(&folder.file("avalanches.npy"));
        let of = |kind: f64| {
            all.rows().into_iter().filter(|row| row[0] == kind).map(|row| row[3]).collect::<Vec<_>>()
        };
        assert!(all.rows().into_iter().all(|row| row[1] <= row[2] && row[4] >= 4.0 && row[5] >= 0.0));
        let with_stress = all.rows().into_iter().filter(|row| row[9].is_finite()).count();
        let sizes = [of(0.0), of(1.0)];
        sizes.iter().for_each(|all| assert_eq!(all.iter().sum::<f64>(), transitions.nrows() as f64));
        (sizes.map(|all| all.len()), with_stress)
    };
    let ([local, whole], with_stress) = counts(&out);
    assert_eq!(with_stress, whole);
    assert_eq!(number(&found, "/avalanches/bursts"), whole as f64);
    let ([local_later, whole_later], without) = counts(&longer);
    assert!(local_later < local && whole_later < whole && whole < local && without == 0);
    let size = |report: &serde_json::Value| number(report, "/numbers/avalanche_size/value");
    assert!(size(&later) > size(&found) && size(&found) >= 1.0);
    let curve: Array2<f64> = read(&out.file("avalanche_size_by_time.npy"));
    assert!((curve[(0, 1)] - size(&found)).abs() < 1e-12);
    assert_refused("observe", run.path(), &["--burst-time", "-1"], &["--burst-time is -1"]);
}

#[test]
fn one_frame_without_velocities_has_no_motion_and_says_so() {
    let (data, cells, out) = (fixture("open-field"), Folder::new(), Folder::new());
    let positions: Array3<f64> = read(&data.join("positions.npy"));
    cells.write_array("positions.npy", &positions.slice_axis(Axis(0), Slice::from(..1)).to_owned());
    cells.write("dataset.toml", "boundary = \"open\"\n");
    let outcome = succeed("observe", &[("", cells.path()), ("--out", out.path())]);
    assert!(outcome.stderr.contains("nothing is said of motion"), "{}", outcome.stderr);
    let found = report(out.path());
    assert_described(&found);
    assert_eq!(found["velocities"], "none");
    assert!(found["numbers"].get("mean_square_velocity").is_none());
    assert!(found["curves"].get("mean_square_displacement").is_none());
    assert!(out.names().contains(&"shape_index.npy".to_owned()));
}

/// In a periodic box comets and three-armed defects are as many as each other; a file whose y points down shows the same defects, seen in its axes.
#[test]
fn defects_are_told_with_what_cells_do_around_them() {
    let (run, out, turned, seen) = (Folder::new(), Folder::new(), Folder::new(), Folder::new());
    succeed("simulate --cells 400 --P_0 4 --alpha 1 --time 4 --frames 4 --seed 8", &[("--out", run.path())]);
    let parameters = run.file("report.json");
    succeed(
        "observe --stress --director-width 1.2",
        &[("", run.path()), ("--parameters", &parameters), ("--out", out.path())],
    );
    let found = report(out.path());
    assert_described(&found);
    let [plus, minus] = ["plus", "minus"].map(|sign| found["nematic"][sign].as_u64().unwrap());
    assert!(plus == minus && plus > 20, "{plus} and {minus}");
    assert!((number(&found, "/nematic/stress_of/alpha") - 1.0).abs() < 1e-12);
    let defects: Array2<f64> = read(&out.file("defects.npy"));
    assert_eq!(defects.dim(), ((plus + minus) as usize, 5));
    let expected = (plus + minus) as f64 / (4.0 * 400.0);
    assert!((number(&found, "/numbers/defect_density/value") / expected - 1.0).abs() < 1e-9);
    for (what, components) in [("flow", 2), ("stress", 4)] {
        for sign in ["plus", "minus"] {
            let own: Array4<f64> = read(&out.file(&format!("{what}_around_{sign}.npy")));
            assert_eq!(own.dim(), (9, 9, components, 2));
            assert!(own.iter().filter(|value| value.is_finite()).count() > 9 * 9 * components);
        }
    }
    for name in ["positions.npy", "velocities.npy"] {
        let mut array: Array3<f64> = read(&run.file(name));
        array.index_axis_mut(Axis(2), 1).mapv_inplace(|y| -y);
        turned.write_array(name, &array);
    }
    let settings = std::fs::read_to_string(run.file("dataset.toml")).unwrap();
    turned.write("dataset.toml", settings.replace("y_axis = \"up\"", "y_axis = \"down\""));
    succeed("observe --director-width 1.2", &[("", turned.path()), ("--out", seen.path())]);
    let mut mirrored: Array2<f64> = read(&seen.file("defects.npy"));
    let side = 20.0;
    for mut row in mirrored.rows_mut() {
        row[2] = (-row[2]).rem_euclid(side);
        row[4] = -row[4];
    }
    let mut near = 0;
    for own in defects.rows() {
        let is_same = |other: &ndarray::ArrayView1<'_, f64>| {
            let d = [1, 2].map(|axis| (own[axis] - other[axis] + 0.5 * side).rem_euclid(side) - 0.5 * side);
            own[0] == other[0]
                && own[3] == other[3]
                && d[0].hypot(d[1]) < 1e-6
                && (own[4] - other[4]).sin().abs() < 1e-6
        };
        near += usize::from(mirrored.rows().into_iter().any(|other| is_same(&other)));
    }
    assert_eq!(near, defects.nrows());
}

#[test]
fn what_cannot_be_asked_of_shapes_is_refused() {
    let cells = fixture("chiral-liquid");
    assert_refused("observe", &cells, &["--director-width", "50"], &["smoothed over 50 spacings", "at most"]);
    assert_refused("observe", &cells, &["--director-width", "-1"], &["must be positive"]);
    assert_refused("observe", &cells, &["--P_0", "4"], &["nothing is asked of it"]);
}

#[test]
fn too_few_cells_are_refused_with_a_hint() {
    let few = Array3::from_shape_fn((1, 5, 2), |(_, cell, axis)| ((cell * 7 + axis * 3) % 5) as f64);
    let cells = Folder::data_set(&few, "boundary = \"open\"\n");
    assert_refused("observe", cells.path(), &[], &["positions.npy: no cell has all its neighbours in view"]);
}
