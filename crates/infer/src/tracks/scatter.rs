//! How far cells are moved at random, anew at every moment: what the dynamics scatter by.
//!
//! What the model leaves of a displacement has the variance σ_v² T h in each component, which is 2Dh of cells that diffuse. A fit always has such a
//! scatter, because it holds no cell more stiffly to the model than errors of positions are worth (see [`least_scatter`]). What speaks
//! for a scatter is by how much −2 log L falls from the least that a fit has to the likeliest one, positions with errors in either case.

use super::anchors::Share;
use super::course::least_scatter;
use super::held_out::AsMeasured;
use super::inference::Followed;
use super::likely::LESS_LIKELY;
use super::look::{Seen, Way};
use super::motions::Motion;
use super::movie::Movie;
use super::objective::MovieObjective;
use super::placed::Placed;
use super::states::States;
use crate::diagnostics::robust_variance;
use crate::restricted::Likelihood;
use crate::{CoefficientSpace, Error, Request};

/// How many motions are taken for jumps by chance.
const JUMPS: f64 = 0.1;

/// Draws for slopes of the likelihood.
const DRAWS: usize = 48;

/// Points from which Newton's method goes on to the likeliest log k at most, and a step to the last of them that is short.
const LOOKS: usize = 3;
const SHORT: f64 = 0.25;

/// How far an end of an interval is in log k at most, points at which it is sought, and a share by which the likelihood may miss it.
const FURTHEST: f64 = 4.0;
const POINTS: usize = 4;
const PRECISION: f64 = 0.05;

/// What the dynamics scatter by, in the units of the movie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scatter {
    /// D
    pub diffusion: f64,
    /// Its 95 % interval.
    pub interval: [f64; 2],
    /// By how much −2 log L, restricted, falls from the least scatter to this one.
    pub evidence: f64,
}

/// The likelihood as a function of k, near that of a fit.
struct OfSpring<'a> {
    seen: Seen<'a>,
    /// The least log k.
    least: f64,
}

/// The likeliest k.
struct Likeliest {
    log_k: f64,
    here: Likelihood,
    /// Derivatives of −2 log L by log k.
    slope: f64,
    bend: f64,
}

impl OfSpring<'_> {
    fn at(&self, log_k: f64) -> Result<Likelihood, Error> {
        self.seen.restricted(None).likelihood(log_k)
    }

    /// The likeliest log k near the fit.
    fn likeliest(&self) -> Result<Likeliest, Error> {
        let mut log_k = self.seen.objective.levels.spring().ln().max(self.least);
        let mut looks = 1;
        loop {
            let look = self.seen.look(&self.seen.about_spring(log_k), Way::Draws(DRAWS))?;
            let (slope, bend) = (look.criterion.slope[0], look.criterion.bend[(0, 0)]);
            let newton = if bend > 0.0 { -slope / bend } else { -slope.signum() };
            let step = newton.clamp(-1.0, 1.0).max(self.least - log_k);
            log_k += step;
            if step.abs() < SHORT || looks == LOOKS {
                let here = Likelihood {
                    criterion: look.here.criterion + (slope + 0.5 * bend * step) * step,
                    variance: look.here.variance * (look.log_variance[0] * step).exp(),
                };
                return Ok(Likeliest { log_k, here, slope: slope + bend * step, bend });
            }
            looks += 1;
        }
    }

    /// σ_v² where the likelihood has fallen as far as the end of an interval, above the likeliest k or below.
    fn end(&self, from: &Likeliest, side: f64) -> Result<f64, Error> {
        let (slope, bend) = (side * from.slope, from.bend.max(f64::MIN_POSITIVE));
        // Where a parabola ends.
        let mut aside = ((slope * slope + 2.0 * bend * LESS_LIKELY).sqrt() - slope) / bend;
        let mut there = from.here;
        for _ in 0..POINTS {
            aside = aside.min(FURTHEST);
            there = self.at(from.log_k + side * aside)?;
            // The root of what it falls by is nearly a line.
            let share = ((there.criterion - from.here.criterion) / LESS_LIKELY).max(0.0).sqrt();
            if (share - 1.0).abs() < PRECISION || (share < 1.0 && aside == FURTHEST) {
                break;
            }
            aside *= (1.0 / share).clamp(0.5, 2.0);
        }
        Ok(there.variance)
    }
}

