//! The pages as a site with search, by mdBook.

use crate::Outcome;
use crate::check::pages::{CONTENTS, Pages};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is said where mdBook is not there.
const INSTALL: &str = "mdbook cannot be run; cargo install mdbook --no-default-features --features search";

/// Builds the site in target/book, and checks the links of its pages.
pub fn run(root: &Path) -> Outcome {
    let [source, site] = ["target/book-source", "target/book"].map(|folder| root.join(folder));
    for folder in [&source, &site] {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
    }
    gather(root, &source)?;
    let mut mdbook = Command::new("mdbook");
    let status = mdbook.arg("build").arg(&source).arg("--dest-dir").arg(&site).status();
    if !status.map_err(|error| format!("{INSTALL} ({error})"))?.success() {
        return Err("mdbook failed".into());
    }
    let dead = dead_links(&site)?;
    match dead.is_empty() {
        true => println!("{} has the pages", site.join("index.html").display()),
        false => return Err(dead.join("\n").into()),
    }
    Ok(())
}

/// Puts the pages of the table of contents, and what they lead to, where mdBook can find them by the same paths.
fn gather(root: &Path, source: &Path) -> Outcome {
    let pages = Pages::read(root)?;
    let contents = pages.texts.get(Path::new(CONTENTS)).ok_or("there is no table of contents")?;
    let mut files: Vec<PathBuf> = Vec::new();
    within(&root.join("docs"), &mut files)?;
    files.extend(pages.links_of(Path::new(CONTENTS)).map(|link| root.join(link.page)));
    let listed: Vec<PathBuf> = pages.links_of(Path::new(CONTENTS)).map(|link| link.page).collect();
    files.extend(listed.iter().flat_map(|page| pages.links_of(page)).map(|link| root.join(link.page)));
    for file in files.iter().filter(|file| file.is_file()) {
        let place = source.join(file.strip_prefix(root)?);
        fs::create_dir_all(place.parent().unwrap_or(source))?;
        fs::copy(file, place)?;
    }
    // Paths of the table of contents are those from its folder.
    let contents = contents.replace("](", "](docs/").replace("](docs/../", "](");
    fs::write(source.join("SUMMARY.md"), contents)?;
    fs::remove_file(source.join(CONTENTS))?;
    fs::copy(root.join("docs/book.toml"), source.join("book.toml"))?;
    Ok(())
}

/// All files of a folder and of those in it.
fn within(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        match path.is_dir() {
            true => within(&path, files)?,
            false => files.push(path),
        }
    }
    Ok(())
}

/// Links of the site that lead to no file of it, or to no part of a page.
fn dead_links(site: &Path) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let mut files = Vec::new();
    within(site, &mut files)?;
    let mut found = Vec::new();
    let is_page = |file: &&PathBuf| file.extension().is_some_and(|end| end == "html");
    for page in files.iter().filter(is_page) {
        let text = fs::read_to_string(page)?;
        for target in ["href=\"", "src=\""].into_iter().flat_map(|begin| text.split(begin).skip(1)) {
            let target = target.split('"').next().unwrap_or_default();
            if target.contains(':') || target.starts_with('/') {
                continue;
            }
            let (file, part) = target.split_once('#').unwrap_or((target, ""));
            let file = file.split('?').next().unwrap_or_default();
            let to = if file.is_empty() { page.clone() } else { page.with_file_name("").join(file) };
            let has_part = || {
                let quoted = format!("id=\"{part}\"");
                part.is_empty() || fs::read_to_string(&to).is_ok_and(|text| text.contains(&quoted))
            };
            if !to.is_file() || !has_part() {
                found.push(format!("{}: {target} leads nowhere", page.strip_prefix(site)?.display()));
            }
        }
    }
    found.sort();
    found.dedup();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_a_site_that_lead_nowhere_are_found() {
        let site = tempfile::tempdir().unwrap();
        fs::create_dir(site.path().join("docs")).unwrap();
        let write = |name: &str, text: &str| fs::write(site.path().join(name), text).unwrap();
        write(
            "index.html",
            r##"<a href="docs/a.html#part">a</a> <a href="https://example.org/b">b</a> <img src="c.svg">"##,
        );
        write(
            "docs/a.html",
            r##"<h1 id="part">A</h1> <a href="../index.html?x">up</a> <a href="#part">here</a> <a href="#no">no</a>"##,
        );
        assert_eq!(
            dead_links(site.path()).unwrap(),
            ["docs/a.html: #no leads nowhere", "index.html: c.svg leads nowhere"]
        );
    }

    #[test]
    fn all_that_pages_lead_to_is_gathered() {
        let source = tempfile::tempdir().unwrap();
        gather(&crate::root(), source.path()).unwrap();
        let contents = fs::read_to_string(source.path().join("SUMMARY.md")).unwrap();
        for place in ["README.md", "docs/commands/README.md", "ARCHITECTURE.md", "fixtures/imports/README.md"]
        {
            assert!(contents.contains(&format!("]({place})")), "{contents}");
            assert!(source.path().join(place).is_file());
        }
        for linked in
            ["LICENSE-MIT", "crates/report/schema/infer.schema.json", "docs/figures/report.png", "book.toml"]
        {
            assert!(source.path().join(linked).is_file(), "{linked}");
        }
    }
}
