//! `voronudge spectrum`: the linear modes of a snapshot.

mod arrays;
mod frame;
mod lattice;
mod page;
mod report;
mod request;
mod search;
mod sections;
mod strip;
mod strip_figures;
mod strip_page;
mod theory;
mod tissue;
mod view;

use crate::arguments::{
    CellArguments, CommonArguments, DataSetArguments, EffectArguments, ParameterArguments,
};
use crate::boundary::domain_at;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use frame::Solved;
use lattice::Lattice;
use request::SelectionArguments;
use strip::{Bands, EndedLattice, EndsName};
pub(crate) use theory::mean_field;
use voronudge_io::FrameSelection;
use voronudge_report::SpectrumReport;

/// Computes the linear modes of the model at the positions of a data set: growth rates, odd waves, exceptional
/// points.
///
/// Writes eigenvalues.npy (2N, 2: real, imaginary; the largest real part first), participation.npy, longitudinal.npy,
/// condition.npy, report.json and report.html. With --modes, also writes the modes themselves; between walls, also
/// edge.npy and localisation.npy.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    data: DataSetArguments,
    /// Use a honeycomb of unit cells instead of a data set, and compare its waves along Γ–K–M–Γ with the mean-field
    /// theory.
    #[arg(long, num_args = 2, value_names = ["COLUMNS", "ROWS"], conflicts_with_all = ["dataset", "positions"], allow_negative_numbers = true)]
    lattice: Option<Vec<usize>>,
    /// What terminates the strip of --lattice, whose rows are along y. Also computes the modes at each wave number
    /// along the rows.
    #[arg(long, value_enum, requires = "lattice")]
    ends: Option<EndsName>,
    /// Wave number along the rows at which the modes of --ends are shown, in 1/ℓ₀ [default: where modes pile up
    /// most].
    #[arg(long, value_name = "Q", requires = "ends", allow_negative_numbers = true)]
    wave_number: Option<f64>,
    /// Number of steps of the wave number along the rows across the Brillouin zone, 1 to 10000 [default: 64].
    #[arg(long, value_name = "COUNT", requires = "ends", allow_negative_numbers = true)]
    wave_numbers: Option<usize>,
    /// Frames to analyse, counted from zero: `6`, `4..16` (end excluded) or `4,7,9` [default: the first].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true)]
    frames: Option<FrameSelection>,
    #[command(flatten)]
    selection: SelectionArguments,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    effects: EffectArguments,
    /// Also write modes.npy (modes, N, 2, 2: component, then real and imaginary part) for the first frame chosen.
    #[arg(long, help_heading = "Modes")]
    modes: bool,
    #[command(flatten)]
    common: CommonArguments,
}

/// Steps of the wave number along a strip where nothing is said.
const WAVE_NUMBERS: usize = 64;

impl Reporting for Arguments {
    const NAME: &'static str = "spectrum";
    type Report = SpectrumReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let request = self.selection.resolve()?;
        if self.modes && !request.has_vectors() {
            return Err(Failure::new("--modes asks for vectors and --values-only for none")
                .with_hint("leave one of them out"));
        }
        let effects = self.effects.resolve()?;
        let mut parameters = self.parameters.resolve()?;
        let lattice = self.lattice.as_deref().map(Lattice::new).transpose()?;
        let count = self.wave_numbers.unwrap_or(WAVE_NUMBERS);
        strip::check(count, self.wave_number)?;
        let ended = match (&lattice, self.ends) {
            (Some(lattice), Some(ends)) => Some(EndedLattice::new(lattice, ends, (&parameters, &effects))?),
            _ => None,
        };
        let (data, place) = match (&lattice, &ended) {
            (Some(lattice), Some(ended)) => (ended.data_set(lattice), "the honeycomb".to_owned()),
            (Some(lattice), None) => (lattice.data_set(), "the honeycomb".to_owned()),
            (None, _) => (self.data.load()?, self.data.positions_file().display().to_string()),
        };
        if data.walls.is_none() {
            domain_at(&data, 0)?;
        }
        let frames = match &self.frames {
            Some(selection) => {
                selection.resolve(data.frames()).map_err(|error| Failure::from(error).at(&place))?
            }
            None => vec![0],
        };
        let own = self.cells.of_data(&data, frames.first().copied().unwrap_or(0), &mut parameters)?;
        if ended.is_some() && !own.is_empty() {
            return Err(
                Failure::new("cells that differ do not go with --ends").with_hint("leave one of them out")
            );
        }
        let inputs = data.inputs.iter().map(|input| input.path.clone());
        let mut out = self.common.output(inputs.chain(self.cells.files()))?;
        if self.frames.is_none() && data.frames() > 1 {
            run.warn(format!(
                "of {} frames only the first is looked at; --frames chooses others",
                data.frames()
            ));
        }
        let mut progress = Progress::new(self.common.verbosity());
        let mut solved = Vec::new();
        for &frame in &frames {
            let at = || format!("{place}, frame {frame}");
            let held = |cell: usize| ended.as_ref().is_some_and(|ended| ended.is_held(cell));
            let one =
                Solved::new((&data, frame), (&parameters, &own, &effects), &request, held, &mut progress)
                    .map_err(|failure| failure.at_unless_interrupted(at()))?;
            solved.push(one);
        }
        let scan = |ended: &EndedLattice, progress: &mut Progress| {
            Bands::new(&ended.strip, (count, self.wave_number), progress)
        };
        let bands = ended.as_ref().map(|ended| scan(ended, &mut progress)).transpose()?;
        progress.finish();
        if let Some(warning) = solved.first().and_then(|first| first.doubtful_units(&parameters)) {
            run.warn(warning);
        }
        for one in &solved {
            one.warnings().into_iter().for_each(|warning| run.warn(warning));
        }
        let waves = lattice.as_ref().map(|lattice| lattice.waves(&parameters, &effects)).transpose()?;
        arrays::write(&mut out, &data, &solved, self.modes)?;
        if let (Some(lattice), Some(waves)) = (&lattice, &waves) {
            lattice.write(&mut out, &data, waves)?;
        }
        let strip = ended.as_ref().zip(bands.as_ref());
        if let Some((ended, bands)) = strip {
            bands.write(&mut out, &ended.strip)?;
            bands.warnings(ended).into_iter().for_each(|warning| run.warn(warning));
        }
        if self.modes && solved.len() > 1 {
            run.warn(format!("modes.npy holds the modes of frame {} only", frames[0]));
        }
        let model = (&parameters, own.of_data(&data, frames[0]), &effects);
        let report = report::report(run, &data, model, &request, &solved, (waves.as_ref(), strip));
        let title = match (&lattice, &self.data.dataset) {
            (Some(lattice), _) => lattice.title(),
            (None, Some(folder)) => folder.display().to_string(),
            (None, None) => place,
        };
        let page = page::page(&title, &data, &solved, &report, (waves.as_ref(), strip))?;
        let summary = page::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}
