//! The answer in words: what was found, what that does not say, and what to measure next.

use super::history::has_memory;
use super::measured::Findings;
use super::phrases::{listed, percent};
use crate::problem::Problem;
use voronudge_infer::NoiseSource;
use voronudge_infer::discover::{Discovery, Fate, HeldOutUnit, Ranked, Search, Selected, Verdict};
use voronudge_model::Effect;
use voronudge_model::effect::Kind;
use voronudge_report::numbers::significant;

/// How meanings tell which sign of the coefficient is meant.
const POSITIVE: &str = "(c > 0)";

/// Share of the squared velocities below which a rest is none to speak of.
const LEAST_REST: f64 = 0.0005;

/// The largest share that is said to be explained where something is left.
const NEARLY_ALL: f64 = 0.99;

/// The measurement that tells two effects apart.
pub(super) fn told_apart_by(effect: &Effect, other: &Effect) -> String {
    let known = |one: &Effect, two: &Effect| {
        one.aliases.iter().find(|alias| alias.of == two.id).map(|alias| alias.told_apart_by.to_owned())
    };
    known(effect, other).or_else(|| known(other, effect)).unwrap_or_else(|| {
        format!(
            "more cells or frames, or a tissue in which only one of the two can act. {} stands for: {}",
            other.id, other.meaning
        )
    })
}

/// An effect with those that the data cannot tell from it.
fn name(selected: &Selected) -> String {
    let others: Vec<&str> = others(selected).map(|other| other.id).collect();
    match others.as_slice() {
        [] => selected.effect.id.into(),
        others => {
            format!("{} or, indistinguishable from it here, {}", selected.effect.id, listed(others, "or"))
        }
    }
}

fn others(selected: &Selected) -> impl Iterator<Item = &'static Effect> {
    selected.class.iter().copied().filter(|other| other.id != selected.effect.id)
}

/// What an effect means, without the full stop; with its sign here, where that decides on the meaning.
fn meaning(selected: &Selected) -> String {
    let text = selected.effect.meaning.trim_end_matches('.');
    match selected.coefficients.as_slice() {
        [only] if selected.effect.differing_parameter().is_some() => {
            let [low, high] = only.interval.map(|end| end.map(percent));
            let interval = match (low, high) {
                (Some(low), Some(high)) => format!(" (95 %: {low} to {high})"),
                _ => String::new(),
            };
            format!("{text}, by {}{interval}", percent(only.value))
        }
        [only] if text.contains(POSITIVE) => {
            format!("{text}; here c {} 0", if only.value > 0.0 { ">" } else { "<" })
        }
        _ => text.to_owned(),
    }
}

/// The error on data that the fit has not seen, before and after.
fn errors(discovery: &Discovery) -> String {
    let (Some(before), Some(after)) = (discovery.before.held_out, discovery.after.held_out) else {
        return "no error on data held out could be computed".into();
    };
    let unit = match before.unit {
        HeldOutUnit::Frames => "on held-out frames",
        HeldOutUnit::Blocks => "on held-out blocks of cells",
    };
    let [from, to] = [before, after].map(|error| significant(error.value, 3));
    let course = match discovery.selected.is_empty() {
        true => format!("is {from}"),
        false if after.value < before.value => format!("falls from {from} to {to}"),
        false => format!("goes from {from} to {to}"),
    };
    let floor = discovery.after.inference.nmse.noise_floor;
    let estimated = discovery.after.inference.noise_source == NoiseSource::Estimated;
    let alone = match (floor.is_finite(), estimated) {
        (false, _) => String::new(),
        (true, false) => format!(", where noise alone leaves {}", significant(floor, 3)),
        (true, true) => format!(", where noise alone leaves at most {}", significant(floor, 3)),
    };
    format!("the error {unit} {course}{alone}")
}

/// Why effects that were found are not all that is missing.
fn reservation(discovery: &Discovery) -> String {
    if discovery.cells_differ() && discovery.shared().all(|_| discovery.predicts_better()) {
        return "but deviations of single cells cannot predict cells that were not seen, so held-out data cannot confirm it".into();
    }
    if discovery.selected.iter().all(|own| own.effect.is_random_motion()) {
        return "but random motion predicts nothing, so held-out data cannot confirm it".into();
    }
    if !discovery.predicts_better() {
        let why = discovery.gain.map_or("this could not be tested".into(), |[value, error]| {
            format!(
                "held-out data are not predicted better by more than the standard error (by {} ± {})",
                significant(value, 2),
                significant(error, 1)
            )
        });
        return format!("but {why}, so it is not established");
    }
    if let Some(doubt) = discovery.doubt_of_measurement() {
        let part = doubt.part().name().replace('_', " ");
        return format!(
            "but the measurement is in doubt ({part}: see the warnings), so it is not established"
        );
    }
    let rest = discovery.after.budget.unexplained;
    let left = match rest > LEAST_REST {
        true => format!("{} of the squared velocities remain unexplained", percent(rest)),
        false => "little is left".into(),
    };
    match discovery.rest_is_structured {
        true => format!("{left}, but the remainder is not noise: it is structured"),
        false => left,
    }
}

