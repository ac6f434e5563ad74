//! Synthetic parameters of fits.

use std::collections::BTreeMap;
use voronudge_report::infer_report::{KindDifference, KindReport, Parameter, Parameters};

/// One that is fitted.
pub fn fitted(value: f64, half: f64, unit: &str) -> Parameter {
    Parameter {
        value,
        ci95: Some([value - half, value + half]),
        fixed: false,
        unit: unit.to_owned(),
        words: "K_P alpha is known to 2 %.".into(),
    }
}

/// One that is held.
pub fn held(value: f64, unit: &str) -> Parameter {
    Parameter { value, ci95: None, fixed: true, unit: unit.into(), words: "It is held.".into() }
}

/// Those of a fit.
pub fn parameters() -> Parameters {
    Parameters {
        K_A: held(0.0008, "1/(um^2*min)"),
        K_P: fitted(0.021, 0.0057, "1/min"),
        P_0: fitted(44.4, 1.6, "um"),
        A_0: held(124.8, "um^2"),
        alpha: fitted(3.4, 0.9, ""),
        K_P_alpha: fitted(0.0714, 0.0031, "1/min"),
        shape_index: fitted(3.97, 0.14, ""),
    }
}

/// The cells of a label, as in a fit of two kinds.
pub fn kind(label: i64) -> KindReport {
    let is_reference = label == 0;
    let difference = KindDifference { value: 0.8, ci95: [0.3, 1.3] };
    KindReport {
        label,
        cells: 320,
        is_reference,
        parameters: parameters(),
        differences: if is_reference {
            BTreeMap::new()
        } else {
            BTreeMap::from([("alpha".into(), difference)])
        },
        p: if is_reference { 1.0 } else { 0.002 },
        p_adjusted: if is_reference { 1.0 } else { 0.002 },
        differs: !is_reference,
        words: format!("cells of label {label}"),
    }
}
