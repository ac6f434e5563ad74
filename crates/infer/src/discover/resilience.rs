//! Whether an effect, or that cells differ, stands without the data that could decide for it alone: those that speak most for it, those
//! around one place, those near cells that were put in, and those at the rim of what is certain.

use super::chance::Chance;
use super::lineup::{Lineup, Score};
use super::steps::{Model, Setting};
use crate::cross_validation::without;
use crate::normal_matrix::invert;
use crate::residuals::residuals;
use crate::uncertainty::nudges;
use crate::{Error, FitParameter, Observation, Velocities};
use nalgebra::{DMatrix, DVector};
use voronudge_geometry::{Vector, Visibility};

/// Share of the velocities, those that speak most for an effect, without which it must be better than chance.
const FEW: f64 = 0.02;

/// Velocities around which the place is looked for that speaks most.
const PLACES: usize = 200;

/// Distance from a cell that was not detected, in ℓ₀, within which velocities depend on where it is.
const NEAR: f64 = 2.0;

/// Least share of the velocities that must be left for a test without those.
const ENOUGH: f64 = 0.3;

/// Least statistic of an effect there, as a share of what is expected of it.
const LEAST: f64 = 0.25;

/// Why effects do not stand.
const ONE_PLACE: &str = "it rests on one place, where a cell that was not detected could be as well: without the velocities within two cells of \
                         it, it is no more than chance";
const AT_UNSEEN: &str = "it is not there away from the cells that were not detected";

/// Which velocities of each frame are left out.
type Mask = Vec<Vec<bool>>;

/// An effect in a model.
pub(super) struct Member<'a> {
    pub candidate: usize,
    /// Where its coefficients are.
    pub places: &'a [usize],
    /// The other effects of the model.
    pub others: &'a [usize],
    /// Its statistic with all data.
    pub statistic: f64,
}

/// What is left of an effect without some of the data.
struct Rest {
    score: Score,
    /// Probability of so much by chance.
    adjusted_p: f64,
    /// The statistic that is expected of it there.
    expected: f64,
}

impl Member<'_> {
    /// Why it does not stand, if it does not.
    pub fn weakness(
        &self,
        setting: &Setting<'_>,
        base: &Model,
        model: &Model,
    ) -> Result<Option<&'static str>, Error> {
        let told_apart = self.others.is_empty() || setting.candidates[self.candidate].is_linear();
        // Along tracks there is no velocity to leave out, and beside others the columns of a response are not its own.
        if setting.movie.is_some() || !told_apart {
            return Ok(None);
        }
        let speaking = Speaking::new(setting, model, self.places)?;
        let tests = [
            (
                speaking.most(),
                "it rests on a few velocities: without the 2 % that speak most for it, it is no more than chance",
            ),
            (speaking.around_one_place(), ONE_PLACE),
        ];
        for (out, reason) in tests {
            let Rest { score, adjusted_p, .. } = self.without(setting, base, model, &out)?;
            if score.dimension == 0 || adjusted_p >= setting.level(self.others.len()) {
                return Ok(Some(reason));
            }
        }
        let acts_at_edge = setting.candidates[self.candidate].effect.acts_at_edge();
        let doubtful = [
            (near_unseen(setting.frames), AT_UNSEEN),
            (
                if acts_at_edge { Mask::new() } else { at_the_rim(setting.frames) },
                "it is not there away from the rim of what is seen for certain",
            ),
        ];
        for (out, reason) in doubtful {
            let left = left(setting.frames, &out);
            if left < 1.0 && left > ENOUGH {
                let Rest { score, expected, .. } = self.without(setting, base, model, &out)?;
                if score.statistic < LEAST * expected.min(self.statistic) {
                    return Ok(Some(reason));
                }
            }
        }
        Ok(None)
    }

    /// What is left of it without some of the data.
    fn without(&self, setting: &Setting<'_>, base: &Model, model: &Model, out: &Mask) -> Result<Rest, Error> {
        let alone = self.others.is_empty();
        let about = if alone { base } else { model };
        let frames: Vec<Observation> =
            about.frames(setting.frames).iter().zip(out).map(|(frame, out)| without(frame, out)).collect();
        let lineup =
            Lineup::new(&frames, &setting.search.fit, setting.candidates, &about.added, &about.inference)?;
        let own: Vec<f64> = self.places.iter().map(|k| model.inference.coefficients[*k]).collect();
        let lineup = if alone { lineup } else { lineup.restored(self.candidate, &own) };
        let projected = lineup.beyond(self.others);
        let score = projected.score(self.candidate);
        let chance = Chance::new(&projected, &setting.named(self.others), setting.search.fit.seed);
        let adjusted_p = chance.adjusted(score.p);
        let expected = projected.expected(self.candidate, &own, &score);
        Ok(Rest { score, adjusted_p, expected })
    }
}

