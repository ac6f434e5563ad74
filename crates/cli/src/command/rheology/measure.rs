//! Tissues simulated at the fitted parameters, and from where they came to at parameters moved by one standard error.

use super::posterior::{Posterior, Scaled};
use crate::command::moduli::measure::{Measured, one};
use crate::command::moduli::names::{NAMES, VISCOSITY_NAMES};
use crate::command::moduli::protocol::{Protocol, ProtocolArguments};
use crate::command::simulate::Start;
use crate::failure::Failure;
use crate::progress::Progress;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::sync::Mutex;
use voronudge_geometry::Vector;
use voronudge_infer::NORMAL_95;
use voronudge_model::Model;
use voronudge_report::rheology_report::{FittedRheology, RheologyFrequency, RheologyQuantity};
use voronudge_simulate::moduli::{Dynamic, DynamicModulus, Motion};
use voronudge_theory::{MeanField, Moduli};

/// What is told of a tissue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Told {
    /// Of B, A, μ, Kᵒ.
    Modulus(usize),
    /// Of η, ηᵒ.
    Viscosity(usize),
    /// Frequency, which of B, A, μ, Kᵒ, and whether it is the loss modulus.
    Dynamic(usize, usize, bool),
}

impl Told {
    /// The number in a tissue, in units of the data; none where that tissue has none.
    fn of(self, measured: &Measured, rate: f64) -> Option<f64> {
        match self {
            Self::Modulus(k) => Some(rate * measured.elastic.moduli.to_array()[k]),
            Self::Viscosity(k) => measured.viscosity.map(|own| [own.shear, own.odd_shear][k]),
            Self::Dynamic(frequency, k, loss) => {
                let part = |own: DynamicModulus| if loss { own.loss } else { own.storage };
                measured
                    .dynamic
                    .get(frequency)
                    .and_then(|own: &Dynamic| own.moduli[k])
                    .map(|own| rate * part(own))
            }
        }
    }

    fn named(self) -> (String, String) {
        match self {
            Self::Modulus(k) => (NAMES[k].0.into(), NAMES[k].1.into()),
            Self::Viscosity(k) => (VISCOSITY_NAMES[k].0.into(), VISCOSITY_NAMES[k].1.into()),
            Self::Dynamic(_, k, false) => (format!("{}_storage", NAMES[k].0), format!("{}′", NAMES[k].1)),
            Self::Dynamic(_, k, true) => (format!("{}_loss", NAMES[k].0), format!("{}″", NAMES[k].1)),
        }
    }
}

/// A fit and the tissues simulated for it.
pub(super) struct Work<'a> {
    pub starts: &'a [Start],
    pub arguments: &'a ProtocolArguments,
    pub progress: &'a Mutex<Progress>,
}

