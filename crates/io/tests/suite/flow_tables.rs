//! Imports of tables of vectors.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

use flate2::Compression;
use flate2::write::GzEncoder;
use voronudge_io::{
    Error, FlowColumnNames, FlowField, FlowImport, FlowOptions, ImageScale, YAxis, import_flow,
};

use crate::{Scratch, assert_told};

const NAN: f64 = f64::NAN;

fn up() -> FlowOptions {
    FlowOptions {
        scale: ImageScale { y_axis: Some(YAxis::Up), ..ImageScale::default() },
        ..FlowOptions::default()
    }
}

fn import(text: impl AsRef<[u8]>) -> Result<FlowImport, Error> {
    import_with(text, FlowColumnNames::default())
}

fn import_with(text: impl AsRef<[u8]>, columns: FlowColumnNames) -> Result<FlowImport, Error> {
    let scratch = Scratch::new();
    import_flow(&[scratch.write("piv.txt", text)], &FlowOptions { columns, ..up() })
}

fn several(texts: &[&str]) -> Result<FlowImport, Error> {
    let scratch = Scratch::new();
    let write = |(index, text): (usize, &&str)| scratch.write(&format!("piv-{index}.txt"), text);
    let files: Vec<PathBuf> = texts.iter().enumerate().map(write).collect();
    import_flow(&files, &up())
}

/// x, y, u, v of a grid of 3 columns 16 apart and 2 rows 8 apart, the rows from above.
const ROWS: [[f64; 4]; 6] = [
    [16.0, 20.0, 1.0, -1.0],
    [32.0, 20.0, 2.0, -2.0],
    [48.0, 20.0, 3.0, -3.0],
    [16.0, 12.0, 4.0, -4.0],
    [32.0, 12.0, 5.0, -5.0],
    [48.0, 12.0, 6.0, -6.0],
];

fn lines(rows: &[[f64; 4]], separator: &str) -> String {
    rows.iter().fold(String::new(), |mut text, row| {
        let fields: Vec<String> = row.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", fields.join(separator));
        text
    })
}

/// Asserts the grid of `ROWS`, with NaN for the rows left out.
#[track_caller]
fn assert_rows(import: Result<FlowImport, Error>, left_out: &[usize]) {
    let import = import.unwrap();
    assert_eq!(import.summary.missing, left_out.len());
    let flow = import.dataset.flow.unwrap();
    assert_eq!(
        (flow.x.as_slice(), flow.y.as_slice()),
        ([16.0, 32.0, 48.0].as_slice(), [12.0, 20.0].as_slice())
    );
    for (index, [_, _, u, v]) in ROWS.into_iter().enumerate() {
        let expected = if left_out.contains(&index) { [NAN; 2] } else { [u, v] };
        let found = [0, 1].map(|axis| flow.velocities[[0, 1 - index / 3, index % 3, axis]]);
        let same = found.iter().zip(expected).all(|(a, b)| *a == b || (a.is_nan() && b.is_nan()));
        assert!(same, "row {index}: {found:?}, not {expected:?}");
    }
}

#[test]
fn every_separator_is_recognised() {
    for separator in [",", ";", "\t", " ", "   ", ", ", " \t "] {
        assert_rows(
            import(format!("{}\n{}", ["x", "y", "u", "v"].join(separator), lines(&ROWS, separator))),
            &[],
        );
        assert_rows(import(lines(&ROWS, separator)), &[]);
    }
    assert_rows(import(lines(&ROWS, ",").replace('\n', "\r\n")), &[]);
    assert_rows(import(lines(&ROWS, " ").replace('\n', "  \r\n\r\n")), &[]);
    // A separator at the end of each line.
    assert_rows(import(format!("x,y,u,v\n{}", lines(&ROWS, ",").replace('\n', ",\n"))), &[]);
}

#[test]
fn rows_may_come_in_any_order() {
    for order in [[5, 4, 3, 2, 1, 0], [3, 0, 5, 1, 4, 2]] {
        assert_rows(import(lines(&order.map(|row| ROWS[row]), " ")), &[]);
    }
}

