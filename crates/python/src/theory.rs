//! Mean-field theory of the honeycomb.

use crate::error::fault;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voronudge::theory::{MeanField, Parameters, Phase};

/// Moduli, prestress and phase of the honeycomb, for a mean area of 1.
#[pyfunction]
#[pyo3(signature = (*, K_A = 0.0, K_P = 1.0, P_0 = 3.0, alpha = 0.0))]
#[allow(non_snake_case, reason = "the field's symbols are the names of the arguments")]
pub(crate) fn mean_field<'py>(
    py: Python<'py>,
    K_A: f64,
    K_P: f64,
    P_0: f64,
    alpha: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let parameters = Parameters {
        area_elasticity: K_A,
        perimeter_elasticity: K_P,
        preferred_perimeter: P_0,
        chirality: alpha,
    };
    let theory = MeanField::new(parameters).map_err(|error| fault(py, error, None::<&str>))?;
    let moduli = theory.moduli();
    let table = PyDict::new(py);
    for (name, value) in [
        ("B", moduli.bulk),
        ("A", moduli.odd_bulk),
        ("mu", moduli.shear),
        ("K_odd", moduli.odd_shear),
        ("exceptional_alpha", theory.exceptional_chirality()),
        ("distance_to_limit", theory.distance_to_limit()),
    ] {
        table.set_item(name, value)?;
    }
    table.set_item("prestress", theory.prestress())?;
    let phase = match theory.phase() {
        Phase::Solid => "solid",
        Phase::OddElasticSolid => "odd elastic solid",
        Phase::Unstable => "unstable",
    };
    table.set_item("phase", phase)?;
    Ok(table)
}
