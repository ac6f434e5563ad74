//! How large the source is: lines and types of every crate, without tests.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::Command;

#[derive(clap::Args)]
pub struct Arguments {
    /// Count in this commit.
    #[arg(long, default_value = "HEAD", value_name = "COMMIT")]
    at: String,
}

/// Lines, and structs and enums.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Size {
    lines: usize,
    types: usize,
}

impl Size {
    /// Of a file, up to the tests inside it.
    fn of(text: &str) -> Self {
        let lines: Vec<&str> = text.lines().collect();
        let is_test = |pair: &[&str]| {
            pair[0] == "#[cfg(test)]" && pair[1].starts_with("mod ") && pair[1].ends_with('{')
        };
        let end = lines.windows(2).position(is_test).unwrap_or(lines.len());
        let types = lines[..end].iter().filter(|line| declares_type(line)).count();
        Self { lines: end, types }
    }

    fn add(&mut self, other: Self) {
        self.lines += other.lines;
        self.types += other.types;
    }
}

fn declares_type(line: &str) -> bool {
    let words = line.trim_start();
    let words = match words.strip_prefix("pub") {
        Some(rest) => rest.trim_start_matches(|c: char| c != ' ').trim_start(),
        None => words,
    };
    words.starts_with("struct ") || words.starts_with("enum ")
}

/// The crate of a file of the source; nothing for tests and benchmarks.
fn crate_of(file: &str) -> Option<&str> {
    let tests = ["tests/", "benches/"];
    let is_test = tests.iter().any(|folder| file.starts_with(folder) || file.contains(&format!("/{folder}")));
    let is_source = file.ends_with(".rs") && !is_test && !file.ends_with("/tests.rs");
    let name = file.strip_prefix("crates/").unwrap_or(file).split('/').next();
    name.filter(|_| is_source)
}

pub fn run(root: &Path, arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let git = |words: &[&str]| -> Result<String, Box<dyn Error>> {
        let output = Command::new("git").current_dir(root).args(words).output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned().into());
        }
        Ok(String::from_utf8(output.stdout)?)
    };
    let mut sizes: BTreeMap<String, Size> = BTreeMap::new();
    for file in git(&["ls-tree", "-r", "--name-only", &arguments.at])?.lines() {
        if let Some(name) = crate_of(file) {
            let size = Size::of(&git(&["show", &format!("{}:{file}", arguments.at)])?);
            sizes.entry(name.to_owned()).or_default().add(size);
        }
    }
    let mut total = Size::default();
    println!("{:<16}{:>8}{:>8}", "crate", "lines", "types");
    for (name, size) in &sizes {
        total.add(*size);
        println!("{name:<16}{:>8}{:>8}", size.lines, size.types);
    }
    println!("{:<16}{:>8}{:>8}", "all", total.lines, total.types);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Size, crate_of};

    #[test]
    fn tests_are_not_counted() {
        let text =
            "pub(crate) struct A;\nenum B {}\n// struct C\n#[cfg(test)]\nmod tests {\n    struct D;\n}\n";
        assert_eq!(Size::of(text), Size { lines: 3, types: 2 });
        assert_eq!(crate_of("crates/io/src/lib.rs"), Some("io"));
        assert_eq!(crate_of("xtask/src/main.rs"), Some("xtask"));
        for file in
            ["tests/claims/a.rs", "crates/io/tests/suite/a.rs", "crates/io/src/a/tests.rs", "README.md"]
        {
            assert_eq!(crate_of(file), None, "{file}");
        }
    }
}
