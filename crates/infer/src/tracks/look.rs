//! The likelihood of noise levels and memory about a point, from factors at points around it.

use super::likely::{Place, Spaced};
use super::memory::Memory;
use super::objective::MovieObjective;
use super::surface::{CLOSE, ENOUGH, POINTS, Point, Surface};
use crate::noise::{Likelihood, Restricted};
use crate::normal_equations::NormalEquations;
use crate::{Error, KnownNoise};

/// A linearised problem and what is known of its noise.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub objective: MovieObjective<'a>,
    pub equations: &'a NormalEquations,
    pub components: f64,
    pub known: KnownNoise,
}

/// What was seen about a point, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// The point; none if it is of another linearised problem.
    at: Option<Point>,
    /// The likelihood there.
    pub here: Likelihood,
    /// −2 log L
    pub criterion: Surface,
    /// log σ_v²
    pub log_variance: Surface,
}

impl Look {
    /// For another fit of the same cells: how the likelihood bends, and nothing of where it was seen. `None` if all that is not held is not
    /// so well known that the likelihood is that of a normal distribution.
    pub fn of_another(self, held: [bool; 4]) -> Option<Self> {
        self.criterion.is_sharp(held).then_some(Self { at: None, ..self })
    }
}

impl Seen<'_> {
    /// About a point: with second derivatives as they were if something was seen earlier.
    pub fn look(&self, spaced: &Spaced, earlier: Option<Look>) -> Result<Look, Error> {
        let points: Vec<Point> = match earlier {
            None => POINTS.iter().map(|point| (*point).into()).collect(),
            Some(_) => POINTS[..ENOUGH].iter().map(|point| Point::from(*point) * CLOSE).collect(),
        };
        let values = self.at_points(spaced, &points)?;
        let criteria: Vec<f64> = values.iter().map(|own| own.criterion).collect();
        let variances: Vec<f64> = values.iter().map(|own| own.variance.ln()).collect();
        let at = spaced.centre();
        let (criterion, log_variance) = match earlier {
            None => (Surface::new(&criteria), Surface::new(&variances)),
            Some(earlier) => (
                match (Surface::again(&criteria, earlier.criterion.bend), earlier.at) {
                    (own, Some(before)) => own.updated(&earlier.criterion, at - before),
                    (own, None) => own,
                },
                Surface::again(&variances, earlier.log_variance.bend),
            ),
        };
        Ok(Look { at: Some(at), here: values[0], criterion, log_variance })
    }

    /// At some points; those that differ in an alignment alone that is none are one.
    fn at_points(&self, spaced: &Spaced, points: &[Point]) -> Result<Vec<Likelihood>, Error> {
        let own = |point: &Point| match self.objective.states.polarities.align() {
            true => *point,
            false => Point::new(point[0], point[1], point[2], 0.0),
        };
        let first = |point: &Point| points.iter().position(|other| *other == own(point)).unwrap_or(0);
        let needed: Vec<usize> = (0..points.len()).filter(|k| first(&points[*k]) == *k).collect();
        let found = self.equations.each(&needed, |k| self.likelihood(spaced.at(points[*k])))?;
        Ok(points.iter().map(|point| found[needed.binary_search(&first(point)).unwrap_or(0)]).collect())
    }

    /// The likelihood at some levels and memory.
    pub fn likelihood(&self, Place { log_k, times, ratio, alignment }: Place) -> Result<Likelihood, Error> {
        let Self { objective, equations, components, known } = *self;
        let speed = objective.levels.velocity / ratio.sqrt();
        let memory = Memory { times, speed, alignment, ..objective.memory.unwrap_or(Memory::FIRST) };
        let held = MovieObjective { memory: Some(memory), ..objective }.held();
        let own = Restricted { equations, components, known, held: Some(&held) }.likelihood(log_k)?;
        let of_lengths = ratio / objective.movie.interval().powi(2);
        let determinant = objective.states.polarities.log_determinant(memory, of_lengths)?;
        Ok(Likelihood { criterion: own.criterion - determinant, ..own })
    }
}
