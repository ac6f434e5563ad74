//! What surrounds and preceded the cells: data that terms may refer to.

use crate::CellFactors;
use thiserror::Error;
use voronudge_geometry::{Certificate, Domain, Elementary, Grid, Tessellation, Vector, areas};

/// Why an environment cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EnvironmentError {
    /// Two arrays over cells disagree.
    #[error("{what} are given for {found} cells, but there are {expected}")]
    Cells {
        /// Which data.
        what: &'static str,
        /// Number of entries given.
        found: usize,
        /// Number of cells known from other data.
        expected: usize,
    },
    /// A map does not fill its grid.
    #[error("a map has {found} vectors, but its grid has {expected} places")]
    Map {
        /// Number of vectors given.
        found: usize,
        /// Number of places of the grid.
        expected: usize,
    },
    /// A length is not positive, or a vector not finite.
    #[error("{what} is not usable: {value}")]
    Value {
        /// Which value.
        what: &'static str,
        /// The value.
        value: f64,
    },
}

/// An external field of vectors on a regular grid, interpolated bilinearly between the centres of its squares.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorMap {
    grid: Grid,
    values: Vec<Vector<f64>>,
}

impl VectorMap {
    /// A map from the vectors at the centres of a grid, in the order of its squares.
    ///
    /// # Errors
    /// [`EnvironmentError::Map`] if their number is another, [`EnvironmentError::Value`] if one is not finite.
    pub fn new(grid: Grid, values: Vec<Vector<f64>>) -> Result<Self, EnvironmentError> {
        if values.len() != grid.len() {
            return Err(EnvironmentError::Map { found: values.len(), expected: grid.len() });
        }
        match values.iter().flatten().find(|value| !value.is_finite()) {
            Some(&value) => Err(EnvironmentError::Value { what: "a vector of a map", value }),
            None => Ok(Self { grid, values }),
        }
    }

    /// The field at a position; zero outside the outermost centres. In a periodic box the image of the position that
    /// follows the first centre is looked up.
    pub fn at<S: Elementary>(&self, position: Vector<S>, domain: Domain) -> Vector<S> {
        let zero = S::constant(0.0);
        let outside = Vector::new(zero, zero);
        let ([nx, ny], [dx, dy]) = (self.grid.size(), self.grid.spacing());
        if nx < 2 || ny < 2 {
            return outside;
        }
        let first = self.grid.centre(0);
        let real = Vector::new(position.x.real(), position.y.real()) - first;
        let image = match domain {
            Domain::Periodic(cell_box) => cell_box.translation(cell_box.image(real)),
            Domain::Open => Vector::zeros(),
        };
        let start = first + image;
        let (x, y) = ((position.x - start.x) * (1.0 / dx), (position.y - start.y) * (1.0 / dy));
        let inside = |at: f64, count: usize| at >= 0.0 && at <= (count - 1) as f64;
        if !(inside(x.real(), nx) && inside(y.real(), ny)) {
            return outside;
        }
        let square = |at: f64, count: usize| (at as usize).min(count - 2);
        let (ix, iy) = (square(x.real(), nx), square(y.real(), ny));
        let (u, w) = (x - ix as f64, y - iy as f64);
        let value = |jx: usize, jy: usize| self.values[(iy + jy) * nx + ix + jx];
        let blend = |k: usize| {
            let row = |jy| (-u + 1.0) * value(0, jy)[k] + u * value(1, jy)[k];
            (-w + 1.0) * row(0) + w * row(1)
        };
        Vector::new(blend(0), blend(1))
    }
}

/// The entries of some cells, where there are any.
pub(crate) fn picked<T: Copy>(of_cells: &[T], cells: &[usize]) -> Vec<T> {
    if of_cells.is_empty() { Vec::new() } else { cells.iter().map(|cell| of_cells[*cell]).collect() }
}

/// Cells that do not differ.
static ALIKE: CellFactors = CellFactors::ALIKE;

/// What surrounds and preceded the cells of one configuration. Empty by default.
///
/// ```
/// use voronudge_model::Environment;
/// let environment = Environment::default().with_labels(vec![Some(1), None, Some(1)])?;
/// assert!(environment.with_beyond_edge(vec![true; 2]).is_err());
/// # Ok::<(), voronudge_model::EnvironmentError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    origin: Vector<f64>,
    cell_size: f64,
    labels: Vec<Option<i64>>,
    maps: Vec<VectorMap>,
    earlier: Vec<Option<Vector<f64>>>,
    beyond_edge: Vec<bool>,
    cell_factors: Option<CellFactors>,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            origin: Vector::zeros(),
            cell_size: 1.0,
            labels: Vec::new(),
            maps: Vec::new(),
            earlier: Vec::new(),
            beyond_edge: Vec::new(),
            cell_factors: None,
        }
    }
}

