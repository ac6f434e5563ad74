//! Cells that differ: parameters of single cells from arrays and by labels.

use super::LARGEST_PARAMETER;
use crate::failure::Failure;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voronudge_io::DataSet;
use voronudge_model::{CellFactors, CellParameter, Environment, EnvironmentError, Model, Parameters};

/// Mean below which, relative to the largest value, a parameter has no mean to be a multiple of.
const NO_MEAN: f64 = 1e-6;
/// What may differ.
pub(super) const KNOWN: &str = "K_A, P_0, A_0 or alpha";

/// Parameters of the cells of data.
#[derive(Debug, Args)]
#[command(next_help_heading = "Cells that differ")]
pub(crate) struct CellArguments {
    /// Give each cell its own value of a parameter: `P_0=FILE.npy`, with an array (N) of values. NAME is K_A, P_0,
    /// A_0 or alpha. The parameter of the model is then the mean of the values. May be repeated.
    #[arg(long, value_name = "NAME=FILE")]
    cell_parameter: Vec<String>,
    /// Give the cells of each label their own value of a parameter: `alpha=0:0.2,1:1`. NAME is K_A, P_0, A_0 or
    /// alpha. Other cells have the value given for the model, whose parameter is then the mean over cells. May be
    /// repeated.
    #[arg(long, value_name = "NAME=LABEL:VALUE,…", allow_hyphen_values = true)]
    label_parameter: Vec<String>,
}

/// What one parameter is of each cell.
#[derive(Debug, Clone)]
pub(super) enum Values {
    /// By the number of the cell.
    OfCells(Vec<f64>),
    /// By its label, and of other cells.
    OfLabels(BTreeMap<i64, f64>, f64),
}

impl Values {
    fn of(&self, cell: usize, label: Option<i64>) -> f64 {
        match self {
            Self::OfCells(own) => own.get(cell).copied().unwrap_or(f64::NAN),
            Self::OfLabels(own, other) => label.and_then(|label| own.get(&label)).copied().unwrap_or(*other),
        }
    }
}

/// The parameters that cells have of their own; none if they are alike.
#[derive(Debug, Clone, Default)]
pub(crate) struct OwnParameters {
    /// With what the model has for it, which is not nought where the cells differ.
    given: BTreeMap<CellParameter, (Values, f64)>,
}

/// The values (N) of each parameter in which cells differ, by name.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
#[serde(transparent)]
pub(crate) struct OfCells(pub BTreeMap<&'static str, Vec<f64>>);

impl OfCells {
    /// Whether all cells are alike.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The parameter of `NAME=…`, and what follows.
pub(super) fn named<'a>(option: &str, text: &'a str) -> Result<(CellParameter, &'a str), Failure> {
    text.split_once('=').and_then(|(name, rest)| Some((CellParameter::from_name(name)?, rest))).ok_or_else(
        || {
            Failure::new(format!("{option} {text}: there is no such parameter of a cell"))
                .with_hint(format!("write {KNOWN}, then = and what it is"))
        },
    )
}

pub(super) fn of_model(parameters: &mut Parameters<f64>, parameter: CellParameter) -> &mut f64 {
    match parameter {
        CellParameter::AreaElasticity => &mut parameters.area_elasticity,
        CellParameter::PreferredPerimeter => &mut parameters.preferred_perimeter,
        CellParameter::PreferredArea => &mut parameters.preferred_area,
        CellParameter::Chirality => &mut parameters.chirality,
    }
}

impl CellArguments {
    /// The files that are read.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> + '_ {
        let file = |text: &String| text.split_once('=').map(|(_, file)| PathBuf::from(file));
        self.cell_parameter.iter().filter_map(file)
    }

    /// Reads what is given for so many cells with such labels. The parameters of the model become the means over them.
    pub fn read(
        &self,
        cells: usize,
        labels: Option<&[Option<i64>]>,
        parameters: &mut Parameters<f64>,
    ) -> Result<OwnParameters, Failure> {
        let mut own = OwnParameters::default();
        for text in &self.cell_parameter {
            let (parameter, file) = named("--cell-parameter", text)?;
            let values =
                read_values(file, cells).map_err(|failure| failure.at(format!("--cell-parameter {text}")))?;
            own.add(parameter, Values::OfCells(values), (cells, labels), parameters)?;
        }
        for text in &self.label_parameter {
            let (parameter, list) = named("--label-parameter", text)?;
            let fault = |message: String, hint: &str| {
                Failure::new(format!("--label-parameter {text}: {message}")).with_hint(hint)
            };
            let Some(labels) = labels else {
                return Err(fault(
                    "the cells have no labels".into(),
                    "give data with labels.npy, or --labels FILE",
                ));
            };
            let values = by_label(list).map_err(|message| {
                fault(message, "write LABEL:VALUE, separated by commas, as in alpha=0:0.2,1:1")
            })?;
            if let Some(unknown) = values.keys().find(|label| !labels.contains(&Some(**label))) {
                return Err(fault(format!("no cell has the label {unknown}"), "leave it out"));
            }
            let other = *of_model(parameters, parameter);
            own.add(parameter, Values::OfLabels(values, other), (cells, Some(labels)), parameters)?;
        }
        Ok(own)
    }
}

