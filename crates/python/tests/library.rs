//! The extension is built with all else, as a library that Python finds its entry in.

use std::error::Error;
use std::fs;

#[test]
fn python_finds_its_entry() -> Result<(), Box<dyn Error>> {
    let program = std::env::current_exe()?;
    let folder = program.parent().ok_or("no folder")?;
    let name = format!("{}_native{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = fs::read(folder.join(name))?;
    let entry = b"PyInit__native";
    assert!(library.windows(entry.len()).any(|bytes| bytes == entry));
    Ok(())
}