/// Why it does not stand that cells differ beside a model, if it does not. `evidence` is how much speaks for it in frames from which some
/// velocities are left out, `all` how much in all, and `is_chance` whether so much is no more than chance.
pub(super) fn weakness_of_difference(
    setting: &Setting<'_>,
    model: &Model,
    all: f64,
    evidence: impl Fn(&[Observation]) -> Option<f64>,
    is_chance: impl Fn(f64) -> bool,
) -> Result<Option<&'static str>, Error> {
    let frames = model.frames(setting.frames);
    let left_of = |out: &Mask| -> Option<f64> {
        let rest: Vec<Observation> = frames.iter().zip(out).map(|(frame, out)| without(frame, out)).collect();
        evidence(&rest)
    };
    if left_of(&Speaking::of_rest(setting, model)?.around_one_place()).is_some_and(is_chance) {
        return Ok(Some(ONE_PLACE));
    }
    let unseen = near_unseen(frames);
    let share = left(frames, &unseen);
    let is_known = share < 1.0 && share > ENOUGH;
    let fails = is_known && left_of(&unseen).is_some_and(|left| left < LEAST * share * all);
    Ok(fails.then_some(AT_UNSEEN))
}

/// How much each velocity speaks for an effect of a model.
struct Speaking<'a> {
    frames: &'a [Observation],
    /// How much, frame and datum; the most first.
    all: Vec<(f64, usize, usize)>,
}

impl<'a> Speaking<'a> {
    fn new(setting: &Setting<'a>, model: &Model, places: &[usize]) -> Result<Self, Error> {
        let frames = setting.frames;
        let data =
            frames.iter().enumerate().flat_map(|(index, own)| own.targets().map(move |own| (index, own.0)));
        let own = partial(setting, model, places)?.into_iter().zip(data);
        let all = own.map(|([predicted, rest], (index, datum))| (predicted.dot(&rest), index, datum));
        Ok(Self::sorted(frames, all.collect()))
    }

    /// By what a model leaves of them.
    fn of_rest(setting: &Setting<'a>, model: &Model) -> Result<Self, Error> {
        let mut all = Vec::new();
        let objective = model.objective(setting.frames);
        for (index, nudges) in nudges(setting.frames, &model.inference).iter().enumerate() {
            let evaluated =
                objective.displaced(index, nudges)?.evaluate(model.inference.coefficients.as_slice());
            let rests = residuals(&setting.frames[index], &evaluated.predicted);
            all.extend(rests.into_iter().map(|(datum, rest)| (rest.norm_squared(), index, datum)));
        }
        Ok(Self::sorted(setting.frames, all))
    }

    fn sorted(frames: &'a [Observation], mut all: Vec<(f64, usize, usize)>) -> Self {
        all.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        Self { frames, all }
    }

    fn nothing(&self) -> Mask {
        self.frames.iter().map(|frame| vec![false; frame.velocities.values().len()]).collect()
    }

    /// The few that speak most.
    fn most(&self) -> Mask {
        let few = (FEW * self.all.len() as f64).ceil() as usize;
        let mut out = self.nothing();
        self.all.iter().take(few).for_each(|(_, index, datum)| out[*index][*datum] = true);
        out
    }

