//! The `--frames` selection.

use voronudge_io::{Error, FrameSelection};

use crate::assert_told;

fn select(text: &str, total: usize) -> Result<Vec<usize>, Error> {
    text.parse::<FrameSelection>()?.resolve(total)
}

#[test]
fn documented_forms_are_understood() {
    assert_eq!(select("6", 20).unwrap(), [6]);
    assert_eq!(select("4..16", 16).unwrap(), (4..16).collect::<Vec<_>>());
    assert_eq!(select("4,7,9", 20).unwrap(), [4, 7, 9]);
    assert_eq!(select("1,4..6", 20).unwrap(), [1, 4, 5]);
    assert_eq!(select(" 4 .. 6 , 9 ", 20).unwrap(), [4, 5, 9]);
    assert_eq!(select("3..", 5).unwrap(), [3, 4]);
    assert_eq!(select("..2", 5).unwrap(), [0, 1]);
}

#[test]
fn frames_come_out_ascending_whatever_the_order_typed() {
    assert_eq!(select("9,4", 20).unwrap(), [4, 9]);
}

#[test]
fn a_selection_prints_as_typed() {
    let selection: FrameSelection = "1,4..6".parse().unwrap();
    assert_eq!(selection.to_string(), "1,4..6");
}

#[test]
fn what_is_not_a_selection_is_told() {
    for text in ["", "  ", "4,,5", "4,"] {
        let fact = format!("frames \"{text}\": empty");
        assert_told(select(text, 20), &[&fact], "4..16");
    }
    for (text, part) in [
        ("all", "all"),
        ("-1", "-1"),
        ("+3", "+3"),
        ("1.5", "1.5"),
        ("2-5", "2-5"),
        ("1,4..=6", "4..=6"),
        ("1...3", "1...3"),
        ("99999999999999999999999", "99999999999999999999999"),
    ] {
        let fact = format!("frames \"{text}\": \"{part}\" is neither a frame nor a range");
        assert_told(select(text, 20), &[&fact], "the end is excluded");
    }
}

#[test]
fn ranges_without_frames_are_told() {
    assert_told(select("9..4", 20), &["range 9..4 holds no frame"], "4..9");
    assert_told(select("4..4", 20), &["range 4..4 holds no"], "alone write 4");
}

#[test]
fn frames_that_do_not_exist_are_told() {
    let advice = "frames are 0 to 17; a range may end at 18";
    let facts = ["frame 18 does not exist, the data set has 18 frames"];
    assert_told(select("18", 18), &facts, advice);
    assert_told(select("4..19", 18), &facts, advice);
    assert_told(select("18..", 18), &facts, advice);
    let most = usize::MAX;
    assert_told(select(&most.to_string(), 18), &[&most.to_string()], advice);
    // Refused before anything of this length is made.
    assert_told(select(&format!("0..{most}"), 18), &facts, advice);
    assert_told(select("0", 0), &["has 0 frames"], "no frames");
}

#[test]
fn frames_named_twice_are_told() {
    assert_told(select("4,4", 20), &["frame 4 is named twice"], "once");
    assert_told(select("1..5,3", 20), &["frame 3 is named twice"], "once");
}

#[test]
fn a_range_is_the_list_of_its_frames() {
    for start in 0..6 {
        for end in start + 1..=6 {
            let list: Vec<String> = (start..end).map(|frame| frame.to_string()).collect();
            let range = select(&format!("{start}..{end}"), 6).unwrap();
            assert_eq!(range, select(&list.join(","), 6).unwrap());
        }
    }
}
