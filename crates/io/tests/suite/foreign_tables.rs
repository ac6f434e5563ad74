//! Tables of tracks as other programs write them: encodings, separators, names of columns.

use ndarray::Array3;
use voronudge_io::{Error, ImageScale, Import, ImportOptions, NoteKind, YAxis, import_tracks};

use crate::{Scratch, assert_told};

fn tracks(text: impl AsRef<[u8]>) -> Result<Import, Error> {
    let scratch = Scratch::new();
    let options = ImportOptions {
        scale: ImageScale { y_axis: Some(YAxis::Up), ..ImageScale::default() },
        ..ImportOptions::default()
    };
    import_tracks(&scratch.write("tracks.csv", text), &options)
}

#[track_caller]
fn assert_read(text: impl AsRef<[u8]>) -> Import {
    let import = tracks(text).unwrap();
    let expected = Array3::from_shape_vec((2, 1, 2), vec![1.0, 2.0, 1.5, 2.5]).unwrap();
    assert_eq!(import.dataset.positions, expected);
    import
}

fn notes(import: &Import, kind: NoteKind) -> String {
    let of = import.notes.iter().filter(|note| note.kind == kind);
    of.map(|note| note.text.as_str()).collect::<Vec<_>>().join("; ")
}

#[test]
fn marks_and_encodings_of_spreadsheets_are_no_obstacle() {
    let text = "track;frame;x [µm];y [µm]\r\n3;0;1;2\r\n3;1;1.5;2.5\r\n";
    let latin: Vec<u8> = text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for (bytes, encoding) in [
        (text.as_bytes().to_vec(), ""),
        ([b"\xef\xbb\xbf", text.as_bytes()].concat(), ""),
        (latin, "Latin-1"),
        ([b"\xff\xfe".to_vec(), little].concat(), "UTF-16"),
        ([b"\xfe\xff".to_vec(), big].concat(), "UTF-16"),
    ] {
        let import = assert_read(bytes);
        assert_eq!(import.dataset.length_unit, "µm");
        let guessed = notes(&import, NoteKind::Guessed);
        assert_eq!(guessed.contains("the text is in"), !encoding.is_empty(), "{guessed}");
        assert!(guessed.contains(encoding), "{guessed}");
        assert!(notes(&import, NoteKind::Read).contains("lengths in µm"));
    }
}

#[test]
fn blanks_separate_and_marks_of_comments_do_not_matter() {
    assert_read("track frame x y\n3 0 1 2\n3 1 1.5 2.5\n");
    assert_read("# track   frame x y\n 3   0  1.0  2.0\n 3   1  1.5  2.5\n");
    assert_read("track frame x [um] y [um]\n3 0 1 2\n3 1 1.5 2.5\n");
    let facts = ["tracks.csv, line 3: column \"x\" holds \"one\""];
    assert_told(tracks("track frame x y\n3 0 1 2\n3 1 one 2.5\n"), &facts, "this row");
}

#[test]
fn names_of_other_programs_are_known() {
    for header in [
        "TrackObjects_Label_50,Metadata_Frame,Location_Center_X,Location_Center_Y",
        "TrackObjects_Label,ImageNumber,AreaShape_Center_X,AreaShape_Center_Y",
        "TID,t [frame],x [pixel],y [pixel]",
        "Track n°,Slice n°,X,Y",
        "label,frame,centroid_weighted-1,centroid_weighted-0",
        "particle,Slice,XM,YM",
    ] {
        assert_read(format!("{header}\n3,0,1,2\n3,1,1.5,2.5\n"));
    }
    // In three dimensions the first axis of regionprops is z.
    let import = assert_read("label,frame,centroid-0,centroid-1,centroid-2\n3,0,7,2,1\n3,1,7,2.5,1.5\n");
    assert!(notes(&import, NoteKind::Doubtful).contains("\"label\" is taken for the track"));
    let import = assert_read("track,frame,z,y,x\n3,0,7,2,1\n3,1,8,2.5,1.5\n");
    assert!(notes(&import, NoteKind::Doubtful).contains("z runs from 7 to 8"));
    // Where numbers of regions stand beside tracks, tracks win.
    let import = assert_read("label,track_id,frame,centroid-0,centroid-1\n1,3,0,2,1\n9,3,1,2.5,1.5\n");
    assert_eq!((import.track_ids.as_slice(), notes(&import, NoteKind::Doubtful).as_str()), (&[3][..], ""));
}

#[test]
fn tables_without_names_are_not_guessed() {
    // x and y exchanged would turn the sign of the chirality.
    for text in ["3,0,1,2\n3,1,1.5,2.5\n", "3 0 1 2\n3 1 1.5 2.5\n"] {
        assert_told(tracks(text), &["tracks.csv, line 1: begins with numbers"], "track,frame,y,x");
    }
}

#[test]
fn what_is_no_text_is_told() {
    assert_told(tracks(b"track,frame,x,y\n\0\0\0\0"), &["tracks.csv: is not text"], "as text");
    assert_told(tracks(b"MATLAB 5.0 MAT-file"), &["is a MATLAB file"], "as text");
    assert_told(tracks(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"), &["is an old spreadsheet"], "as text");
}