/// How much effects explain. Along tracks the noise of the motion is always estimated, so that it takes up what nothing explains: what counts
/// there is the fall of the error on motions held out.
fn explained(discovery: &Discovery) -> String {
    match discovery.after.tracked {
        Some(_) if discovery.selected.iter().all(|own| own.effect.is_random_motion()) => {
            let share: f64 = discovery.selected.iter().map(|own| own.size.powi(2)).sum();
            format!("{} of the squared velocities, as unpredictable scatter", percent(share))
        }
        Some(_) if discovery.after.budget.effects <= 0.0 => {
            "nothing of the squared velocities, held out".into()
        }
        Some(_) => format!("{} of the squared velocities, held out", percent(discovery.after.budget.effects)),
        None => {
            // Something is left, where this is not all.
            let most = if discovery.verdict == Verdict::Partial { NEARLY_ALL } else { 1.0 };
            let more = if discovery.share_of_excess > most { "more than " } else { "" };
            format!("{more}{} of what the base model lacks", percent(discovery.share_of_excess.min(most)))
        }
    }
}

/// The answer in a sentence.
pub(super) fn sentence(discovery: &Discovery, prepared: &Problem, findings: &Findings) -> String {
    let errors = errors(discovery);
    let share = explained(discovery);
    let names: Vec<String> = discovery.selected.iter().map(name).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let meanings: Vec<String> = discovery.selected.iter().map(meaning).collect();
    let by_measurement = match discovery.selected.iter().all(|own| own.effect.kind == Kind::Observation) {
        true => " This is, or may be, an artefact of how the cells were measured, not something they do.",
        false => "",
    };
    match (discovery.verdict, meanings.as_slice()) {
        (Verdict::NothingMissing, _) => match findings.statement() {
            None => format!("Nothing is missing: the base model leaves only noise; {errors}."),
            Some(found) => format!(
                "Nothing is missing beyond how the cells were measured: there are {found}. With that taken into account the base \
                 model leaves only noise; {errors}."
            ),
        },
        (Verdict::Attributed, [meaning]) => {
            format!("{meaning} ({}).{by_measurement} This explains {share}; {errors}.", names.concat())
        }
        (Verdict::Attributed, meanings) => format!(
            "{} effects are missing, {}: {}.{by_measurement} Together they explain {share}; {errors}.",
            meanings.len(),
            listed(&names, "and"),
            meanings.join("; ")
        ),
        (Verdict::Partial, [meaning]) => format!(
            "{meaning} ({}): the data are consistent with that, and it explains {share}; {}; {errors}.",
            names.concat(),
            reservation(discovery)
        ),
        (Verdict::Partial, _) => format!(
            "The data are consistent with {}, which together explain {share}; {}; {errors}.",
            listed(&names, "and"),
            reservation(discovery)
        ),
        (Verdict::UnexplainedStructured, _) => {
            let length =
                discovery.after.diagnostics.correlations.length.value().map_or(String::new(), |length| {
                    format!(", correlated over {} cell sizes", significant(length, 2))
                });
            format!(
                "Something structured{length} is missing, {} of the squared velocities, and no candidate explains it; {errors}.",
                percent(discovery.after.budget.unexplained)
            )
        }
        (Verdict::UnexplainedWhite, _) => format!(
            "The base model leaves more than noise, {} of the squared velocities, but without structure; {errors}.",
            percent(discovery.after.budget.unexplained)
        ),
        (Verdict::NotTestable, _) => {
            if discovery.before.inference.cells_turn() {
                return format!(
                    "These data cannot tell whether something is missing: cells turn around between frames, so the paths that \
                     the base model finds may be wrong; {errors}."
                );
            }
            let used = discovery.before.inference.used;
            let frames = prepared.frames.len();
            format!(
                "These data cannot tell whether something is missing: {used} velocities in {frames} frame{} are too few, or \
                 the parameters of the base model absorb what the candidates would explain; {errors}.",
                if frames == 1 { "" } else { "s" }
            )
        }
    }
}

