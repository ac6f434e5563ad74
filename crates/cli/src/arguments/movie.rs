//! The cells of all frames as an animated image.

use crate::failure::Failure;
use crate::run::Run;
use clap::{Args, ValueEnum};
use voronudge_io::OutputDirectory;
use voronudge_report::movie::{CellMovie, Colouring};

#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MovieArguments {
    /// Also write the cells of the frames as movie.gif, coloured by this.
    #[arg(long, value_name = "QUANTITY", value_enum)]
    movie: Option<Quantity>,
}

/// Colours of a movie, by the names that are typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Quantity {
    /// Area.
    Area,
    /// Perimeter over the root of the area.
    Shape,
    /// Number of neighbours.
    Neighbours,
    /// Size of the measured velocity.
    Speed,
    /// Vorticity of the measured velocities.
    Vorticity,
    /// Size of what the model leaves of the measured velocity.
    Residual,
}

impl Quantity {
    fn colouring(self) -> Colouring {
        match self {
            Self::Area => Colouring::Area,
            Self::Shape => Colouring::Shape,
            Self::Neighbours => Colouring::Neighbours,
            Self::Speed => Colouring::Speed,
            Self::Vorticity => Colouring::Vorticity,
            Self::Residual => Colouring::Residual,
        }
    }
}

impl MovieArguments {
    /// Refuses what nothing is known of where nothing is fitted.
    pub fn check_without_fit(self) -> Result<(), Failure> {
        match self.movie {
            Some(Quantity::Residual) => {
                Err(Failure::new("--movie residual: nothing is fitted, so nothing is left")
                    .with_hint("colour it by area, shape, neighbours, speed or vorticity"))
            }
            _ => Ok(()),
        }
    }

    /// Writes the image, if it is asked for; warns if what it is to be coloured by is not known.
    pub fn write(
        self,
        out: &mut OutputDirectory,
        movie: Option<&CellMovie>,
        run: &mut Run,
    ) -> Result<(), Failure> {
        let Some(quantity) = self.movie else { return Ok(()) };
        match movie.map(|movie| movie.gif(quantity.colouring())).transpose()?.flatten() {
            Some(image) => Ok(out.write_bytes("movie.gif", &image)?),
            None => {
                let name =
                    quantity.to_possible_value().map(|own| own.get_name().to_owned()).unwrap_or_default();
                run.warn(format!("no movie.gif was written: the {name} of the cells is not known here"));
                Ok(())
            }
        }
    }
}
