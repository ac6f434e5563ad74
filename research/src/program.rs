//! The tool itself, as a process.

use std::error::Error;
use std::path::PathBuf;
use std::process::Command;

/// The tool, built with this program or by it.
pub fn path() -> Result<PathBuf, Box<dyn Error>> {
    let own = std::env::current_exe()?;
    // target/release/research, or target/release/deps/research-… of the tests.
    let beside = own.ancestors().skip(1).take(2).map(|folder| folder.join("voronudge"));
    if let Some(found) = beside.into_iter().find(|path| path.is_file()) {
        return Ok(found);
    }
    let root = crate::root();
    let status = Command::new("cargo")
        .args(["build", "--release", "--package", "voronudge"])
        .current_dir(&root)
        .status()?;
    if !status.success() {
        return Err("the tool cannot be built".into());
    }
    Ok(root.join("target/release/voronudge"))
}
