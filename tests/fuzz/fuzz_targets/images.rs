//! Images of labels and of fields: PNG, TIFF, `.npy`, also with pickled masks, by their first byte.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, told};
use voronudge_io::{FieldOptions, LabelOptions, WantedExtrema, import_field, import_labels};

fuzz_target!(|bytes: &[u8]| {
    let name = match bytes.first() {
        Some(0x93) => "image.npy",
        Some(b'I' | b'M') => "image.tif",
        _ => "image.png",
    };
    let path = file(name, bytes);
    told(import_labels(&path, &LabelOptions { gap: 2, ..LabelOptions::default() }));
    let options = FieldOptions { extrema: WantedExtrema::Both, smoothing: 1.0, ..FieldOptions::default() };
    told(import_field(&path, &options));
});
