//! Where every cell would have been seen: as declared, as given, and as what cannot be.

use crate::inferences::infer;
use crate::program::{assert_described, fixture, succeed};
use crate::refusal::{assert_refused, assert_unreadable};
use crate::scratch::{Folder, number, report};
use serde_json::json;

/// The open fixture, y down, with a line added to its settings.
fn declared(line: &str) -> Folder {
    let folder = Folder::copy_of("open-field");
    let settings = std::fs::read_to_string(folder.file("dataset.toml")).unwrap();
    folder.write("dataset.toml", format!("{settings}{line}\n"));
    folder
}

/// Its cells lie within 43.7 … 355.6 along x and 47.6 … 355.9 along y.
const RECTANGLE: &str = "field_of_view = [40, 44, 360, 360]";

/// One frame with the velocities of its neighbours in time.
const FRAME: &str = "--frames 2 --difference central";

#[test]
fn impossible_fields_of_view_are_refused() {
    let cases = [
        ("field_of_view = [40, 44, 360, 300]", vec!["positions.npy", "frame 0", "cell 0", "outside"]),
        // Right only if y pointed up.
        ("field_of_view = [40, -360, 360, -44]", vec!["positions.npy", "frame 0, cell 0", "outside"]),
        ("field_of_view = [40, 44, 40, 360]", vec!["dataset.toml, line 6", "no area"]),
        (
            "field_of_view = [[0, 0], [400, 400], [400, 0], [0, 300]]",
            vec!["line 6", "sides 0 and 2", "cross"],
        ),
        ("field_of_view = [[0, 0], [400, 400], [0, 400], [inf, 0]]", vec!["line 6", "corner 3"]),
        ("field_of_view = [[0, 0], [400, 400]]", vec!["line 6", "2 corners"]),
        ("field_of_view = [0, 0, 400]", vec!["line 6", "array of another form"]),
        ("field_of_view = \"all\"", vec!["line 6", "a text"]),
    ];
    for (line, facts) in cases {
        let folder = declared(line);
        assert_unreadable(folder.path(), &[], &facts);
    }
    let open = fixture("open-field");
    let flags = ["--field-of-view", "40", "44", "360", "300"];
    assert_refused("infer", &open, &flags, &["positions.npy", "frame 0", "cell 0"]);
    let boxed = fixture("chiral-liquid");
    assert_refused("infer", &boxed, &flags, &["field_of_view", "periodic"]);
}

#[test]
fn a_declared_field_of_view_keeps_more_cells_than_the_hull() {
    let out = infer(&fixture("open-field"), FRAME);
    let hull = report(out.path());
    assert_described(&hull);
    assert_eq!(hull["measurement"]["field_of_view"]["source"], "hull");
    assert_eq!(hull["measurement"]["field_of_view"]["corners"], json!(null));
    let folder = declared(RECTANGLE);
    let out = infer(folder.path(), FRAME);
    let stated = report(out.path());
    assert_described(&stated);
    let view = &stated["measurement"]["field_of_view"];
    assert_eq!(view["source"], "data_set");
    assert_eq!(view["corners"], json!([[40.0, 44.0], [360.0, 44.0], [360.0, 360.0], [40.0, 360.0]]));
    let certain = |report| number(report, "/measurement/certain");
    assert!(certain(&stated) > certain(&hull), "{} > {}", certain(&stated), certain(&hull));
    assert_eq!(number(&stated, "/cells/used"), certain(&stated));
    // Given on the command line, it wins.
    let out = infer(folder.path(), &format!("{FRAME} --field-of-view 0 0 400 400"));
    let given = report(out.path());
    assert_eq!(given["measurement"]["field_of_view"]["source"], "given");
    assert!(certain(&given) > certain(&stated));
    let all = |report| certain(report) + number(report, "/measurement/uncertain");
    assert_eq!(all(&given), all(&stated));
}

#[test]
fn other_commands_know_the_field_of_view() {
    let counted = |folder: &Folder| {
        let out = Folder::new();
        succeed("evaluate --frames 2", &[("", folder.path()), ("--out", out.path())]);
        number(&report(out.path()), "/cells/counted/0")
    };
    assert!(counted(&declared(RECTANGLE)) > counted(&declared("")));
}