/// Which motions the model misses by more than chance lets one of so many miss.
fn jumps(objective: &MovieObjective<'_>, placed: &Placed<'_>, at: &[f64]) -> Result<Vec<bool>, Error> {
    let displacements = objective.split(at).1;
    let means = objective.seen_velocities(placed, displacements)?;
    let measured = AsMeasured::new(*objective, displacements);
    // In units of what an interval of this length leaves by errors of positions.
    let missed = measured.velocities.iter().zip(means).zip(&objective.states.motions);
    let halved: Vec<f64> = missed
        .map(|((seen, mean), motion)| {
            let missed = seen.map_or(0.0, |seen| (seen - mean).norm_squared());
            0.5 * missed * objective.span(motion.interval).powi(2)
        })
        .collect();
    Ok(stand_out(&halved))
}

/// Which halved squares of normal vectors are larger than one of so many is by chance; of those that are zero nothing is known.
fn stand_out(halved: &[f64]) -> Vec<bool> {
    let known: Vec<f64> = halved.iter().copied().filter(|square| *square > 0.0).collect();
    let usual = robust_variance(&known).map_or(f64::INFINITY, |(variance, _)| variance);
    let most = usual * (known.len() as f64 / JUMPS).ln();
    halved.iter().map(|square| *square > most).collect()
}

impl Followed {
    /// What the dynamics of a fit of cells that do not crawl scatter by; `None` if that was given.
    pub fn scatter(
        &self,
        movie: &Movie,
        request: &Request,
        space: &CoefficientSpace,
    ) -> Result<Option<Scatter>, Error> {
        if request.noise.velocity.is_some() {
            return Ok(None);
        }
        // In steps that are fine enough for coefficients contacts change too soon or too late, and leave a scatter of their own.
        let of_fit = self.objective(movie, &request.structure, space);
        let objective = MovieObjective { rule: of_fit.rule.twice(), ..of_fit };
        let at = &self.fit.parameters;
        let placed = objective.displaced(at)?;
        // A track that jumps is no scatter of all cells.
        let states = objective.states;
        let jumps = jumps(&objective, &placed, at)?;
        let is_smooth = |(_, jumps): &(&Motion, bool)| !jumps;
        let motions = states.motions.iter().zip(jumps).filter(is_smooth).map(|(motion, _)| *motion).collect();
        let states = &States { motions, ..states.clone() };
        let objective = MovieObjective { states, ..objective };
        let components = objective.explained_components(&placed, at);
        let equations = &objective.linearise_at(&placed, at, Share::Known)?;
        let seen = Seen { objective, equations, components, known: request.noise };
        let interval = movie.interval();
        let own = OfSpring { seen, least: 2.0 * least_scatter(1.0, interval).ln() };
        let likeliest = own.likeliest()?;
        let Likelihood { criterion, variance } = likeliest.here;
        let evidence = match likeliest.log_k > own.least {
            true => (own.at(own.least)?.criterion - criterion).max(0.0),
            false => 0.0,
        };
        let diffusion = |variance: f64| 0.5 * variance * interval;
        let lower = if evidence < LESS_LIKELY { 0.0 } else { diffusion(own.end(&likeliest, -1.0)?) };
        let interval = [lower, diffusion(own.end(&likeliest, 1.0)?)];
        Ok(Some(Scatter { diffusion: diffusion(variance), interval, evidence }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::{Distribution, Exp1};
    use rand_pcg::Pcg64;

    #[test]
    fn jumps_stand_out_and_chance_does_not() {
        let (count, mut alarms) = (1000, 0);
        for seed in 0..400 {
            let mut generator = Pcg64::seed_from_u64(seed);
            let mut halved: Vec<f64> = (0..count).map(|_| Exp1.sample(&mut generator)).collect();
            halved[generator.random_range(0..count)] = 0.0;
            alarms += usize::from(stand_out(&halved).contains(&true));
            let jump = generator.random_range(0..count);
            halved[jump] = 18.0;
            assert!(stand_out(&halved)[jump], "seed {seed}");
        }
        // One in ten.
        assert!((20..=60).contains(&alarms), "{alarms} of 400");
    }
}
