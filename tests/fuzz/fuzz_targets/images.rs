//! Images of labels and of fields: PNG, TIFF, `.npy`, by their first byte.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, told};
use voronudge_geometry::Edge;
use voronudge_io::{
    BorderCells, FieldLinking, FieldOptions, ImageScale, LabelLinking, LabelOptions, WantedExtrema,
    import_field, import_labels,
};

fuzz_target!(|bytes: &[u8]| {
    let name = match bytes.first() {
        Some(0x93) => "image.npy",
        Some(b'I' | b'M') => "image.tif",
        _ => "image.png",
    };
    let (path, scale) = (file(name, bytes), ImageScale::default());
    let linking = LabelLinking::Separate;
    told(import_labels(&path, &LabelOptions { scale, gap: 2, linking, border: BorderCells::Kept }));
    let options = FieldOptions {
        scale: ImageScale::default(),
        extrema: WantedExtrema::Both,
        smoothing: 1.0,
        prominence: None,
        distance: 0.0,
        edge: Edge::Open,
        linking: FieldLinking::Separate,
    };
    told(import_field(&path, &options));
});
