//! The steady state of the continuum theory, with the moduli of the honeycomb and with a measured equation of state.

use super::request::ChannelRequest;
use crate::command::spectrum::mean_field;
use crate::failure::Failure;
use voronudge_model::Parameters;
use voronudge_report::channel_report::{ContinuumRecord, LiquidRecord};
use voronudge_simulate::Proliferation;
use voronudge_simulate::measure::{ChannelProfile, Estimate};
use voronudge_theory::{ChannelEvolution, ChannelMedium, ChannelTurnover, EquationOfState};

/// Distances and `ρ`, distances and velocities, in the units of the request.
pub(super) struct Flow {
    pub density: Vec<[f64; 2]>,
    pub velocity: [Vec<[f64; 2]>; 2],
}

/// With the moduli of the honeycomb.
pub(super) struct Continuum {
    pub record: ContinuumRecord,
    pub flow: Flow,
}

/// With an equation of state.
pub(super) struct Liquid {
    pub record: LiquidRecord,
    pub flow: Flow,
    /// What the simulated density implies: distances and transport along the channel from there to the middle.
    pub transport: Vec<[f64; 2]>,
}

/// What both have in common: lengths in ℓ₀ and times in 1/K_P.
pub(super) struct Theory<'a> {
    request: &'a ChannelRequest,
    folded: &'a ChannelProfile,
    turnover: ChannelTurnover,
    /// Grid cells.
    cells: usize,
}

/// Grid cells for the shorter of both decay lengths, and how many there are at most.
const RESOLUTION: f64 = 4.0;
const FINEST: usize = 400;

impl<'a> Theory<'a> {
    /// None where births do not replace extrusions.
    pub fn of(request: &'a ChannelRequest, folded: &'a ChannelProfile) -> Option<Self> {
        let Proliferation::Replacing { decay_length } = request.turnover.proliferation else {
            return None;
        };
        let (size, extrusion) = (request.cell_size, request.turnover.extrusion);
        let width = request.cell_box.lengths()[0] / size;
        let turnover = ChannelTurnover {
            width,
            extrusion_rate: extrusion.rate / request.parameters.perimeter_elasticity,
            // Far longer than the channel is the same everywhere.
            extrusion_length: (extrusion.decay_length / size).min(1e6 * width),
            proliferation_length: (decay_length / size).min(1e6 * width),
        };
        let shortest = turnover.extrusion_length.min(turnover.proliferation_length);
        let cells = ((RESOLUTION * 0.5 * width / shortest).ceil() as usize).clamp(40, FINEST);
        Some(Self { request, folded, turnover, cells })
    }

    /// None where a honeycomb does not resist compression.
    pub fn mean_field(&self) -> Option<Continuum> {
        let (size, p) = (self.request.cell_size, &self.request.parameters);
        let rate = p.perimeter_elasticity;
        let in_units_of_it =
            Parameters { area_elasticity: p.area_elasticity / rate, perimeter_elasticity: 1.0, ..*p };
        let medium = ChannelMedium::mean_field(&mean_field(&in_units_of_it, size)?).ok()?;
        let mut evolution = ChannelEvolution::new(medium, self.turnover, self.cells).ok()?;
        let flow = self.settled(&mut evolution, medium.longitudinal);
        let record = ContinuumRecord {
            longitudinal: medium.longitudinal * size * size * rate,
            transverse: medium.transverse * size * size * rate,
            ratio: medium.transverse / medium.longitudinal,
            velocity_x_difference: self.difference(&flow, 0),
            velocity_y_difference: self.difference(&flow, 1),
        };
        Some(Continuum { record, flow })
    }

    /// The flow of a liquid; numbers in the record begin at the distance `from`.
    ///
    /// # Errors
    /// Where the pressure does not rise with the density.
    pub fn liquid(&self, equation: &EquationOfState, from: f64) -> Result<Liquid, Failure> {
        let fault = |error: voronudge_theory::Error| {
            Failure::new(format!("--equation-of-state: {error}")).with_hint(
                "measure it with more replicas, or over a longer --time, so that its slope is known",
            )
        };
        let [softest, _] = equation.stiffness();
        let mut evolution =
            ChannelEvolution::of_liquid(equation.clone(), self.turnover, self.cells).map_err(fault)?;
        let flow = self.settled(&mut evolution, softest);
        let (size, folded) = (self.request.cell_size, self.folded);
        let relative = size * size;
        let simulated: Vec<[f64; 2]> = (folded.centres.iter().zip(&folded.density))
            .map(|(distance, at)| [*distance, at.value * relative])
            .collect();
        let rate = self.request.parameters.perimeter_elasticity;
        let middle = 0.5 * self.turnover.width * size;
        let torque = |distance: f64| 0.5 * rate * equation.torque(interpolated(&simulated, distance));
        let transport: Vec<[f64; 2]> =
            folded.faces.iter().map(|distance| [*distance, torque(*distance) - torque(middle)]).collect();
        let [low, high] = equation.range();
        let beyond = simulated.iter().filter(|[_, density]| !(low..=high).contains(density)).count();
        let at = transport.iter().find(|[distance, _]| *distance >= from);
        let record = LiquidRecord {
            density_range: equation.range().map(|own| own / relative),
            places_beyond: beyond,
            density_difference: self.difference_of(
                &folded.density,
                &flow.density,
                largest(flow.density.iter().map(|at| at[1] - 1.0 / relative)),
            ),
            velocity_x_difference: self.difference(&flow, 0),
            velocity_y_difference: self.difference(&flow, 1),
            transport: at.map_or(f64::NAN, |[_, value]| *value),
        };
        Ok(Liquid { record, flow, transport })
    }

    fn settled(&self, evolution: &mut ChannelEvolution, stiffness: f64) -> Flow {
        let (size, width) = (self.request.cell_size, self.turnover.width);
        evolution.settle(1e-4 * self.turnover.extrusion_rate, 20.0 * width * width / stiffness);
        let speed = size * self.request.parameters.perimeter_elasticity;
        let faces = evolution.faces();
        let velocity = evolution
            .velocities()
            .map(|v| faces.iter().zip(v).map(|(d, v)| [d * size, v * speed]).collect::<Vec<_>>());
        let centres = evolution.centres();
        let density = centres.iter().zip(evolution.density());
        Flow { density: density.map(|(d, rho)| [d * size, rho / (size * size)]).collect(), velocity }
    }

    /// Root mean square difference of a velocity: of v_x in units of the largest in the theory, of v_y of that simulated.
    fn difference(&self, flow: &Flow, axis: usize) -> f64 {
        let simulated = &self.folded.velocity[axis];
        let unit = match axis {
            0 => largest(flow.velocity[0].iter().map(|at| at[1])),
            _ => largest(simulated.iter().map(|at| at.value)),
        };
        self.difference_of(simulated, &flow.velocity[axis], unit)
    }

    fn difference_of(&self, simulated: &[Estimate], theory: &[[f64; 2]], unit: f64) -> f64 {
        let off = self.folded.centres.iter().zip(simulated);
        let squares: Vec<f64> =
            off.map(|(d, at)| ((at.value - interpolated(theory, *d)) / unit).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// Between points of a curve with ascending places, on a line.
fn interpolated(curve: &[[f64; 2]], x: f64) -> f64 {
    let after = curve.partition_point(|at| at[0] < x).clamp(1, curve.len() - 1);
    let ([x0, y0], [x1, y1]) = (curve[after - 1], curve[after]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}