impl Environment {
    /// What effects may refer to at given positions (N): `ℓ_0` is the root of the mean area (of the box per cell, or of the
    /// cells that count, or if there are none of those with a closed polygon), the origin the middle of the box or the mean
    /// position of these cells, and in an open field cells that do not count are beyond the edge.
    ///
    /// # Errors
    /// [`EnvironmentError::Value`] if no cell has a size.
    pub fn around(
        tessellation: &Tessellation,
        positions: &[Vector<f64>],
        view: &Certificate,
    ) -> Result<Self, EnvironmentError> {
        match tessellation.domain() {
            Domain::Periodic(cell_box) => {
                let [x, y] = cell_box.lengths();
                let area = cell_box.area() / positions.len() as f64;
                Self::default().about(Vector::new(0.5 * x, 0.5 * y)).with_cell_size(area.sqrt())
            }
            Domain::Open => {
                let cells = 0..positions.len();
                let mut counted: Vec<usize> = cells.clone().filter(|&cell| view.counts(cell)).collect();
                if counted.is_empty() {
                    counted = cells.clone().filter(|&cell| tessellation.is_closed(cell)).collect();
                }
                let areas = areas(tessellation, positions);
                let number = counted.len().max(1) as f64;
                let middle = counted.iter().map(|&cell| positions[cell]).sum::<Vector<f64>>() / number;
                let area = counted.iter().map(|&cell| areas[cell]).sum::<f64>() / number;
                Self::default()
                    .about(middle)
                    .with_cell_size(area.sqrt())?
                    .with_beyond_edge(cells.map(|cell| !view.counts(cell)).collect())
            }
        }
    }

    /// The same with another origin, about which ramps and polynomials are taken: the centre of the data.
    #[must_use]
    pub fn about(self, origin: Vector<f64>) -> Self {
        Self { origin, ..self }
    }

    /// The same with another size `ℓ_0` of a cell, in the unit of the positions; one by default.
    ///
    /// # Errors
    /// [`EnvironmentError::Value`] unless it is positive.
    pub fn with_cell_size(self, cell_size: f64) -> Result<Self, EnvironmentError> {
        if cell_size.is_finite() && cell_size > 0.0 {
            Ok(Self { cell_size, ..self })
        } else {
            Err(EnvironmentError::Value { what: "the size of a cell", value: cell_size })
        }
    }

    /// The same with a measured label of each cell, where there is one, in place of any that were given before.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] if other data are for another number of cells.
    pub fn with_labels(self, labels: Vec<Option<i64>>) -> Result<Self, EnvironmentError> {
        let unlabelled = Self { labels: Vec::new(), ..self };
        unlabelled.fits("labels", labels.len())?;
        Ok(Self { labels, ..unlabelled })
    }

    /// The same with one external field more.
    #[must_use]
    pub fn with_map(mut self, map: VectorMap) -> Self {
        self.maps.push(map);
        self
    }

    /// The same with the velocity of each cell in an earlier interval that shares no time with the one at hand.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] if other data are for another number of cells; [`EnvironmentError::Value`] if a
    /// velocity is not finite.
    pub fn with_earlier(self, earlier: Vec<Option<Vector<f64>>>) -> Result<Self, EnvironmentError> {
        self.fits("earlier velocities", earlier.len())?;
        match earlier.iter().flatten().flatten().find(|v| !v.is_finite()) {
            Some(&value) => Err(EnvironmentError::Value { what: "an earlier velocity", value }),
            None => Ok(Self { earlier, ..self }),
        }
    }

    /// The same with the cells that do not count: those at the rim of an open field.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] if other data are for another number of cells.
    pub fn with_beyond_edge(self, beyond_edge: Vec<bool>) -> Result<Self, EnvironmentError> {
        self.fits("cells beyond the edge", beyond_edge.len())?;
        Ok(Self { beyond_edge, ..self })
    }

    /// The same with parameters that differ from cell to cell, in place of any that were given before.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] if other data are for another number of cells.
    pub fn with_cell_factors(self, factors: CellFactors) -> Result<Self, EnvironmentError> {
        let alike = self.having(CellFactors::default());
        if let Some(cells) = factors.cells() {
            alike.fits("parameters of cells", cells)?;
        }
        Ok(alike.having(factors))
    }

    /// The same for factors that fit.
    pub(crate) fn having(self, factors: CellFactors) -> Self {
        Self { cell_factors: factors.cells().map(|_| factors), ..self }
    }

