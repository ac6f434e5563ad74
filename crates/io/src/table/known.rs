//! Names of columns as other programs write them.

use super::header::plain;
use super::spot::Layout;

/// Numbers that regionprops gives to the regions of one image; they are tracks only where the segmentation was tracked.
pub(super) const LABEL: &str = "label";

/// For each role the names that are looked for; the earlier name wins.
pub(super) struct Known {
    pub(super) track: &'static [&'static str],
    pub(super) frame: &'static [&'static str],
    pub(super) x: &'static [&'static str],
    pub(super) y: &'static [&'static str],
    pub(super) z: &'static [&'static str],
}

/// Any program: trackpy, btrack, napari, CellProfiler (`TrackObjects_Label_50`), ImageJ's Manual Tracking (`Track n°`) and
/// MTrackJ (`TID`), regionprops.
const TRACK: &[&str] = &[
    "track_id",
    "track",
    "particle",
    "particle_id",
    "trackobjects_label",
    "track_n°",
    "tid",
    "cell_id",
    "cell",
    "id",
    LABEL,
];
/// CellProfiler counts images, and may have their frames from names of files; ImageJ counts slices.
const FRAME: &[&str] = &[
    "frame",
    "t",
    "time_index",
    "time_point",
    "metadata_frame",
    "metadata_t",
    "image_number",
    "slice_n°",
    "slice",
];
const X: &[&str] = &[
    "x",
    "position_x",
    "pos_x",
    "x_position",
    "centroid_x",
    "x_centroid",
    "location_center_x",
    "areashape_center_x",
    "xm",
];
const Y: &[&str] = &[
    "y",
    "position_y",
    "pos_y",
    "y_position",
    "centroid_y",
    "y_centroid",
    "location_center_y",
    "areashape_center_y",
    "ym",
];
const Z: &[&str] =
    &["z", "position_z", "pos_z", "z_position", "centroid_z", "location_center_z", "areashape_center_z"];

/// Axes of arrays by number, as regionprops names centroids: rows before columns, and planes before both.
const BY_NUMBER: [[&str; 3]; 3] = [
    ["centroid_0", "centroid_1", "centroid_2"],
    ["centroid_weighted_0", "centroid_weighted_1", "centroid_weighted_2"],
    ["weighted_centroid_0", "weighted_centroid_1", "weighted_centroid_2"],
];

/// Axes of points as napari numbers them, the last being x.
const AXES: [&[&str]; 4] = [&["axis_0"], &["axis_1"], &["axis_2"], &["axis_3"]];

impl Known {
    /// The names to look for in a table with these columns.
    pub(super) fn of(layout: Layout, columns: &[String]) -> Self {
        if layout == Layout::TrackMate {
            let (x, y) = (&["position_x", "x"], &["position_y", "y"]);
            return Self { track: &["track_id"], frame: &["frame"], x, y, z: &["position_z", "z"] };
        }
        let has = |name: &str| columns.iter().any(|column| plain(column) == plain(name));
        let known = Self { track: TRACK, frame: FRAME, x: X, y: Y, z: Z };
        if X.iter().any(|name| has(name)) {
            return known;
        }
        if layout == Layout::Points && has("axis_0") && has("axis_1") {
            let none: &[&str] = &[];
            let [a, b, c, d] = AXES;
            let (frame, z, y, x) = match (has("axis_2"), has("axis_3")) {
                (_, true) => (a, b, c, d),
                (true, false) => (a, none, b, c),
                (false, false) => (none, none, a, b),
            };
            return Self { frame, z, y, x, ..known };
        }
        match BY_NUMBER.iter().find(|[first, second, _]| has(first) && has(second)) {
            Some([z, y, x]) if has(x) => Self { x: one(x), y: one(y), z: one(z), ..known },
            Some([y, x, _]) => Self { x: one(x), y: one(y), z: &[], ..known },
            None => known,
        }
    }
}

fn one(name: &'static &'static str) -> &'static [&'static str] {
    std::slice::from_ref(name)
}
