//! Imports of track tables.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use ndarray::array;
use voronudge_io::{
    Boundary, ColumnNames, Error, ImageScale, Import, ImportOptions, ImportSummary, YAxis, import_trackmate,
    import_tracks,
};

use crate::{Scratch, assert_told};

const NAN: f64 = f64::NAN;

fn trackmate(text: impl AsRef<[u8]>) -> Result<Import, Error> {
    trackmate_with(text, &ImportOptions::default())
}

fn trackmate_with(text: impl AsRef<[u8]>, options: &ImportOptions) -> Result<Import, Error> {
    let scratch = Scratch::new();
    import_trackmate(&scratch.write("spots.csv", text), options)
}

fn tracks(text: impl AsRef<[u8]>) -> Result<Import, Error> {
    tracks_with(text, ColumnNames::default())
}

fn tracks_with(text: impl AsRef<[u8]>, columns: ColumnNames) -> Result<Import, Error> {
    let scratch = Scratch::new();
    let options = ImportOptions {
        scale: ImageScale { y_axis: Some(YAxis::Up), ..ImageScale::default() },
        columns,
        ..ImportOptions::default()
    };
    import_tracks(&scratch.write("tracks.csv", text), &options)
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

#[track_caller]
fn assert_positions(import: &Import, expected: &ndarray::Array3<f64>) {
    let positions = &import.dataset.positions;
    assert_eq!(positions.dim(), expected.dim());
    for (found, wanted) in positions.iter().zip(expected) {
        assert!(found == wanted || (found.is_nan() && wanted.is_nan()), "{positions}");
    }
}

/// The layout of TrackMate 7: three more rows below the header, a unit, an untracked spot, a
/// split in frame 1 and a gap in track 5.
const EXPORT: &str = "\
LABEL,ID,TRACK_ID,QUALITY,POSITION_X,POSITION_Y,FRAME
Label,Spot ID,Track ID,Quality,X,Y,Frame
Label,Spot ID,Track ID,Quality,X,Y,Frame
,,,(quality),(micron),(micron),
ID1,1,7,1.0,10.0,20.0,3
ID2,2,5,1.0,30.0,40.0,3
ID3,3,7,1.0,11.0,21.0,4
ID4,4,7,1.0,99.0,99.0,4
ID5,5,,1.0,50.0,60.0,4
ID6,6,5,1.0,32.0,42.0,5
";

#[test]
fn a_trackmate_export_becomes_a_data_set() {
    let import = trackmate(EXPORT).unwrap();
    let expected =
        array![[[30.0, -40.0], [10.0, -20.0]], [[NAN, NAN], [11.0, -21.0]], [[32.0, -42.0], [NAN, NAN]],];
    assert_positions(&import, &expected);
    assert_eq!(import.track_ids, [5, 7]);
    let summary = ImportSummary {
        frames: 3,
        first_frame: 3,
        empty_frames: 0,
        tracks: 2,
        spots: 4,
        left_out_untracked: 1,
        left_out_duplicate: 1,
    };
    assert_eq!(import.summary, summary);
    let data = &import.dataset;
    assert_eq!((data.boundary, data.y_axis), (Boundary::Open, YAxis::Down));
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("micron", "frame"));
    assert_eq!(data.inputs.len(), 1);
    data.check().unwrap();
}

#[test]
fn short_column_names_without_extra_rows_are_read() {
    let import = trackmate("Frame,X,Y,TRACK_ID\n0.0,1.5,2.5,0.0\n1.0,1.75,2.25,0.0\n").unwrap();
    assert_positions(&import, &array![[[1.5, -2.5]], [[1.75, -2.25]]]);
    assert_eq!(import.dataset.length_unit, "length");
}

#[test]
fn options_say_what_the_table_does_not() {
    let options = ImportOptions {
        scale: ImageScale {
            pixel_size: Some(0.5),
            length_unit: Some("µm".into()),
            time_unit: Some("min".into()),
            frame_interval: Some(10.0),
            y_axis: Some(YAxis::Up),
        },
        boundary: Some(Boundary::Periodic { lengths: [100.0, 100.0] }),
        ..ImportOptions::default()
    };
    let data = trackmate_with(EXPORT, &options).unwrap().dataset;
    assert_eq!(data.positions[[0, 0, 0]], 15.0);
    assert_eq!(data.positions[[0, 0, 1]], 20.0);
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("µm", "min"));
    assert_eq!((data.frame_interval, data.y_axis), (10.0, YAxis::Up));
    assert_eq!(Some(data.boundary), options.boundary);
    // After scaling, the unit of the table is no longer the unit of the data.
    let options = ImportOptions {
        scale: ImageScale { pixel_size: Some(0.5), frame_interval: Some(2.0), ..ImageScale::default() },
        ..ImportOptions::default()
    };
    let data = trackmate_with(EXPORT, &options).unwrap().dataset;
    assert_eq!((data.length_unit.as_str(), data.time_unit.as_str()), ("length", "time"));
}

