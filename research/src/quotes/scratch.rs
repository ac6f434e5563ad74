//! A folder in which the commands of a page are run as a reader would.

use crate::program;
use std::error::Error;
use std::fs::{self, File};
use std::io;
use std::path::{Component, Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time between looks at a command.
const LOOK: Duration = Duration::from_millis(20);
/// Ticks of a second in which Linux tells processor time.
const TICKS: f64 = 100.0;
/// By how much more time of the clock than of the processor a command is stopped, which waits or has children whose time is told at their end only.
const PATIENCE: f64 = 10.0;

/// A folder with the fixtures, and with what else a reader has.
pub struct Scratch {
    folder: tempfile::TempDir,
    program: PathBuf,
}

/// What became of a command.
#[derive(Debug)]
pub enum Ran {
    /// It ended: what it printed, its exit code, and the processor time in seconds.
    Ended(Printed),
    /// It was stopped.
    TooLong,
    /// It was not begun for want of a file.
    Lacks(String),
}

#[derive(Debug)]
pub struct Printed {
    pub text: String,
    pub code: Option<i32>,
    pub seconds: f64,
}

impl Scratch {
    /// With links to the fixtures, and to what is in the folder of the reader.
    pub fn new(root: &Path, reader: Option<&Path>) -> Result<Self, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        link(&root.join("fixtures"), &folder.path().join("fixtures"))?;
        for entry in reader.map(fs::read_dir).into_iter().flatten().flatten() {
            let entry = entry?;
            link(&entry.path().canonicalize()?, &folder.path().join(entry.file_name()))?;
        }
        Ok(Self { folder, program: program::path()? })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs a command line for at most so many seconds of processor time; `brought` are files that a reader has.
    pub fn run(&self, line: &str, brought: &[String], limit: f64) -> Result<Ran, Box<dyn Error>> {
        let words = words(line);
        let begins = |word: &str, name: &str| word == name || word.starts_with(&format!("{name}/"));
        let lacks = |name: &&String| {
            words.iter().any(|word| begins(word, name)) && !self.folder.path().join(name).exists()
        };
        if let Some(name) = brought.iter().find(lacks) {
            return Ok(Ran::Lacks(name.clone()));
        }
        let (program, arguments) = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["voronudge", ..] => (self.program.clone(), &words[1..]),
            ["cargo", "xtask", ..] => (std::env::current_exe()?, &words[2..]),
            _ => return Err(format!("{line}: neither voronudge nor cargo xtask").into()),
        };
        let path = self.folder.path().join(".printed");
        let printed = File::create(&path)?;
        let mut command = Command::new(program);
        command.args(arguments).current_dir(self.folder.path()).env("RAYON_NUM_THREADS", "1");
        command.stdin(Stdio::null()).stdout(printed.try_clone()?).stderr(printed);
        alone(&mut command);
        let mut child = command.spawn()?;
        let begun = Instant::now();
        let mut seconds = 0.0;
        let status = loop {
            seconds =
                processor_time(child.id()).unwrap_or_else(|| begun.elapsed().as_secs_f64()).max(seconds);
            if let Some(status) = child.try_wait()? {
                break status;
            }
            if seconds > limit || begun.elapsed().as_secs_f64() > PATIENCE * limit {
                stop(&mut child)?;
                self.clear(&out(line))?;
                return Ok(Ran::TooLong);
            }
            sleep(LOOK);
        };
        let text = String::from_utf8_lossy(&fs::read(&path)?).into_owned();
        Ok(Ran::Ended(Printed { text, code: status.code(), seconds }))
    }

    /// Removes a folder that a command which was stopped had begun, lest the next find it.
    fn clear(&self, name: &str) -> io::Result<()> {
        let is_within = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let folder = self.folder.path().join(name);
        if is_within && !name.is_empty() && folder.symlink_metadata().is_ok_and(|found| found.is_dir()) {
            fs::remove_dir_all(folder)?;
        }
        Ok(())
    }
}

/// The words of a command line, parts in quotation marks kept together.
pub fn words(line: &str) -> Vec<String> {
    let (mut found, mut word, mut mark) = (Vec::new(), None::<String>, None);
    for letter in line.chars() {
        match mark {
            Some(end) if letter == end => mark = None,
            None if matches!(letter, '"' | '\'') => {
                mark = Some(letter);
                word.get_or_insert_default();
            }
            None if letter.is_whitespace() => found.extend(word.take()),
            _ => word.get_or_insert_default().push(letter),
        }
    }
    found.extend(word);
    found
}

/// The folder that a command line writes to.
pub fn out(line: &str) -> String {
    let words = words(line);
    let place = words.iter().position(|word| word == "--out");
    place.and_then(|place| words.get(place + 1)).cloned().unwrap_or_default()
}

/// What Linux says of a process: its own time, and that of its children that have ended.
fn processor_time(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name of the program, which may contain anything, is in brackets.
    let fields: Vec<&str> = status.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: Option<Vec<f64>> = fields.get(11..15)?.iter().map(|field| field.parse().ok()).collect();
    Some(ticks?.iter().sum::<f64>() / TICKS)
}

#[cfg(unix)]
fn link(from: &Path, to: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(from, to)
}

#[cfg(not(unix))]
fn link(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::Error::new(io::ErrorKind::Unsupported, "files are linked on Unix only"))
}

/// In a group of its own, which can be stopped with all that it starts.
#[cfg(unix)]
fn alone(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

#[cfg(not(unix))]
fn alone(_: &mut Command) {}

/// Ends a command and what it started.
fn stop(child: &mut Child) -> io::Result<()> {
    if cfg!(unix) {
        Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status()?;
    }
    child.kill()?;
    child.wait()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_a_shell() {
        assert_eq!(words(r#"a --b "5 %" 'c d'e  f"#), ["a", "--b", "5 %", "c de", "f"]);
        assert_eq!(words(r#"a """#), ["a", ""]);
        assert_eq!(out("voronudge infer x --out fit --dry-run"), "fit");
        assert_eq!(out("voronudge info x"), "");
    }

    #[test]
    fn the_time_of_a_process_is_told() {
        if cfg!(target_os = "linux") {
            assert!(processor_time(std::process::id()).is_some_and(|seconds| seconds >= 0.0));
        }
        assert_eq!(processor_time(u32::MAX), None);
    }
}
