//! The result of `infer` as a summary on stdout.

use crate::command::fit::words;
use std::fmt::Write as _;
use std::path::Path;
use voronudge_infer::FitParameter;
use voronudge_report::InferReport;
use voronudge_report::infer_report::Parameter;
use voronudge_report::numbers::{interval_text, significant};

/// What the terminal shows.
pub(super) fn summary(report: &InferReport, folder: &Path) -> String {
    let mut text = String::new();
    let is_finding = report.verdict.kind.is_finding();
    let _ = writeln!(text, "{}", report.verdict.sentence);
    if is_finding {
        let directions: Vec<String> = report.identifiability.iter().map(|d| d.words.clone()).collect();
        let _ = writeln!(text, "{}", words::in_short(&directions));
    }
    text.push('\n');
    let left_out: usize = report.cells.left_out.values().sum();
    let frames = report.cells.frames.len();
    let _ = writeln!(
        text,
        "{} velocities in {frames} frame{}, {left_out} {} left out\n",
        report.cells.used,
        if frames == 1 { "" } else { "s" },
        match (report.flow.is_some(), left_out) {
            (true, 1) => "grid point",
            (true, _) => "grid points",
            (false, 1) => "cell",
            (false, _) => "cells",
        }
    );
    let p = &report.parameters;
    let n = &report.naive;
    let _ = writeln!(text, "{:<13} {:>12}  {:<26} {:>12}", "parameter", "nudged", "95 % interval", "naive");
    for (name, parameter, naive) in [
        ("K_P alpha", &p.K_P_alpha, n.K_P_alpha),
        ("P_0 / l_0", &p.shape_index, n.shape_index),
        ("alpha", &p.alpha, n.alpha),
        ("K_A", &p.K_A, n.K_A),
        ("K_P", &p.K_P, n.K_P),
        ("P_0", &p.P_0, n.P_0),
    ] {
        let [value, interval] = match parameter.interval() {
            Some(ends) if ends.contains(&Some(parameter.value)) => {
                let [value, interval] = interval_text(parameter.value, ends);
                [value, format!("{interval}, at a bound")]
            }
            Some(ends) => interval_text(parameter.value, ends),
            None => [significant(parameter.value, 4), "fixed".into()],
        };
        let [value, interval, naive] =
            [value, interval, significant(naive, 4)].map(|text| match is_finding {
                true => text,
                false => format!("({text})"),
            });
        let row = format!("{name:<13} {value:>12}  {interval:<26} {naive:>12}  {}", parameter.unit);
        let _ = writeln!(text, "{}", row.trim_end());
    }
    let of_activity = report.activity.iter().flat_map(|own| {
        [("v_0", &own.v_0), ("D_r", &own.D_r)].into_iter().chain(own.J.iter().map(|own| ("J", own)))
    });
    for (name, own) in of_activity {
        let [value, interval] = match own.interval() {
            Some(ends) => interval_text(own.value, ends),
            None => ["–".into(), "not determined".into()],
        };
        let _ = writeln!(text, "{name:<13} {value:>12}  {interval:<26} {:>12}  {}", "–", own.unit);
    }
    for spread in &report.spreads {
        let _ = writeln!(text, "{}", spread.words);
    }
    for kind in &report.by_label {
        let told = |parameter: &Parameter| match parameter.interval() {
            Some(ends) => interval_text(parameter.value, ends).join(", "),
            None => format!("{}, fixed", significant(parameter.value, 4)),
        };
        let [shape, alpha] = [&kind.parameters.shape_index, &kind.parameters.alpha].map(told);
        let _ = writeln!(text, "{}\n    P_0 / l_0  {shape}\n    alpha      {alpha}", kind.words);
    }
    if !is_finding {
        let _ = writeln!(text, "in brackets: a model that explains nothing has no meaningful parameters");
    }
    text.push_str(&answers(report));
    let e = &report.nmse;
    let held_out = match (e.cross_validated, e.cross_validated_standard_error) {
        (Some(error), Some(spread)) => format!("{} ± {}", significant(error, 3), significant(spread, 1)),
        _ => "–".into(),
    };
    let floor = match e.noise_floor.is_finite() {
        true => format!("; noise alone {}", significant(e.noise_floor, 3)),
        false => String::new(),
    };
    let _ = writeln!(
        text,
        "\nerror (NMSE)  naive {}, nudged {}, same parameters un-nudged {}, held out {held_out}{floor}",
        significant(e.naive, 3),
        significant(e.nudged, 3),
        significant(e.un_nudged, 3)
    );
    let _ = writeln!(
        text,
        "noise         sigma_r {}, sigma_v {}; {} degrees of freedom in the nudges, {} contacts changed",
        significant(report.noise.sigma_r, 3),
        significant(report.noise.sigma_v, 3),
        significant(report.nudge.degrees_of_freedom, 3),
        report.nudge.edges_changed
    );
    text.push_str(&detections(report));
    if let Some(advice) = report.prospects.as_ref().map(|own| &own.words).filter(|words| !words.is_empty()) {
        let _ = writeln!(text, "next          {advice}");
    }
    let _ = writeln!(text, "\nfigures in {}", folder.join("report.html").display());
    text
}

/// What was wrong with detections, if anything was.
fn detections(report: &InferReport) -> String {
    let Some(found) = &report.measurement.latent else {
        return String::new();
    };
    let told: Vec<String> = [
        (found.inserted, "put in where none was detected"),
        (found.deleted, "taken away"),
        (found.split, "split into two"),
        (found.merged, "merged from two"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect();
    if told.is_empty() { String::new() } else { format!("cells         {}\n", told.join(", ")) }
}

/// Intervals of profiles and of the bootstrap, a line each.
fn answers(report: &InferReport) -> String {
    let mut text = String::new();
    let spoken = |name: &str| FitParameter::from_name(name).map_or("", words::spoken);
    let p = &report.parameters;
    let best = |name: &str| {
        let parameters = [("K_A", &p.K_A), ("K_P", &p.K_P), ("P_0", &p.P_0), ("alpha", &p.alpha)];
        let found = parameters.into_iter().find(|(known, _)| *known == name);
        found.map_or(p.K_P_alpha.value, |(_, parameter)| parameter.value)
    };
    for profile in &report.profiles {
        let name = &profile.parameter;
        let [_, interval] = interval_text(best(name), profile.interval);
        let _ = writeln!(text, "profile       {}: {interval}", spoken(name));
    }
    if let Some(bootstrap) = &report.bootstrap {
        for (name, interval) in &bootstrap.intervals {
            let told =
                interval.map_or("–".into(), |ends| interval_text(best(name), ends.map(Some))[1].clone());
            let _ = writeln!(text, "bootstrap     {}: {told}", spoken(name));
        }
        let failed = match bootstrap.failed {
            0 => String::new(),
            count => format!(", {count} could not be"),
        };
        let _ = writeln!(text, "bootstrap     {} data sets fitted{failed}", bootstrap.replicates);
    }
    if text.is_empty() { text } else { format!("\n{text}") }
}