#[test]
fn columns_may_come_in_any_order_under_any_usual_name() {
    let reordered: Vec<[f64; 4]> = ROWS.iter().map(|[x, y, u, v]| [*v, *u, *y, *x]).collect();
    for header in
        ["v,u,y,x", "V, U ,Y,X", "v [px/frame],u [px/frame],y [px],x [px]", "dy,dx,Y_Position,pos x"]
    {
        assert_rows(import(format!("{header}\n{}", lines(&reordered, ","))), &[]);
    }
    let name = |name: &str| Some(name.to_owned());
    let columns =
        FlowColumnNames { x: name("a (m)"), y: name("B"), u: name("c"), v: name("d"), ..Default::default() };
    assert_rows(import_with(format!("d,c,b,a (m)\n{}", lines(&reordered, ",")), columns), &[]);
}

#[test]
fn exports_of_openpiv_are_read() {
    // As numpy.savetxt writes them: a mark before the header, %.4e, tabs.
    let mut text = "# x\ty\tu\tv\tflags\tmask\n".to_owned();
    for (index, [x, y, u, v]) in ROWS.into_iter().enumerate() {
        let mask = f64::from(u8::from(index == 4));
        let _ = writeln!(text, "{x:.4e}\t{y:.4e}\t{u:.4e}\t{v:.4e}\t{:.4e}\t{mask:.4e}", 1.0);
    }
    assert_rows(import(&text), &[4]);
    assert_rows(import(text.replace('\t', " ")), &[4]);
    // Flags mark vectors that were replaced; they are left out on request only.
    let columns = FlowColumnNames { mask: Some("flags".into()), ..FlowColumnNames::default() };
    let flow = import_with(&text, columns).unwrap();
    assert_eq!(flow.summary.missing, 6);
}

#[test]
fn exports_of_pivlab_are_read() {
    let names = ["x [px]", "y [px]", "u [px/frame]", "v [px/frame]", "vector type [-]"];
    for separator in [",", "\t", " "] {
        let mut text = format!(
            "PIVlab by W.Th. & E.J.S., ASCII chart output - 21-Nov-2025\n\
             FRAME: 1, filenames: A: a_01.tif & B: a_02.tif, conversion factor xy (px -> m): 1\n{}\n",
            names.join(separator)
        );
        for [x, y, u, v] in ROWS {
            let [u, v, kind] = if u == 2.0 {
                ["NaN".into(), "NaN".into(), "0".into()]
            } else {
                [u, v, 1.0].map(|n| n.to_string())
            };
            let fields = [x.to_string(), y.to_string(), u, v, kind];
            let _ = writeln!(text, "{}", fields.join(separator));
        }
        let import = import(&text);
        assert_eq!(import.as_ref().unwrap().summary.stated_unit.as_deref(), Some("px/frame"));
        assert_rows(import, &[1]);
    }
}

#[test]
fn points_without_a_row_are_missing() {
    assert_rows(import(lines(&ROWS[..5], ",")), &[5]);
    // Even where a whole column has none.
    let rows: Vec<[f64; 4]> = [0.0, 1.0, 2.0, 4.0, 5.0]
        .into_iter()
        .flat_map(|x| [[x, 0.0, 1.0, 1.0], [x, 1.0, 1.0, 1.0]])
        .collect();
    let import = import(lines(&rows, " ")).unwrap();
    assert_eq!((import.summary.columns, import.summary.missing), (6, 2));
    let empty = lines(&ROWS, ",").replace("2,-2", ",");
    assert_rows(self::import(format!("x,y,u,v\n{empty}")), &[1]);
}

#[test]
fn digits_that_were_not_printed_do_no_harm() {
    let spacing = 16.0 * 0.325e-6;
    let mut text = String::from("x [m],y [m],u [m/s],v [m/s]\n");
    for row in 1..=100 {
        for column in 1..=120 {
            let _ =
                writeln!(text, "{:.4e},{:.4e},1e-8,0", f64::from(column) * spacing, f64::from(row) * spacing);
        }
    }
    let import = import(text).unwrap();
    assert_eq!((import.summary.rows, import.summary.columns, import.summary.missing), (100, 120, 0));
    assert!((import.summary.spacing[0] / spacing - 1.0).abs() < 1e-3);
    assert_eq!(import.summary.stated_unit.as_deref(), Some("m/s"));
}

