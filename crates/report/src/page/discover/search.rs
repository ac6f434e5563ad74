//! How the search was checked.

use super::super::words::{percent, probability, with_error};
use super::super::{Block, Section, Text};
use crate::discover_report::DiscoverReport;
use crate::numbers::significant;

/// The section of the page; without content if nothing was checked.
pub(super) fn section(report: &DiscoverReport) -> Section {
    let mut facts: Vec<[Text; 2]> = Vec::new();
    let mut fact = |name: &str, text: Text| facts.push([name.into(), text]);
    if let Some(gain) = report.likelihood_gain.filter(|gain| gain.value.is_finite()) {
        let name = "velocities held out become more probable: fall of −2 log p over all folds";
        fact(name, with_error(gain.value, gain.standard_error).into());
    }
    if report.null_sets.refitted > 0 {
        let sets = format!("{} sets; the seeds are in report.json", report.null_sets.refitted);
        fact("made-up data without an effect, fitted in the same way", sets.into());
    }
    if let Some(found) = &report.calibration {
        let level = format!(
            "{} over all candidates together; a single candidate needs p below {}",
            significant(found.level, 2),
            probability(found.single_p)
        );
        fact("level of the search", level.into());
        fact(
            "without that adjustment, sets in which something would have been found",
            percent(found.unadjusted_false_positives).into(),
        );
        fact("", Text::prose(&found.words));
    }
    if let Some(own) = &report.predictors {
        fact("effects with a memory were predicted from", Text::prose(&own.interval));
        fact("overlap of the intervals", Text::prose(&own.overlap));
    }
    Section::new("How the search was checked").with(Block::facts(facts))
}
