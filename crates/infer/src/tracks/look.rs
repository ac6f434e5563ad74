//! The likelihood of noise levels and memory about a point: from factors at points around it, or from one factor and draws.

use super::memory::Memory;
use super::objective::MovieObjective;
use super::place::{Place, Spaced};
use super::surface::{CLOSE, Matrix, PAIRS_OF_SIDES, POINTS, Point, Surface};
use crate::linearisation::{Held, Weighting};
use crate::normal_equations::NormalEquations;
use crate::restricted::{Likelihood, Restricted};
use crate::{Error, KnownNoise};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Draws for traces of products, which need four solutions each, at least; and unknowns in all of them: sums over many scatter less.
const FEWEST_FOR_PRODUCTS: usize = 3;
const FOR_PRODUCTS: usize = 50_000;

/// A linearised problem and what is known of its noise.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub objective: MovieObjective<'a>,
    pub equations: &'a NormalEquations,
    pub components: f64,
    pub known: KnownNoise,
}

/// How a likelihood is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// At points a spacing away: for intervals, which are as wide.
    Points,
    /// By its derivatives, of which traces are found from so many draws of the unknowns: they err by standard errors over the root of that number.
    Draws(usize),
}

/// What was seen about a point, in units of the spacings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// The likelihood there.
    pub here: Likelihood,
    /// −2 log L
    pub criterion: Surface,
    /// The slope of log σ_v².
    pub log_variance: Point,
}

impl Seen<'_> {
    /// About a point.
    pub fn look(&self, spaced: &Spaced, way: Way) -> Result<Look, Error> {
        match way {
            Way::Draws(count) => self.derivatives(spaced, count),
            Way::Points => {
                let values = self.at_points(spaced, &POINTS.map(Point::from))?;
                let criteria: Vec<f64> = values.iter().map(|own| own.criterion).collect();
                let variances: Vec<f64> = values.iter().map(|own| own.variance.ln()).collect();
                let log_variance = Surface::new(&variances).slope;
                Ok(Look { here: values[0], criterion: Surface::new(&criteria), log_variance })
            }
        }
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

    /// Which of the unknowns the likelihood depends on.
    fn unknown(&self) -> Vec<usize> {
        match self.objective.memory {
            None => vec![0],
            Some(_) if self.objective.states.polarities.align() => vec![0, 1, 2, 3],
            Some(_) => vec![0, 1, 2],
        }
    }

    /// How the weights change with each of the unknowns, from those at all points.
    fn directions(&self, points: &[(Weighting, f64)]) -> Vec<Weighting> {
        let sides = self.unknown().into_iter().map(|k| PAIRS_OF_SIDES[k]);
        let slope =
            |[above, below]: [usize; 2]| Weighting::slope(&points[below].0, &points[above].0, 2.0 * CLOSE);
        sides.map(slope).collect()
    }

    /// By derivatives, from one factor.
    fn derivatives(&self, spaced: &Spaced, count: usize) -> Result<Look, Error> {
        let [frame] = &self.equations.frames[..] else { return Err(Error::Degenerate) };
        let points: Vec<(Weighting, f64)> = POINTS
            .par_iter()
            .map(|point| self.weighting(spaced.at(Point::from(*point) * CLOSE)))
            .collect::<Result<_, _>>()?;
        let about = |of: &dyn Fn(&Weighting, f64) -> f64| {
            let values: Vec<f64> = points.iter().map(|(own, determinant)| of(own, *determinant)).collect();
            Surface::new(&values).seen_from(CLOSE)
        };
        let (unknown, directions) = (self.unknown(), self.directions(&points));
        let (solved, measured) = (frame.solved(&points[0].0)?, frame.measured_components());
        let for_products = (FOR_PRODUCTS / frame.order().max(1)).max(FEWEST_FOR_PRODUCTS);
        let draws = solved.draws(count.max(for_products));
        let (rests, trace) = (solved.rests(), solved.trace(&draws));
        let mut misfit = about(&|own, _| rests.of(own));
        misfit.bend -= among(&unknown, &solved.responses(&directions)) * 2.0;
        let mut criterion =
            about(&|own, determinant| trace.of(own) - determinant - measured * own.spring.ln());
        let some = &draws[..for_products * frame.order()];
        criterion.bend -= among(&unknown, &solved.products(&directions, some));
        let log_k = spaced.at(Point::zeros()).log_k;
        let here = self.restricted(None).of(log_k, solved.leftover);
        let (of_misfit, log_variance) = self.of_misfit(here.variance, solved.leftover.misfit, &misfit);
        Ok(Look {
            here: Likelihood { criterion: here.criterion - points[0].1, ..here },
            criterion: criterion.plus(&of_misfit),
            log_variance,
        })
    }

    /// What a misfit m adds to −2 log L, `n log σ_v² + m/σ_v²`, and the slope of log σ_v², if that variance belongs to it.
    fn of_misfit(&self, variance: f64, m: f64, misfit: &Surface) -> (Surface, Point) {
        let left = self.restricted(None).left();
        let Surface { slope, bend } = *misfit;
        let log_variance = match (self.known.velocity, self.known.position) {
            (Some(_), _) => Point::zeros(),
            (None, Some(_)) => Spaced::of_log_k(),
            (None, None) => slope / m,
        };
        let g = log_variance;
        let of_variance = match self.known.variance(0.0) {
            Some(_) => Matrix::zeros(),
            None => bend / m - g * g.transpose(),
        };
        let surface = Surface {
            slope: g * left + (slope - g * m) / variance,
            bend: of_variance * left
                + (bend - slope * g.transpose() - g * slope.transpose() + g * g.transpose() * m
                    - of_variance * m)
                    / variance,
        };
        (surface, log_variance)
    }

    /// The likelihood at some levels and memory.
    pub fn likelihood(&self, place: Place) -> Result<Likelihood, Error> {
        let (Weighting { held, .. }, determinant) = self.weighting(place)?;
        let own = self.restricted(Some(&held)).likelihood(place.log_k)?;
        Ok(Likelihood { criterion: own.criterion - determinant, ..own })
    }

    pub(super) fn restricted<'a>(&'a self, held: Option<&'a Held>) -> Restricted<'a> {
        let Self { equations, components, known, .. } = *self;
        Restricted { equations, components, known, held }
    }

    /// How data and unknowns are weighted at some levels and memory, and −log det of the covariance of the polarities.
    fn weighting(&self, Place { log_k, times, ratio, alignment }: Place) -> Result<(Weighting, f64), Error> {
        let objective = self.objective;
        let speed = objective.levels.velocity / ratio.sqrt();
        let memory = objective.memory.map(|memory| Memory { times, speed, alignment, ..memory });
        let held = MovieObjective { memory, ..objective }.held();
        let of_lengths = ratio / objective.movie.interval().powi(2);
        let determinant = match memory {
            Some(memory) => objective.states.polarities.log_determinant(memory, of_lengths)?,
            None => 0.0,
        };
        Ok((Weighting { spring: log_k.exp(), held }, determinant))
    }
}

