//! The table of layers, verified against the manifests.

use std::fs;
use std::path::Path;
use toml::Table;

/// What a crate of ours may import.
enum Imports {
    /// These crates in the library; those and the second list in tests and benches.
    Only(&'static [&'static str], &'static [&'static str]),
    /// Whatever it needs.
    Any,
}

/// Folder under crates/, or xtask itself, and what it may import.
const LAYERS: &[(&str, Imports)] = &[
    ("geometry", Imports::Only(&[], &[])),
    ("linalg", Imports::Only(&[], &[])),
    ("theory", Imports::Only(&[], &[])),
    ("model", Imports::Only(&["geometry"], &[])),
    ("observables", Imports::Only(&["geometry"], &[])),
    ("segmentation", Imports::Only(&["geometry"], &[])),
    ("simulate", Imports::Only(&["geometry", "model", "observables", "linalg"], &[])),
    ("infer", Imports::Only(&["geometry", "model", "observables", "linalg"], &["segmentation", "simulate"])),
    ("spectrum", Imports::Only(&["geometry", "model", "linalg"], &[])),
    ("io", Imports::Only(&["geometry", "segmentation", "model"], &[])),
    ("report", Imports::Only(&[], &[])),
    ("cli", Imports::Any),
    ("python", Imports::Only(&["cli"], &[])),
    // What is compiled before any check can run.
    ("xtask", Imports::Only(&[], &[])),
];

/// Packages from elsewhere that one crate alone may import.
const OWNED: &[(&str, &str)] =
    &[("delaunator", "geometry"), ("faer", "linalg"), ("robust", "geometry"), ("spade", "geometry")];

/// Prefix of the package names of our libraries.
const PREFIX: &str = "voronudge-";

/// Every breach of the table, as text.
pub fn violations(root: &Path) -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let mut found = Vec::new();
    let mut folders = vec![root.join("xtask")];
    for folder in fs::read_dir(root.join("crates"))? {
        folders.push(folder?.path());
    }
    folders.sort();
    for folder in folders {
        let (name, manifest) = (folder.file_name().unwrap_or_default(), folder.join("Cargo.toml"));
        if manifest.is_file() {
            found.extend(breaches(&name.to_string_lossy(), &fs::read_to_string(&manifest)?.parse()?));
        }
    }
    Ok(found)
}

/// The breaches of one manifest.
fn breaches(folder: &str, manifest: &Table) -> Vec<String> {
    let Some((_, imports)) = LAYERS.iter().find(|(name, _)| *name == folder) else {
        return vec![format!("{folder}: not in the table of layers (xtask/src/check/layers.rs)")];
    };
    let mut found = Vec::new();
    for (section, package) in dependencies(manifest) {
        if let Some((_, owner)) = OWNED.iter().find(|(name, _)| *name == package)
            && *owner != folder
        {
            found.push(format!("{folder}: imports {package}, which only {owner} may"));
        }
        let Imports::Only(always, in_tests) = imports else { continue };
        let ours = match package.strip_prefix(PREFIX) {
            Some(ours) => ours,
            None if package == "voronudge" => "cli",
            None => continue,
        };
        let allowed = always.contains(&ours) || (section == Section::Tests && in_tests.contains(&ours));
        if !allowed {
            found.push(format!("{folder}: may not import {ours}; its layer allows {always:?}"));
        }
    }
    found
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    Library,
    Tests,
}

/// Names of all packages that a manifest depends on, also for certain targets only, renamed ones by their true name.
fn dependencies(manifest: &Table) -> Vec<(Section, String)> {
    let targets = manifest.get("target").and_then(|targets| targets.as_table());
    let parts = std::iter::once(manifest)
        .chain(targets.into_iter().flat_map(|targets| targets.values().filter_map(|value| value.as_table())));
    let mut found = Vec::new();
    for part in parts {
        for (key, section) in [
            ("dependencies", Section::Library),
            ("build-dependencies", Section::Library),
            ("dev-dependencies", Section::Tests),
        ] {
            for (name, value) in part.get(key).and_then(|table| table.as_table()).into_iter().flatten() {
                let package = value.get("package").and_then(|package| package.as_str()).unwrap_or(name);
                found.push((section, package.to_owned()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn breaches_of(folder: &str, manifest: &str) -> Vec<String> {
        breaches(folder, &manifest.parse().unwrap())
    }

    #[test]
    fn the_table_is_kept() {
        assert_eq!(violations(&crate::root()).unwrap(), Vec::<String>::new());
    }

    #[test]
    fn a_sideways_import_is_found() {
        let manifest = "[dependencies]\nvoronudge-simulate = { workspace = true }\nserde = \"1\"\n";
        assert_eq!(breaches_of("infer", manifest).len(), 1);
        assert_eq!(breaches_of("infer", &manifest.replace("[dep", "[dev-dep")).len(), 0);
        assert_eq!(breaches_of("io", &manifest.replace("[dep", "[dev-dep")).len(), 1);
        assert_eq!(breaches_of("cli", manifest).len(), 0);
        assert_eq!(breaches_of("xtask", manifest).len(), 1);
    }

    #[test]
    fn an_owned_package_is_found_behind_a_name_and_a_target() {
        let manifest = "[target.'cfg(unix)'.dependencies]\nfast = { package = \"faer\", version = \"1\" }\n";
        assert_eq!(breaches_of("cli", manifest).len(), 1);
        assert_eq!(breaches_of("linalg", manifest).len(), 0);
    }

    #[test]
    fn an_unknown_crate_is_found() {
        assert_eq!(breaches_of("physics", "").len(), 1);
    }
}
