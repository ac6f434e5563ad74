//! Imports of TrackMate's own files.

use voronudge_io::{Error, ImageScale, Import, ImportOptions, NoteKind, import_trackmate, import_tracks};

use crate::{Scratch, assert_told};

fn read_with(text: &str, options: &ImportOptions) -> Result<Import, Error> {
    let scratch = Scratch::new();
    import_trackmate(&scratch.write("cells.xml", text), options)
}

fn read(text: &str) -> Result<Import, Error> {
    read_with(text, &ImportOptions::default())
}

const TRACKS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Tracks nTracks="2" spaceUnits="µm" frameInterval="0.5" timeUnits="h" from="TrackMate v7.11.1">
  <particle nSpots="2">
    <detection t="3" x="1.0" y="2.0" z="0.0" />
    <detection t="4" x="1.5" y="2.5" z="0.0" />
  </particle>
  <particle nSpots="1">
    <detection t="4" x="7.0" y="8.0" z="0.0" />
  </particle>
</Tracks>
"#;

/// A split, a spot without a track and a track that a filter hides.
const MODEL: &str = r#"<TrackMate version="8.1.6">
  <Log>&lt;Model&gt;</Log>
  <Model spatialunits="micron" timeunits="sec">
    <AllSpots nspots="6">
      <SpotsInFrame frame="0">
        <Spot ID="1" name="a &quot;b&quot;" FRAME="0" VISIBILITY="1" POSITION_X="1.0" POSITION_Y="2.0" POSITION_Z="0.0" />
        <Spot ID="2" name="c" FRAME="0" VISIBILITY="0" POSITION_X="9.0" POSITION_Y="9.0" POSITION_Z="0.0" />
      </SpotsInFrame>
      <SpotsInFrame frame="1">
        <Spot ID="3" name="d" FRAME="1" POSITION_X="1.5" POSITION_Y="2.5" POSITION_Z="0.0" />
        <Spot ID="4" name="e" FRAME="1" POSITION_X="3.0" POSITION_Y="2.5" POSITION_Z="0.0" />
        <Spot ID="5" name="f" FRAME="1" POSITION_X="6.0" POSITION_Y="6.0" POSITION_Z="0.0" />
        <Spot ID="6" name="g" FRAME="1" POSITION_X="7.0" POSITION_Y="6.0" POSITION_Z="0.0" />
      </SpotsInFrame>
    </AllSpots>
    <AllTracks>
      <Track name="Track_5" TRACK_ID="5">
        <Edge SPOT_SOURCE_ID="1" SPOT_TARGET_ID="3" />
        <Edge SPOT_SOURCE_ID="1" SPOT_TARGET_ID="4" />
      </Track>
      <Track name="Track_6" TRACK_ID="6"><Edge SPOT_SOURCE_ID="5" SPOT_TARGET_ID="6" /></Track>
    </AllTracks>
    <FilteredTracks><TrackID TRACK_ID="5" /></FilteredTracks>
  </Model>
  <Settings>
    <ImageData width="20" height="10" nframes="2" pixelwidth="0.65" pixelheight="0.65" timeinterval="600.0" />
  </Settings>
</TrackMate>
"#;

#[test]
fn exported_tracks_bring_their_units() {
    let import = read(TRACKS).unwrap();
    let data = &import.dataset;
    assert_eq!((data.positions.dim(), import.summary.first_frame), ((2, 2, 2), 3));
    assert_eq!((data.positions[[1, 0, 0]], data.positions[[1, 0, 1]]), (1.5, -2.5));
    assert!(data.positions[[0, 1, 0]].is_nan());
    assert_eq!((data.frame_interval, data.length_unit.as_str(), data.time_unit.as_str()), (0.5, "µm", "h"));
    // Found out by content, whatever the command.
    let scratch = Scratch::new();
    let path = scratch.write("cells.xml", format!("\u{feff}{TRACKS}"));
    let same = import_tracks(&path, &ImportOptions::default()).unwrap();
    assert_eq!((same.summary, same.dataset.positions[[1, 0, 1]]), (import.summary, -2.5));
}

#[test]
fn a_model_is_read_as_its_filters_leave_it() {
    let import = read(MODEL).unwrap();
    let data = &import.dataset;
    assert_eq!(import.track_ids, [5]);
    assert_eq!((data.positions[[0, 0, 0]], data.positions[[1, 0, 0]]), (1.0, 1.5));
    let summary = import.summary;
    assert_eq!((summary.spots, summary.left_out_untracked, summary.left_out_duplicate), (2, 3, 1));
    assert_eq!(
        (data.frame_interval, data.length_unit.as_str(), data.time_unit.as_str()),
        (600.0, "micron", "sec")
    );
    let told = |part: &str| import.notes.iter().any(|note| note.text.contains(part));
    assert!(told("1 tracks that its filters hide") && told("--image-size 13 6.5"), "{:?}", import.notes);
}

#[test]
fn options_that_contradict_the_file_are_told() {
    let doubts = |interval, unit: &str| {
        let time_unit = Some(unit.to_owned());
        let options = ImportOptions {
            scale: ImageScale { frame_interval: Some(interval), time_unit, ..ImageScale::default() },
            ..ImportOptions::default()
        };
        let import = read_with(MODEL, &options).unwrap();
        assert_eq!(import.dataset.frame_interval, interval);
        import
            .notes
            .into_iter()
            .filter(|note| note.kind == NoteKind::Doubtful)
            .map(|note| note.text)
            .collect::<Vec<String>>()
    };
    let none: Vec<String> = Vec::new();
    assert_eq!(doubts(600.0, "s"), none);
    assert_eq!(doubts(10.0, "min"), none);
    assert_eq!(doubts(10.0, "s"), ["--frame-interval 10 is taken, but the file says 600 sec (TrackMate)"]);
}

#[test]
fn what_is_no_file_of_trackmate_is_told_with_its_line() {
    assert_told(read("<html></html>"), &["cells.xml: is XML or HTML"], "as text");
    assert_told(
        read("<?xml version=\"1.0\"?>\n<OME/>"),
        &["line 2: is XML of another kind (OME)"],
        "TrackMate",
    );
    assert_told(read(&TRACKS.replace("</Tracks>", "")), &["cells.xml, line", "cannot be read as XML"], "cut");
    let facts = ["cells.xml, line 4: column \"x\" holds \"one\", a finite number is needed"];
    assert_told(read(&TRACKS.replace("x=\"1.0\"", "x=\"one\"")), &facts, "this row");
    assert_told(read(&TRACKS.replace("t=\"4\"", "t=\"4.5\"")), &["\"4.5\", a whole number"], "this row");
    assert_told(
        read(&MODEL.replace("<AllTracks", "<X").replace("AllTracks>", "X>")),
        &["no AllTracks"],
        "whole",
    );
    assert_told(
        read(&MODEL.replace("TrackID", "Other")),
        &["none of its 6 spots belongs to a track"],
        "link",
    );
    assert_told(read("<Tracks></Tracks>"), &["no data rows"], "filter");
    // Entities that unfold to more than the file are not unfolded.
    let bomb = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b \"bb\">]><Tracks>&b;</Tracks>";
    assert_told(read(bomb), &["cannot be read as XML"], "cut");
}