/// A matrix of some of the unknowns; zero for the others.
fn among(some: &[usize], matrix: &DMatrix<f64>) -> Matrix {
    let mut all = Matrix::zeros();
    for (row, i) in some.iter().enumerate() {
        for (column, j) in some.iter().enumerate() {
            all[(*i, *j)] = matrix[(row, column)];
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Activity;
    use crate::tracks::sample::followed;

    /// Slopes and bends from one factor and many draws are those of factors around the point: of cells that crawl, with noise levels estimated or one
    /// of them known, and of such that align.
    #[test]
    fn derivatives_are_those_of_the_likelihood() {
        for activity in [Activity::Polarity, Activity::Alignment] {
            let (movie, request, followed) = followed(activity);
            let space = request.space().unwrap();
            let objective = followed.objective(&movie, &request.structure, &space);
            let at = &followed.fit.parameters;
            let equations = objective.linearise(at).unwrap();
            let components = objective.explained_components(&objective.displaced(at).unwrap(), at);
            let levels = [
                KnownNoise::default(),
                KnownNoise { position: Some(0.006), velocity: None },
                KnownNoise { position: None, velocity: Some(objective.levels.velocity) },
            ];
            let tried = if activity == Activity::Polarity { &levels[..] } else { &levels[..1] };
            for &known in tried {
                let seen = Seen { objective, equations: &equations, components, known };
                // Not at the most likely memory, where slopes would be none.
                let memory = objective.memory.unwrap();
                let alignment = if activity == Activity::Alignment { 0.3 } else { 0.0 };
                let memory = Memory { times: 1.5 * memory.times + 0.05, alignment, ..memory };
                let spaced = seen.about(memory);
                let look = seen.look(&spaced, Way::Draws(4000)).unwrap();
                let near = seen.at_points(&spaced, &POINTS.map(|point| Point::from(point) * CLOSE)).unwrap();
                let exact = |of: fn(&Likelihood) -> f64| {
                    Surface::new(&near.iter().map(of).collect::<Vec<_>>()).seen_from(CLOSE)
                };
                let (criterion, variance) = (exact(|own| own.criterion), exact(|own| own.variance.ln()));
                assert!((look.here.criterion - near[0].criterion).abs() < 1e-6 * near[0].criterion.abs());
                let off = (look.log_variance - variance.slope).amax();
                assert!(off < 1e-3 * variance.slope.amax().max(1.0), "{known:?} {variance:?} {look:?}");
                // The trace of A⁻¹∂A from n draws has a variance of 2 tr (A⁻¹∂A)² / n.
                let around =
                    POINTS.map(|point| seen.weighting(spaced.at(Point::from(point) * CLOSE)).unwrap());
                let solved = equations.frames[0].solved(&around[0].0).unwrap();
                let products = solved.products(&seen.directions(&around), &solved.draws(400));
                let products = among(&seen.unknown(), &products);
                let scatter = |k: usize| (2.0 * products[(k, k)] / 4000.0).sqrt();
                for k in 0..4 {
                    let off = look.criterion.slope[k] - criterion.slope[k];
                    assert!(off.abs() < 4.0 * scatter(k) + 1e-3, "{k}: {off} {criterion:?} {look:?}");
                }
                let off = (look.criterion.bend - criterion.bend).amax();
                assert!(off < 0.2 * criterion.bend.amax(), "{criterion:?} {look:?}");
            }
        }
    }
}
