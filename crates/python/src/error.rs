//! Faults as the Python exception `voronudge.Error`, with the hint.

use pyo3::prelude::*;

/// The exception for a fault and the advice on it.
pub(crate) fn fault(py: Python<'_>, message: impl ToString, hint: Option<impl ToString>) -> PyErr {
    let made = || {
        let class = py.import("voronudge.errors")?.getattr("Error")?;
        class.call1((message.to_string(), hint.map(|hint| hint.to_string())))
    };
    match made() {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// The exception for a fault of a tessellation.
pub(crate) fn of_geometry(py: Python<'_>, error: &voronudge::geometry::Error) -> PyErr {
    fault(py, error, error.hint())
}