#[test]
fn impossible_options_are_told() {
    for (pixel_size, interval, fact) in [
        (Some(0.0), None, "pixel_size is 0"),
        (Some(NAN), None, "pixel_size is NaN"),
        (None, Some(-1.0), "frame_interval is -1"),
    ] {
        let options = ImportOptions {
            scale: ImageScale { pixel_size, frame_interval: interval, ..ImageScale::default() },
            ..ImportOptions::default()
        };
        let facts = [fact, "finite and above zero"];
        assert_told(trackmate_with(EXPORT, &options), &facts, "positive number");
    }
}

#[test]
fn gzip_is_recognised_by_content() {
    let import = trackmate(gzip(EXPORT)).unwrap();
    assert_eq!(import.summary, trackmate(EXPORT).unwrap().summary);
    // Several members one after the other are one table.
    let (head, tail) = EXPORT.split_at(200);
    let members = [gzip(head), gzip(tail)].concat();
    assert_eq!(trackmate(members).unwrap().track_ids, [5, 7]);
}

#[test]
fn a_truncated_gzip_file_is_told() {
    let whole = gzip(EXPORT);
    for length in [4, 12, whole.len() / 2, whole.len() - 1] {
        let facts = ["spots.csv: cannot be decompressed"];
        assert_told(trackmate(&whole[..length]), &facts, "copy it again");
    }
}

#[test]
fn usual_column_names_are_recognised() {
    for header in [
        "track,frame,x,y",
        "TrackID,Time Point,Pos-X,pos_y",
        "particle,t,POSITION_X,Position Y",
        "id,time_index,x_position,y_position",
        "\u{feff}cell , frame , x , y",
    ] {
        let import = tracks(format!("{header}\n3,0,1,2\n3,1,1.5,2.5\n")).unwrap();
        assert_positions(&import, &array![[[1.0, 2.0]], [[1.5, 2.5]]]);
    }
    // The more telling of two names wins: trackpy beside a row number.
    let import = tracks("id,particle,frame,x,y\n0,8,0,1,2\n1,9,0,3,4\n2,8,1,1,3\n").unwrap();
    assert_eq!(import.track_ids, [8, 9]);
}

#[test]
fn named_columns_win() {
    let columns = ColumnNames {
        track: Some("who".into()),
        frame: Some("image number".into()),
        x: Some("x_um".into()),
        y: Some("y_um".into()),
    };
    let text = "id,who,x,y,x_um,y_um,Image_Number\n9,1,0,0,5,6,0\n";
    let import = tracks_with(text, columns.clone()).unwrap();
    assert_positions(&import, &array![[[5.0, 6.0]]]);
    let facts = ["tracks.csv, line 1: no column for the track: looked for who, found id, frame, x, y"];
    let text = "id,frame,x,y\n9,1,0,0\n";
    assert_told(tracks_with(text, columns), &facts, "--track-column");
}

#[test]
fn delimiters_and_line_ends_are_recognised() {
    for delimiter in [",", ";", "\t"] {
        for end in ["\n", "\r\n"] {
            let text = format!("{end}track,frame,x,y{end}3,0,1,2{end}{end}3,1,1.5,2.5");
            let import = tracks(text.replace(',', delimiter)).unwrap();
            assert_positions(&import, &array![[[1.0, 2.0]], [[1.5, 2.5]]]);
        }
    }
}

#[test]
fn row_order_does_not_matter_and_gaps_become_absent_frames() {
    let import = tracks("track,frame,x,y\n20,3,7,8\n-4,1,1,2\n20,1,5,6\n").unwrap();
    let expected = array![[[1.0, 2.0], [5.0, 6.0]], [[NAN, NAN], [NAN, NAN]], [[NAN, NAN], [7.0, 8.0]],];
    assert_positions(&import, &expected);
    assert_eq!(import.track_ids, [-4, 20]);
    assert_eq!((import.summary.first_frame, import.summary.empty_frames), (1, 1));
}

#[test]
fn spots_of_no_track_are_counted() {
    let text = "track,frame,x,y\n1,0,1,2\n,0,2,3\nNone,0,3,4\nNaN,0,4,5\n-,x,y,z\n";
    assert_eq!(tracks(text).unwrap().summary.left_out_untracked, 4);
    let facts = ["tracks.csv: none of its 2 spots belongs to a track (column \"track\""];
    assert_told(tracks("track,frame,x,y\n,0,1,2\n,1,1,2\n"), &facts, "link");
}

#[test]
fn missing_columns_are_told_with_those_found() {
    let facts = ["spots.csv, line 1: no column for the frame: looked for frame", "found TRACK_ID, T, X, Y"];
    assert_told(trackmate("TRACK_ID,T,X,Y\n1,2,3,4\n"), &facts, "import tracks");
    let facts = ["no column for the y coordinate", "found track, frame, x"];
    assert_told(tracks("track,frame,x\n1,2,3\n"), &facts, "name the columns");
}

