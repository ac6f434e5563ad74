//! What the targets have in common: a folder of their own, and what is expected of every reader.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use voronudge_io::Error;

/// A folder that lasts as long as the process.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| TempDir::new().expect("a temporary folder")).path()
}

/// A file there with these bytes, in folders that are made for it.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    std::fs::create_dir_all(path.parent().unwrap_or(folder())).expect("room in the temporary folder");
    std::fs::write(&path, bytes).expect("room in the temporary folder");
    path
}

/// Whatever is read, it ends with a value or with an error that comes with advice and in one line.
pub fn told<T>(read: Result<T, Error>) {
    if let Err(error) = read {
        let text = error.to_string();
        assert!(error.hint().is_some() && !text.contains('\n'), "{text}");
    }
}
