//! `dataset.toml` and flags.

use ndarray::array;
use voronudge_io::{
    Boundary, DataSet, DeclaredWindow, Error, Noise, PositionsAre, Source, WindowKind, YAxis,
};

use crate::{Scratch, assert_told};

const LENGTHS: [f64; 2] = [10.0, 20.0];

/// Loads two cells with this `dataset.toml`.
fn load(toml: &str) -> Result<DataSet, Error> {
    load_with(toml.as_bytes(), Source::default())
}

fn load_with(toml: &[u8], source: Source) -> Result<DataSet, Error> {
    let scratch = Scratch::new();
    scratch.write_array("positions.npy", &array![[1.0, 2.0], [3.0, 4.0]]);
    scratch.write("dataset.toml", toml);
    let folder = Some(scratch.root().to_path_buf());
    Source { folder, ..source }.load()
}

#[test]
fn every_key_is_read() {
    let data = load(
        "boundary = \"periodic\"\nbox = [10, 20.0]\nframe_interval = 5\nlength_unit = \"µm\"\n\
         time_unit = \"min\"\ny_axis = \"down\"\nunwrapped = true\nposition_noise = \"2 %\"\n\
         velocity_noise = 0.1 # data units\npositions_are = \"centroids\"\nwindow = \"gaussian\"\nwindow_width = 3\n",
    )
    .unwrap();
    assert_eq!(data.boundary, Boundary::Periodic { lengths: LENGTHS });
    assert_eq!(data.frame_interval, 5.0);
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("µm", "min"));
    assert_eq!((data.y_axis, data.unwrapped), (YAxis::Down, true));
    assert_eq!(data.position_noise, Some(Noise::Relative(0.02)));
    assert_eq!(data.velocity_noise, Some(Noise::Absolute(0.1)));
    assert_eq!(data.positions_are, Some(PositionsAre::CENTROIDS));
    let declared = DeclaredWindow { kind: Some(WindowKind::Gaussian), width: Some(3.0) };
    assert_eq!(data.window, declared);
}

#[test]
fn all_but_the_boundary_has_a_default() {
    let data = load("boundary = \"open\"").unwrap();
    assert_eq!((data.boundary, data.frame_interval), (Boundary::Open, 1.0));
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("length", "time"));
    assert_eq!((data.y_axis, data.unwrapped), (YAxis::Up, false));
    assert_eq!((data.position_noise, data.velocity_noise), (None, None));
    assert_eq!((data.positions_are, data.window), (None, DeclaredWindow::default()));
}

#[test]
fn a_flag_wins_over_the_file() {
    let toml = b"boundary = \"open\"\nframe_interval = 5\nlength_unit = \"um\"\ntime_unit = \"h\"\n\
        y_axis = \"down\"\nunwrapped = true\nposition_noise = 1\nvelocity_noise = 2\npositions_are = \"sites\"";
    let flags = Source {
        boundary: Some(Boundary::Periodic { lengths: LENGTHS }),
        frame_interval: Some(7.0),
        length_unit: Some("px".into()),
        time_unit: Some("s".into()),
        y_axis: Some(YAxis::Up),
        unwrapped: Some(false),
        position_noise: Some(Noise::Absolute(3.0)),
        velocity_noise: Some(Noise::Relative(0.5)),
        positions_are: Some(PositionsAre::CENTROIDS),
        ..Source::default()
    };
    let data = load_with(toml, flags).unwrap();
    assert_eq!(data.boundary, Boundary::Periodic { lengths: LENGTHS });
    assert_eq!(data.frame_interval, 7.0);
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("px", "s"));
    assert_eq!((data.y_axis, data.unwrapped), (YAxis::Up, false));
    assert_eq!(data.position_noise, Some(Noise::Absolute(3.0)));
    assert_eq!(data.velocity_noise, Some(Noise::Relative(0.5)));
    assert_eq!(data.positions_are, Some(PositionsAre::CENTROIDS));
}

#[test]
fn a_boundary_flag_mends_an_incomplete_file() {
    let flags = Source { boundary: Some(Boundary::Open), ..Source::default() };
    assert!(load_with(b"boundary = \"periodic\"", flags).is_ok());
}

