//! Journals of runs that were cut off: as they are, and as lines of a whole one.
#![no_main]

use libfuzzer_sys::fuzz_target;
use voronudge_fuzz::{file, folder, told};
use voronudge_io::{Journal, OutputFolder};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes)
        && !text.contains('\n')
    {
        let claimed = OutputFolder::claim(folder()).expect("a folder of one process");
        Journal::begin(&claimed, text).expect("room in the temporary folder");
        let lines = Journal::find(folder()).expect("a journal that was written");
        assert_eq!(lines.as_deref(), Some([text.to_owned()].as_slice()));
    }
    file(".voronudge-run/journal", bytes);
    told(Journal::find(folder()));
});
