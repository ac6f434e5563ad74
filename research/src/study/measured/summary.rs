//! What the sets of a class come to.

use super::count::Count;
use super::record::{Estimate, Fit, Record};
use crate::study::seeds::quartiles;
use claims::measured::Class;
use std::collections::BTreeMap;

/// What the sets of a class come to.
pub struct Summary {
    pub class: Class,
    pub sets: usize,
    pub k_p_alpha: Errors,
    pub p_0: Errors,
    /// Of cells that crawl.
    pub v_0: Errors,
    pub d_r: Errors,
    pub trustworthy: Count,
    /// Of the fits that are off, those that are called not trustworthy.
    pub flagged: Count,
    pub recall: Count,
    pub precision: Count,
    /// Of searches for missing effects, those that name one, and how often each is named.
    pub findings: Count,
    /// Of searches in data in which something acts that the model lacks, those that name it and nothing else.
    pub right: Count,
    pub named: BTreeMap<String, usize>,
    /// Median wall time.
    pub seconds: f64,
    /// Sets of which the program gave no answer.
    pub failed: usize,
}

/// Errors of a parameter.
pub struct Errors {
    /// Relative errors of all sets.
    pub all: Vec<f64>,
    pub covered: Count,
}

impl Errors {
    fn of<'a>(estimates: impl Iterator<Item = &'a Estimate> + Clone) -> Self {
        let all = estimates.clone().map(Estimate::error).collect();
        Self { all, covered: Count::of(estimates.map(Estimate::covers)) }
    }

    /// Median of the size of the errors.
    pub fn size(&self) -> f64 {
        quartiles(self.all.iter().map(|error| error.abs()).collect())[1]
    }
}

impl Summary {
    pub fn of(class: &Class, records: &[Record]) -> Self {
        let fits: Vec<&Fit> = records.iter().filter_map(|record| record.fit.as_ref()).collect();
        let recoveries = || fits.iter().filter_map(|fit| fit.recall);
        let discoveries = || records.iter().filter_map(|record| record.discovery.as_ref());
        let mut named = BTreeMap::new();
        for effect in discoveries().flat_map(|discovery| &discovery.effects) {
            *named.entry(effect.clone()).or_insert(0) += 1;
        }
        Self {
            class: *class,
            sets: records.len(),
            k_p_alpha: Errors::of(fits.iter().map(|fit| &fit.k_p_alpha)),
            p_0: Errors::of(fits.iter().map(|fit| &fit.p_0)),
            v_0: Errors::of(fits.iter().filter_map(|fit| fit.activity.as_ref()).map(|own| &own.v_0)),
            d_r: Errors::of(fits.iter().filter_map(|fit| fit.activity.as_ref()).map(|own| &own.d_r)),
            trustworthy: Count::of(fits.iter().map(|fit| fit.trustworthy)),
            flagged: Count::of(fits.iter().filter(|fit| fit.is_off()).map(|fit| !fit.trustworthy)),
            recall: recoveries().map(|own| own.recall()).sum(),
            precision: recoveries().map(|own| own.precision()).sum(),
            findings: Count::of(discoveries().map(|own| !own.effects.is_empty())),
            right: Count::of(discoveries().filter_map(|own| own.right)),
            named,
            seconds: quartiles(records.iter().map(|record| record.seconds).collect())[1],
            failed: records.len() - fits.len(),
        }
    }
}

/// Prints the table, and what was found that is not there.
pub fn print(summaries: &[Summary]) {
    const HEAD: [&str; 12] = [
        "data",
        "sets",
        "K_P α: error %",
        "size %",
        "covered",
        "P_0: error %",
        "size %",
        "covered",
        "trustworthy",
        "off by over 3 s.e., flagged",
        "latent cells: recall, precision",
        "s",
    ];
    println!("| {} |\n|{}", HEAD.join(" | "), "---|".repeat(HEAD.len()));
    let errors = |errors: &Errors| {
        let [low, median, high] = quartiles(errors.all.clone()).map(|error| 100.0 * error);
        let size = 100.0 * errors.size();
        format!("{median:+.1} ({low:+.1} to {high:+.1}) | {size:.1} | {}", errors.covered)
    };
    for own in summaries {
        let sets = if own.failed == 0 {
            own.sets.to_string()
        } else {
            format!("{}, {} failed", own.sets, own.failed)
        };
        println!(
            "| {} | {sets} | {} | {} | {} | {} | {}, {} | {:.1} |",
            own.class.words,
            errors(&own.k_p_alpha),
            errors(&own.p_0),
            own.trustworthy,
            own.flagged,
            own.recall,
            own.precision,
            own.seconds
        );
    }
    if summaries.iter().any(|own| own.v_0.covered.total > 0) {
        println!("\n| data | v_0: error % | size % | covered | D_r: error % | size % | covered |");
        println!("|{}", "---|".repeat(7));
    }
    for own in summaries.iter().filter(|own| own.v_0.covered.total > 0) {
        println!("| {} | {} | {} |", own.class.words, errors(&own.v_0), errors(&own.d_r));
    }
    if summaries.iter().all(|own| own.findings.total == 0) {
        return;
    }
    println!(
        "\n| data | an effect is named | which | the one that acts, or its class, and no other |\n|---|---|---|---|"
    );
    for own in summaries {
        let named = own.named.iter().map(|(effect, count)| format!("`{effect}` {count}"));
        println!(
            "| {} | {} | {} | {} |",
            own.class.words,
            own.findings,
            named.collect::<Vec<_>>().join(", "),
            if own.right.total > 0 { own.right.to_string() } else { "none acts".into() }
        );
    }
}
