//! A linearised problem solved: what is least, draws of the unknowns about it, and forms that are quadratic in these.
//!
//! With all unknowns z = (u, β) and M half the second derivative of the sum of squares Q, of which weights and stiffness hold a part,
//! derivatives by a parameter t_i of these are
//!
//! ```text
//! (min Q)_i = Q_i(ẑ)            (min Q)_ij = Q_ij(ẑ) − 2 r_iᵀ M⁻¹ r_j,            r_i = −½ ∂Q_i/∂z at ẑ
//! (log det M)_i = tr M⁻¹M_i     (log det M)_ij ≈ tr M⁻¹M_ij − tr A⁻¹A_i A⁻¹A_j
//! ```
//!
//! Traces of M⁻¹ are those of draws `x = L⁻ᵀz` of u, with random signs z (Hutchinson 1990), and of what β adds: exact, because it is few. A is
//! M without β, whose part in the last term is left out.

use super::freedom::SEED;
use super::{Held, Linearisation, product};
use crate::Error;
use crate::diagnostics::random_signs;
use crate::rows::{Group, from_lanes, to_lanes};
use crate::stiffness::Stiffness;
use crate::whitened::Leftover;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use voronudge_linalg::DissectedCholesky;

/// Right-hand sides per task.
const TOGETHER: usize = 8;

/// What multiplies data and unknowns: or, of a direction, by how much that changes.
#[derive(Debug, Clone)]
pub(crate) struct Weighting {
    /// k
    pub spring: f64,
    pub held: Held,
}

impl Weighting {
    /// The derivative between two, by a parameter of which they are so far apart.
    pub fn slope(before: &Self, after: &Self, apart: f64) -> Self {
        let of = |before: &f64, after: &f64| (after - before) / apart;
        let all = |before: &[f64], after: &[f64]| before.iter().zip(after).map(|(b, a)| of(b, a)).collect();
        let [b, a] = [before, after].map(|own| &own.held.stiffness);
        let couplings = b.couplings.iter().zip(&a.couplings).map(|(b, a)| (b.0, b.1, of(&b.2, &a.2)));
        Self {
            spring: of(&before.spring, &after.spring),
            held: Held {
                weights: all(&before.held.weights, &after.held.weights),
                stiffness: Stiffness {
                    of_blocks: all(&b.of_blocks, &a.of_blocks),
                    couplings: couplings.collect(),
                },
            },
        }
    }

    /// Weights of positions and of what is known beforehand.
    fn of_groups(&self) -> impl Iterator<Item = f64> {
        std::iter::once(self.spring).chain(self.held.weights.iter().copied())
    }
}

/// A linear function of a weighting: `Σ_g w_g c_g + Σ_b a_b d_b − 2 Σ s_bc e_bc`.
#[derive(Debug, Clone)]
pub(crate) struct Form {
    of_groups: Vec<f64>,
    of_blocks: Vec<f64>,
    of_couplings: Vec<f64>,
}

impl Form {
    pub fn of(&self, weighting: &Weighting) -> f64 {
        let Stiffness { of_blocks, couplings } = &weighting.held.stiffness;
        let of_groups: f64 = self.of_groups.iter().zip(weighting.of_groups()).map(|(c, w)| c * w).sum();
        let of_blocks: f64 = self.of_blocks.iter().zip(of_blocks).map(|(d, a)| d * a).sum();
        let of_couplings: f64 = self.of_couplings.iter().zip(couplings).map(|(e, s)| e * s.2).sum();
        of_groups + of_blocks - 2.0 * of_couplings
    }
}

/// All unknowns, or one value for each.
struct Whole {
    own: Vec<f64>,
    free: DVector<f64>,
}

/// The solution for one weighting.
pub(crate) struct Solved<'a> {
    frame: &'a Linearisation,
    stiffness: Stiffness,
    /// The kinds of data that a weight multiplies.
    parts: Vec<&'a Group>,
    factor: DissectedCholesky,
    /// A⁻¹JᵀX (n × p)
    by_free: Vec<f64>,
    /// R with RRᵀ = (XᵀW⁻¹X)⁻¹
    root: DMatrix<f64>,
    least: Whole,
    pub leftover: Leftover,
}

