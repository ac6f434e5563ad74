//! Numbers in what commands leave behind: reports, arrays, printed lines.

use super::number;
use serde_json::Value;
use std::path::Path;
use voronudge_io::read_reals;

/// What commands left behind.
pub struct Left<'a> {
    /// The folder in which they ran.
    pub folder: &'a Path,
    /// Where the last one wrote to, from there.
    pub out: &'a str,
    /// What all of them printed.
    pub printed: &'a str,
}

impl Left<'_> {
    /// The numbers that a source names: `/nmse/naive` of the report of the last command, `fit/report.json /nmse/naive`,
    /// `out/density.npy 3,0`, `line "text" 2`, the second number of the first line that has the text. A `*` in a pointer stands for all
    /// entries, `name=shear` for those of this name, a `:` for all indices, `2:5` for some.
    pub fn numbers(&self, source: &str) -> Result<Vec<f64>, String> {
        if source.starts_with('/') {
            return self.entries(&format!("{}/report.json", self.out), source);
        }
        if let Some(rest) = source.strip_prefix("line \"") {
            let (text, place) = rest.rsplit_once("\" ").ok_or_else(|| format!("{source}: which number?"))?;
            return Ok(vec![self.in_line(text, place)?]);
        }
        let (file, place) = source.split_once(' ').unwrap_or((source, ":"));
        if file.ends_with(".npy") { self.of_array(file, place) } else { self.entries(file, place) }
    }

    fn entries(&self, file: &str, pointer: &str) -> Result<Vec<f64>, String> {
        let text =
            std::fs::read_to_string(self.folder.join(file)).map_err(|error| format!("{file}: {error}"))?;
        let report: Value = serde_json::from_str(&text).map_err(|error| format!("{file}: {error}"))?;
        let found = pointed(&report, pointer);
        let numbers: Vec<f64> = found.iter().filter_map(|entry| entry.as_f64()).collect();
        if numbers.is_empty() { Err(format!("{file} has no number {pointer}")) } else { Ok(numbers) }
    }

    fn in_line(&self, text: &str, place: &str) -> Result<f64, String> {
        let line = self.printed.lines().find(|line| line.contains(text));
        let numbers = number::numbers(line.ok_or_else(|| format!("nothing printed has \"{text}\""))?);
        let place: usize = place.trim().parse().map_err(|_| format!("\"{place}\" is no place in a line"))?;
        let found = place.checked_sub(1).and_then(|place| numbers.get(place));
        found.copied().ok_or_else(|| format!("\"{text}\": {} numbers in the line", numbers.len()))
    }

    fn of_array(&self, file: &str, place: &str) -> Result<Vec<f64>, String> {
        let array = read_reals(&self.folder.join(file)).map_err(|error| error.to_string())?;
        let wanted: Vec<&str> = place.split(',').map(str::trim).collect();
        let spans: Vec<(usize, usize)> = (array.shape().iter().enumerate())
            .map(|(axis, length)| span(wanted.get(axis).copied().unwrap_or(":"), *length))
            .collect::<Option<_>>()
            .filter(|_| wanted.len() <= array.ndim() || place == ":")
            .ok_or_else(|| format!("{file} of shape {:?} has no {place}", array.shape()))?;
        let is_asked = |index: &ndarray::IxDyn| {
            spans.iter().enumerate().all(|(axis, (begin, end))| (*begin..*end).contains(&index[axis]))
        };
        Ok(array.indexed_iter().filter(|(index, _)| is_asked(index)).map(|(_, value)| *value).collect())
    }
}

/// The entries that a pointer with `*` leads to.
fn pointed<'a>(report: &'a Value, pointer: &str) -> Vec<&'a Value> {
    let mut found = vec![report];
    for step in pointer.split('/').skip(1) {
        let next = |entry: &'a Value| -> Vec<&'a Value> {
            match (entry, step) {
                (Value::Array(all), "*") => all.iter().collect(),
                (Value::Object(all), "*") => all.values().collect(),
                (Value::Array(all), _) if step.contains('=') => {
                    all.iter().filter(|entry| is_meant(entry, step)).collect()
                }
                _ => entry.pointer(&format!("/{step}")).into_iter().collect(),
            }
        };
        found = found.into_iter().flat_map(next).collect();
    }
    found
}

/// Whether an entry has the value of `key=value`, of which `/` is written `~1`.
fn is_meant(entry: &Value, step: &str) -> bool {
    let Some((key, value)) = step.split_once('=') else { return false };
    entry.get(key).and_then(Value::as_str) == Some(value.replace("~1", "/").as_str())
}

/// The indices `3`, `:`, `2:`, `:5` or `2:5` of an axis.
fn span(text: &str, length: usize) -> Option<(usize, usize)> {
    let (begin, end) = match text.split_once(':') {
        Some((begin, end)) => {
            let of =
                |text: &str, otherwise| if text.is_empty() { Some(otherwise) } else { text.parse().ok() };
            (of(begin, 0)?, of(end, length)?)
        }
        None => (text.parse().ok()?, text.parse::<usize>().ok()? + 1),
    };
    (begin < end && end <= length).then_some((begin, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_in_reports_arrays_and_lines() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        let report = r#"{"a": {"b": [1.5, {"c": 2, "n": "u/v = 1"}, {"c": 3}, null]}, "d": "x"}"#;
        std::fs::write(out.join("report.json"), report).unwrap();
        let mut written = voronudge_io::OutputDirectory::create(folder.path().join("arrays")).unwrap();
        written.write_array("x.npy", ndarray::arr2(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]).view()).unwrap();
        written.commit().unwrap();
        let printed = "first 1 2\nK_P alpha   3.40  3.28 to 3.52\nK_P alpha 9\n";
        let left = Left { folder: folder.path(), out: "out", printed };
        let of = |source: &str| left.numbers(source);
        assert_eq!(of("/a/b/0"), Ok(vec![1.5]));
        assert_eq!(of("/a/b/*/c"), Ok(vec![2.0, 3.0]));
        assert_eq!(of("/a/b/n=u~1v = 1/c"), Ok(vec![2.0]));
        assert_eq!(of("out/report.json /a/b/1/c"), Ok(vec![2.0]));
        assert_eq!(of("arrays/x.npy 1,2"), Ok(vec![6.0]));
        assert_eq!(of("arrays/x.npy :,1"), Ok(vec![2.0, 5.0]));
        assert_eq!(of("arrays/x.npy 0,1:"), Ok(vec![2.0, 3.0]));
        assert_eq!(of("arrays/x.npy").unwrap().len(), 6);
        assert_eq!(of("line \"K_P alpha\" 3"), Ok(vec![3.52]));
        for no in [
            "/d",
            "/e",
            "no/report.json /a",
            "arrays/x.npy 2,0",
            "arrays/x.npy 0,0,0",
            "arrays/y.npy 0",
            "line \"K_P alpha\" 4",
            "line \"second\" 1",
            "line \"first\"",
            "line \"first\" 0",
        ] {
            assert!(of(no).is_err(), "{no}");
        }
    }
}
