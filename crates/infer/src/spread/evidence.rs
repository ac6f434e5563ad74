//! What speaks for cells that differ beside a fit in which they are alike.

use super::columns::{FrameColumns, columns, columns_of_field};
use super::fitting::{FIRST, Fitting, Linearised, SPACING, State};
use super::levels::Variances;
use crate::objective::Objective;
use crate::own_parts::Layout;
use crate::{Error, KnownNoise};
use nalgebra::DVector;
use voronudge_model::CellParameter;

/// Widths of the patches of a smooth velocity, in units of ℓ₀.
const WIDTHS: [f64; 3] = [0.6, 1.2, 2.4];

/// Springs at most about which the likeliest is looked for.
const SPRINGS: usize = 12;

/// By how much −2 log L of the linearised problem falls if cells differ in a parameter too, beside some in which they differ already. The
/// level of the velocities is estimated even where it is known: scatter that is the same everywhere is no difference between cells.
pub(crate) fn evidence(
    objective: &Objective<'_>,
    at: &[f64],
    known: KnownNoise,
    beside: &[CellParameter],
    parameter: CellParameter,
) -> Result<f64, Error> {
    let all: Vec<CellParameter> = beside.iter().copied().chain([parameter]).collect();
    let layout = Layout::new(objective.frames, &all)?;
    fall(objective, at, known, (&layout, beside.len()), columns(objective, at, &layout)?)
}

/// The same for a random velocity that changes smoothly from place to place, at the better of some lengths.
pub(crate) fn evidence_of_field(
    objective: &Objective<'_>,
    at: &[f64],
    known: KnownNoise,
) -> Result<f64, Error> {
    let layout = Layout::of_field(objective.frames);
    let of = |width: &f64| {
        let columns = columns_of_field(objective, at, (&layout, *width))?;
        fall(objective, at, known, (&layout, 0), columns)
    };
    let falls = WIDTHS.iter().map(of).collect::<Result<Vec<f64>, Error>>()?;
    Ok(falls.into_iter().fold(0.0, f64::max))
}

/// By how much −2 log L falls if all unknowns after those of the first blocks vary, too.
fn fall(
    objective: &Objective<'_>,
    at: &[f64],
    known: KnownNoise,
    (layout, first): (&Layout, usize),
    columns: Vec<FrameColumns>,
) -> Result<f64, Error> {
    let fitting = Fitting { objective, layout, known: KnownNoise { velocity: None, ..known } };
    let with = Variances {
        velocity: 2.0 * objective.levels.velocity.ln(),
        of_cells: vec![Some(2.0 * FIRST.ln()); layout.blocks],
    };
    let mut without = with.clone();
    without.of_cells[first..].fill(None);
    let state = State {
        parameters: at.to_vec(),
        deviations: DVector::zeros(layout.order()),
        reference: objective.space.coefficients(objective.split(at).0),
        levels: objective.levels,
        variances: with.clone(),
    };
    let linearised = fitting.linearised(&state, columns)?;
    let criterion = |variances: &Variances| fitting.criterion(&state, &linearised, variances);
    Ok(criterion(&without)? - criterion(&with)?)
}

impl Fitting<'_> {
    /// −2 log L at the most likely spring and variances near some; spreads that are none stay none.
    pub(super) fn criterion(
        &self,
        state: &State,
        linearised: &Linearised,
        start: &Variances,
    ) -> Result<f64, Error> {
        let mut at = (state.levels.spring().ln(), start.clone());
        let mut least = f64::INFINITY;
        for _ in 0..SPRINGS {
            let grams = self.grams(state, linearised, at.0)?;
            let (log_k, variances, criterion) = self.over_springs(&grams, linearised.left, &at.1, None)?;
            // Within the springs that were looked at the parabola is as good as the least of them.
            let is_settled = (log_k - at.0).abs() <= SPACING;
            (at, least) = ((log_k, variances), criterion);
            if is_settled {
                break;
            }
        }
        Ok(least)
    }
}
