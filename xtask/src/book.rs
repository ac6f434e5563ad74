//! The pages as a site with search, by mdBook, with the reference of the crates and of the Python package.

use crate::Outcome;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::pages::{CONTENTS, Pages};

/// What is said where mdBook is not there.
const INSTALL: &str = "mdbook cannot be run; cargo install mdbook --no-default-features --features search";
/// What is said where the Python package is left out.
const PYTHON: &str = "without the reference of the Python package: that takes `pip install . pdoc`";

/// Pages of another tool that go into the site.
struct Reference {
    /// What they are of.
    of: &'static str,
    /// Where they were made, their folder in the site, and the page there with which they begin.
    made: PathBuf,
    folder: &'static str,
    first: &'static str,
}

/// Builds the site in target/book, and checks the links of its pages.
pub fn run(root: &Path) -> Outcome {
    let [source, site] = ["target/book-source", "target/book"].map(|folder| root.join(folder));
    let references = references(root)?;
    build(root, &source, &site, &references)?;
    println!("{} has the pages", site.join("index.html").display());
    Ok(())
}

/// The site of the pages and of references.
fn build(root: &Path, source: &Path, site: &Path, references: &[Reference]) -> Outcome {
    for folder in [source, site] {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
    }
    gather(root, source, references)?;
    let mut mdbook = Command::new("mdbook");
    let status = mdbook.arg("build").arg(source).arg("--dest-dir").arg(site).status();
    if !status.map_err(|error| format!("{INSTALL} ({error})"))?.success() {
        return Err("mdbook failed".into());
    }
    let mut pages = Vec::new();
    within(site, &mut pages)?;
    for Reference { made, folder, .. } in references {
        let mut files = Vec::new();
        within(made, &mut files)?;
        copy(&files, made, &site.join(folder))?;
    }
    let dead = dead_links(site, &pages)?;
    if dead.is_empty() { Ok(()) } else { Err(dead.join("\n").into()) }
}

/// Makes the reference of the crates, and that of the Python package where there are Python, the package and pdoc.
fn references(root: &Path) -> Result<Vec<Reference>, Box<dyn std::error::Error>> {
    let mut cargo = Command::new("cargo");
    cargo.current_dir(root).args(["doc", "--quiet", "--workspace", "--no-deps", "--lib"]);
    if !cargo.args(["--exclude", "claims", "--exclude", "xtask"]).status()?.success() {
        return Err("cargo doc failed".into());
    }
    let made = root.join("target/doc");
    let mut all = vec![Reference { of: "The crates", made, folder: "api", first: "voronudge/index.html" }];
    let made = root.join("target/book-python");
    let mut pdoc = Command::new("pdoc");
    pdoc.args(["--docformat", "numpy", "--output-directory"]).arg(&made).arg("voronudge");
    match pdoc.status() {
        Ok(status) if status.success() => {
            all.push(Reference { of: "The Python package", made, folder: "python", first: "voronudge.html" });
        }
        _ => eprintln!("{PYTHON}"),
    }
    Ok(all)
}

/// Puts the pages of the table of contents, and what they lead to, where mdBook can find them by the same paths.
fn gather(root: &Path, source: &Path, references: &[Reference]) -> Outcome {
    let pages = Pages::read(root)?;
    let contents = pages.texts.get(Path::new(CONTENTS)).ok_or("there is no table of contents")?;
    let mut files: Vec<PathBuf> = Vec::new();
    within(&root.join("docs"), &mut files)?;
    files.extend(pages.links_of(Path::new(CONTENTS)).map(|link| root.join(link.page)));
    let listed: Vec<PathBuf> = pages.links_of(Path::new(CONTENTS)).map(|link| link.page).collect();
    files.extend(listed.iter().flat_map(|page| pages.links_of(page)).map(|link| root.join(link.page)));
    copy(files.iter().filter(|file| file.is_file()), root, source)?;
    // Paths of the table of contents are those from its folder.
    let mut contents = contents.replace("](", "](docs/").replace("](docs/../", "](");
    if !references.is_empty() {
        let line = |Reference { of, folder, first, .. }: &Reference| format!("- [{of}]({folder}/{first})\n");
        let lines: String = references.iter().map(line).collect();
        fs::write(source.join("reference.md"), format!("# Reference\n\n{lines}"))?;
        contents += "- [Reference](reference.md)\n";
    }
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

/// Copies files of one folder to the same places in another.
fn copy<'a>(files: impl IntoIterator<Item = &'a PathBuf>, from: &Path, to: &Path) -> Outcome {
    for file in files {
        let place = to.join(file.strip_prefix(from)?);
        fs::create_dir_all(place.parent().unwrap_or(to))?;
        fs::copy(file, place)?;
    }
    Ok(())
}

/// Links of files of the site that lead to no file of it, or to no part of a page.
fn dead_links(site: &Path, files: &[PathBuf]) -> Result<Vec<String>, Box<dyn std::error::Error>> {
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
        let mut files = Vec::new();
        within(site.path(), &mut files).unwrap();
        assert_eq!(
            dead_links(site.path(), &files).unwrap(),
            ["docs/a.html: #no leads nowhere", "index.html: c.svg leads nowhere"]
        );
    }

    /// Where there is mdBook.
    #[test]
    fn the_site_is_made_and_no_link_of_it_leads_nowhere() {
        if Command::new("mdbook").arg("--version").output().is_err() {
            eprintln!("skipped: there is no mdBook");
            return;
        }
        let scratch = tempfile::tempdir().unwrap();
        let [source, site, made] = ["source", "site", "made"].map(|folder| scratch.path().join(folder));
        fs::create_dir(&made).unwrap();
        fs::write(made.join("first.html"), "<a href=\"elsewhere.html\">not of ours</a>").unwrap();
        let reference = Reference { of: "Another", made, folder: "another", first: "first.html" };
        build(&crate::root(), &source, &site, &[reference]).unwrap();
        for page in
            ["index.html", "docs/theory.html", "docs/gallery.html", "reference.html", "another/first.html"]
        {
            assert!(site.join(page).is_file(), "{page}");
        }
        assert!(fs::read_to_string(site.join("reference.html")).unwrap().contains("another/first.html"));
    }

    #[test]
    fn all_that_pages_lead_to_is_gathered() {
        let source = tempfile::tempdir().unwrap();
        gather(&crate::root(), source.path(), &[]).unwrap();
        let contents = fs::read_to_string(source.path().join("SUMMARY.md")).unwrap();
        for place in ["README.md", "docs/commands/README.md", "ARCHITECTURE.md", "fixtures/imports/README.md"]
        {
            assert!(contents.contains(&format!("]({place})")), "{contents}");
            assert!(source.path().join(place).is_file());
        }
        for linked in ["LICENSE-MIT", "docs/figures/report.png", "book.toml"] {
            assert!(source.path().join(linked).is_file(), "{linked}");
        }
    }
}