#[test]
fn unknown_keys_are_told_with_line_and_known_keys() {
    let facts = ["dataset.toml, line 3: unknown key \"frame_intervall\""];
    let toml = "boundary = \"open\"\n\nframe_intervall = 2\n";
    assert_told(load(toml), &facts, "boundary, box, box_offset, walls, frame_interval, length_unit");
    let facts = ["dataset.toml, line 2: unknown key \"microscope\""];
    assert_told(load("boundary = \"open\"\n[microscope]\n"), &facts, "y_axis");
}

#[test]
fn malformed_toml_is_told_with_its_line() {
    let facts = ["dataset.toml, line 2: malformed TOML"];
    assert_told(load("boundary = \"open\"\ny_axis = up\n"), &facts, "quotation");
    assert_told(load("y_axis = \"up\"\ny_axis = \"up\"\n"), &facts, "key = value");
    assert_told(load("y_axis = \"up\"\nbox = [1, 2"), &facts, "key = value");
    let not_text = load_with(b"\xff\xfe", Source::default());
    assert_told(not_text, &["dataset.toml: is not UTF-8 text"], "UTF-8");
}

#[test]
fn wrong_types_are_told() {
    for (entry, fact) in [
        ("boundary = 1", "boundary is a number, expected a text"),
        ("box = 3.0", "box is a number, expected two lengths"),
        ("box = [1, 2, 3]", "box is an array of another length"),
        ("box = [1, \"2\"]", "box is an array with other things"),
        ("frame_interval = \"2\"", "frame_interval is a text, expected a number"),
        ("length_unit = true", "length_unit is true or false, expected a text"),
        ("y_axis = 1979-05-27", "y_axis is a date, expected a text"),
        ("unwrapped = \"yes\"", "unwrapped is a text, expected true or false"),
        ("position_noise = [1]", "position_noise is an array, expected a number"),
        ("velocity_noise = {a = 1}", "velocity_noise is a table"),
        ("positions_are = true", "positions_are is true or false, expected \"sites\""),
        ("window = 2", "window is a number, expected a text"),
        ("window_width = \"2 px\"", "window_width is a text, expected a length"),
    ] {
        assert_told(load(entry), &["dataset.toml, line 1", fact], "quotation marks");
    }
}

#[test]
fn impossible_values_are_told() {
    let positive = "must be finite and above zero";
    for (entry, facts) in [
        ("box = [10, 0]", ["box length is 0", positive]),
        ("box = [-1.5, 2]", ["box length is -1.5", positive]),
        ("box = [inf, 2]", ["box length is inf", positive]),
        ("box = [2, nan]", ["box length is NaN", positive]),
        ("frame_interval = 0", ["frame_interval is 0", positive]),
        ("frame_interval = -inf", ["frame_interval is -inf", positive]),
        ("boundary = \"closed\"", ["boundary is \"closed\"", "\"periodic\" or \"open\""]),
        ("y_axis = \"Down\"", ["y_axis is \"Down\"", "\"up\" or \"down\""]),
        ("position_noise = \"two\"", ["position_noise is \"two\"", "\"2 %\""]),
        ("window_width = -2", ["window_width is -2", positive]),
        ("window = \"disc\"", ["window is \"disc\"", "\"gaussian-area\""]),
        ("positions_are = \"nuclei\"", ["positions_are is \"nuclei\"", "\"sites\", \"centroids\""]),
    ] {
        let advice = if facts[1] == positive { "positive number" } else { "as the message says" };
        let facts = ["dataset.toml, line 1", facts[0], facts[1]];
        assert_told(load(entry), &facts, advice);
    }
    for entry in ["velocity_noise = -1", "velocity_noise = \"-1 %\"", "velocity_noise = nan"] {
        let facts = ["line 1: velocity_noise is", "must be finite and not negative"];
        assert_told(load(entry), &facts, "leave it out");
    }
}

#[test]
fn a_position_is_somewhere_between_site_and_centroid() {
    let read = |entry: &str| {
        load(&format!("boundary = \"open\"\npositions_are = {entry}")).map(|data| data.positions_are)
    };
    assert_eq!(read("0.25").unwrap(), Some(PositionsAre::between(0.25).unwrap()));
    assert_eq!(read("1").unwrap(), Some(PositionsAre::CENTROIDS));
    assert_eq!(read("\"sites\"").unwrap(), Some(PositionsAre::SITES));
    for wrong in ["-0.1", "1.5", "nan"] {
        assert_told(read(wrong), &["line 2: positions_are is", "between 0 and 1"], "0 for sites");
    }
}

