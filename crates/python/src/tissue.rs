//! The cells of one moment.

use crate::arrays::{array, field, vectors};
use crate::error::of_geometry;
use crate::model::Given;
use ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voronudge::geometry::{FieldOfView, areas, perimeters, polygons};
use voronudge::model::{jacobian, jvp, stress, velocities, vjp};
use voronudge::{Domain, Model, PeriodicBox, Tessellation, Vector};

/// Cells at given positions and their Voronoi tessellation.
#[pyclass(frozen, module = "voronudge")]
pub(crate) struct Tissue {
    positions: Vec<Vector<f64>>,
    tessellation: Tessellation,
    view: FieldOfView,
}

type Blocks<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u64>>);

impl Tissue {
    /// What was given, and the model that it is here.
    fn model(&self, py: Python<'_>, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<(Given, Model<f64>)> {
        let given = Given::read(py, parameters)?;
        let model = given.model(py, &self.tessellation, &self.positions, &self.view)?;
        Ok((given, model))
    }
}

#[pymethods]
impl Tissue {
    #[new]
    #[pyo3(signature = (positions, r#box = None, *, shear = 0.0))]
    fn new(
        py: Python<'_>,
        positions: PyReadonlyArray2<'_, f64>,
        r#box: Option<[f64; 2]>,
        shear: f64,
    ) -> PyResult<Self> {
        let positions = vectors(py, "positions", &positions)?;
        let made = py.detach(|| {
            let domain = match r#box {
                Some(lengths) => Domain::Periodic(PeriodicBox::sheared(lengths, shear * lengths[1])?),
                None => Domain::Open,
            };
            Tessellation::new(&positions, domain)
        });
        let tessellation = made.map_err(|error| of_geometry(py, &error))?;
        Ok(Self { positions, tessellation, view: FieldOfView::default() })
    }

    fn __len__(&self) -> usize {
        self.positions.len()
    }

    /// Positions (N, 2).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        array(py, self.positions.iter().copied())
    }

    /// Side lengths of the periodic box; None of an open field.
    #[getter]
    fn r#box(&self) -> Option<[f64; 2]> {
        match self.tessellation.domain() {
            Domain::Periodic(own) => Some(own.lengths()),
            Domain::Open => None,
        }
    }

    /// Areas (N,); NaN of open polygons.
    #[getter]
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        py.detach(|| areas(&self.tessellation, &self.positions)).into_pyarray(py)
    }

    /// Perimeters (N,); NaN of open polygons.
    #[getter]
    fn perimeters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        py.detach(|| perimeters(&self.tessellation, &self.positions)).into_pyarray(py)
    }

    /// Whether each cell's velocity depends on cells that were seen alone (N,).
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let certificate = py.detach(|| self.view.judge(&self.tessellation, &self.positions));
        let counts: Vec<bool> = (0..self.positions.len()).map(|cell| certificate.counts(cell)).collect();
        counts.into_pyarray(py)
    }

    /// Neighbours as (indices, indptr): those of cell i, counter-clockwise, are indices[indptr[i]:indptr[i + 1]].
    #[getter]
    fn neighbours<'py>(&self, py: Python<'py>) -> (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<u64>>) {
        let cells = 0..self.positions.len();
        let indices: Vec<u32> =
            cells.clone().flat_map(|cell| self.tessellation.neighbours(cell)).copied().collect();
        let mut starts: Vec<u64> = cells.map(|cell| self.tessellation.half_edge_start(cell) as u64).collect();
        starts.push(indices.len() as u64);
        (indices.into_pyarray(py), starts.into_pyarray(py))
    }

    /// Vertices of each cell's polygon, counter-clockwise; an array without rows where it is open.
    fn polygons<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray2<f64>>> {
        let polygons = py.detach(|| polygons(&self.tessellation, &self.positions));
        polygons.into_iter().map(|vertices| array(py, vertices)).collect()
    }

    /// Velocities of the cells (N, 2); NaN where the polygon of a cell or of a neighbour is open.
    #[pyo3(signature = (**parameters))]
    fn velocities<'py>(
        &self,
        py: Python<'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let model =
            Given::read(py, parameters)?.model(py, &self.tessellation, &self.positions, &self.view)?;
        Ok(array(py, py.detach(|| velocities(&self.tessellation, &self.positions, &model))))
    }

    /// Blocks (data, indices, indptr) of the Jacobian.
    #[pyo3(signature = (**parameters))]
    fn _jacobian<'py>(
        &self,
        py: Python<'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Blocks<'py>> {
        let model =
            Given::read(py, parameters)?.model(py, &self.tessellation, &self.positions, &self.view)?;
        let matrix = py.detach(|| jacobian(&self.tessellation, &self.positions, &model));
        let blocks = matrix.block.len();
        let flat = matrix.block.into_flattened();
        // Four numbers for each block: the shape always fits.
        let data = Array3::from_shape_vec((blocks, 2, 2), flat).unwrap_or_default();
        let starts: Vec<u64> = matrix.row_start.into_iter().map(|start| start as u64).collect();
        Ok((data.into_pyarray(py), matrix.column.into_pyarray(py), starts.into_pyarray(py)))
    }

    /// The change of the velocities (N, 2) for displacements.
    #[pyo3(signature = (displacements, **parameters))]
    fn jvp<'py>(
        &self,
        py: Python<'py>,
        displacements: PyReadonlyArray2<'py, f64>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let u = field(py, "displacements", &displacements, self.positions.len())?;
        let (_, model) = self.model(py, parameters)?;
        Ok(array(py, py.detach(|| jvp(&self.tessellation, &self.positions, &model, &u))))
    }

    /// The derivative of Σ w·v by positions, and by parameters and coefficients of effects.
    #[pyo3(signature = (w, **parameters))]
    fn vjp<'py>(
        &self,
        py: Python<'py>,
        w: PyReadonlyArray2<'py, f64>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyDict>)> {
        let w = field(py, "w", &w, self.positions.len())?;
        let (given, model) = self.model(py, parameters)?;
        let (by_position, by_parameter) = py.detach(|| {
            let slopes = given.slopes(&self.tessellation, &self.positions, &model, &w);
            (vjp(&self.tessellation, &self.positions, &model, &w), slopes)
        });
        let named = PyDict::new(py);
        for (name, values) in by_parameter {
            match values.as_slice() {
                [value] => named.set_item(name, value)?,
                _ => named.set_item(name, values.into_pyarray(py))?,
            }
        }
        Ok((array(py, by_position), named))
    }

    /// Mean stress (2, 2): force index first.
    #[pyo3(signature = (**parameters))]
    fn stress<'py>(
        &self,
        py: Python<'py>,
        parameters: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let model =
            Given::read(py, parameters)?.model(py, &self.tessellation, &self.positions, &self.view)?;
        let [[xx, xy], [yx, yy]] = py.detach(|| {
            let certificate = self.view.judge(&self.tessellation, &self.positions);
            stress(&self.tessellation, &self.positions, &model, |cell| certificate.counts(cell))
        });
        Ok(Array2::from(vec![[xx, xy], [yx, yy]]).into_pyarray(py))
    }
}