    fn fits(&self, what: &'static str, found: usize) -> Result<(), EnvironmentError> {
        let known = [self.labels.len(), self.earlier.len(), self.beyond_edge.len(), self.cells_of_factors()];
        match known.into_iter().find(|&cells| cells != 0 && cells != found) {
            Some(expected) => Err(EnvironmentError::Cells { what, found, expected }),
            None => Ok(()),
        }
    }

    /// Checks that the data over cells are for a given number of them.
    ///
    /// # Errors
    /// [`EnvironmentError::Cells`] otherwise.
    pub fn check(&self, cells: usize) -> Result<(), EnvironmentError> {
        let given = [
            ("labels", self.labels.len()),
            ("earlier velocities", self.earlier.len()),
            ("cells beyond the edge", self.beyond_edge.len()),
            ("parameters of cells", self.cells_of_factors()),
        ];
        match given.into_iter().find(|&(_, found)| found != 0 && found != cells) {
            Some((what, found)) => Err(EnvironmentError::Cells { what, found, expected: cells }),
            None => Ok(()),
        }
    }

    fn cells_of_factors(&self) -> usize {
        self.cell_factors.as_ref().and_then(CellFactors::cells).unwrap_or(0)
    }

    /// Whether parameters differ from cell to cell.
    #[inline]
    pub fn cells_differ(&self) -> bool {
        self.cell_factors.is_some()
    }

    /// The multiples that the cells have of the model's parameters.
    #[inline]
    pub fn cell_factors(&self) -> &CellFactors {
        self.cell_factors.as_ref().unwrap_or(&ALIKE)
    }

    /// The point about which ramps and polynomials are taken.
    pub fn origin(&self) -> Vector<f64> {
        self.origin
    }

    /// The size `ℓ_0` of a cell: the root of the mean area.
    pub fn cell_size(&self) -> f64 {
        self.cell_size
    }

    /// The measured labels, one per cell, or none at all.
    pub fn labels(&self) -> &[Option<i64>] {
        &self.labels
    }

    /// The label of a cell, if it has one.
    pub fn label(&self, cell: usize) -> Option<i64> {
        self.labels.get(cell).copied().flatten()
    }

    /// Distinct labels but the most frequent, ascending; of equally frequent ones the lowest counts as the reference.
    pub fn other_labels(&self) -> Vec<i64> {
        let mut counts = std::collections::BTreeMap::<i64, usize>::new();
        for label in self.labels.iter().flatten() {
            *counts.entry(*label).or_default() += 1;
        }
        let reference = counts.iter().rev().max_by_key(|(_, count)| **count).map(|(label, _)| *label);
        counts.into_keys().filter(|label| Some(*label) != reference).collect()
    }

    /// The external fields.
    pub fn maps(&self) -> &[VectorMap] {
        &self.maps
    }

    /// Whether any earlier velocity is known.
    pub fn has_history(&self) -> bool {
        self.earlier.iter().any(Option::is_some)
    }

    /// The earlier velocity of a cell, if it is known.
    pub fn earlier(&self, cell: usize) -> Option<Vector<f64>> {
        self.earlier.get(cell).copied().flatten()
    }

    /// Whether there is an edge: cells that count beside cells that do not.
    pub fn has_edge(&self) -> bool {
        self.beyond_edge.contains(&true) && self.beyond_edge.contains(&false)
    }

    /// Whether a cell does not count.
    pub fn is_beyond_edge(&self, cell: usize) -> bool {
        self.beyond_edge.get(cell).copied().unwrap_or(false)
    }

    /// What surrounds and preceded some of the cells, by their index.
    #[must_use]
    pub fn of_cells(&self, cells: &[usize]) -> Self {
        let Self { origin, cell_size, labels, maps, earlier, beyond_edge, cell_factors } = self;
        Self {
            origin: *origin,
            cell_size: *cell_size,
            labels: picked(labels, cells),
            maps: maps.clone(),
            earlier: picked(earlier, cells),
            beyond_edge: picked(beyond_edge, cells),
            cell_factors: cell_factors.as_ref().map(|factors| factors.of_cells(cells)),
        }
    }

    /// The environment of the tissue moved by `r → map r + shift`. Maps are shifted only.
    pub(crate) fn moved(&self, map: &nalgebra::Matrix2<f64>, shift: Vector<f64>) -> Self {
        let shifted = |field: &VectorMap| {
            let corner = field.grid.centre(0) + shift;
            let grid = Grid::new([corner.x, corner.y], field.grid.spacing(), field.grid.size());
            VectorMap { grid: grid.unwrap_or(field.grid), values: field.values.clone() }
        };
        Self {
            origin: map * self.origin + shift,
            maps: self.maps.iter().map(shifted).collect(),
            earlier: self.earlier.iter().map(|v| v.map(|v| map * v)).collect(),
            ..self.clone()
        }
    }
}