#[test]
fn lengths_are_scaled_and_y_is_turned() {
    let scratch = Scratch::new();
    let table = scratch.write("piv.txt", lines(&ROWS, " "));
    let options = FlowOptions {
        scale: ImageScale { pixel_size: Some(0.5), frame_interval: Some(2.0), ..ImageScale::default() },
        ..FlowOptions::default()
    };
    let flow: FlowField = import_flow(&[table], &options).unwrap().dataset.flow.unwrap();
    assert_eq!((flow.x, flow.y), (vec![8.0, 16.0, 24.0], vec![-6.0, -10.0]));
    // (6, -6) pixels per frame at (48, 12).
    assert_eq!([0, 1].map(|axis| flow.velocities[[0, 0, 2, axis]]), [1.5, 1.5]);
}

#[test]
fn frames_come_from_a_column_or_from_files() {
    let mut text = String::from("frame,x,y,u,v\n");
    for (frame, sign) in [(7, -1.0), (5, 1.0)] {
        for [x, y, u, v] in ROWS {
            let _ = writeln!(text, "{frame},{x},{y},{},{}", sign * u, sign * v);
        }
    }
    let one = import(&text).unwrap();
    // Frame 6 has no row.
    assert_eq!((one.summary.frames, one.summary.first_frame, one.summary.missing), (3, 5, 6));
    let one = one.dataset.flow.unwrap().velocities;
    assert_eq!((one[[0, 1, 2, 0]], one[[2, 1, 2, 0]]), (3.0, -3.0));
    let negative = ROWS.map(|[x, y, u, v]| [x, y, -u, -v]);
    let two = several(&[&lines(&ROWS, ","), &lines(&negative, " ")]).unwrap();
    assert_eq!((two.summary.frames, two.dataset.inputs.len()), (2, 2));
    let two = two.dataset.flow.unwrap().velocities;
    assert_eq!(two.index_axis(ndarray::Axis(0), 0), one.index_axis(ndarray::Axis(0), 0));
    assert_eq!(two.index_axis(ndarray::Axis(0), 1), one.index_axis(ndarray::Axis(0), 2));
    let facts = ["piv-1.txt: holds 3 frames"];
    assert_told(several(&[&lines(&ROWS, ","), &text]), &facts, "this file alone");
}

#[test]
fn compressed_tables_are_read() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(lines(&ROWS, "\t").as_bytes()).unwrap();
    let bytes = encoder.finish().unwrap();
    assert_rows(import(&bytes), &[]);
    assert_told(import(&bytes[..bytes.len() / 2]), &["cannot be decompressed"], "cut");
}

#[test]
fn rows_off_the_grid_are_told_with_their_line() {
    let text = |row: &str| format!("x,y,u,v\r\n\r\n{}{row}\r\n", lines(&ROWS, ",").replace('\n', "\r\n"));
    let facts = ["piv.txt, line 9: x is 40, but the points of the grid are at 16 and every 16 from there"];
    assert_told(import(text("40,12,1,1")), &facts, "rectangular grid");
    assert_told(import(text("16,25,1,1")), &["piv.txt, line 9: y is 25"], "rectangular grid");
    let facts = ["piv.txt, line 9: a second row for the grid point (32, 12) in frame 0"];
    assert_told(import(text("32,12,1,1")), &facts, "--frame-column");
    assert_told(import(lines(&ROWS[..3], ",")), &["number of grid points along y is 1"], "2 × 2");
    let scattered: Vec<[f64; 4]> =
        (0..400_u32).map(|k| [f64::from(k), f64::from(k * 7919 % 401), 1.0, 1.0]).collect();
    assert_told(import(lines(&scattered, ",")), &["has 400 rows for a grid of"], "import tracks");
    let far = lines(&[[1e300, 12.0, 1.0, 1.0]], ",");
    assert_told(import(text(&far)), &["has 7 rows for a grid of"], "rectangular grid");
    let mut wide = String::from("x,y,u,v,frame\n");
    for k in 0..40 {
        let _ = writeln!(wide, "{},{},1,1,{}", k % 8, k / 8, 99_999 * (k / 39));
    }
    assert!(import(&wide).is_ok());
    assert_told(import(wide.replace(",99999", ",100000")), &["more than 100000 frames"], "counts images");
}