impl Work<'_> {
    /// All tissues at some parameters, from some positions.
    fn tissues(
        &self,
        from: &[&[Vector<f64>]],
        scaled: &Scaled,
        stage: &str,
    ) -> Result<Vec<Measured>, Failure> {
        let arguments = ProtocolArguments {
            frequencies: self.arguments.frequencies.iter().map(|own| own / scaled.rate).collect(),
            ..self.arguments.clone()
        };
        let protocol = Protocol::new(&arguments, &scaled.parameters, 1.0)?;
        let model = Model::chiral_voronoi(&scaled.parameters);
        let own = |(k, (positions, start)): (usize, (&&[Vector<f64>], &Start))| {
            let stage = format!("{stage}, tissue {} of {}", k + 1, self.starts.len());
            one((positions, start.cell_box), &model, &protocol, &stage, self.progress)
        };
        from.iter().zip(self.starts).enumerate().map(own).collect()
    }

    /// Everything that a fit implies.
    pub fn fitted(&self, fit: &Posterior, at: f64, name: &str) -> Result<FittedRheology, Failure> {
        let estimate = fit.estimate()?;
        let starts: Vec<&[Vector<f64>]> =
            self.starts.iter().map(|start| start.positions.as_slice()).collect();
        let centre = self.tissues(&starts, &estimate, &format!("{name}, at the estimate"))?;
        // A solid keeps its state, which differs more from one to another than moduli do with parameters.
        let settled: Vec<&[Vector<f64>]> = centre.iter().map(|own| own.positions.as_slice()).collect();
        let mut sides = Vec::new();
        for axis in 0..fit.axes() {
            let mut both = Vec::new();
            for (side, word) in [(1.0, "above"), (-1.0, "below")] {
                let scaled = fit.moved(axis, side)?;
                let stage = format!("{name}, axis {} of {} {word}", axis + 1, fit.axes());
                both.push((self.tissues(&settled, &scaled, &stage)?, scaled.rate));
            }
            sides.push(both);
        }
        let theory = MeanField::new(voronudge_theory::Parameters {
            area_elasticity: estimate.parameters.area_elasticity,
            perimeter_elasticity: 1.0,
            preferred_perimeter: estimate.parameters.preferred_perimeter,
            chirality: estimate.parameters.chirality,
        });
        let theory = theory.ok().map(|theory| {
            let Moduli { bulk, odd_bulk, shear, odd_shear } = theory.moduli();
            [bulk, odd_bulk, shear, odd_shear].map(|own| own * estimate.rate)
        });
        let quantity = |told: Told| -> Option<RheologyQuantity> {
            let values = of_all(told, &centre, estimate.rate)?;
            let (value, scatter) = mean_and_deviation(&values);
            let count = values.len() as f64;
            let simulation_error = scatter / count.sqrt();
            let mut variance = 0.0;
            for both in &sides {
                let [above, below] = [0, 1].map(|side: usize| of_all(told, &both[side].0, both[side].1));
                let halves: Vec<f64> = above?.iter().zip(below?).map(|(a, b)| 0.5 * (a - b)).collect();
                let (half, spread) = mean_and_deviation(&halves);
                // And what so few tissues do not tell of it.
                variance += half * half + spread * spread / count;
            }
            let inference_error = variance.sqrt();
            let student =
                StudentsT::new(0.0, 1.0, count - 1.0).map_or(NORMAL_95, |law| law.inverse_cdf(0.975));
            let reach = (NORMAL_95 * inference_error).hypot(student * simulation_error);
            let (name, symbol) = told.named();
            let mean_field = match told {
                Told::Modulus(k) => theory.map(|theory| theory[k]),
                _ => None,
            };
            Some(RheologyQuantity {
                name,
                symbol,
                value,
                ci95: [value - reach, value + reach],
                inference_error,
                simulation_error,
                scatter,
                mean_field,
            })
        };
        let moduli = (0..4).map(Told::Modulus).chain((0..2).map(Told::Viscosity));
        let dynamic = self.arguments.frequencies.iter().enumerate().map(|(frequency, &own)| {
            let all = [2, 3, 0, 1].into_iter();
            let all = all.flat_map(|k| [false, true].map(|loss| Told::Dynamic(frequency, k, loss)));
            RheologyFrequency { frequency: own, moduli: all.filter_map(quantity).collect() }
        });
        let at_rest = centre.iter().filter(|own| own.elastic.motion == Motion::AtRest).count();
        Ok(FittedRheology {
            path: fit.path.display().to_string(),
            at,
            parameters: fit.parameters(),
            length_scale: fit.length,
            at_rest,
            flowing: centre.len() - at_rest,
            axes: fit.axes(),
            moduli: moduli.filter_map(quantity).collect(),
            dynamic: dynamic.collect(),
        })
    }
}

/// The number in all tissues; none if one has none.
fn of_all(told: Told, tissues: &[Measured], rate: f64) -> Option<Vec<f64>> {
    tissues.iter().map(|own| told.of(own, rate)).collect()
}

/// Mean and standard deviation of two values or more.
fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    (mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt())
}
