//! Pages in Markdown: where their links lead, and that the table of contents has each once.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// The table of contents of the site.
pub const CONTENTS: &str = "docs/SUMMARY.md";
/// Folders with pages, besides the top.
const FOLDERS: [&str; 2] = ["docs", "fixtures"];

/// Links that lead nowhere, and pages of `docs` that are not in the table of contents exactly once.
pub fn violations(root: &Path) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let pages = Pages::read(root)?;
    let mut found = pages.dead_links();
    let listed: Vec<PathBuf> = pages.links_of(Path::new(CONTENTS)).map(|link| link.page).collect();
    let in_docs = |page: &&PathBuf| page.starts_with("docs") && *page != Path::new(CONTENTS);
    for page in pages.texts.keys().filter(in_docs) {
        let times = listed.iter().filter(|own| *own == page).count();
        if times != 1 {
            found.push(format!("{CONTENTS}: has {} {times} times, and should have it once", page.display()));
        }
    }
    Ok(found)
}

/// The text of each page by its path from the root.
pub struct Pages {
    root: PathBuf,
    /// By path from the root.
    pub texts: BTreeMap<PathBuf, String>,
}

/// A link from one file to another.
#[derive(Debug, PartialEq, Eq)]
pub struct Link {
    /// Where it stands, counted from 1.
    pub line: usize,
    /// Where it leads, from the root.
    pub page: PathBuf,
    /// By the name that links have for it.
    pub heading: Option<String>,
}

impl Pages {
    /// Those at the top, and those in the folders of pages.
    pub fn read(root: &Path) -> io::Result<Self> {
        let mut texts = BTreeMap::new();
        collect(root, Path::new(""), false, &mut texts)?;
        for folder in FOLDERS {
            collect(root, Path::new(folder), true, &mut texts)?;
        }
        Ok(Self { root: root.to_path_buf(), texts })
    }

    /// The links of a page to other files, and within it.
    pub fn links_of<'a>(&'a self, page: &'a Path) -> impl Iterator<Item = Link> + 'a {
        let text = self.texts.get(page).map_or("", String::as_str);
        targets(text).into_iter().filter_map(move |(line, target)| {
            let (file, heading) = match target.split_once('#') {
                Some((file, heading)) => (file, Some(heading.to_owned())),
                None => (target.as_str(), None),
            };
            let page = match file {
                "" => page.to_path_buf(),
                file => joined(page.parent()?, Path::new(file))?,
            };
            Some(Link { line, page, heading })
        })
    }

    fn dead_links(&self) -> Vec<String> {
        let headings: BTreeMap<&PathBuf, BTreeSet<String>> =
            self.texts.iter().map(|(page, text)| (page, anchors(text))).collect();
        let mut found = Vec::new();
        for page in self.texts.keys() {
            for Link { line, page: target, heading } in self.links_of(page) {
                let place = format!("{}:{line}", page.display());
                if !self.root.join(&target).exists() {
                    found.push(format!("{place}: a link to {}, which is not there", target.display()));
                } else if let (Some(heading), Some(known)) = (heading, headings.get(&target))
                    && !known.contains(&heading)
                {
                    found.push(format!("{place}: {} has no heading #{heading}", target.display()));
                }
            }
        }
        found
    }
}

fn collect(
    root: &Path,
    folder: &Path,
    with_folders: bool,
    texts: &mut BTreeMap<PathBuf, String>,
) -> io::Result<()> {
    for entry in fs::read_dir(root.join(folder))? {
        let entry = entry?;
        let (page, kind) = (folder.join(entry.file_name()), entry.file_type()?);
        if kind.is_dir() && with_folders {
            collect(root, &page, true, texts)?;
        } else if kind.is_file() && page.extension().is_some_and(|end| end == "md") {
            let text = fs::read_to_string(entry.path())?;
            texts.insert(page, text);
        }
    }
    Ok(())
}

/// A path without `..`; `None` if it leads out of the root.
fn joined(folder: &Path, target: &Path) -> Option<PathBuf> {
    let mut path = folder.to_path_buf();
    for part in target.components() {
        match part {
            Component::ParentDir if !path.pop() => return None,
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    Some(path)
}

/// Lines of a text that are no code, counted from 1.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_fence && !is_code
    })
}

/// What the links of a text lead to, web pages aside, with their lines.
fn targets(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        for after in without_code(line).split("](").skip(1) {
            let target = after.split([')', ' ']).next().unwrap_or_default();
            if !target.is_empty() && !target.contains("://") && !target.starts_with("mailto:") {
                found.push((number, target.to_owned()));
            }
        }
    }
    found
}

/// A line without what stands between backticks.
fn without_code(line: &str) -> String {
    let parts: Vec<&str> = line.split('`').collect();
    // An odd backtick at the end opens nothing.
    let is_text = |place: usize| place.is_multiple_of(2) || place + 1 == parts.len();
    parts.iter().enumerate().filter(|(place, _)| is_text(*place)).map(|(_, part)| *part).collect()
}

/// The names by which links know the headings of a text.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    let headings = prose(text).filter_map(|(_, line)| {
        let rest = line.trim_start_matches('#');
        (rest.len() < line.len() && rest.starts_with(' ')).then(|| anchor(rest.trim()))
    });
    let numbered = headings.map(|name| {
        let time = times.entry(name.clone()).or_insert(0);
        *time += 1;
        if *time == 1 { name } else { format!("{name}-{}", *time - 1) }
    });
    numbered.collect()
}

/// The name of a heading: small letters, digits, - and _, with - for blanks.
pub fn anchor(heading: &str) -> String {
    // Of a link its text counts.
    let mut text = String::new();
    let mut rest = heading;
    while let Some((before, after)) = rest.split_once("](") {
        text.push_str(before);
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    text.push_str(rest);
    let kept = text.chars().filter(|letter| letter.is_alphanumeric() || matches!(letter, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_somewhere_and_every_page_is_in_the_contents_once() {
        assert_eq!(violations(&crate::root()).unwrap(), Vec::<String>::new());
    }

    #[test]
    fn dead_links_and_pages_that_are_left_out_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("README.md", "[a](docs/a.md#second-part) [b](docs/c.md)\n");
        write("docs/SUMMARY.md", "- [A](a.md)\n- [A again](a.md)\n- [Top](../README.md)\n");
        write(
            "docs/a.md",
            "# A\n\n## Second `part`\n\n[here](#first) `[no](link.md)`\n\n```\n[nor](this.md)\n```\n",
        );
        write("docs/b/b.md", "[up](../a.md) [web](https://example.org/x.md) [out](../../../x.md)\n");
        write("fixtures/README.md", "[a](../docs/a.md#a)\n");
        assert_eq!(
            violations(folder.path()).unwrap(),
            [
                "README.md:1: a link to docs/c.md, which is not there",
                "docs/a.md:5: docs/a.md has no heading #first",
                "docs/SUMMARY.md: has docs/a.md 2 times, and should have it once",
                "docs/SUMMARY.md: has docs/b/b.md 0 times, and should have it once",
            ]
        );
    }

    #[test]
    fn headings_are_named_as_web_pages_name_them() {
        let text = "# report.json\n## Files of [other](x.md) programs\n### Kᵒ, η\n## Files\n## Files\n#no\n";
        let expected = ["report.json", "files-of-other-programs", "kᵒ-η", "files", "files-1"];
        let expected = expected.map(|name| name.replace('.', ""));
        assert_eq!(anchors(text), expected.into_iter().collect());
    }
}
