//! The Python package `voronudge`: velocities, derivatives and polygons of a tissue on NumPy arrays, mean-field theory, and
//! the commands of the program.

mod arrays;
mod error;
mod model;
mod program;
mod theory;
mod tissue;

use pyo3::prelude::*;

/// What the Python side of the package is made of.
#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::program::{options, run};
    #[pymodule_export]
    use crate::theory::mean_field;
    #[pymodule_export]
    use crate::tissue::Tissue;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add(
            "effects",
            voronudge::model::Effect::all().iter().map(|effect| effect.id).collect::<Vec<_>>(),
        )
    }
}
