//! The runs of a diagram as a file: a header, then a line for each run, in order.

use super::point::Record;
use super::request::Request;
use crate::arguments::Shard;
use crate::failure::Failure;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// Name of the file among the results.
pub(crate) const FILE: &str = "points.jsonl";

/// The first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    pub request: Request,
    pub shard: Shard,
}

/// A header with the runs made so far, or all of them.
#[derive(Debug)]
pub(crate) struct Points {
    pub header: Header,
    pub records: Vec<Record>,
}

impl Points {
    /// Reads lines; `place` is the file they come from.
    pub fn parse<'a>(lines: impl Iterator<Item = &'a str>, place: impl Display) -> Result<Self, Failure> {
        let unreadable = |line: usize, error: String| {
            Failure::new(format!("{place}, line {}: not a line of a diagram ({error})", line + 1))
                .with_hint("another version of the program may have made it; make the diagram again")
        };
        let mut lines = lines.enumerate();
        let Some((_, first)) = lines.next() else {
            return Err(Failure::new(format!("{place} is empty")).with_hint("make the diagram again"));
        };
        let header: Header = serde_json::from_str(first).map_err(|error| unreadable(0, error.to_string()))?;
        header.request.check().map_err(|failure| unreadable(0, failure.message().to_owned()))?;
        let record = |(number, line): (usize, &str)| {
            let record: Record =
                serde_json::from_str(line).map_err(|error| unreadable(number, error.to_string()))?;
            if record.point >= header.request.points() || record.replica >= header.request.replicas {
                let fault = format!("run {} of point {}, which is none", record.replica, record.point);
                return Err(unreadable(number, fault));
            }
            Ok(record)
        };
        let records = lines.map(record).collect::<Result<_, _>>()?;
        Ok(Self { header, records })
    }

    /// The content of the file, the same whatever the order in which the runs ended.
    pub fn to_text(&self) -> Result<String, Failure> {
        let mut text = serde_json::to_string(&self.header)? + "\n";
        for record in &self.records {
            text += &serde_json::to_string(record)?;
            text.push('\n');
        }
        Ok(text)
    }

    /// Puts the runs in order.
    pub fn sort(&mut self) {
        self.records.sort_by_key(|record| (record.point, record.replica));
    }
}

impl Header {
    /// The name of the first entry in which another request differs.
    pub fn difference(&self, other: &Self) -> Result<Option<String>, Failure> {
        let [own, other] = [serde_json::to_value(self)?, serde_json::to_value(other)?];
        let entries = |value: &serde_json::Value| {
            let mut entries = value.get("request").and_then(|r| r.as_object()).cloned().unwrap_or_default();
            entries.insert("shard".into(), value.get("shard").cloned().unwrap_or_default());
            entries
        };
        let [own, other] = [entries(&own), entries(&other)];
        Ok(own.keys().find(|name| own.get(*name) != other.get(*name)).cloned())
    }
}
