//! The answer in one sentence.

use voronudge_infer::{Doubt, Inference, Verdict as Answer};
use voronudge_report::infer_report::{Nmse, Parameters, Verdict, VerdictKind};
use voronudge_report::numbers::significant;

/// What a fit says; errors and parameters are those of the report.
pub(super) fn verdict(result: &Inference, nmse: &Nmse, parameters: &Parameters) -> Verdict {
    let answer = result.verdict();
    let held_out = nmse.cross_validated.unwrap_or(nmse.un_nudged);
    let missed = format!("leaves {} of the squared held-out velocities unexplained", percent(held_out));
    let kind = kind(answer);
    let sentence = match answer {
        Answer::ExplainsNothing => format!(
            "The model explains almost nothing of these velocities (held-out NMSE {}, where 1 is no explanation at all): the \
             numbers below describe no mechanism of this tissue.",
            significant(held_out, 3)
        ),
        Answer::NoFit => format!(
            "No acceptable fit: the objective is {} times what the noise levels explain, so these are too small or the model \
             lacks something; it {missed}.",
            significant(result.excess(), 2)
        ),
        Answer::MeasurementMisfit => {
            let doubts = result.doubts.iter().filter(|doubt| doubt.part().is_measurement());
            let causes: Vec<&str> = doubts.map(misfit).collect();
            format!(
                "Do not quote these numbers yet: {}. The model {missed}; its parameters may be wrong by more than their \
                 intervals.",
                causes.join("; ")
            )
        }
        Answer::Explained => format!(
            "{}. The model {missed}, as measurement noise alone would ({}).",
            findings(parameters),
            percent(nmse.noise_floor)
        ),
        Answer::ExplainedInPart => format!("{}. The model {missed}.", findings(parameters)),
        Answer::LacksSomething => format!(
            "{}. The model {missed}; measurement noise alone would leave {}: the model lacks something.",
            findings(parameters),
            percent(nmse.noise_floor)
        ),
    };
    Verdict { kind, sentence }
}

fn kind(answer: Answer) -> VerdictKind {
    match answer {
        Answer::Explained => VerdictKind::Explained,
        Answer::ExplainedInPart => VerdictKind::ExplainedInPart,
        Answer::LacksSomething => VerdictKind::LacksSomething,
        Answer::ExplainsNothing => VerdictKind::ExplainsNothing,
        Answer::MeasurementMisfit => VerdictKind::MeasurementMisfit,
        Answer::NoFit => VerdictKind::NoFit,
    }
}

/// Chirality and shape index in a clause.
fn findings(parameters: &Parameters) -> String {
    let alpha = &parameters.alpha;
    let chirality = match (parameters.K_P_alpha.ci95, alpha.fixed) {
        (Some([low, high]), false) if low > 0.0 || high < 0.0 => {
            format!("The tissue is chiral, α = {}", significant(alpha.value, 2))
        }
        (_, true) => format!("With α held at {}", significant(alpha.value, 2)),
        _ if parameters.K_P_alpha.fixed => {
            let held = format!("With K_P α held at {}", significant(parameters.K_P_alpha.value, 3));
            format!("{held}, α is {}", significant(alpha.value, 2))
        }
        _ => "No chirality is seen".into(),
    };
    format!(
        "{chirality}; the preferred shape index P₀/ℓ₀ is {}",
        significant(parameters.shape_index.value, 3)
    )
}

/// In what way the data are not what the fit takes them for.
fn misfit(doubt: &Doubt) -> &'static str {
    match doubt {
        Doubt::PositionNoise => {
            "positions would have to be so uncertain that nudges could explain almost anything"
        }
        Doubt::Voids(_) => "cells were missed",
        Doubt::Tails(_) => "a few velocities are outliers",
        Doubt::Turning(_) => "cells turn around between frames",
        Doubt::LongSteps(_) | Doubt::Integration(_) | Doubt::Effect("time_lag", _) => {
            "cells move too far between frames"
        }
        Doubt::Effect("flow_blur", _) => "the flow is averaged over a window other than the one assumed",
        Doubt::Effect(..) => "positions are centroids rather than sites",
        Doubt::Objective(_) | Doubt::Steps | Doubt::Pattern => "the fit is not a good one",
    }
}

fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 2))
}