impl CellArguments {
    /// The same for the cells of a data set, with their labels in one of its frames.
    pub fn of_data(
        &self,
        data: &DataSet,
        frame: usize,
        parameters: &mut Parameters<f64>,
    ) -> Result<OwnParameters, Failure> {
        self.read(data.cells(), data.all_labels(frame).as_deref(), parameters)
    }
}

fn read_values(file: &str, cells: usize) -> Result<Vec<f64>, Failure> {
    let array = voronudge_io::read_reals(Path::new(file))?;
    let hint = "give an array of one finite number for each cell";
    if array.shape() != [cells] {
        let found = format!("the array has the shape {:?}, but there are {cells} cells", array.shape());
        return Err(Failure::new(found).with_hint(hint));
    }
    match array.iter().position(|value| !value.is_finite()) {
        Some(cell) => {
            Err(Failure::new(format!("the value of cell {cell} is {}", array[cell])).with_hint(hint))
        }
        None => Ok(array.iter().copied().collect()),
    }
}

fn by_label(list: &str) -> Result<BTreeMap<i64, f64>, String> {
    let mut values = BTreeMap::new();
    for pair in list.split(',') {
        let parsed = pair.split_once(':').and_then(|(label, value)| {
            let value = value.trim().parse::<f64>().ok().filter(|value| value.is_finite())?;
            Some((label.trim().parse::<i64>().ok()?, value))
        });
        let (label, value) = parsed.ok_or_else(|| format!("{pair:?} is no label with a finite value"))?;
        if values.insert(label, value).is_some() {
            return Err(format!("the label {label} is given twice"));
        }
    }
    Ok(values)
}

impl OwnParameters {
    /// Adds what one parameter is of so many cells with such labels; that of the model becomes the mean over them.
    pub(super) fn add(
        &mut self,
        parameter: CellParameter,
        values: Values,
        (cells, labels): (usize, Option<&[Option<i64>]>),
        parameters: &mut Parameters<f64>,
    ) -> Result<(), Failure> {
        let own: Vec<f64> =
            (0..cells).map(|cell| values.of(cell, labels.and_then(|labels| labels[cell]))).collect();
        let largest =
            own.iter().fold(0.0, |most: f64, value| if value.abs() > most.abs() { *value } else { most });
        let mean = own.iter().sum::<f64>() / cells.max(1) as f64;
        if !mean.is_finite() || largest.abs() > LARGEST_PARAMETER {
            return Err(Failure::new(format!(
                "{} of a cell is {largest:e}, but {LARGEST_PARAMETER:e} is the most in magnitude",
                parameter.name()
            ))
            .with_hint("give it in units in which lengths and times of cells are about 1"));
        }
        let base = if mean.abs() > NO_MEAN * largest.abs() { mean } else { largest };
        *of_model(parameters, parameter) = base;
        match self.given.insert(parameter, (values, base)) {
            None => Ok(()),
            Some(_) => Err(Self::twice(parameter)),
        }
    }

    fn twice(parameter: CellParameter) -> Failure {
        Failure::new(format!("{} of the cells is given twice", parameter.name()))
            .with_hint("give each parameter by one of --cell-parameter, --label-parameter and --cell-spread")
    }

    /// These and others.
    pub fn and(mut self, others: Self) -> Result<Self, Failure> {
        for (parameter, given) in others.given {
            if self.given.insert(parameter, given).is_some() {
                return Err(Self::twice(parameter));
            }
        }
        Ok(self)
    }

    /// Whether all cells are alike.
    pub fn is_empty(&self) -> bool {
        self.given.is_empty()
    }

