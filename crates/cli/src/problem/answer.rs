//! What a fit answers, in the units of the data.

use super::Problem;
use voronudge_geometry::Vector;
use voronudge_infer::{Estimate, FitParameter, Inference, ParameterEstimates, Velocities};
use voronudge_model::Parameters;

/// No vector.
const NOWHERE: Vector<f64> = Vector::new(f64::NAN, f64::NAN);

impl Problem {
    /// A parameter in the units of the data. What was given keeps its last digit.
    pub fn estimate(&self, result: &Inference, quantity: FitParameter) -> Estimate {
        self.in_units(&result.parameters, quantity)
    }

    /// The same of parameters of some of the cells.
    pub fn in_units(&self, estimates: &ParameterEstimates, quantity: FitParameter) -> Estimate {
        let fitted = estimates.get(quantity).in_unit(self.scale.factor(quantity));
        let given = self.constraints.fixed.get(&quantity).filter(|_| fitted.standard_error == 0.0);
        Estimate { value: given.copied().unwrap_or(fitted.value), ..fitted }
    }

    /// The parameters in the units of the data, as a model takes them. `A_0`, which no velocity depends on, is `ℓ₀²`.
    pub fn parameters(&self, result: &Inference) -> Parameters<f64> {
        let value = |quantity| self.estimate(result, quantity).value;
        Parameters {
            area_elasticity: value(FitParameter::AreaElasticity),
            perimeter_elasticity: value(FitParameter::PerimeterElasticity),
            preferred_perimeter: value(FitParameter::PreferredPerimeter),
            preferred_area: self.scale.length * self.scale.length,
            chirality: value(FitParameter::Chirality),
        }
    }

    /// Nudged positions (N) of one frame.
    pub fn nudged_positions(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let nudged = result.frames[index].nudged_positions.iter();
        self.of_detections(index, nudged.map(|r| r * self.scale.length).collect())
    }

    /// Predicted velocities (N) of the cells of one frame.
    pub fn predicted(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let predicted = result.frames[index].predicted.iter();
        self.of_detections(index, predicted.map(|v| v * self.scale.velocity()).collect())
    }

    /// Polarities (N) of the cells of one frame; NaN where there is none.
    pub fn polarities(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let own = result.frames[index].polarities.iter();
        let velocity = |p: &Option<Vector<f64>>| p.map_or(NOWHERE, |p| p * self.scale.velocity());
        self.of_detections(index, own.map(velocity).collect())
    }

    /// The data of one frame as the model predicts them, of cells (N) or on the grid; NaN out of its reach.
    pub fn predicted_data(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let observation = &self.observations[index];
        let predicted = result.frames[index].predicted_data.iter().enumerate();
        predicted
            .map(
                |(datum, v)| if observation.is_in_reach(datum) { v * self.scale.velocity() } else { NOWHERE },
            )
            .collect()
    }

    /// Measured minus predicted data of one frame; NaN where there is no measurement to be explained.
    pub fn residual_data(&self, result: &Inference, index: usize) -> Vec<Vector<f64>> {
        let (observation, predicted) = (&self.observations[index], &result.frames[index].predicted_data);
        let mut rests: Vec<Vector<f64>> =
            observation.targets().map(|(datum, v)| (v - predicted[datum]) * self.scale.velocity()).collect();
        observation.remove_background(&mut rests);
        let mut field = vec![NOWHERE; predicted.len()];
        for ((datum, _), rest) in observation.targets().zip(rests) {
            field[datum] = rest;
        }
        match observation.velocities {
            Velocities::OfCells(_) => self.of_detections(index, field),
            Velocities::OnGrid(_) => field,
        }
    }
}
