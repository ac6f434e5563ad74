//! Forecasts against what was seen.

use super::start::Start;
use super::{Ahead, Forecast, Said, Skill, WithError};
use voronudge_geometry::Vector;

/// Parts of the field of view along each axis that are left out one by one.
const PARTS: usize = 2;

/// Squares of one forecast, of one part of the field.
#[derive(Debug, Clone, Copy, Default)]
struct Squares {
    /// Of the error of the displacement, and of that of the velocity over the last interval.
    missed: [f64; 2],
    /// Of what the displacement should be wrong by.
    expected: f64,
}

/// What was seen in one part of the field.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// Squares of displacements and of velocities.
    squares: [f64; 2],
    count: usize,
}

/// What was seen of a cell at a horizon.
struct Moved {
    cell: usize,
    /// Since the start, and in the last interval.
    whole: Vector<f64>,
    last: Vector<f64>,
    /// That interval.
    time: f64,
}

/// All forecasts from one frame.
pub(super) struct Row {
    frame: usize,
    /// The cells that are scored at each horizon.
    seen: Vec<Vec<Moved>>,
    /// Part of the field of each cell.
    part: Vec<usize>,
    of_parts: Vec<Vec<Seen>>,
    /// By who says it, horizon, and part.
    said: Vec<Vec<Vec<Squares>>>,
    position_noise: f64,
}

impl Row {
    pub fn new(start: &Start<'_>, ahead: &Ahead<'_>) -> Self {
        let frames = ahead.movie.frames();
        let part = parts(start);
        let of_horizon = |h: usize| {
            let to = start.frame + h;
            if to >= frames {
                return Vec::new();
            }
            let of_cell = |cell: usize| {
                let whole = start.displacement(cell, start.frame, to)?;
                let last = start.displacement(cell, to - 1, to)?;
                Some(Moved { cell, whole, last, time: start.time(to - 1, to) })
            };
            start.scored().filter_map(of_cell).collect()
        };
        let seen: Vec<Vec<Moved>> = (1..=ahead.horizon).map(of_horizon).collect();
        let of_parts = seen
            .iter()
            .map(|all| {
                let mut parts = vec![Seen::default(); PARTS * PARTS];
                for Moved { cell, whole, last, time } in all {
                    let own = &mut parts[part[*cell]];
                    own.squares[0] += whole.norm_squared();
                    own.squares[1] += (last / *time).norm_squared();
                    own.count += 1;
                }
                parts
            })
            .collect();
        Self {
            frame: start.frame,
            seen,
            part,
            of_parts,
            said: Vec::new(),
            position_noise: ahead.noise.position,
        }
    }

    /// Scores one who says how far cells go.
    pub fn push(&mut self, (displacements, variances): Said) {
        let mut all = Vec::with_capacity(self.seen.len());
        for (h, seen) in self.seen.iter().enumerate() {
            let mut parts = vec![Squares::default(); PARTS * PARTS];
            for Moved { cell, whole, last, time } in seen {
                let own = &mut parts[self.part[*cell]];
                let said = displacements[h][*cell];
                let before = if h > 0 { displacements[h - 1][*cell] } else { Vector::zeros() };
                own.missed[0] += (whole - said).norm_squared();
                own.missed[1] += ((last - (said - before)) / *time).norm_squared();
                own.expected += match &variances {
                    Some(known) => 2.0 * (known[h][*cell] + self.position_noise.powi(2)),
                    None => f64::NAN,
                };
            }
            all.push(parts);
        }
        self.said.push(all);
    }
}

/// Quarters of the field about the middle of the cells.
fn parts(start: &Start<'_>) -> Vec<usize> {
    let positions = &start.cells.positions;
    let median = |axis: usize| {
        let mut all: Vec<f64> = positions.iter().map(|r| r[axis]).collect();
        all.sort_unstable_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let middle = [median(0), median(1)];
    positions.iter().map(|r| usize::from(r.x > middle[0]) + PARTS * usize::from(r.y > middle[1])).collect()
}

/// All scores.
pub(super) struct Tally<'a> {
    rows: &'a [Row],
    horizon: usize,
    models: usize,
    position_noise: f64,
}

