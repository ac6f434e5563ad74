//! Cells that differ: parameters of single cells from arrays.

use crate::failure::Failure;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use voronudge_model::{CellFactors, CellParameter, Parameters};

/// Mean below which, relative to the largest value, a parameter has no mean to be a multiple of.
const NO_MEAN: f64 = 1e-6;

/// The values (N) of each parameter in which cells differ, by name.
#[derive(Debug, Clone, Default, Serialize)]
#[serde(transparent)]
pub(super) struct OfCells(BTreeMap<&'static str, Vec<f64>>);

impl OfCells {
    /// Whether all cells are alike.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The files of `NAME=FILE.npy`.
    pub fn files(arguments: &[String]) -> impl Iterator<Item = &Path> {
        arguments.iter().filter_map(|text| text.split_once('=')).map(|(_, file)| Path::new(file))
    }

    /// Reads `NAME=FILE.npy` for so many cells. The parameter of the model becomes the mean of the values.
    pub fn read(
        arguments: &[String],
        cells: usize,
        parameters: &mut Parameters<f64>,
    ) -> Result<(Self, CellFactors), Failure> {
        let (mut values, mut factors) = (BTreeMap::new(), CellFactors::default());
        for text in arguments {
            let fault = |message: String, hint: &str| {
                Failure::new(format!("--cell-parameter {text}: {message}")).with_hint(hint)
            };
            let Some((parameter, file)) =
                text.split_once('=').and_then(|(name, file)| Some((CellParameter::from_name(name)?, file)))
            else {
                let hint = "write K_A, P_0, A_0 or alpha, then = and a file, as in P_0=P_0.npy";
                return Err(fault("there is no such parameter of a cell".into(), hint));
            };
            let array = voronudge_io::read_reals(Path::new(file))?;
            if array.shape() != [cells] {
                let found =
                    format!("the array has the shape {:?}, but there are {cells} cells", array.shape());
                return Err(fault(found, "give an array of one number for each cell"));
            }
            let own: Vec<f64> = array.iter().copied().collect();
            if let Some(cell) = own.iter().position(|value| !value.is_finite()) {
                let found = format!("the value of cell {cell} is {}", own[cell]);
                return Err(fault(found, "give one finite number for each cell"));
            }
            let mean = own.iter().sum::<f64>() / cells as f64;
            let largest = own.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
            // Values of zero, too, have none.
            if !mean.is_finite() || mean.abs() <= NO_MEAN * largest {
                return Err(fault(
                    format!("the mean of the values is {mean}"),
                    "give finite values whose mean is not zero",
                ));
            }
            match parameter {
                CellParameter::AreaElasticity => parameters.area_elasticity = mean,
                CellParameter::PreferredPerimeter => parameters.preferred_perimeter = mean,
                CellParameter::PreferredArea => parameters.preferred_area = mean,
                CellParameter::Chirality => parameters.chirality = mean,
            }
            let refused = |error: voronudge_model::EnvironmentError| {
                fault(error.to_string(), "give one finite number for each cell")
            };
            factors =
                factors.with(parameter, own.iter().map(|value| value / mean).collect()).map_err(refused)?;
            if values.insert(parameter.name(), own).is_some() {
                return Err(fault("the parameter is given twice".into(), "give one file for it"));
            }
        }
        Ok((Self(values), factors))
    }
}
