//! Parameters of the model, from flags or a file.

use crate::failure::Failure;
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};
use voronudge_model::Parameters;
use voronudge_report::ModelParameters;

/// Largest parameter whose forces and stresses are finite numbers.
pub(crate) const LARGEST_PARAMETER: f64 = 1e50;

#[derive(Debug, Args)]
#[command(next_help_heading = "Model")]
#[allow(non_snake_case, reason = "the field's symbols are the names of the flags")]
pub(crate) struct ParameterArguments {
    /// Read the parameters from JSON: `{"K_A": …, "K_P": …, "P_0": …, "A_0": …, "alpha": …}`, or a report.json that
    /// holds them. Parameters given as options override the file.
    #[arg(long, value_name = "FILE")]
    parameters: Option<PathBuf>,
    /// Area elasticity, in 1/(length² time) [default: 0.1].
    #[arg(long = "K_A", allow_negative_numbers = true)]
    K_A: Option<f64>,
    /// Perimeter elasticity, in 1/time [default: 1].
    #[arg(long = "K_P", allow_negative_numbers = true)]
    K_P: Option<f64>,
    /// Preferred perimeter, a length [default: 4].
    #[arg(long = "P_0", allow_negative_numbers = true)]
    P_0: Option<f64>,
    /// Preferred area, in length². Velocities do not depend on it if all cells have the same [default: 1].
    #[arg(long = "A_0", allow_negative_numbers = true)]
    A_0: Option<f64>,
    /// Cortical chirality, dimensionless [default: 0].
    #[arg(long = "alpha", allow_negative_numbers = true)]
    alpha: Option<f64>,
}

impl ParameterArguments {
    /// The parameters: defaults, overridden by the file, overridden by flags.
    pub fn resolve(&self) -> Result<Parameters<f64>, Failure> {
        self.resolve_over(Parameters::default())
    }

    /// Whether any is given.
    pub fn is_given(&self) -> bool {
        self.parameters.is_some() || self.flags().iter().any(Option::is_some)
    }

    /// The flags, in the order of [`Parameters::by_name`].
    fn flags(&self) -> [Option<f64>; 5] {
        [self.K_A, self.K_P, self.P_0, self.A_0, self.alpha]
    }

    /// The file that they are read from, if there is one.
    pub fn file(&self) -> Option<&Path> {
        self.parameters.as_deref()
    }

    /// The parameters with other defaults.
    pub fn resolve_over(&self, defaults: Parameters<f64>) -> Result<Parameters<f64>, Failure> {
        let mut parameters = defaults;
        if let Some(file) = &self.parameters {
            parameters = read(file)?;
        }
        for ((name, slot), flag) in parameters.by_name().into_iter().zip(self.flags()) {
            if let Some(value) = flag {
                if !value.is_finite() {
                    return Err(Failure::new(format!("--{name} is {value}, but it must be finite"))
                        .with_hint("leave it out for the default"));
                }
                *slot = value;
            }
            if slot.abs() > LARGEST_PARAMETER {
                return Err(Failure::new(format!(
                    "{name} is {slot:e}, but {LARGEST_PARAMETER:e} is the most in magnitude"
                ))
                .with_hint("give it in units in which lengths and times of cells are about 1"));
            }
        }
        Ok(parameters)
    }
}

/// The parameters as reports have them.
pub(crate) fn named(p: &Parameters<f64>) -> ModelParameters {
    ModelParameters {
        K_A: p.area_elasticity,
        K_P: p.perimeter_elasticity,
        P_0: p.preferred_perimeter,
        A_0: p.preferred_area,
        alpha: p.chirality,
    }
}

fn read(file: &Path) -> Result<Parameters<f64>, Failure> {
    const HINT: &str =
        r#"write {"K_A": 0.1, "K_P": 1, "P_0": 4, "A_0": 1, "alpha": 0}, or give a report.json of infer"#;
    let fault = |text: String| Failure::new(format!("{}: {text}", file.display())).with_hint(HINT);
    let text = std::fs::read_to_string(file).map_err(|error| fault(error.to_string()))?;
    let json: Value = serde_json::from_str(&text).map_err(|error| fault(format!("not JSON: {error}")))?;
    // A report carries the same names one level down, each as an object with its value.
    let table = json.get("parameters").unwrap_or(&json);
    let table = table.as_object().ok_or_else(|| fault("not a table of parameters".into()))?;
    let mut parameters = Parameters::default();
    let mut found = 0;
    for (name, slot) in parameters.by_name() {
        let Some(entry) = table.get(name) else { continue };
        let value = entry.get("value").unwrap_or(entry).as_f64().filter(|value| value.is_finite());
        *slot = value.ok_or_else(|| fault(format!("{name} is not a finite number")))?;
        found += 1;
    }
    if found == 0 {
        return Err(fault("none of K_A, K_P, P_0, A_0, alpha is there".into()));
    }
    Ok(parameters)
}
