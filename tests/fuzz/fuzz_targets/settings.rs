//! `dataset.toml` beside positions of nine cells.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, folder, told};
use voronudge_io::Source;

/// Nine places in two dimensions.
fn positions() -> Vec<u8> {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (9, 2), }";
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend((0..18).flat_map(|k| (f64::from(k * k % 23) * 0.4).to_le_bytes()));
    bytes
}

fuzz_target!(|bytes: &[u8]| {
    file("positions.npy", &positions());
    file("dataset.toml", bytes);
    told(Source { folder: Some(folder().into()), ..Source::default() }.load());
});
