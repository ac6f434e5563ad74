//! `.npy` files: reals, whole numbers, vectors.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, told};
use voronudge_io::{read_integers, read_reals, read_vectors};

fuzz_target!(|bytes: &[u8]| {
    let path = file("a.npy", bytes);
    told(read_reals(&path));
    told(read_integers(&path));
    told(read_vectors(&path));
});