impl<'a> Tally<'a> {
    pub fn new(rows: &'a [Row], ahead: &Ahead<'_>, models: usize) -> Self {
        Self { rows, horizon: ahead.horizon, models, position_noise: ahead.noise.position }
    }

    /// Displacements scored at each horizon.
    pub fn scored(&self) -> Vec<usize> {
        (0..self.horizon).map(|h| self.rows.iter().map(|row| row.seen[h].len()).sum()).collect()
    }

    /// Sums over groups: forecasts that share time or place are in one. Of each, what is seen and some sum over what is said.
    fn groups(
        &self,
        h: usize,
        of: impl Fn(&[Vec<Vec<Squares>>], usize) -> f64,
        which: usize,
    ) -> Vec<[f64; 2]> {
        let mut groups: Vec<[f64; 2]> = Vec::new();
        let mut end = 0;
        for row in self.rows.iter().filter(|row| !row.seen[h].is_empty()) {
            if groups.is_empty() || row.frame >= end {
                groups.extend([[0.0; 2]; PARTS * PARTS]);
                end = row.frame + h + 1;
            }
            let first = groups.len() - PARTS * PARTS;
            for part in 0..PARTS * PARTS {
                groups[first + part][0] += row.of_parts[h][part].squares[which];
                groups[first + part][1] += of(&row.said, part);
            }
        }
        groups.retain(|group| group[0] > 0.0);
        groups
    }

    /// One less a ratio of sums, with its standard error by leaving out one group at a time.
    fn share(groups: &[[f64; 2]]) -> WithError {
        let sum = groups.iter().fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
        let value = 1.0 - sum[1] / sum[0];
        let count = groups.len() as f64;
        if groups.len() < 3 || !value.is_finite() {
            return [value, f64::NAN];
        }
        let without: Vec<f64> =
            groups.iter().map(|own| 1.0 - (sum[1] - own[1]) / (sum[0] - own[0])).collect();
        let mean = without.iter().sum::<f64>() / count;
        let squares: f64 = without.iter().map(|own| (own - mean).powi(2)).sum();
        [value, ((count - 1.0) / count * squares).sqrt()]
    }

    fn shares(&self, who: usize, which: usize) -> Vec<WithError> {
        let of =
            |h: usize| Self::share(&self.groups(h, |said, part| said[who][h][part].missed[which], which));
        (0..self.horizon).map(of).collect()
    }

    pub fn skill(&self, who: usize, of: Forecast) -> Skill {
        let counts = self.scored();
        let per_cell = |value: fn(&Squares) -> f64| -> Vec<f64> {
            let of = |h: usize| {
                let all = self.rows.iter().flat_map(|row| &row.said[who][h]).map(value);
                (all.sum::<f64>() / counts[h] as f64).sqrt()
            };
            (0..self.horizon).map(of).collect()
        };
        let is_model = who < self.models;
        Skill {
            of,
            position: self.shares(who, 0),
            velocity: self.shares(who, 1),
            error: per_cell(|own| own.missed[0]),
            expected_error: per_cell(if is_model { |own| own.expected } else { |_| f64::NAN }),
        }
    }

    /// By how much the skill of one is above that of another, from the same displacements.
    pub fn gain(&self, of: usize, to: usize) -> Vec<WithError> {
        let at = |h: usize| {
            let less = |said: &[Vec<Vec<Squares>>], part: usize| {
                said[of][h][part].missed[0] - said[to][h][part].missed[0]
            };
            let [value, error] = Self::share(&self.groups(h, less, 0));
            [1.0 - value, error]
        };
        (0..self.horizon).map(at).collect()
    }

    /// Skill of who knows where the cells are going, but not how wrong they are seen to be there.
    pub fn best_possible(&self) -> Vec<f64> {
        let of = |h: usize| {
            let all = self.rows.iter().flat_map(|row| &row.of_parts[h]);
            let (squares, count) =
                all.fold((0.0, 0), |(squares, count), own| (squares + own.squares[0], count + own.count));
            1.0 - 2.0 * self.position_noise.powi(2) * count as f64 / squares
        };
        (0..self.horizon).map(of).collect()
    }
}
