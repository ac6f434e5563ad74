//! Tissues as a microscope delivers them: what `discover` says of each, and only then the truth.

use crate::program::{fixture, voronudge};
use crate::scratch::{Folder, report};
use serde_json::Value;
use std::ffi::OsStr;
use std::fs;

/// What is wrong with the answer to a tissue; nothing if it is right.
fn fault(name: &str) -> Option<String> {
    let out = Folder::new();
    let data = fixture(&format!("measured/{name}"));
    let outcome =
        voronudge([OsStr::new("discover"), data.as_os_str(), OsStr::new("--out"), out.path().as_os_str()]);
    assert!(matches!(outcome.code, Some(0 | 1)), "{name}: {}", outcome.stderr);
    let report = report(out.path());
    let text = fs::read_to_string(fixture(&format!("measured-truth/{name}.json"))).unwrap();
    let truth: Value = serde_json::from_str(&text).unwrap();
    let selected = report["selected"].as_array().unwrap();
    let is_it = |own: &Value, effect: &str| {
        let class = own["class"].as_array().unwrap().iter();
        class.chain([&own["effect"]]).any(|id| id.as_str() == Some(effect))
    };
    let right = match (truth["effect"].as_str(), selected.as_slice()) {
        (None, []) => report["verdict"] == "nothing_missing",
        (Some(effect), [only]) => is_it(only, effect),
        _ => false,
    };
    let found: Vec<&Value> = selected.iter().map(|own| &own["effect"]).collect();
    (!right).then(|| {
        format!("{name}: {} {found:?}, but {} of {}", report["verdict"], truth["effect"], truth["class"])
    })
}

/// A test for each tissue, so that they run side by side.
macro_rules! tissues {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            assert_eq!(fault(&stringify!($name).replace('_', "-")), None);
        }
    )*};
}

tissues! {
    tissue_01 tissue_02 tissue_03 tissue_04 tissue_05 tissue_06
    tissue_07 tissue_08 tissue_09 tissue_10 tissue_11 tissue_12
}