    /// Those around the place of a frame that speak most together.
    fn around_one_place(&self) -> Mask {
        let around = |centre: &(f64, usize, usize)| -> (f64, Vec<usize>) {
            let frame = &self.frames[centre.1];
            let (domain, at) = (frame.tessellation.domain(), frame.position_of_datum(centre.2));
            let is_near = |own: &&(f64, usize, usize)| {
                own.1 == centre.1 && domain.shortest(frame.position_of_datum(own.2) - at).norm() < NEAR
            };
            let near: Vec<&(f64, usize, usize)> = self.all.iter().filter(is_near).collect();
            (near.iter().map(|own| own.0).sum(), near.iter().map(|own| own.2).collect())
        };
        let places = self.all.iter().take(PLACES).map(|centre| (centre.1, around(centre)));
        let mut out = self.nothing();
        if let Some((index, (_, near))) = places.max_by(|a, b| a.1.0.total_cmp(&b.1.0)) {
            near.iter().for_each(|datum| out[index][*datum] = true);
        }
        out
    }
}

/// The velocities near cells without a measured position.
fn near_unseen(frames: &[Observation]) -> Mask {
    let of_frame = |frame: &Observation| -> Vec<bool> {
        let domain = frame.tessellation.domain();
        let unseen: Vec<Vector<f64>> = (0..frame.positions.len())
            .filter(|cell| !frame.is_seen(*cell))
            .map(|cell| frame.positions[cell])
            .collect();
        let is_near = |r: Vector<f64>| unseen.iter().any(|own| domain.shortest(r - own).norm() < NEAR);
        (0..frame.velocities.values().len()).map(|datum| is_near(frame.position_of_datum(datum))).collect()
    };
    frames.iter().map(of_frame).collect()
}

/// The velocities of cells that would not count if it took one ring more of what is certain.
fn at_the_rim(frames: &[Observation]) -> Mask {
    let of_frame = |frame: &Observation| -> Vec<bool> {
        if matches!(frame.velocities, Velocities::OnGrid(_)) {
            return vec![false; frame.velocities.values().len()];
        }
        let counts = |cell: &u32| frame.visibility[*cell as usize] == Visibility::Counted;
        (0..frame.positions.len())
            .map(|cell| !frame.tessellation.neighbours(cell).iter().all(counts))
            .collect()
    };
    frames.iter().map(of_frame).collect()
}

/// The share of the velocities that a mask leaves.
fn left(frames: &[Observation], out: &Mask) -> f64 {
    let all: usize = frames.iter().map(|frame| frame.targets().count()).sum();
    let lost = |(frame, out): (&Observation, &Vec<bool>)| frame.targets().filter(|own| out[own.0]).count();
    let lost: usize = frames.iter().zip(out).map(lost).sum();
    1.0 - lost as f64 / all.max(1) as f64
}

/// What an effect predicts beyond the terms of the base model, and that with what the whole model leaves, in each target.
pub(super) fn partial(
    setting: &Setting<'_>,
    model: &Model,
    places: &[usize],
) -> Result<Vec<[Vector<f64>; 2]>, Error> {
    // Along tracks there is no velocity to set against another.
    if model.followed.is_some() {
        return Ok(Vec::new());
    }
    let frames = setting.frames;
    let objective = model.objective(frames);
    let coefficients = model.inference.coefficients.as_slice();
    let base = FitParameter::COEFFICIENTS;
    let (mut rows, mut targets) = (Vec::new(), Vec::new());
    for (index, nudges) in nudges(frames, &model.inference).iter().enumerate() {
        let evaluated = objective.displaced(index, nudges)?.evaluate(coefficients);
        for (datum, rest) in residuals(&frames[index], &evaluated.predicted) {
            let at = |k: usize| evaluated.by_coefficient[k][datum];
            let effect =
                places.iter().fold(Vector::zeros(), |sum: Vector<f64>, k| sum + at(*k) * coefficients[*k]);
            rows.push((std::array::from_fn::<Vector<f64>, 4, _>(at), effect));
            targets.push(rest);
        }
    }
    let normal = DMatrix::from_fn(base, base, |i, j| rows.iter().map(|(x, _)| x[i].dot(&x[j])).sum());
    let right = DVector::from_fn(base, |i, _| rows.iter().map(|(x, effect)| x[i].dot(effect)).sum());
    let shared = invert(normal).map_or_else(|_| DVector::zeros(base), |inverse| inverse * right);
    let beyond = rows.iter().map(|(x, effect)| (0..base).fold(*effect, |rest, k| rest - x[k] * shared[k]));
    Ok(beyond.zip(targets).map(|(predicted, rest)| [predicted, predicted + rest]).collect())
}