#[test]
fn grids_beyond_reason_are_told_before_they_are_made() {
    let mut text = String::from("frame x y u v\n");
    for frame in [0, 90_000] {
        for point in 0..1600 {
            let _ = writeln!(text, "{frame} {} {} 1 1", point % 40, point / 40);
        }
    }
    assert_told(import(text), &["90001 frames of 1600 grid points need", "limit"], "fewer frames");
}

#[test]
fn tables_that_cannot_be_meant_are_told() {
    let with = |header: &str| import(format!("{header}\n{}", lines(&ROWS, ",")));
    let facts =
        ["piv.txt, line 1: no column for the displacement along x: looked for u, dx", "found x, y, p, q"];
    assert_told(with("x,y,p,q"), &facts, "--u-column");
    assert_told(with("# x,y,p,q"), &facts, "--u-column");
    assert_told(import("x,y,u,v\n"), &["no data rows"], "export");
    assert_told(import("\n\n"), &["is empty"], "export");
    assert_told(import(""), &["is empty"], "export");
    assert_told(
        import(b"MATLAB 5.0 MAT-file\0\0\x01"),
        &["piv.txt: cannot be read as a file of MATLAB"],
        "as text",
    );
    assert_told(import(b"MATLAB 7.3 MAT-file, Platform"), &["is a MATLAB file of version 7.3"], "\"-v7\"");
    assert_told(import(b"1,2,3,4\n\0\0"), &["piv.txt: is not text"], "as text");
    assert_told(import("1 2 3\n4 5 6\n"), &["line 2: no column for the x coordinate"], "name the columns");
    let quoted = format!("x,y,u,v\n\"1,1,1,1\n{}", lines(&ROWS, ","));
    assert_told(import(quoted), &["line 2: has 1 fields"], "cut");
    let quoted = format!("x,y,\"u,v\n{}", lines(&ROWS, ","));
    assert_told(import(quoted), &["found x, y, u,v 16,20", "…"], "name the columns");
    let bad = |row: &str| import(format!("# made by hand\nx,y,u,v\n{row}\n{}", lines(&ROWS, ",")));
    assert_told(bad("east,0,0,0"), &["line 3: column \"x\" holds \"east\", a finite number"], "this row");
    assert_told(bad("nan,0,0,0"), &["line 3: column \"x\" holds \"nan\""], "this row");
    assert_told(
        bad("0,0,inf,0"),
        &["line 3: column \"u\" holds \"inf\", a finite number or NaN"],
        "this row",
    );
    assert_told(bad("0,0,nan,0"), &["line 3: half of the displacement is missing (\"nan\", \"0\")"], "both");
    assert_told(bad("0,0,1"), &["line 3: has 3 fields, the header has 4"], "cut");
    assert_told(bad("0,0,1,1,1"), &["line 3: has 5 fields"], "cut");
    let mut masked = String::from("x y u v mask\n0 0 1 1 no\n");
    masked += &lines(&ROWS, " ").replace('\n', " 0\n");
    assert_told(import(masked), &["line 2: column \"mask\" holds \"no\""], "this row");
    let columns = FlowColumnNames { u: Some("dx".into()), ..FlowColumnNames::default() };
    assert_told(import_with(lines(&ROWS, ","), columns), &["line 1: begins with numbers"], "line of names");
    let scratch = Scratch::new();
    let options = FlowOptions { grid_spacing: Some(32.0), ..up() };
    let table = [scratch.write("piv.txt", lines(&ROWS, ","))];
    let facts = ["piv.txt: is a table, whose grid stays as it is"];
    assert_told(import_flow(&table, &options), &facts, "--grid-spacing");
}
