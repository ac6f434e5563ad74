//! Tables of tracks, plain and of TrackMate, its XML, arrays of napari, tables of points, of outlines and of flows; compressed if the first byte says so.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, told};
use voronudge_io::{
    FlowOptions, ImportOptions, OutlineOptions, PlaceLinking, import_flow, import_outlines, import_points,
    import_trackmate, import_tracks, inspect, read_flow_profile,
};

fuzz_target!(|bytes: &[u8]| {
    let name = if bytes.first() == Some(&0x1f) { "spots.csv.gz" } else { "spots.csv" };
    let path = file(name, bytes);
    told(import_tracks(&path, &ImportOptions::default()));
    told(import_trackmate(&path, &ImportOptions::default()));
    told(import_points(&path, &ImportOptions::default(), PlaceLinking::Nearest { limit: None }));
    told(inspect(&path));
    told(import_outlines(&path, &OutlineOptions::default()));
    told(read_flow_profile(&path));
    told(import_flow(&[path], &FlowOptions::default()));
});
