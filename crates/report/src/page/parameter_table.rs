//! The rows of the parameter table: symbols, meanings, digits.

use super::Text;
use crate::figure::{Estimate, ParameterRow};
use crate::infer_report::{ActivityReport, NaiveParameters, Parameter, Parameters};
use crate::numbers::{as_given, interval_text, significant};
use crate::units::unit_text;

/// A value and its interval as they are printed.
pub(super) fn value_and_interval(row: &ParameterRow) -> [String; 2] {
    match (row.interval(), row.estimate) {
        (Some(ends), Estimate::AtBound) => {
            let [value, interval] = interval_text(row.value, ends);
            [value, format!("{interval}, at a bound")]
        }
        (Some(ends), _) => interval_text(row.value, ends),
        (None, Estimate::Fixed) => [as_given(row.value), "held fixed".to_owned()],
        (None, _) => [significant(row.value, 3), "not determined".to_owned()],
    }
}

/// Symbol, value, interval and unit as cells of a table.
pub(super) fn cells_of(row: &ParameterRow) -> [Text; 4] {
    let [value, interval] = value_and_interval(row);
    [Text::from(&row.symbol), value.into(), interval.into(), Text::plain(&unit_text(&row.unit))]
}

/// The printed symbol of the name of a parameter, or of the coefficient of an effect, in the file.
pub(super) fn symbol_of(name: &str) -> String {
    match name {
        "alpha" => "α".to_owned(),
        "K_P_alpha" => "K_P α".to_owned(),
        "K_P_P_0" => "K_P P_0".to_owned(),
        "shape_index" => "P_0/ℓ_0".to_owned(),
        "v_0" => "v_0".to_owned(),
        effect if effect.starts_with(char::is_lowercase) => effect.replace('_', " "),
        other => other.to_owned(),
    }
}

/// An interval that begins or ends at the estimate itself was cut off there by a bound.
fn estimate(parameter: &Parameter) -> Estimate {
    let ends = parameter.interval().unwrap_or_default().map(|end| end == Some(parameter.value));
    match (parameter.fixed, ends) {
        (true, _) => Estimate::Fixed,
        (false, [true, false] | [false, true]) => Estimate::AtBound,
        (false, _) => Estimate::Fitted,
    }
}

/// The row of one parameter.
pub(super) fn parameter_row(
    name: &str,
    parameter: &Parameter,
    naive: Option<f64>,
    meaning: &str,
) -> ParameterRow {
    ParameterRow {
        symbol: symbol_of(name),
        unit: parameter.unit.clone(),
        value: parameter.value,
        ci95: parameter.interval(),
        naive: naive.filter(|naive| naive.is_finite()),
        estimate: estimate(parameter),
        meaning: meaning.to_owned(),
    }
}

/// The rows of the parameter table, the best determined first.
pub(super) fn parameter_rows(fitted: &Parameters, naive: Option<&NaiveParameters>) -> Vec<ParameterRow> {
    let row = |name: &str, parameter: &Parameter, of: fn(&NaiveParameters) -> f64, meaning: &str| {
        parameter_row(name, parameter, naive.map(of), meaning)
    };
    vec![
        row(
            "K_P_alpha",
            &fitted.K_P_alpha,
            |naive| naive.K_P_alpha,
            "chiral rate: strength of the turned outline force; for positive values the extra force points a \
             quarter turn clockwise from the outline force (y axis up)",
        ),
        row(
            "shape_index",
            &fitted.shape_index,
            |naive| naive.shape_index,
            "preferred shape: small is round and rigid, above about 3.8 elongated and fluid \
             (without chirality)",
        ),
        row(
            "alpha",
            &fitted.alpha,
            |naive| naive.alpha,
            "chirality: turned outline force relative to the outline force itself",
        ),
        row("K_P", &fitted.K_P, |naive| naive.K_P, "stiffness of the cell outline"),
        row("P_0", &fitted.P_0, |naive| naive.P_0, "preferred length of the cell outline"),
        row("K_A", &fitted.K_A, |naive| naive.K_A, "stiffness of the cell area; often not determined"),
    ]
}

/// The rows of cells that crawl.
pub(super) fn activity_rows(activity: &ActivityReport) -> Vec<ParameterRow> {
    let row =
        |name: &str, parameter: &Parameter, meaning: &str| parameter_row(name, parameter, None, meaning);
    let alignment = activity
        .J
        .iter()
        .map(|own| row("J", own, "rate at which a cell takes on the mean polarity of its neighbours"));
    let mut rows = vec![
        row("v_0", &activity.v_0, "speed that a cell has of itself: root mean square of the polarity"),
        row("D_r", &activity.D_r, "rate at which a cell forgets the direction of its polarity"),
    ];
    rows.extend(alignment);
    let inhibited = activity.b.iter().map(|own| row("b", own, "how fast polarities turn away from contacts"));
    rows.extend(inhibited);
    let along = activity.kappa.iter();
    rows.extend(
        along
            .map(|own| row("kappa", own, "rate at which polarities turn towards the velocity of the forces")),
    );
    rows
}
