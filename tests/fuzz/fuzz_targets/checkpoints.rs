//! Checkpoints of a run that was cut off: as they are, and inside a whole one.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, folder, told};
use voronudge_io::{OutputFolder, Recording};

fuzz_target!(|bytes: &[u8]| {
    let claimed = OutputFolder::claim(folder()).expect("a folder of one process");
    let mut recording = Recording::begin(&claimed, &[]).expect("room in the temporary folder");
    recording.checkpoint(bytes).expect("room in the temporary folder");
    let whole = Recording::find(folder()).expect("a checkpoint that was written");
    assert_eq!(whole.as_deref(), Some(bytes));
    file(".voronudge-run/checkpoint", bytes);
    told(Recording::find(folder()));
});