#[test]
fn what_is_not_a_number_is_told_with_its_line() {
    let head = "track,frame,x,y\n1,0,1,2\n";
    for (row, column, text, expected) in [
        ("1,1,one,2", "x", "one", "a finite number"),
        ("1,1,1,inf", "y", "inf", "a finite number"),
        ("1,1,nan,2", "x", "nan", "a finite number"),
        ("1,1,,2", "x", "", "a finite number"),
        ("1,0.5,1,2", "frame", "0.5", "a whole number"),
        ("1,1e30,1,2", "frame", "1e30", "a whole number"),
        ("a1,1,1,2", "track", "a1", "a whole number"),
    ] {
        let fact = format!("tracks.csv, line 3: column \"{column}\" holds \"{text}\", {expected}");
        assert_told(tracks(format!("{head}{row}\n")), &[&fact], "this row");
    }
    let facts = ["line 2: column \"x\" holds \"1,5\""];
    assert_told(tracks("track;frame;x;y\n1;0;1,5;2.5\n"), &facts, "decimal point");
}

#[test]
fn lines_are_counted_the_way_an_editor_does() {
    // Blank lines and CRLF are where a reader's own count goes wrong.
    let facts = ["line 6: column \"x\""];
    let text = "track,frame,x,y\r\n1,0,1,2\r\n\r\n\r\n1,1,1,2\r\n1,2,?,2\r\n";
    assert_told(tracks(text), &facts, "row");
}

#[test]
fn only_the_rows_below_the_header_may_be_text() {
    let broken = EXPORT.replace("ID3,3,7,1.0,11.0,21.0,4", "x,x,7,x,x,x,x");
    let facts = ["spots.csv, line 7: column \"FRAME\" holds \"x\""];
    assert_told(trackmate(broken), &facts, "this row");
    // A first spot with one bad field is not a row of labels.
    let text = "TRACK_ID,FRAME,X,Y\n1,zero,1,2\n";
    assert_told(trackmate(text), &["line 2: column \"FRAME\""], "this row");
    // Tables of other origin have no rows of labels at all.
    let text = "track,frame,x,y\nTrack,Frame,X,Y\n1,0,1,2\n";
    assert_told(tracks(text), &["line 2: column \"track\""], "this row");
}

#[test]
fn empty_tables_are_told() {
    for text in ["", "\n\n", "  \n"] {
        assert_told(tracks(text), &["tracks.csv: is empty"], "header line");
    }
    assert_told(tracks("track,frame,x,y\n"), &["no data rows"], "filter");
    let (head, _) = EXPORT.split_at(EXPORT.find("ID1").unwrap());
    assert_told(trackmate(head), &["spots.csv: has a header but no"], "filter");
}

#[test]
fn rows_of_another_length_are_told() {
    let facts = ["tracks.csv, line 3: has 2 fields, the header has 4"];
    assert_told(tracks("track,frame,x,y\n1,0,1,2\n1,1\n"), &facts, "cut");
}

#[test]
fn absurd_gaps_are_refused_before_allocating() {
    let (least, most) = (i64::MIN, i64::MAX);
    for (first, last) in [(0, 100_000), (least, most)] {
        let text = format!("track,frame,x,y\n1,{first},1,2\n1,{last},1,2\n");
        let fact = format!("frames run from {first} to {last}, more than 100000");
        assert_told(tracks(text), &["tracks.csv", &fact], "is the frame column a time");
    }
    assert!(tracks("track,frame,x,y\n1,1,1,2\n1,100000,1,2\n").is_ok());
    let mut text = String::from("track,frame,x,y\n0,99999,1,2\n");
    for track in 0..1300 {
        text.push_str(&format!("{track},0,{track},2\n"));
    }
    let facts = ["100000 frames of 1300 tracks need 2080000000 bytes"];
    assert_told(tracks(text), &facts, "short tracks");
}

#[test]
fn two_tracks_in_one_place_are_told() {
    let text = "track,frame,x,y\n1,0,1,2\n2,0,1,2\n";
    let facts = ["tracks.csv: frame 0: cells 0 and 1 are both at (1, 2)"];
    assert_told(tracks(text), &facts, "remove one");
}

#[test]
fn foreign_encodings_outside_the_numbers_do_no_harm() {
    // Latin-1 µ in the row of units.
    let text = b"TRACK_ID,FRAME,X,Y\nTrack ID,Frame,X,Y\n,,(\xb5m),(\xb5m)\n1,0,1,2\n";
    assert_eq!(trackmate(text).unwrap().summary.spots, 1);
}

#[test]
fn a_missing_table_is_told() {
    let scratch = Scratch::new();
    let path = scratch.path("none.csv");
    let import = import_trackmate(&path, &ImportOptions::default());
    assert_told(import, &["none.csv: no such file"], "spelling");
}
