//! The scaling of ⟨v²⟩ about the transition.

use super::diagram::Diagram;
use super::request::Quantity;
use crate::failure::Failure;
use clap::Args;
use voronudge_report::figure::{CollapseRow, collapse};
use voronudge_report::numbers::{as_given, significant};
use voronudge_report::page::Figure;
use voronudge_report::phase_report::{CollapseRecord, ExponentRecord, FittedExponents, GivenExponents};
use voronudge_simulate::collapse::{
    AMPLITUDE_EXPONENT, Exponents, Interval, VelocityPoint, collapse_scatter, fit_collapse, scaled_velocities,
};

/// Bootstrap samples behind the intervals of exponents.
const SAMPLES: usize = 200;

#[derive(Debug, Args)]
#[command(next_help_heading = "Scaling of ⟨v²⟩")]
pub(crate) struct ScalingArguments {
    /// Exponents β and φ with which ⟨v²⟩ is collapsed, in addition to the fitted ones.
    #[arg(long, num_args = 2, value_names = ["BETA", "PHI"], default_values_t = [Exponents::PAPER.beta, Exponents::PAPER.phi], allow_negative_numbers = true)]
    exponents: Vec<f64>,
    /// Range of |α| in which the collapse is tested.
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"], default_values_t = [0.04, 0.2], allow_negative_numbers = true)]
    collapse_alpha: Vec<f64>,
    /// Smallest ⟨v²⟩ for a point to count as moving, in (K_P ℓ_0)².
    #[arg(long, value_name = "V2", default_value_t = 1e-3, allow_negative_numbers = true)]
    least_velocity: f64,
}

/// What is asked of the scaling.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scaling {
    exponents: Exponents,
    alpha: [f64; 2],
    least_velocity: f64,
}

impl ScalingArguments {
    pub fn resolve(&self) -> Result<Scaling, Failure> {
        let (&[beta, phi], &[low, high]) = (self.exponents.as_slice(), self.collapse_alpha.as_slice()) else {
            return Err(Failure::new("--exponents and --collapse-alpha need two numbers each")
                .with_hint("leave them out for those of the paper"));
        };
        if !(beta.is_finite() && phi.is_finite() && phi > 0.0) {
            return Err(Failure::new(format!(
                "--exponents {beta} {phi}: both must be finite, and φ positive"
            ))
            .with_hint("the paper has 3 4"));
        }
        if !(low >= 0.0 && high > low && high.is_finite()) {
            return Err(Failure::new(format!("--collapse-alpha {low} {high} is no range of |α|"))
                .with_hint("the paper's scaling is for |α| above 0.04 and its P_0* for |α| up to 0.2"));
        }
        if !(self.least_velocity.is_finite() && self.least_velocity > 0.0) {
            return Err(Failure::new(format!(
                "--least-velocity is {}, but it must be positive",
                self.least_velocity
            ))
            .with_hint("leave it out for 0.001"));
        }
        Ok(Scaling {
            exponents: Exponents { beta, phi },
            alpha: [low, high],
            least_velocity: self.least_velocity,
        })
    }
}

/// The collapse as the report has it, with figures; or why there is none.
pub(super) struct Collapse {
    pub record: Result<CollapseRecord, String>,
    pub figures: Vec<Figure>,
}

impl Collapse {
    pub fn new(diagram: &Diagram, scaling: &Scaling, seed: u64) -> Self {
        let none = |text: String| Self { record: Err(text), figures: Vec::new() };
        let Some(field) = diagram.fields.get(&Quantity::MeanSquareVelocity) else {
            return none("⟨v²⟩ was not asked for.".into());
        };
        let [low, high] = scaling.alpha;
        let (mut points, mut at_rest) = (Vec::new(), 0);
        for ((row, column), &mean_square_velocity) in field.mean.indexed_iter() {
            let chirality = diagram.chiralities[row];
            let size = chirality.abs();
            if size < low * (1.0 - 1e-9) || size > high * (1.0 + 1e-9) || mean_square_velocity.is_nan() {
                continue;
            }
            if mean_square_velocity < scaling.least_velocity {
                at_rest += 1;
                continue;
            }
            let preferred_perimeter = diagram.preferred_perimeters[column];
            points.push(VelocityPoint { preferred_perimeter, chirality, mean_square_velocity });
        }
        let fit = match fit_collapse(&points, scaling.exponents, SAMPLES, seed) {
            Ok(fit) => fit,
            Err(error) => {
                return none(format!(
                    "The scaling of ⟨v²⟩ could not be tried for |α| from {low} to {high}: {error}. A diagram for it is, for example, \
                     --P_0 3.5 4.1 13 --alpha 0.04 0.2 9."
                ));
            }
        };
        let record =
            |interval: Interval| ExponentRecord { value: interval.value, interval: interval.interval };
        let fitted = Exponents { beta: fit.beta.value, phi: fit.phi.value };
        let Exponents { beta, phi } = scaling.exponents;
        Self {
            figures: vec![
                figure(&points, scaling.exponents, "given exponents"),
                figure(&points, fitted, "fitted exponents"),
            ],
            record: Ok(CollapseRecord {
                alpha: scaling.alpha,
                least_velocity: scaling.least_velocity,
                points: points.len(),
                at_rest,
                amplitude_exponent: AMPLITUDE_EXPONENT,
                given: GivenExponents {
                    beta,
                    phi,
                    scatter: collapse_scatter(&points, scaling.exponents).ok(),
                },
                fitted: FittedExponents {
                    beta: record(fit.beta),
                    phi: record(fit.phi),
                    scatter: fit.scatter,
                    samples: SAMPLES,
                },
            }),
        }
    }
}

fn figure(points: &[VelocityPoint], exponents: Exponents, what: &str) -> Figure {
    let mut alphas: Vec<f64> = points.iter().map(|point| point.chirality).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    let scaled = scaled_velocities(points, exponents);
    let side = |alpha: f64, sign: f64| {
        let own = points.iter().zip(&scaled).filter(|(point, _)| point.chirality == alpha);
        own.filter(|(_, scaled)| scaled.distance * sign > 0.0).map(|(_, s)| [s.argument, s.value]).collect()
    };
    let rows: Vec<CollapseRow> = alphas
        .iter()
        .map(|&alpha| CollapseRow {
            label: format!("α = {}", as_given(alpha)),
            liquid: side(alpha, 1.0),
            solid: side(alpha, -1.0),
        })
        .collect();
    let [beta, phi] = [exponents.beta, exponents.phi].map(|exponent| significant(exponent, 2));
    let labels = ["|α| / |ΔP|^φ", "⟨v²⟩ / (|α|^0.4 |ΔP|^β)"];
    let svg = collapse(&format!("collapse with {what}"), labels, &rows);
    Figure::new(
        svg,
        &format!("⟨v²⟩ on scaled axes with {what}, β = {beta} and φ = {phi}. ΔP = P_0 − 3.81 + |α|."),
    )
}
