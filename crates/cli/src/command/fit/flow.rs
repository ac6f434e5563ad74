//! Velocities on a grid: whether they are wanted, and how reports tell them.

use crate::arguments::DataSetArguments;
use crate::failure::Failure;
use crate::problem::OrderedField;
use clap::{Args, ValueEnum};
use voronudge_infer::{Window, WindowKind};
use voronudge_io::DataSet;
use voronudge_report::infer_report::{FlowGrid, FlowWindow};

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Velocities")]
pub(crate) struct FlowArguments {
    /// Velocities to explain: those of cells, or a flow field on a grid [default: flow if there is a flow field and
    /// no velocities of cells, else cells].
    #[arg(long, value_enum)]
    data: Option<Kind>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Velocities of cells, given or derived from tracks.
    Cells,
    /// A flow field on a grid.
    Flow,
}

impl FlowArguments {
    /// The flow field to explain, if it is one.
    pub fn field(&self, files: &DataSetArguments, data: &DataSet) -> Result<Option<OrderedField>, Failure> {
        let wanted = match self.data {
            Some(kind) => kind == Kind::Flow,
            None => data.flow.is_some() && data.velocities.is_none(),
        };
        match (&data.flow, wanted) {
            (Some(field), true) => Ok(Some(OrderedField::new(field, data.window)?)),
            (None, true) => Err(Failure::new("there is no flow field")
                .with_hint("give --flow with --flow-x and --flow-y, or --data cells")
                .at(files.flow_file().display())),
            (_, false) => {
                let unused =
                    [("--window", files.window.is_some()), ("--window-width", files.window_width.is_some())];
                match unused.into_iter().find(|(_, given)| *given) {
                    Some((option, _)) => {
                        Err(Failure::new(format!("{option} is for flow fields, but velocities are of cells"))
                            .with_hint(format!("leave out {option}, or give --data flow")))
                    }
                    None => Ok(None),
                }
            }
        }
    }
}

/// The kind of window as reports name it.
pub(super) fn told(kind: WindowKind) -> FlowWindow {
    match kind {
        WindowKind::Square => FlowWindow::Square,
        WindowKind::Gaussian => FlowWindow::Gaussian,
        WindowKind::GaussianArea => FlowWindow::GaussianArea,
    }
}

/// The kind of window in words.
pub(super) fn name(kind: WindowKind) -> &'static str {
    match kind {
        WindowKind::Square => "squares",
        WindowKind::Gaussian => "Gaussians over the centres of cells",
        WindowKind::GaussianArea => "Gaussians over the plane",
    }
}

/// The grid for the report.
pub(crate) fn described(field: &OrderedField) -> FlowGrid {
    let (Window { kind, width }, grid) = (field.window(), field.grid());
    FlowGrid { grid_points: grid.size(), spacing: grid.spacing(), window: told(kind), width }
}
