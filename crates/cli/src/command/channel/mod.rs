//! `voronudge channel`: flows that extrusion and proliferation near the edges of a channel drive.

mod arrays;
mod continuum;
mod cycle;
mod figures;
mod frames;
mod page;
mod report;
mod request;
mod shapes;

use crate::arguments::{CommonArguments, ParameterArguments};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::reporting::{Answer, Rendered, Reporting};
use crate::run::Run;
use clap::Args;
use frames::Frames;
use ndarray::Array2;
use request::{ChannelArguments, ChannelRequest};
use std::ops::ControlFlow;
use voronudge_geometry::Domain;
use voronudge_model::Model;
use voronudge_report::ChannelReport;
use voronudge_report::channel_report::DisturbanceRecord;
use voronudge_simulate::{
    Injection, LivingTissue, RandomPlacement, Simulation, generator, run_channel, sort_in_space,
};

/// Simulates the flow across and along a channel whose cells are extruded and born near its edges.
///
/// Writes profiles as .npy files of shape (places, 2) with value and standard error, and as folded_profile.csv. Also
/// writes lineage.csv, report.json and report.html, and with --frames a data set.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    channel: ChannelArguments,
    /// Number of frames to keep as a data set, evenly spaced over the averaging time; 0 for none.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    frames: usize,
    #[command(flatten)]
    parameters: ParameterArguments,
    #[command(flatten)]
    common: CommonArguments,
}

/// Places of births tried for the disturbance that a birth makes.
const DRAWS: usize = 200;

impl Reporting for Arguments {
    const NAME: &'static str = "channel";
    type Report = ChannelReport;

    fn common(&self) -> &CommonArguments {
        &self.common
    }

    fn work(self, run: &mut Run) -> Result<Rendered<Self::Report>, Failure> {
        let request = self.channel.resolve(&self.parameters, self.common.seed)?;
        let mut frames = Frames::new(self.frames, &request.schedule)?;
        let mut shapes = shapes::Shapes::new(&request)?;
        let mut tissue = tissue(&request, self.common.seed)?;
        let inputs = self.parameters.file().into_iter().chain(self.channel.equation_of_state());
        let mut out = self.common.output(inputs)?;
        request.doubtful_step().into_iter().for_each(|warning| run.warn(warning));
        let mut progress = Progress::new(self.common.verbosity());
        let mut interrupted = false;
        let outcome = run_channel(&mut tissue, &request.schedule, |tissue, done, total| {
            frames.after_step(done, tissue);
            shapes.after_step(done, &request, tissue);
            interrupted = progress.step("channel", done as u64, total as u64).is_break();
            if interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        progress.finish();
        if interrupted {
            return Err(Failure::interrupted());
        }
        if outcome.recorder.samples() == 0 {
            let why = outcome.ended.map_or_else(|| "no sample was ended".into(), |error| error.to_string());
            return Err(Failure::new(format!("{why}, before the first of the averages")).with_hint(
                "change the rates so that births and extrusions balance, or shorten --relaxation and --time",
            ));
        }
        if let Some(error) = &outcome.ended {
            run.warn(format!(
                "the run ended before its time: {error}; averages are over the {} samples until then, which are not a steady state",
                outcome.recorder.samples()
            ));
        }
        if outcome.recorder.samples() < 16 {
            run.warn(format!(
                "{} samples are too few for standard errors, which need 16; there are no fits",
                outcome.recorder.samples()
            ));
        }
        let crossings = tissue.simulation().state().crossings;
        if crossings > 0 {
            run.warn(format!("cells crossed a wall {crossings} times and were put in front of it"));
        }
        let (full, folded) = (outcome.recorder.profile(), outcome.recorder.folded_profile());
        let disturbance = disturbance(&request, &tissue, self.common.seed);
        let in_two = (request.cycle.map(Injection::Cycle))
            .and_then(|own| tissue.birth_disturbance(own, DRAWS, self.common.seed).ok());
        let record = disturbance.as_ref().map(|[vertex, division]| DisturbanceRecord {
            draws: DRAWS,
            division_distance: request.division_distance,
            vertex_mean: mean(vertex),
            division_mean: mean(division),
            cycle_mean: in_two.as_deref().map(mean),
        });
        let cycles = request.cycle.as_ref().map(|cycle| cycle::record(cycle, &tissue, shapes.mean_size()));
        let findings = report::findings(run, &request, (&tissue, &outcome), &folded, (record, cycles))?;
        arrays::write(&mut out, &full, &folded)?;
        frames.write(&mut out, &tissue, &request.named)?;
        if let Some([vertex, division]) = &disturbance {
            let all: Vec<&Vec<f64>> = [vertex, division].into_iter().chain(&in_two).collect();
            let table = Array2::from_shape_fn((DRAWS, all.len()), |(draw, way)| all[way][draw]);
            out.write_array("birth_disturbance.npy", table.view())?;
        }
        let by_age = shapes.found();
        shapes::write(&mut out, &by_age)?;
        let figures = figures::Figures {
            request: &request,
            findings: &findings,
            full: &full,
            folded: &folded,
            by_age: &by_age,
        };
        let disturbances = disturbance.as_ref().map(|[vertex, division]| (vertex, division, in_two.as_ref()));
        let page = page::page(&figures, disturbances);
        let summary = page::summary(&findings.report, out.path());
        let answer = Answer::of(outcome.ended.is_none());
        Ok(Rendered::with_page(out, &findings.report, page, summary)?.with_answer(answer))
    }
}

fn tissue(request: &ChannelRequest, seed: u64) -> Result<LivingTissue, Failure> {
    let mut positions = RandomPlacement::new(request.cells, request.cell_box).draw(&mut generator(seed))?;
    sort_in_space(&mut positions, &request.cell_box);
    let model = Model::chiral_voronoi(&request.parameters);
    let mut simulation = Simulation::new(positions, Domain::Periodic(request.cell_box), model)?;
    if let Some(walls) = request.walls {
        simulation = simulation.with_walls(walls)?;
    }
    Ok(LivingTissue::new(simulation, request.turnover)?)
}

/// How much births by both ways change velocities; nothing where a daughter would lie on another cell.
fn disturbance(request: &ChannelRequest, tissue: &LivingTissue, seed: u64) -> Option<[Vec<f64>; 2]> {
    let by = |injection| tissue.birth_disturbance(injection, DRAWS, seed).ok();
    Some([by(Injection::Vertex)?, by(Injection::Division { distance: request.division_distance })?])
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
