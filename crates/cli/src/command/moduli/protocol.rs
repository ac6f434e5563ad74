//! How moduli are measured: as typed, and in numbers.

use crate::failure::Failure;
use clap::Args;
use std::f64::consts::TAU;
use voronudge_model::Parameters;
use voronudge_report::numbers::significant;
use voronudge_simulate::moduli::{
    DynamicProtocol, FEWEST_PERIODS, Flowing, Relaxation, Settings, ViscosityProtocol,
};
use voronudge_simulate::{Schedule, recommended_time_step};

#[derive(Debug, Clone, Args)]
pub(crate) struct ProtocolArguments {
    /// Longest time that the tissue is given to come to rest.
    #[arg(long, default_value_t = 300.0, allow_negative_numbers = true)]
    pub time: f64,
    /// Time step [default: 0.01 / max(K_P, K_P |α|, K_A ℓ₀²)].
    #[arg(long, allow_negative_numbers = true)]
    pub dt: Option<f64>,
    /// Larger strain of a tissue at rest; the smaller one is half of it.
    #[arg(long, default_value_t = 1e-5, allow_negative_numbers = true)]
    pub strain: f64,
    /// Larger strain of a tissue that flows; the smaller one is half of it.
    #[arg(long, value_name = "STRAIN", default_value_t = 0.1, allow_negative_numbers = true)]
    pub flowing_strain: f64,
    /// For a tissue that flows: time after a strain before averaging of the stress begins.
    #[arg(long, value_name = "TIME", default_value_t = 20.0, allow_negative_numbers = true)]
    pub transient: f64,
    /// For a tissue that flows: time over which the stress is averaged.
    #[arg(long, value_name = "TIME", default_value_t = 100.0, allow_negative_numbers = true)]
    pub average: f64,
    /// Also measure viscosities, by shear back and forth; see --rate, --period and --periods.
    #[arg(long)]
    pub viscosity: bool,
    /// With --viscosity: rate of the shear, in 1/time.
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    pub rate: f64,
    /// With --viscosity: period of the shear.
    #[arg(long, default_value_t = 200.0, allow_negative_numbers = true)]
    pub period: f64,
    /// With --viscosity: number of periods to average over, after a first one that is discarded.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true)]
    pub periods: usize,
    /// Also measure storage and loss moduli at these angular frequencies, in 1/time. A tissue that flows is sheared
    /// with the amplitude --flowing-strain for at least --average.
    #[arg(long, value_name = "OMEGA", num_args = 1.., allow_negative_numbers = true)]
    pub frequencies: Vec<f64>,
}

impl ProtocolArguments {
    /// Refuses times that are none.
    pub fn check(&self) -> Result<(), Failure> {
        for (name, value, least) in [
            ("--time", self.time, 0.0),
            ("--transient", self.transient, 0.0),
            ("--average", self.average, f64::MIN_POSITIVE),
        ] {
            if !(value.is_finite() && value >= least) {
                return Err(Failure::new(format!("{name} is {value}, but it must be a time"))
                    .with_hint(format!("leave {name} out for the default")));
            }
        }
        Ok(())
    }
}

/// Speeds in units of K_P ℓ₀ below which a tissue is at rest, and below which implicit steps are tried.
const AT_REST: f64 = 1e-10;
const SLOW: f64 = 1e-2;

/// How moduli are measured, in numbers.
pub(crate) struct Protocol {
    pub settings: Settings,
    pub viscosity: Option<ViscosityProtocol>,
    pub dynamic: Option<DynamicProtocol>,
    advised_step: f64,
}

impl Protocol {
    /// For tissues of these parameters and this mean spacing.
    pub fn new(
        arguments: &ProtocolArguments,
        parameters: &Parameters<f64>,
        spacing: f64,
    ) -> Result<Self, Failure> {
        let advised_step = recommended_time_step(parameters, spacing);
        let time_step = arguments.dt.unwrap_or(advised_step);
        Schedule { time: arguments.time.max(arguments.transient + arguments.average), time_step, frames: 1 }
            .steps_per_frame()?;
        let speed = parameters.perimeter_elasticity.abs() * spacing;
        let protocol = Self {
            advised_step,
            settings: Settings {
                relaxation: Relaxation {
                    time_step,
                    longest: arguments.time,
                    tolerance: AT_REST * speed,
                    slow: SLOW * speed,
                },
                strain: arguments.strain,
                flowing: Flowing {
                    strain: arguments.flowing_strain,
                    transient: arguments.transient,
                    time: arguments.average,
                },
            },
            viscosity: arguments.viscosity.then_some(ViscosityProtocol {
                rate: arguments.rate,
                period: arguments.period,
                periods: arguments.periods,
                transient_periods: 1,
                time_step,
            }),
            dynamic: (!arguments.frequencies.is_empty()).then(|| DynamicProtocol {
                frequencies: arguments.frequencies.clone(),
                strain: arguments.strain,
                amplitude: arguments.flowing_strain,
                time: arguments.average,
                time_step,
            }),
        };
        protocol.settings.check()?;
        if let Some(dynamic) = &protocol.dynamic {
            dynamic.check()?;
        }
        Ok(protocol)
    }

    /// What should be known before measuring.
    pub fn doubts(&self) -> Option<String> {
        let (time_step, advised) = (self.settings.relaxation.time_step, self.advised_step);
        (time_step > 2.0 * advised).then(|| {
            format!(
                "the time step {time_step} is more than twice the {} advised for these parameters; flowing tissues can come \
                 out wrong by tens of per cent",
                significant(advised, 2)
            )
        })
    }

    /// About how often a replica is looked at, at most: every hundred steps.
    pub fn looks(&self) -> u64 {
        let Settings { relaxation, flowing, .. } = self.settings;
        let viscosity = self.viscosity.map_or(0.0, |v| v.period * (v.periods + v.transient_periods) as f64);
        let dynamic = self.dynamic.as_ref().map_or(0.0, |own| {
            let longest =
                |frequency: &f64| own.time.max(FEWEST_PERIODS as f64 * TAU / frequency) + TAU / frequency;
            own.frequencies.iter().map(longest).sum()
        });
        let time = dynamic + relaxation.longest + 12.0 * (flowing.transient + flowing.time) + viscosity;
        (time / relaxation.time_step / 100.0).min(1e15) as u64 + 1
    }
}
