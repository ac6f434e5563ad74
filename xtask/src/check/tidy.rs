//! Tidiness of the text files, and where packages come from.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Endings of the files whose text is looked at.
const TEXT: &[&str] = &["rs", "toml", "md", "html"];
/// Lines that a Rust file may have.
const LINE_LIMIT: usize = 400;
/// Names that say nothing about what is in a file.
const EMPTY_NAMES: &[&str] = &["utils", "helpers", "common", "misc"];
/// Hidden folders that belong to the project.
const HIDDEN: &[&str] = &[".cargo", ".ci", ".github"];
/// The one registry that packages come from.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Every untidiness, as text.
pub fn violations(root: &Path) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let ignored = Ignored::read(root)?;
    let mut files = Vec::new();
    collect(root, root, &ignored, &mut files)?;
    files.sort();
    let mut found = Vec::new();
    for file in &files {
        let name = file.strip_prefix(root).unwrap_or(file);
        found.extend(name_faults(name));
        if TEXT.iter().any(|ending| has_ending(name, ending)) {
            found.extend(text_faults(name, &fs::read_to_string(file)?));
        }
    }
    for lock in files.iter().filter(|file| file.ends_with("Cargo.lock")) {
        found.extend(source_faults(&fs::read_to_string(lock)?));
    }
    Ok(found)
}

/// What .gitignore leaves out: folders at the top (`/name`) and endings (`*.ending`).
struct Ignored {
    lines: Vec<String>,
}

impl Ignored {
    fn read(root: &Path) -> io::Result<Self> {
        let text = match fs::read_to_string(root.join(".gitignore")) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            other => other?,
        };
        Ok(Self { lines: text.lines().map(|line| line.trim_end_matches('/').to_owned()).collect() })
    }

    fn covers(&self, name: &Path) -> bool {
        self.lines.iter().any(|line| match (line.strip_prefix('/'), line.strip_prefix("*.")) {
            (Some(folder), _) => name == Path::new(folder),
            (_, Some(ending)) => has_ending(name, ending),
            _ => false,
        })
    }
}

fn collect(root: &Path, folder: &Path, ignored: &Ignored, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let (path, kind) = (entry.path(), entry.file_type()?);
        let name = entry.file_name().to_string_lossy().into_owned();
        let foreign = name.starts_with('.') && !HIDDEN.contains(&name.as_str());
        if foreign || ignored.covers(path.strip_prefix(root).unwrap_or(&path)) {
            continue;
        }
        if kind.is_dir() {
            collect(root, &path, ignored, files)?;
        } else if kind.is_file() {
            files.push(path);
        }
    }
    Ok(())
}

fn has_ending(name: &Path, ending: &str) -> bool {
    name.extension().is_some_and(|found| found == ending)
}

/// Files and folders, and so modules, with an empty name.
fn name_faults(name: &Path) -> Option<String> {
    let stem = |part: &Path| part.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let empty = name
        .iter()
        .filter_map(|part| stem(Path::new(part)))
        .find(|stem| EMPTY_NAMES.contains(&stem.as_str()));
    empty.map(|stem| format!("{}: \"{stem}\" does not say what is in it", name.display()))
}

fn text_faults(name: &Path, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let place = name.display();
    for (number, line) in (1..).zip(text.split('\n')) {
        if line.contains('\t') {
            found.push(format!("{place}:{number}: a tab"));
        }
        if line.ends_with([' ', '\r']) {
            found.push(format!("{place}:{number}: whitespace at the end of the line"));
        }
    }
    if !text.is_empty() && !text.ends_with('\n') {
        found.push(format!("{place}: no newline at the end of the file"));
    }
    let lines = text.lines().count();
    if has_ending(name, "rs") && lines > LINE_LIMIT {
        found.push(format!("{place}: {lines} lines, but {LINE_LIMIT} are the limit"));
    }
    found
}

/// Packages of a lock file that come from anywhere but crates.io.
fn source_faults(lock: &str) -> Vec<String> {
    let sources = lock.lines().filter_map(|line| line.strip_prefix("source = "));
    let foreign = sources.map(|source| source.trim_matches('"')).filter(|source| *source != REGISTRY);
    foreign.map(|source| format!("Cargo.lock: a package from {source}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_is_found_with_its_place() {
        let name = Path::new("src/a.rs");
        assert_eq!(text_faults(name, "fn a() {}\n"), Vec::<String>::new());
        assert_eq!(text_faults(name, "a\n\tb\n"), ["src/a.rs:2: a tab"]);
        assert_eq!(text_faults(name, "a \n"), ["src/a.rs:1: whitespace at the end of the line"]);
        assert_eq!(text_faults(name, "a"), ["src/a.rs: no newline at the end of the file"]);
        assert_eq!(text_faults(name, &"a\n".repeat(401)).len(), 1);
        assert_eq!(text_faults(Path::new("a.md"), &"a\n".repeat(401)).len(), 0);
    }

    #[test]
    fn empty_names_are_found_for_files_and_folders() {
        assert!(name_faults(Path::new("crates/model/src/utils.rs")).is_some());
        assert!(name_faults(Path::new("tests/common/mod.rs")).is_some());
        assert!(name_faults(Path::new("crates/model/src/stress.rs")).is_none());
    }

    #[test]
    fn foreign_sources_are_found() {
        assert!(source_faults(&format!("source = \"{REGISTRY}\"\n")).is_empty());
        assert_eq!(source_faults("source = \"git+https://example.org/a\"\n").len(), 1);
    }

    #[test]
    fn ignored_places_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write(".gitignore", "/target\n*.tmp\n");
        write("Cargo.lock", "");
        for name in ["target/a.rs", "b.tmp", ".hidden/c.rs"] {
            write(name, "\t");
        }
        assert_eq!(violations(folder.path()).unwrap(), Vec::<String>::new());
        write("src/target/a.rs", "\t\n");
        assert_eq!(violations(folder.path()).unwrap().len(), 1);
    }
}