    /// The environment of some cells, by their numbers, with their labels and with what they have of their own.
    pub fn of_cells(
        &self,
        environment: Environment,
        cells: &[usize],
        labels: Option<Vec<Option<i64>>>,
    ) -> Result<Environment, Failure> {
        let label = |k: usize| labels.as_ref().and_then(|labels: &Vec<Option<i64>>| labels[k]);
        let multiple = |(k, &cell): (usize, &usize), (values, base): &(Values, f64)| match *base {
            0.0 => 1.0,
            base => values.of(cell, label(k)) / base,
        };
        let factors = self.given.iter().try_fold(CellFactors::default(), |factors, (&parameter, given)| {
            factors.with(parameter, cells.iter().enumerate().map(|at| multiple(at, given)).collect())
        });
        let fault = |error: EnvironmentError| {
            Failure::new(error.to_string()).with_hint("check labels and parameters of cells")
        };
        let environment = environment.with_cell_factors(factors.map_err(fault)?).map_err(fault)?;
        match labels {
            Some(labels) => environment.with_labels(labels).map_err(fault),
            None => Ok(environment),
        }
    }

    /// The same of all cells, so many.
    pub fn of_all(
        &self,
        environment: Environment,
        cells: usize,
        labels: Option<Vec<Option<i64>>>,
    ) -> Result<Environment, Failure> {
        self.of_cells(environment, &(0..cells).collect::<Vec<_>>(), labels)
    }

    /// The base model of so many cells.
    pub fn model(
        &self,
        parameters: &Parameters<f64>,
        cells: usize,
        labels: Option<Vec<Option<i64>>>,
    ) -> Result<Model<f64>, Failure> {
        let environment = self.of_all(Environment::default(), cells, labels)?;
        Ok(Model::chiral_voronoi(parameters).within(&Arc::new(environment)))
    }

    /// The values of the cells of a data set, with their labels in one of its frames.
    pub fn of_data(&self, data: &DataSet, frame: usize) -> OfCells {
        self.values(data.cells(), data.all_labels(frame).as_deref())
    }

    /// The values of so many cells with such labels, for reports and files.
    pub fn values(&self, cells: usize, labels: Option<&[Option<i64>]>) -> OfCells {
        let label = |cell: usize| labels.and_then(|labels| labels[cell]);
        let of = |(parameter, (values, _)): (&CellParameter, &(Values, f64))| {
            (parameter.name(), (0..cells).map(|cell| values.of(cell, label(cell))).collect())
        };
        OfCells(self.given.iter().map(of).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_labels(typed: &[&str], parameters: &mut Parameters<f64>) -> Result<OwnParameters, Failure> {
        let label_parameter = typed.iter().map(|text| (*text).to_owned()).collect();
        let labels = [Some(0), Some(1), None, Some(1)];
        CellArguments { cell_parameter: Vec::new(), label_parameter }.read(4, Some(&labels), parameters)
    }

    #[test]
    fn labels_give_values_and_other_cells_keep_those_of_the_model() {
        let mut parameters = Parameters { chirality: 0.5, ..Parameters::default() };
        let own = by_labels(&["alpha=0:-1,1:2"], &mut parameters).unwrap();
        let labels = [Some(0), Some(1), None, Some(1)];
        assert_eq!(own.values(4, Some(&labels)).0["alpha"], [-1.0, 2.0, 0.5, 2.0]);
        assert_eq!(parameters.chirality, 0.875);
        let environment =
            own.of_cells(Environment::default(), &[3, 0], Some(vec![Some(1), Some(0)])).unwrap();
        let factor = |cell| 0.875 * environment.cell_factors().factor(CellParameter::Chirality, cell);
        assert_eq!([factor(0), factor(1)], [2.0, -1.0]);
        // Two kinds of opposite chirality have no mean.
        parameters.chirality = 0.5;
        by_labels(&["alpha=0:-1.5,1:0.5"], &mut parameters).unwrap();
        assert_eq!(parameters.chirality, -1.5);
        for fault in ["alpha=2:1", "alpha=0", "alpha=0:x", "alpha=0:1,0:2", "beta=0:1"] {
            assert!(by_labels(&[fault], &mut parameters).is_err(), "{fault}");
        }
        assert!(
            by_labels(&["alpha=0:1", "alpha=1:2"], &mut parameters)
                .unwrap_err()
                .to_string()
                .contains("twice")
        );
    }
}