impl Linearisation {
    /// Solves it for some weighting.
    ///
    /// # Errors
    /// [`Error::Degenerate`] if the data do not determine the coefficients; [`Error::Algebra`].
    pub fn solved(&self, at: &Weighting) -> Result<Solved<'_>, Error> {
        let (factor, mut by_free, whitened) = self.eliminate_data(at.spring, &at.held)?;
        let (n, p) = (self.order(), whitened.mixed.len());
        let own = by_free.split_off(n * p);
        let lower = whitened.free.clone().cholesky().ok_or(Error::Degenerate)?;
        let root = lower.l().transpose().try_inverse().ok_or(Error::Degenerate)?;
        let free = lower.solve(&whitened.mixed);
        let mut least = Whole { own, free };
        subtract(&mut least.own, &by_free, &least.free);
        let parts = std::iter::once(&self.positions).chain(&self.known).collect();
        let (leftover, stiffness) = (whitened.restricted()?, at.held.stiffness.clone());
        Ok(Solved { frame: self, stiffness, parts, factor, by_free, root, least, leftover })
    }
}

impl Solved<'_> {
    fn order(&self) -> usize {
        self.frame.order()
    }

    /// Q at the solution.
    pub fn rests(&self) -> Form {
        let mut form = self.form(&self.least);
        let (n, p) = (self.order(), self.least.free.len());
        for (sum, group) in form.of_groups.iter_mut().zip(&self.parts) {
            let with_data: f64 = dot(&group.mixed[n * p..], &self.least.own);
            *sum += group.data - 2.0 * (with_data + group.free_data.dot(&self.least.free));
        }
        form
    }

    /// Draws of u for given coefficients (n for each).
    pub fn draws(&self, count: usize) -> Vec<f64> {
        let mut generator = Pcg64::seed_from_u64(SEED);
        let mut draws = vec![1.0; count * self.order()];
        random_signs::draw(&mut generator, &mut draws);
        draws.par_chunks_mut(TOGETHER * self.order()).for_each(|some| self.factor.draw(some));
        draws
    }

    /// tr M⁻¹M, from draws.
    pub fn trace(&self, draws: &[f64]) -> Form {
        let p = self.least.free.len();
        let of_free = self.root.column_iter().map(|column| {
            let mut own = vec![0.0; self.order()];
            subtract(&mut own, &self.by_free, &column.into_owned());
            (1.0, Whole { own, free: column.into_owned() })
        });
        let count = draws.len() / self.order();
        let random = draws
            .chunks_exact(self.order())
            .map(|own| (1.0 / count as f64, Whole { own: own.to_vec(), free: DVector::zeros(p) }));
        let all: Vec<(f64, Whole)> = of_free.chain(random).collect();
        let forms: Vec<Form> = all.par_iter().map(|(_, own)| self.form(own)).collect();
        let sum = |of: fn(&Form) -> &[f64]| {
            let mut sum = vec![0.0; forms.first().map_or(0, |form| of(form).len())];
            for (form, (share, _)) in forms.iter().zip(&all) {
                sum.iter_mut().zip(of(form)).for_each(|(sum, own)| *sum += share * own);
            }
            sum
        };
        Form {
            of_groups: sum(|form| &form.of_groups),
            of_blocks: sum(|form| &form.of_blocks),
            of_couplings: sum(|form| &form.of_couplings),
        }
    }

    /// `r_iᵀM⁻¹r_j` of some directions.
    pub fn responses(&self, directions: &[Weighting]) -> DMatrix<f64> {
        let (n, p) = (self.order(), self.least.free.len());
        let rests: Vec<Whole> = directions.iter().map(|direction| self.pull(direction)).collect();
        let own: Vec<f64> = rests.iter().flat_map(|rest| rest.own.iter().copied()).collect();
        let solved = self.solve(own.clone());
        let of_free = |rest: &Whole| {
            let by_free = DVector::from_fn(p, |k, _| dot(&self.by_free[k * n..(k + 1) * n], &rest.own));
            self.root.tr_mul(&(&rest.free - by_free))
        };
        let of_free: Vec<DVector<f64>> = rests.iter().map(of_free).collect();
        DMatrix::from_fn(directions.len(), directions.len(), |i, j| {
            product(&own, &solved, n, i, j) + of_free[i].dot(&of_free[j])
        })
    }

    /// `tr A⁻¹A_i A⁻¹A_j` of some directions, from draws. What β adds is left out.
    pub fn products(&self, directions: &[Weighting], draws: &[f64]) -> DMatrix<f64> {
        let (n, m) = (self.order(), directions.len());
        let pairs: Vec<(&[f64], &Weighting)> =
            draws.chunks_exact(n).flat_map(|draw| directions.iter().map(move |own| (draw, own))).collect();
        let own: Vec<f64> =
            pairs.par_iter().flat_map_iter(|(draw, own)| self.held_times(own, draw)).collect();
        let solved = self.solve(own.clone());
        let count = draws.len() / n;
        let of = |i: usize, j: usize| -> f64 {
            (0..count).map(|draw| product(&own, &solved, n, draw * m + i, draw * m + j)).sum()
        };
        DMatrix::from_fn(m, m, |i, j| of(i.min(j), i.max(j)) / count as f64)
    }

    /// A⁻¹ times some vectors.
    fn solve(&self, mut right: Vec<f64>) -> Vec<f64> {
        right.par_chunks_mut(TOGETHER * self.order()).for_each(|some| self.factor.solve(some));
        right
    }

    /// The part of A that a direction changes, times a vector.
    fn held_times(&self, direction: &Weighting, u: &[f64]) -> Vec<f64> {
        let u = to_lanes::<1>(u, u.len());
        let (mut sum, mut room) = (vec![[[0.0]; 2]; u.len()], Vec::new());
        direction.held.stiffness.add_products(&u, &mut sum);
        for (group, weight) in self.parts.iter().zip(direction.of_groups()).filter(|(_, w)| *w != 0.0) {
            group.add_products(weight, &u, &mut sum, &mut room);
        }
        from_lanes(&sum, 1)
    }

    /// r of a direction.
    fn pull(&self, direction: &Weighting) -> Whole {
        let (n, p) = (self.order(), self.least.free.len());
        let Whole { own: u, free } = &self.least;
        let mut own = self.held_times(direction, u);
        own.iter_mut().for_each(|own| *own = -*own);
        let mut of_free = DVector::zeros(p);
        for (group, weight) in self.parts.iter().zip(direction.of_groups()) {
            for (k, column) in group.mixed.chunks_exact(n.max(1)).enumerate() {
                // The last column is that of the data.
                let factor = if k < p { -free[k] } else { 1.0 };
                own.iter_mut().zip(column).for_each(|(own, mixed)| *own += weight * factor * mixed);
                if k < p {
                    of_free[k] -= weight * dot(column, u);
                }
            }
            of_free += (&group.free_data - &group.free_normal * free) * weight;
        }
        Whole { own, free: of_free }
    }

    /// The sum of squares that some unknowns have without data.
    fn form(&self, at: &Whole) -> Form {
        let (n, p) = (self.order(), at.free.len());
        let own = to_lanes::<1>(&at.own, n);
        let of_group = |group: &&Group| {
            let Group { mixed, free_normal, .. } = *group;
            let cross: f64 = (0..p).map(|k| at.free[k] * dot(&mixed[k * n..(k + 1) * n], &at.own)).sum();
            group.square(&own) + 2.0 * cross + at.free.dot(&(free_normal * &at.free))
        };
        let block = |b: u32| [at.own[2 * b as usize], at.own[2 * b as usize + 1]];
        let pair = |b: u32, c: u32| dot(&block(b), &block(c));
        Form {
            of_groups: self.parts.iter().map(of_group).collect(),
            of_blocks: (0..self.stiffness.of_blocks.len() as u32).map(|b| pair(b, b)).collect(),
            of_couplings: self.stiffness.couplings.iter().map(|(b, c, _)| pair(*b, *c)).collect(),
        }
    }
}

/// Takes some columns times a factor each off a vector.
fn subtract(from: &mut [f64], columns: &[f64], factors: &DVector<f64>) {
    for (column, factor) in columns.chunks_exact(from.len().max(1)).zip(factors.iter()) {
        from.iter_mut().zip(column).for_each(|(own, column)| *own -= factor * column);
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(x, y)| x * y).sum()
}
