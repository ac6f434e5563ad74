//! Effects of the catalogue in the data: how often they are found, and told from others.

use super::added::{Size, with_effects};
use super::table::{count, head, named, percent, row, seconds, spread, verdict};
use super::{Found, Plan};
use crate::Outcome;
use crate::study::seeds::quartiles;
use claims::Noise;
use voronudge_infer::discover::Verdict;

const VELOCITY_NOISE: f64 = 0.1;
const POSITION_NOISE: [f64; 2] = [0.01, 0.02];
const SIZES: [f64; 4] = [0.05, 0.1, 0.15, 0.2];
const EFFECTS: [&str; 9] = [
    "drift",
    "alpha_area",
    "size_friction",
    "short_range_repulsion",
    "internal_drag",
    "cell_centre_chirality",
    "nonlinear_area",
    "nematic_stress",
    "p0_gradient",
];

/// Effects that others resemble. Those that slow all cells are hardly more than another unit of velocity and need to be
/// large.
const ALIASES: [(&str, Size); 6] = [
    ("p0_gradient", Size::Beyond(0.1)),
    ("kp_gradient", Size::Beyond(0.1)),
    ("edge_tension", Size::Beyond(0.1)),
    ("chiral_edge_tension", Size::Beyond(0.1)),
    ("internal_drag", Size::Whole(0.4)),
    ("flow_blur", Size::Whole(0.4)),
];

const PAIRS: [[&str; 2]; 5] = [
    ["drift", "alpha_area"],
    ["size_friction", "nonlinear_area"],
    ["short_range_repulsion", "cell_centre_chirality"],
    ["p0_gradient", "size_friction"],
    ["nematic_stress", "drift"],
];

/// One effect of several sizes.
pub fn single(plan: &Plan) -> Outcome {
    println!("### One effect, σ_v 10 % ({})\n", plan.describe());
    head(&[
        "size %",
        "σ_r %",
        "effect",
        "beyond the base %",
        "ranked first",
        "exact",
        "exact up to class",
        "in class",
        "attributed",
        "partial",
        "coefficient / truth",
        "interval covers",
        "error falls",
        "χ²/dof",
        "s",
    ]);
    for size in SIZES {
        for position in POSITION_NOISE {
            for effect in EFFECTS {
                let name = format!("power, {} %, σ_r {} %, {effect}", percent(size), percent(position));
                let settings = [(effect, Size::Whole(size))];
                let Some(found) = searched(plan, &name, position, &settings, Found::exact)? else { continue };
                row(&[
                    percent(size),
                    percent(position),
                    format!("`{effect}`"),
                    beyond(&found),
                    count(&found, Found::ranked_first),
                    count(&found, Found::exact),
                    count(&found, Found::exact_up_to_class),
                    count(&found, Found::in_classes),
                    verdict(&found, Verdict::Attributed),
                    verdict(&found, Verdict::Partial),
                    bias(&found),
                    coverage(&found),
                    count(&found, Found::error_falls),
                    spread(&found.iter().map(Found::misfit).collect::<Vec<_>>()),
                    seconds(&found),
                ]);
            }
        }
    }
    println!();
    Ok(())
}

/// Effects that others resemble.
pub fn aliases(plan: &Plan) -> Outcome {
    println!("### Aliases, σ_r 1 %, σ_v 10 % ({})\n", plan.describe());
    head(&[
        "effect",
        "beyond the base %",
        "selected",
        "in class",
        "of those selected",
        "another one alone",
        "usual class",
        "s",
    ]);
    for (effect, size) in ALIASES {
        let name = format!("aliases, {effect}");
        let settings = [(effect, size)];
        let Some(found) = searched(plan, &name, POSITION_NOISE[0], &settings, Found::in_classes)? else {
            continue;
        };
        let (hits, all) = (
            found.iter().filter(|found| found.in_classes()).count(),
            found.iter().filter(|found| found.selected()).count(),
        );
        row(&[
            format!("`{effect}`"),
            beyond(&found),
            count(&found, Found::selected),
            count(&found, Found::in_classes),
            format!("{:.2} ({hits}/{all})", hits as f64 / all.max(1) as f64),
            count(&found, Found::wrong_alone),
            named(&found),
            seconds(&found),
        ]);
    }
    println!();
    Ok(())
}

/// Two effects at once.
pub fn pairs(plan: &Plan) -> Outcome {
    println!("### Two effects of 10 % each, σ_v 10 % ({})\n", plan.describe());
    head(&[
        "σ_r %",
        "effects",
        "exact",
        "exact up to class",
        "in classes",
        "attributed",
        "partial",
        "error falls",
        "s",
    ]);
    for position in POSITION_NOISE {
        for pair in PAIRS {
            let name = format!("pairs, σ_r {} %, {}", percent(position), pair.join(" + "));
            let settings = pair.map(|effect| (effect, Size::Whole(0.1)));
            let Some(found) = searched(plan, &name, position, &settings, Found::exact)? else { continue };
            row(&[
                percent(position),
                pair.map(|effect| format!("`{effect}`")).join(", "),
                count(&found, Found::exact),
                count(&found, Found::exact_up_to_class),
                count(&found, Found::in_classes),
                verdict(&found, Verdict::Attributed),
                verdict(&found, Verdict::Partial),
                count(&found, Found::error_falls),
                seconds(&found),
            ]);
        }
    }
    println!();
    Ok(())
}

/// Searches of data with effects, unless they are not asked for.
fn searched(
    plan: &Plan,
    name: &str,
    position: f64,
    effects: &[(&'static str, Size)],
    good: impl Fn(&Found) -> bool,
) -> Result<Option<Vec<Found>>, Box<dyn std::error::Error>> {
    if !plan.includes(name) {
        return Ok(None);
    }
    let noise = Noise { position, velocity: VELOCITY_NOISE };
    let sample = |seed, drawn| with_effects(&plan.tissue(seed)?, drawn, noise, effects);
    plan.search(name, noise, sample, |found| !good(found)).map(Some)
}

fn beyond(found: &[Found]) -> String {
    let [_, median, _] = quartiles(found.iter().map(|found| found.beyond).collect());
    format!("{:.1}", 100.0 * median)
}

fn bias(found: &[Found]) -> String {
    spread(&found.iter().filter_map(|found| Some(found.coefficient.as_ref()?.0)).collect::<Vec<_>>())
}

fn coverage(found: &[Found]) -> String {
    let all = found.iter().filter_map(|found| Some(&found.coefficient.as_ref()?.1)).flatten();
    let (hits, count) = all.fold((0, 0), |(hits, count), covers| (hits + usize::from(*covers), count + 1));
    format!("{:.2} ({hits}/{count})", hits as f64 / count.max(1) as f64)
}
