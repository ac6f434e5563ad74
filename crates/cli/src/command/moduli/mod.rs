//! `voronudge moduli`: elastic moduli and viscosities.

mod measure;
mod report;

use crate::Answer;
use crate::arguments::{CommonArguments, ParameterArguments};
use crate::command::simulate::StartArguments;
use crate::failure::Failure;
use crate::memory::{OF_A_STRAINED_CELL, refuse_beyond};
use crate::run::Run;
use clap::Args;
use voronudge_report::ModuliPage;
use voronudge_simulate::{Schedule, recommended_time_step};

/// Elastic moduli B, A, μ, Kᵒ of a tissue from its stress under small strains, beside the mean-field theory.
///
/// Cells come to rest first; a tissue that does not is strained while it flows. Writes report.json and report.html.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    /// Random starts: the first has --seed, the others seeds made from it.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    replicas: u64,
    /// Longest time to come to rest.
    #[arg(long, default_value_t = 300.0, allow_negative_numbers = true)]
    time: f64,
    /// Time step [default: 0.01 / max(K_P, K_P |α|, K_A ℓ₀²)].
    #[arg(long, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// The larger strain of a tissue at rest; the smaller is half of it.
    #[arg(long, default_value_t = 1e-5, allow_negative_numbers = true)]
    strain: f64,
    /// The larger strain of a tissue that flows.
    #[arg(long, value_name = "STRAIN", default_value_t = 0.1, allow_negative_numbers = true)]
    flowing_strain: f64,
    /// Time after a strain before the stress of a tissue that flows is averaged.
    #[arg(long, value_name = "TIME", default_value_t = 20.0, allow_negative_numbers = true)]
    transient: f64,
    /// Time over which the stress of a tissue that flows is averaged.
    #[arg(long, value_name = "TIME", default_value_t = 100.0, allow_negative_numbers = true)]
    average: f64,
    /// Also viscosities, by shear back and forth at --rate with --period.
    #[arg(long)]
    viscosity: bool,
    /// Rate of the shear back and forth.
    #[arg(long, default_value_t = 0.01, allow_negative_numbers = true)]
    rate: f64,
    /// Its period.
    #[arg(long, default_value_t = 200.0, allow_negative_numbers = true)]
    period: f64,
    /// Periods that are averaged over, after one that is not.
    #[arg(long, default_value_t = 4, allow_negative_numbers = true)]
    periods: usize,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    common: CommonArguments,
}

pub(crate) fn run(arguments: Arguments) -> Result<Answer, Failure> {
    let mut run = Run::begin("moduli", &arguments.common)?;
    let parameters = arguments.parameters.resolve()?;
    for (name, value, least) in [
        ("--time", arguments.time, 0.0),
        ("--transient", arguments.transient, 0.0),
        ("--average", arguments.average, f64::MIN_POSITIVE),
    ] {
        if !(value.is_finite() && value >= least) {
            return Err(Failure::new(format!("{name} is {value}, but it must be a time"))
                .with_hint(format!("leave {name} out for the default")));
        }
    }
    let mut out =
        arguments.common.output(arguments.start.file().into_iter().chain(arguments.parameters.file()))?;
    let starts = measure::starts(&arguments)?;
    let first = &starts[0].1;
    let cells = first.positions.len();
    refuse_beyond(format!("moduli of {cells} cells"), cells, OF_A_STRAINED_CELL)?;
    let spacing = (first.cell_box.area() / first.positions.len() as f64).sqrt();
    let advised = recommended_time_step(&parameters, spacing);
    let time_step = arguments.dt.unwrap_or(advised);
    if time_step > 2.0 * advised {
        run.warn(format!(
            "the time step {time_step} is more than twice the {advised:.2e} advised for these parameters; flowing tissues can come \
             out wrong by tens of per cent"
        ));
    }
    Schedule { time: arguments.time.max(arguments.transient + arguments.average), time_step, frames: 1 }
        .steps_per_frame()?;
    let protocol = measure::Protocol::new(&arguments, &parameters, time_step, spacing);
    let measured = measure::replicas(&starts, &parameters, &protocol, arguments.common.verbosity())?;
    report::doubts(&measured).into_iter().for_each(|doubt| run.warn(doubt));
    let report = report::report(&run, &starts, (&parameters, spacing), &protocol, &measured);
    let json = report.to_json()?;
    out.write_text("report.json", &json)?;
    let (title, headline) = (report::title(&arguments), report::headline(&report));
    let page = ModuliPage { title: &title, headline: &headline, summary: &[], report: &report };
    out.write_text("report.html", &page.render()?)?;
    let summary = report::summary(&report, out.path());
    run.finish(Some(out), &json, &summary)?;
    Ok(Answer::Positive)
}
