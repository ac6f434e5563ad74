//! A fit as `infer` reported it: parameters, and how far they may be off.

use crate::failure::Failure;
use serde_json::Value;
use std::path::{Path, PathBuf};
use voronudge_infer::COEFFICIENT_SIZES;
use voronudge_io::{InputFile, read_text};
use voronudge_model::Parameters;
use voronudge_report::Units;

/// Axes that make less than this share of the variance of all coefficients move no modulus by more than other errors.
const NEGLIGIBLE: f64 = 1e-4;

/// A fit, with lengths in units of the cell size ℓ₀.
pub(super) struct Posterior {
    pub path: PathBuf,
    pub input: InputFile,
    pub units: Units,
    /// ℓ₀ in units of the data.
    pub length: f64,
    /// The mean of the frames fitted.
    pub frame: f64,
    /// The label whose parameters these are, if cells of each label have their own.
    pub label: Option<i64>,
    /// What the fit says of how the cells were measured, if that may have made its parameters.
    pub misfit: Option<String>,
    /// (K_A ℓ₀², K_P P_0/ℓ₀, K_P, K_P α), rates in units of the data.
    coefficients: [f64; 4],
    /// By how much one standard error along each principal axis moves them.
    axes: Vec<[f64; 4]>,
}

/// Parameters of cells of unit area with K_P = 1, and K_P itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scaled {
    pub parameters: Parameters<f64>,
    /// K_P, in 1/time of the data.
    pub rate: f64,
}

impl Posterior {
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file = if path.is_dir() { path.join("report.json") } else { path.to_owned() };
        let (text, input) = read_text(&file)?;
        let fault = |text: &str| {
            Failure::new(text.to_owned())
                .at(file.display())
                .with_hint("give report.json of `voronudge infer`, or the folder that holds it")
        };
        let json: Value =
            serde_json::from_str(&text).map_err(|error| fault(&format!("not JSON: {error}")))?;
        if json["command"] != "infer" {
            return Err(fault("this is no report of infer"));
        }
        let said = |kind: &str| {
            let sentence = json.pointer("/verdict/sentence").and_then(Value::as_str).unwrap_or_default();
            (json.pointer("/verdict/kind").and_then(Value::as_str) == Some(kind)).then(|| sentence.to_owned())
        };
        if let Some(sentence) = said("explains_nothing") {
            return Err(fault(&format!(
                "moduli of a fit that explains nothing would be those of no tissue. {sentence}"
            ))
            .with_hint("see what the page of the fit says is in its way; leave this report out of several"));
        }
        let number = |pointer: &str| {
            let found = json.pointer(pointer).and_then(Value::as_f64).filter(|x| x.is_finite());
            found.ok_or_else(|| fault(&format!("{pointer} is not a finite number")))
        };
        let text_at = |pointer: &str| {
            let found = json.pointer(pointer).and_then(Value::as_str);
            found.map(str::to_owned).ok_or_else(|| fault(&format!("{pointer} is not text")))
        };
        let (length, time) = (number("/length_scale/value")?, number("/time_scale/value")?);
        let value = |name: &str| number(&format!("/parameters/{name}/value"));
        let k_p = value("K_P")?;
        let coefficients =
            [value("K_A")? * length * length, k_p * value("P_0")? / length, k_p, value("K_P_alpha")?];
        if !(length > 0.0 && time > 0.0) {
            return Err(fault("its scales of length and time are not positive"));
        }
        let directions =
            json["identifiability"].as_array().ok_or_else(|| fault("identifiability is no list"))?;
        let mut axes = Vec::new();
        for (k, own) in directions.iter().enumerate() {
            let eigenvalue = number(&format!("/identifiability/{k}/eigenvalue"))?;
            if eigenvalue <= 0.0 {
                return Err(fault("a combination of the parameters is not bounded by the data")
                    .with_hint("hold a parameter that the data do not tell, as in --fix K_A=0"));
            }
            let components = ["K_A", "K_P_P_0", "K_P", "K_P_alpha"];
            let components = components.map(|name| own["direction"][name].as_f64().unwrap_or(0.0));
            let step = 1.0 / (eigenvalue.sqrt() * time);
            axes.push(std::array::from_fn(|k| step * COEFFICIENT_SIZES[k] * components[k]));
        }
        let size = |axis: &[f64; 4]| axis.iter().map(|x| x * x).sum::<f64>();
        let all: f64 = axes.iter().map(size).sum();
        axes.retain(|axis| size(axis) > NEGLIGIBLE * all);
        let frames = json.pointer("/cells/frames").and_then(Value::as_array).cloned().unwrap_or_default();
        let frames: Vec<f64> = frames.iter().filter_map(Value::as_f64).collect();
        let own = Self {
            path: path.to_owned(),
            input,
            misfit: said("measurement_misfit"),
            units: Units { length: text_at("/units/length")?, time: text_at("/units/time")? },
            length,
            frame: frames.iter().sum::<f64>() / frames.len().max(1) as f64,
            label: json.pointer("/by_label/0/label").and_then(Value::as_i64),
            coefficients,
            axes,
        };
        // Whether all of its tissues can be is known before the first of them is simulated.
        own.estimate()?;
        for axis in 0..own.axes() {
            own.moved(axis, 1.0)?;
            own.moved(axis, -1.0)?;
        }
        Ok(own)
    }

    /// How many axes are worth moving along.
    pub fn axes(&self) -> usize {
        self.axes.len()
    }

    /// At the estimate.
    pub fn estimate(&self) -> Result<Scaled, Failure> {
        self.at(self.coefficients)
    }

    /// One standard error along an axis, to either side.
    pub fn moved(&self, axis: usize, side: f64) -> Result<Scaled, Failure> {
        let own = &self.axes[axis];
        self.at(std::array::from_fn(|k| self.coefficients[k] + side * own[k]))
    }

    fn at(&self, [k_a, k_p_p_0, k_p, k_p_alpha]: [f64; 4]) -> Result<Scaled, Failure> {
        if k_p <= 0.0 {
            return Err(Failure::new(format!(
                "K_P is {k_p:.3e} within one standard error, but a tissue needs a positive one"
            ))
            .at(self.path.display())
            .with_hint("fit more frames, or several movies; see the interval of K_P in the report"));
        }
        let parameters = Parameters {
            area_elasticity: k_a / k_p,
            perimeter_elasticity: 1.0,
            preferred_perimeter: k_p_p_0 / k_p,
            preferred_area: 1.0,
            chirality: k_p_alpha / k_p,
        };
        Ok(Scaled { parameters, rate: k_p })
    }

    /// Parameters in units of the data.
    pub fn parameters(&self) -> std::collections::BTreeMap<&'static str, f64> {
        let [k_a, k_p_p_0, k_p, k_p_alpha] = self.coefficients;
        std::collections::BTreeMap::from([
            ("K_A", k_a / (self.length * self.length)),
            ("K_P", k_p),
            ("P_0", k_p_p_0 / k_p * self.length),
            ("alpha", k_p_alpha / k_p),
        ])
    }
}
