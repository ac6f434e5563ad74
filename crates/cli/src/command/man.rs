//! `voronudge man`: manual pages.

use crate::failure::Failure;
use crate::program::description;
use crate::reporting::{Answer, Command};
use clap::Args;
use clap_mangen::Man;
use std::path::PathBuf;
use voronudge_io::OutputDirectory;

/// Writes the manual pages of the program and of its commands.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder for the pages, such as ~/.local/share/man/man1, created if it does not exist. Other files in it are
    /// left alone.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

impl Command for Arguments {
    fn run(self) -> Result<Answer, Failure> {
        let mut out = OutputDirectory::create(&self.folder)?;
        let mut program = description().disable_help_subcommand(true);
        program.build();
        write(&mut out, &program)?;
        let pages = out.commit()?.len();
        Answer::printed(&format!("{pages} pages written to {}\n", self.folder.display()))
    }
}

/// The page of a command and those of the commands below it, which `voronudge-import-tracks.1` and its like are named after.
fn write(out: &mut OutputDirectory, command: &clap::Command) -> Result<(), Failure> {
    let page = Man::new(command.clone()).source(concat!("voronudge ", env!("CARGO_PKG_VERSION")));
    let mut text = Vec::new();
    page.render(&mut text).map_err(|error| Failure::new(format!("{}: {error}", page.get_filename())))?;
    out.write_bytes(&page.get_filename(), &text)?;
    command.get_subcommands().try_for_each(|own| write(out, own))
}