/// What the answer does not say.
pub(super) fn caveat(discovery: &Discovery, search: &Search) -> String {
    let mut sentences = Vec::new();
    for selected in &discovery.selected {
        let others: Vec<&str> = others(selected).map(|other| other.id).collect();
        if !others.is_empty() {
            sentences.push(format!(
                "These data cannot tell {} from {}: read it as one of them.",
                selected.effect.id,
                listed(&others, "or")
            ));
        }
        let parameters = selected.effect.aliases.iter().filter(|alias| Effect::from_id(alias.of).is_none());
        sentences.extend(parameters.map(|alias| {
            format!("{} acts much like the base model's own term ({}).", selected.effect.id, alias.of)
        }));
    }
    let crawls = discovery.after.tracked.as_ref().is_some_and(|tracked| tracked.polarity.is_some());
    let is_tested = |own: &Ranked| own.effect.id == "polarity_alignment" && own.dimension > 0;
    if crawls && !discovery.ranking.iter().any(is_tested) {
        sentences.push(
            "Polarities of neighbours were assumed independent. Whether they align was not tested; if they do, the intervals are too \
             narrow."
                .into(),
        );
    }
    let rest = discovery.after.budget.unexplained;
    // Otherwise the sentence says so.
    if discovery.verdict == Verdict::Partial && !discovery.predicts_better() && rest > LEAST_REST {
        sentences
            .push(format!("A remainder of {} of the squared velocities is not identified.", percent(rest)));
    }
    if discovery.cells_differ() {
        sentences.push(
            "Deviations of single cells explain anything that varies from cell to cell in the same way, so other behaviour of a cell \
             can be mistaken for them."
                .into(),
        );
    }
    if !discovery.selected.is_empty() {
        sentences.push(format!(
            "This is an association, not proof of a mechanism: {} candidates were compared, and something not among them may explain \
             the data as well.",
            search.candidates.len()
        ));
    }
    if matches!(discovery.verdict, Verdict::NothingMissing | Verdict::UnexplainedWhite) {
        sentences.extend(limits(discovery));
    }
    if discovery.before.inference.noise_source == NoiseSource::Estimated {
        sentences.push(
            "Noise was estimated, not given. The estimate counts anything missing as noise, so it is an upper bound and small effects \
             are missed."
                .into(),
        );
    }
    sentences.join(" ")
}

/// What would have been missed.
fn limits(discovery: &Discovery) -> Option<String> {
    let testable = discovery.ranking.iter().filter(|candidate| {
        !matches!(candidate.fate, Fate::Absorbed | Fate::NotTestable(_) | Fate::Description)
    });
    let mut limits: Vec<f64> =
        testable.map(|candidate| candidate.detection_limit).filter(|limit| limit.is_finite()).collect();
    limits.sort_unstable_by(f64::total_cmp);
    let (least, middle) = (limits.first()?, limits.get(limits.len() / 2)?);
    Some(format!(
        "Effects below their detection limits would have been missed: the limits start at {} of the velocity, and half of the \
         candidates have one above {}.",
        percent(*least),
        percent(*middle)
    ))
}

/// What to measure next.
pub(super) fn measure_next(
    discovery: &Discovery,
    search: &Search,
    prepared: &Problem,
    findings: &Findings,
) -> String {
    let mut advice: Vec<String> = findings.advice().collect();
    if discovery.before.inference.cells_turn() {
        advice.push("Frames that are closer in time: cells turn around between the present ones.".into());
        return advice.join(" ");
    }
    for selected in &discovery.selected {
        for other in others(selected) {
            let by = told_apart_by(selected.effect, other);
            advice.push(format!(
                "To tell {} from {}: {}.",
                selected.effect.id,
                other.id,
                by.trim_end_matches('.')
            ));
        }
    }
    let untold = search.candidates.iter().filter(|effect| has_memory(effect)).any(|effect| {
        let is_it = |fate: &Fate| matches!(fate, Fate::NotTestable(_));
        discovery.ranking.iter().any(|candidate| candidate.effect.id == effect.id && is_it(&candidate.fate))
    });
    let open = !matches!(discovery.verdict, Verdict::NothingMissing | Verdict::Attributed);
    if open && untold && prepared.velocities.are_of_cells() {
        advice.push("Tracks over three frames or more, which make effects with a memory testable.".into());
    }
    match discovery.verdict {
        Verdict::UnexplainedStructured => advice.push(
            "Something that varies across the tissue as the residual does: a marker as labels of cells, or a field to compare with \
             (--field)."
                .into(),
        ),
        Verdict::Partial if discovery.cells_differ() => advice.push(
            "The same cells tracked through further frames: their deviations must persist. Or a marker as labels, if there are several \
             kinds of cells."
                .into(),
        ),
        Verdict::Partial => {
            advice.push("More frames of the same tissue, to identify the remainder.".into());
        }
        Verdict::NothingMissing | Verdict::NotTestable => advice.push(
            "More cells or frames, if smaller effects matter: detection limits fall with the root of the number of velocities."
                .into(),
        ),
        Verdict::UnexplainedWhite | Verdict::Attributed => {}
    }
    if discovery.before.inference.noise_source == NoiseSource::Estimated
        || discovery.verdict == Verdict::UnexplainedWhite
    {
        advice.push(
            "The noise by itself, for example from cells tracked twice or from fixed tissue, to be given as position_noise and \
             velocity_noise."
                .into(),
        );
    }
    advice.join(" ")
}
