//! `voronudge moduli`: elastic moduli and viscosities.

mod dynamic;
pub(crate) mod measure;
pub(crate) mod names;
mod page;
pub(crate) mod protocol;
pub(crate) mod replicas;
mod report;

use crate::arguments::{CellArguments, CommonArguments, ParameterArguments, SpreadArguments};
use crate::command::simulate::StartArguments;
use crate::failure::Failure;
use crate::memory::{OF_A_STRAINED_CELL, refuse_beyond};
use crate::reporting::{Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use protocol::{Protocol, ProtocolArguments};
use std::path::Path;
use voronudge_report::ModuliReport;

/// Measures the elastic moduli B, A, μ, Kᵒ of a tissue from its stress under small strains, and compares them with
/// the mean-field theory.
///
/// Cells are first brought to rest; a tissue that does not come to rest is strained while it flows. Writes
/// report.json and report.html.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    /// Number of random starts. The first uses --seed, the others use seeds derived from it.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    replicas: u64,
    #[command(flatten)]
    protocol: ProtocolArguments,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    cells: CellArguments,
    #[command(flatten)]
    spreads: SpreadArguments,
    #[command(flatten)]
    common: CommonArguments,
}

impl Reporting for Arguments {
    const NAME: &'static str = "moduli";
    type Report = ModuliReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let mut parameters = self.parameters.resolve()?;
        self.protocol.check()?;
        let spreads = self.spreads.resolve()?;
        spreads.idle(&parameters).into_iter().for_each(|idle| run.warn(idle));
        let inputs = self.start.file().into_iter().chain(self.parameters.file());
        let out = self.common.reserve(inputs.map(Path::to_owned).chain(self.cells.files()))?;
        let starts = measure::starts(&self)?;
        let first = &starts[0].1;
        let cells = first.positions.len();
        refuse_beyond(format!("moduli of {cells} cells"), cells, OF_A_STRAINED_CELL)?;
        let spacing = (first.cell_box.area() / first.positions.len() as f64).sqrt();
        let models = measure::models(&self.cells, &spreads, &starts, &mut parameters)?;
        let protocol = Protocol::new(&self.protocol, &parameters, spacing)?;
        let out = out.begin()?;
        protocol.doubts().into_iter().for_each(|doubt| run.warn(doubt));
        let measured = measure::replicas(&starts, &models, &protocol, self.common.verbosity())?;
        report::doubts(&measured).into_iter().for_each(|doubt| run.warn(doubt));
        let report = report::report(run, &starts, (&parameters, &spreads, spacing), &protocol, &measured);
        let page = page::page(&self, &report);
        let summary = report::summary(&report, out.path());
        Rendered::with_page(out, &report, page, summary)
    }
}