#[test]
fn a_window_has_a_kind_and_fits_into_the_box() {
    let settings = |rest: &str| format!("boundary = \"periodic\"\nbox = [9, 8]\n{rest}");
    assert!(load(&settings("window_width = 8\nwindow = \"square\"")).is_ok());
    let facts = ["line 4: window_width is 8.5, but the box is 8 wide"];
    assert_told(load(&settings("window = \"gaussian\"\nwindow_width = 8.5")), &facts, "length unit");
    let facts = ["line 3: window_width is given but window is not"];
    assert_told(load(&settings("window_width = 2")), &facts, "gaussian-area");
    // A flag that names another kind is not about the width of the file.
    let given = DeclaredWindow { kind: Some(WindowKind::Square), width: None };
    let toml = settings("window = \"gaussian\"\nwindow_width = 8.5");
    let data = load_with(toml.as_bytes(), Source { window: given, ..Source::default() }).unwrap();
    assert_eq!(data.window, given);
    let wide = DeclaredWindow { width: Some(10.0), ..given };
    let found = load_with(toml.as_bytes(), Source { window: wide, ..Source::default() });
    assert_told(found, &["window_width is 10, but the box is 8 wide"], "estimated");
}

#[test]
fn boundary_and_box_must_agree() {
    let facts = ["line 1: boundary is \"periodic\" but no box is given"];
    assert_told(load("boundary = \"periodic\""), &facts, "box = [Lx, Ly]");
    let facts = ["line 2: a box is given but the boundary is open"];
    assert_told(load("boundary = \"open\"\nbox = [9, 9]"), &facts, "remove box");
    let facts = ["line 1: a box is given but the boundary is not given"];
    assert_told(load("box = [9, 9]"), &facts, "boundary = \"periodic\"");
}

#[test]
fn a_missing_boundary_is_told() {
    let facts = ["the boundary is not given: neither by", "dataset.toml nor"];
    assert_told(load("y_axis = \"up\""), &facts, "--open or --box LX LY");
}

#[test]
fn impossible_flags_are_told() {
    let flag = |source| load_with(b"boundary = \"open\"", source);
    let lengths = [f64::NAN, 1.0];
    let source = Source { boundary: Some(Boundary::Periodic { lengths }), ..Source::default() };
    assert_told(flag(source), &["box length is NaN"], "positive number");
    let source = Source { frame_interval: Some(0.0), ..Source::default() };
    assert_told(flag(source), &["frame_interval is 0"], "positive number");
    let source = Source { position_noise: Some(Noise::Relative(-0.1)), ..Source::default() };
    assert_told(flag(source), &["position_noise is -0.1"], "leave it out");
}

#[test]
fn noise_reads_its_own_text_exactly() {
    assert_eq!("2%".parse::<Noise>().unwrap(), Noise::Relative(0.02));
    assert_eq!(" 1.5e1 % ".parse::<Noise>().unwrap(), Noise::Relative(0.15));
    assert_eq!("0".parse::<Noise>().unwrap(), Noise::Absolute(0.0));
    assert_eq!(Noise::Relative(0.02).to_string(), "2 %");
    assert_eq!(Noise::Relative(0.07).to_string(), "7 %", "not 7.000000000000001 %");
    for bad in ["", "%", "2 percent", "2 % %", "0x1"] {
        let facts = ["noise is", "expected a number"];
        assert_told(bad.parse::<Noise>(), &facts, "as the message says");
    }
    // Multiplying by 100 rounds for many of these; the text must not.
    for step in 0..2000 {
        for noise in [
            Noise::Relative(step as f64 / 997.0),
            Noise::Relative(step as f64 * 1e-320),
            Noise::Absolute((step as f64).exp2().min(f64::MAX)),
        ] {
            assert_eq!(noise.to_string().parse::<Noise>().unwrap(), noise, "{noise}");
        }
    }
}
