//! Cells that differ: what a fit says of them.

use crate::command::fit::spreads::symbol;
use crate::failure::Failure;
use crate::problem::Problem;
use voronudge_infer::{FitParameter, Inference, Method, Spread};
use voronudge_model::CellParameter;
use voronudge_report::infer_report::SpreadReport;
use voronudge_report::numbers::significant;

/// Probability below which it is said that cells differ.
const LEVEL: f64 = 0.05;

/// A parameter by its name.
pub(super) fn parameter(name: &str) -> Result<CellParameter, String> {
    CellParameter::from_name(name).ok_or_else(|| {
        let known: Vec<&str> = CellParameter::ALL.iter().map(|own| own.name()).collect();
        format!("cells may differ in {}", known.join(", "))
    })
}

/// Refuses data and requests that do not go with cells that differ.
pub(super) fn check(vary: &[CellParameter], prepared: &Problem, asked: bool) -> Result<(), Failure> {
    if vary.is_empty() {
        return Ok(());
    }
    let twice = (1..vary.len()).find(|k| vary[..*k].contains(&vary[*k]));
    let problem = match twice {
        Some(k) => format!("--vary has {} twice", vary[k].name()),
        None if prepared.tracks.is_some() || prepared.velocities.flow().is_some() => {
            "--vary is for velocities of cells, not for tracks or a flow field".into()
        }
        None if asked => "--vary does not go with --profile, --landscape or --bootstrap".into(),
        None if matches!(prepared.request.method, Method::Descent { .. }) => {
            "--vary does not go with --method descent".into()
        }
        None => return Ok(()),
    };
    Err(Failure::new(problem).with_hint("leave one of the two out"))
}

/// What to mind of elasticities that were fitted where cells are found to differ in what their shapes can have followed.
pub(super) fn cautions(result: &Inference) -> Vec<&'static str> {
    let of = |(spread, report): (&Spread, SpreadReport)| {
        let (elasticity, caution) = match spread.parameter {
            CellParameter::PreferredPerimeter => (
                FitParameter::PerimeterElasticity,
                "cells differ in P_0: if their perimeters have followed it, K_P comes out too small, and alpha too large, beyond \
                 the interval (in simulated liquids by 7 % at a spread of 2 %, by a quarter to a half at 5 %). Quote K_P_alpha \
                 and P_0, which suffer less",
            ),
            CellParameter::PreferredArea => (
                FitParameter::AreaElasticity,
                "cells differ in A_0: if their areas have followed it, K_A comes out too small, beyond the interval (in a \
                 simulated liquid by a tenth at a spread of 10 %, by a third at 25 %)",
            ),
            CellParameter::AreaElasticity | CellParameter::Chirality => return None,
        };
        (report.named && result.parameters.get(elasticity).standard_error > 0.0).then_some(caution)
    };
    result.spreads.iter().zip(report(result)).filter_map(of).collect()
}

/// The spreads for the report.
pub(super) fn report(result: &Inference) -> Vec<SpreadReport> {
    let count = result.spreads.len() as f64;
    let told = |spread: &Spread| {
        let [low, high] = spread.interval;
        let p_adjusted = 1.0 - (1.0 - spread.p).powf(count);
        let named = p_adjusted < LEVEL;
        let percent = |share: f64| significant(100.0 * share, 2);
        let interval = match high {
            Some(high) => format!("{} to {} %", percent(low.unwrap_or(0.0)), percent(high)),
            None => format!("{} % or more", percent(low.unwrap_or(0.0))),
        };
        let (symbol, p) = (symbol(spread.parameter), significant(p_adjusted, 2));
        let words = match named {
            true => format!(
                "cells differ in {symbol}: by {} % (standard deviation; 95 %: {interval}; p = {p})",
                percent(spread.value)
            ),
            false => format!("cells are not seen to differ in {symbol} (95 %: {interval}; p = {p})"),
        };
        SpreadReport {
            parameter: spread.parameter.name().into(),
            relative: spread.value,
            ci95: [low.unwrap_or(0.0), high.unwrap_or(f64::INFINITY)],
            p: spread.p,
            p_adjusted,
            named,
            words,
        }
    };
    result.spreads.iter().map(told).collect()
}
