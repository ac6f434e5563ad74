//! Growth and division: what is asked of cycles, and what came of them.

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use voronudge_report::channel_report::CycleRecord;
use voronudge_simulate::{CellCycle, DivisionAxis, LivingTissue};

#[derive(Debug, Args)]
pub(super) struct CycleArguments {
    /// With --injection cycle: coefficient of variation of the cycle lengths, 0 to 1 [default: 0.3].
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    cycle_variation: Option<f64>,
    /// With --injection cycle: preferred area of a dividing cell, as a multiple of that of the model; a newborn cell
    /// has half of it [default: 1.386].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    division_size: Option<f64>,
    /// With --injection cycle: axis on which the daughters lie [default: long].
    #[arg(long, value_enum)]
    division_axis: Option<AxisName>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum AxisName {
    /// The long axis of the mother.
    Long,
    /// A random direction.
    Random,
}

impl CycleArguments {
    /// The cycle, if there is one.
    pub fn resolve(&self, wanted: bool, distance: Option<f64>) -> Result<Option<CellCycle>, Failure> {
        let given = [
            ("--cycle-variation", self.cycle_variation.is_some()),
            ("--division-size", self.division_size.is_some()),
            ("--division-axis", self.division_axis.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|(_, is_given)| *is_given && !wanted) {
            return Err(Failure::new(format!("{name} is given, but cells have no cycles"))
                .with_hint("add --injection cycle, or leave it out"));
        }
        let usual = CellCycle::default();
        Ok(wanted.then(|| CellCycle {
            variation: self.cycle_variation.unwrap_or(usual.variation),
            size_at_division: self.division_size.unwrap_or(usual.size_at_division),
            distance,
            axis: match self.division_axis {
                None => usual.axis,
                Some(AxisName::Long) => DivisionAxis::Long,
                Some(AxisName::Random) => DivisionAxis::Random,
            },
        }))
    }
}

/// What was asked, and the cycles from birth to division within the run.
pub(super) fn record(cycle: &CellCycle, tissue: &LivingTissue, mean_size: f64) -> CycleRecord {
    let lives = tissue.lives();
    let whole = lives.iter().filter(|life| life.mother.is_some());
    let times: Vec<f64> = whole.filter_map(|life| Some(life.divided? - life.born)).collect();
    let count = times.len() as f64;
    let mean = times.iter().sum::<f64>() / count;
    let variance = times.iter().map(|time| (time - mean).powi(2)).sum::<f64>() / (count - 1.0);
    CycleRecord {
        variation: cycle.variation,
        size_at_division: cycle.size_at_division,
        axis: match cycle.axis {
            DivisionAxis::Long => "long",
            DivisionAxis::Random => "random",
        },
        mean_size,
        cycles: times.len(),
        mean_time: mean,
        time_deviation: variance.sqrt(),
    }
}
