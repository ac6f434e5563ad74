//! Runs of the program killed at random moments and taken up again, for as long as asked: each must come to the bytes of one that was left
//! alone.

use crate::{Outcome, program};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Kills after which a run is left alone.
const MOST_KILLS: usize = 30;

#[derive(clap::Args)]
pub struct Arguments {
    /// How long.
    #[arg(long, default_value_t = 10.0)]
    minutes: f64,
    /// Seed of the moments.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// Command lines that can be taken up again, `SEED` to be replaced.
const LINES: [&str; 4] = [
    "simulate --cells 200 --time 20 --frames 150 --alpha 1 --checkpoint 0.02 --seed SEED",
    "simulate --cells 100 --time 5 --frames 20 --self-propulsion 0.5 --rotational-diffusion 1 --diffusion 0.01 --checkpoint 0 --seed SEED",
    "phase-diagram --cells 64 --time 6 --P_0 3.6 4 3 --alpha -0.2 0.2 3 --seed SEED",
    "infer FIXTURES/chiral-liquid --fix K_A=0.1 --max-steps 2 --position-noise 0.5% --velocity-noise 5% --bootstrap 40 --seed SEED",
];

pub fn run(root: &Path, arguments: &Arguments) -> Outcome {
    let program = program::path()?;
    let mut random = Pcg64::seed_from_u64(arguments.seed);
    let (begun, whole) = (Instant::now(), Duration::try_from_secs_f64(60.0 * arguments.minutes)?);
    let (mut rounds, mut kills) = (0_usize, 0);
    while begun.elapsed() < whole {
        let seed: u32 = random.random();
        let line = LINES[rounds % LINES.len()].replace("SEED", &seed.to_string());
        let line = line.replace("FIXTURES", &root.join("fixtures").display().to_string());
        let folder = tempfile::tempdir()?;
        let (alone, cut) = (folder.path().join("alone"), folder.path().join("cut"));
        let at_work = Instant::now();
        // Some runs fail, always in the same way.
        let ends = start(&program, &line, &alone, &[])?.wait()?.code();
        let expected = Expected { line: &line, ends, time: at_work.elapsed() };
        kills += expected.cut_off(&program, &cut, &mut random)?;
        if content(&alone)? != content(&cut)? {
            let kept = folder.keep();
            return Err(format!("{line}: another result after kills; see {}", kept.display()).into());
        }
        rounds += 1;
        println!("{rounds} runs, {kills} kills, {:.0} s", begun.elapsed().as_secs_f64());
    }
    Ok(())
}

/// A run that was left alone.
struct Expected<'a> {
    line: &'a str,
    ends: Option<i32>,
    time: Duration,
}

impl Expected<'_> {
    /// Makes the run until it ends by itself, killed at random moments before; how often.
    fn cut_off(&self, program: &Path, out: &Path, random: &mut Pcg64) -> Result<usize, Box<dyn Error>> {
        for kills in 0.. {
            let mut run = start(program, self.line, out, &["--resume"])?;
            // Some moments are those after the last step.
            let patience = self.time.mul_f64(random.random_range(0.0..1.2));
            let begun = Instant::now();
            while run.try_wait()?.is_none() && (kills == MOST_KILLS || begun.elapsed() < patience) {
                sleep(Duration::from_millis(1));
            }
            match run.try_wait()? {
                Some(status) if status.code() == self.ends => return Ok(kills),
                Some(status) => return Err(format!("{}: {status}", self.line).into()),
                None => {
                    run.kill()?;
                    run.wait()?;
                }
            }
        }
        Ok(MOST_KILLS)
    }
}

fn start(program: &Path, line: &str, out: &Path, flags: &[&str]) -> std::io::Result<std::process::Child> {
    let mut command = Command::new(program);
    command.args(line.split_whitespace()).args(flags).arg("--quiet").arg("--out").arg(out);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn()
}

/// All files, hidden ones too; reports contain the record of the run and are only there or not.
fn content(folder: &Path) -> std::io::Result<BTreeMap<PathBuf, Vec<u8>>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = PathBuf::from(path.file_name().unwrap_or_default());
        let is_report = name.to_string_lossy().starts_with("report.");
        files.insert(name, if is_report || path.is_dir() { Vec::new() } else { fs::read(&path)? });
    }
    Ok(files)
}
