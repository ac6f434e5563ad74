//! Readers of files under a fuzzer that is guided by the branches which an input takes.

use crate::Outcome;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Counters of branches, as `cargo fuzz` has them made, with any compiler.
const COUNTED: &str = "--cfg fuzzing -Ccodegen-units=1 -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                       -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
                       -Cllvm-args=-sanitizer-coverage-trace-compares";

/// Longest time of an input, in seconds, and memory of the reader, in MB.
const LIMITS: [&str; 2] = ["-timeout=20", "-rss_limit_mb=2048"];

#[derive(clap::Args)]
pub struct Arguments {
    /// How long for each kind of file.
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// These kinds of files only, names in `tests/fuzz/fuzz_targets`.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
}

pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    let folder = root.join("tests/fuzz");
    let host = host()?;
    let status = Command::new("cargo")
        .args(["build", "--release", "--target", &host])
        .env("RUSTFLAGS", COUNTED)
        .current_dir(&folder)
        .status()?;
    if !status.success() {
        return Err("the targets cannot be built; they need a C++ compiler".into());
    }
    let mut names = Vec::new();
    for entry in fs::read_dir(folder.join("fuzz_targets"))? {
        let path = entry?.path();
        names.extend(path.file_stem().map(|name| name.to_string_lossy().into_owned()));
    }
    names.sort();
    names.retain(|name| arguments.only.is_empty() || arguments.only.contains(name));
    let (mut failed, bytes) = (Vec::new(), root.join("crates/io/tests/corpus"));
    for name in names {
        let (found, artifacts) = (folder.join("corpus").join(&name), folder.join("artifacts").join(&name));
        fs::create_dir_all(&found)?;
        fs::create_dir_all(&artifacts)?;
        println!("{name}");
        let mut target = Command::new(folder.join("target").join(&host).join("release").join(&name));
        target.args(LIMITS).arg("-verbosity=0").arg("-print_final_stats=1");
        target.arg(format!("-max_total_time={}", arguments.seconds));
        target.arg(format!("-artifact_prefix={}/", artifacts.display()));
        // What is found is kept in the first of the folders.
        let status = target.arg(found).arg(folder.join("seeds").join(&name)).arg(&bytes).status()?;
        if !status.success() {
            failed.push(format!("{name} (its input is in {})", artifacts.display()));
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join(", ").into()) }
}

/// The kind of machine that the compiler runs on.
fn host() -> Result<String, Box<dyn std::error::Error>> {
    let told = Command::new("rustc").arg("-vV").output()?;
    let told = String::from_utf8(told.stdout)?;
    let host = told.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.ok_or("rustc does not say what machine it runs on")?.to_owned())
}
