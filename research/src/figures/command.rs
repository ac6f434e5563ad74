//! Figures that a command of the tool draws.

use super::Panel;
use std::error::Error;
use std::path::Path;
use std::process::Command;

/// What a command made.
pub(super) struct Output {
    folder: tempfile::TempDir,
    /// The command as typed, without the output folder.
    pub typed: String,
    page: String,
}

/// Runs the tool in the root of the repository.
pub(super) fn run(arguments: &str) -> Result<Output, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let status = Command::new(crate::program::path()?)
        .args(arguments.split_whitespace())
        .arg("--quiet")
        .arg("--out")
        .arg(folder.path())
        .current_dir(crate::root())
        .status()?;
    if !status.success() {
        return Err(format!("voronudge {arguments}: {status}").into());
    }
    let page = std::fs::read_to_string(folder.path().join("report.html"))?;
    Ok(Output { folder, typed: format!("`voronudge {arguments}`"), page })
}

impl Output {
    /// The folder that the command wrote.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// `report.json`
    pub fn report(&self) -> Result<serde_json::Value, Box<dyn Error>> {
        Ok(serde_json::from_str(&std::fs::read_to_string(self.path().join("report.json"))?)?)
    }

    /// The picture of the page with this title, as a panel.
    pub fn panel(&self, name: &'static str, caption: &str, title: &str) -> Result<Panel, Box<dyn Error>> {
        Ok(Panel { name, caption: caption.into(), svg: self.picture(title)? })
    }

    fn picture(&self, title: &str) -> Result<String, Box<dyn Error>> {
        pictures(&self.page)
            .into_iter()
            .find(|svg| svg.contains(&format!("<title>{title}")))
            .map(String::from)
            .ok_or_else(|| format!("the page of {} has no picture of {title}", self.typed).into())
    }
}

/// The pictures in a page, those within them not counted.
fn pictures(page: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some(begin) = rest.find("<svg") {
        let (mut depth, mut at) = (0usize, begin);
        loop {
            let opens = rest[at..].find("<svg").map(|k| at + k);
            let Some(closes) = rest[at..].find("</svg>").map(|k| at + k) else {
                return found;
            };
            match opens {
                Some(opens) if opens < closes => {
                    depth += 1;
                    at = opens + 4;
                }
                _ => {
                    depth -= 1;
                    at = closes + 6;
                }
            }
            if depth == 0 {
                break;
            }
        }
        found.push(&rest[begin..at]);
        rest = &rest[at..];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_within_pictures_belong_to_them() {
        let page = "<p><svg a><svg b></svg></svg><i><svg c></svg>";
        assert_eq!(pictures(page), ["<svg a><svg b></svg></svg>", "<svg c></svg>"]);
        assert!(pictures("<svg a>").is_empty());
    }
}
