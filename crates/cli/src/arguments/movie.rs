//! The cells of all frames as an animated image.

use crate::failure::Failure;
use crate::run::Run;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use voronudge_io::OutputDirectory;
use voronudge_report::movie::{CellMovie, Colouring};

/// What it is called.
const FILE: &str = "movie.gif";

#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MovieArguments {
    /// Also write the cells of the frames as movie.gif, coloured by this quantity; `residual` only with a fit.
    #[arg(long, value_name = "QUANTITY", value_parser = colouring(), help_heading = "Output")]
    movie: Option<Colouring>,
}

/// Colours by the words that are typed.
fn colouring() -> impl TypedValueParser<Value = Colouring> {
    let words = Colouring::ALL.map(Colouring::word);
    let known = PossibleValuesParser::new(words.map(|[word, help]| PossibleValue::new(word).help(help)));
    known.try_map(|typed| {
        let mut all = Colouring::ALL.into_iter();
        all.find(|own| own.word()[0] == typed).ok_or("cells have no such colour")
    })
}

impl MovieArguments {
    /// Refuses what nothing is known of where nothing is fitted.
    pub fn check_without_fit(self) -> Result<(), Failure> {
        match self.movie {
            Some(Colouring::Residual) => {
                Err(Failure::new("--movie residual: nothing is fitted, so nothing is left")
                    .with_hint("colour it by area, shape, neighbours, speed or vorticity"))
            }
            _ => Ok(()),
        }
    }

    /// Writes the image, if it is asked for; an earlier one goes. Warns if what it is to be coloured by is not known.
    pub fn write(
        self,
        out: &mut OutputDirectory,
        movie: Option<&CellMovie>,
        run: &mut Run,
    ) -> Result<(), Failure> {
        // One of an earlier run would be of other cells.
        out.withdraw(FILE)?;
        let Some(colouring) = self.movie else { return Ok(()) };
        match movie.map(|movie| movie.gif(colouring)).transpose()?.flatten() {
            Some(image) => Ok(out.write_bytes(FILE, &image)?),
            None => {
                let [name, _] = colouring.word();
                run.warn(format!("no {FILE} was written: the {name} of the cells is not known here"));
                Ok(())
            }
        }
    }
}
