//! Small dense convex quadratic programs, and the likelihood-ratio intervals that follow from them.
//!
//! ```text
//! Q(β) = (β − β̂)ᵀ H (β − β̂),    subject to  n_iᵀ β ≥ b_i
//! ```
//!
//! In coordinates z with `β = β̂ + W z`, `W Wᵀ = H⁻¹`, lengths are standard errors and Q is `|z|²`. Few coefficients and
//! few constraints allow to visit every set of active constraints: each leaves a flat, on which the point nearest to
//! the centre and the extremes over a ball have closed forms. Results are thus exact, and independent of scales.

mod functional;

pub use functional::{Functional, Ratio};

use crate::Error;
use nalgebra::{DMatrix, DVector};

/// Violation of a constraint that counts as rounding, relative to its distance, in standard errors.
const TOLERANCE: f64 = 1e-10;

/// Sine of the angle below which the normal of a constraint counts as dependent on others.
const DEPENDENT: f64 = 1e-9;

/// Denominators that count as zero, relative to the largest.
const ZERO: f64 = 1e-12;

/// `Q(β) = (β − β̂)ᵀ H (β − β̂)`, where H is positive definite and of small order.
#[derive(Debug, Clone)]
pub struct Quadratic {
    centre: DVector<f64>,
    /// `W` with `W Wᵀ = H⁻¹`
    root: DMatrix<f64>,
}

/// `nᵀ β ≥ b`.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfSpace {
    /// `n`, not zero.
    pub normal: DVector<f64>,
    /// `b`
    pub bound: f64,
}

/// `nᵀ β = v`.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperplane {
    /// `n`, not zero.
    pub normal: DVector<f64>,
    /// `v`
    pub value: f64,
}

/// Where a quadratic is least.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// β
    pub at: DVector<f64>,
    /// `Q(β)`
    pub value: f64,
    /// Indices of the inequalities that hold β back, ascending.
    pub active: Vec<usize>,
}

/// An interval, unbounded where there is no number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lower: Option<f64>,
    /// Upper end.
    pub upper: Option<f64>,
}

/// A constraint in coordinates z: `mᵀ z ≥ d` with `|m| = 1`, so d is its distance from the centre.
struct Wall {
    normal: DVector<f64>,
    distance: f64,
}

impl Wall {
    fn admits(&self, z: &DVector<f64>) -> bool {
        self.normal.dot(z) >= self.distance - TOLERANCE * (1.0 + self.distance.abs())
    }
}

/// The points on some walls.
struct Flat {
    /// Its point nearest to the centre.
    nearest: DVector<f64>,
    /// Orthonormal directions that leave it.
    across: Vec<DVector<f64>>,
}

impl Flat {
    fn everything(dimension: usize) -> Self {
        Self { nearest: DVector::zeros(dimension), across: Vec::new() }
    }

    /// The part of `v` parallel to the flat.
    fn along(&self, v: &DVector<f64>) -> DVector<f64> {
        let mut rest = v.clone();
        // The second pass removes what rounding leaves after the first.
        for q in self.across.iter().chain(&self.across) {
            let amount = q.dot(&rest);
            rest.axpy(-amount, q, 1.0);
        }
        rest
    }

    /// The points that are also on `wall`, unless its normal depends on those before.
    fn cut(&self, wall: &Wall) -> Option<Self> {
        let along = self.along(&wall.normal);
        let sine = along.norm();
        if sine < DEPENDENT {
            return None;
        }
        let q = along / sine;
        let nearest = &self.nearest + &q * ((wall.distance - wall.normal.dot(&self.nearest)) / sine);
        let mut across = self.across.clone();
        across.push(q);
        Some(Self { nearest, across })
    }

    /// Visits the flats of all sets of independent walls; no supersets where `visit` returns false.
    fn walk<F>(&self, walls: &[Wall], active: &mut Vec<usize>, visit: &mut F)
    where
        F: FnMut(&Self, &[usize]) -> bool,
    {
        if !visit(self, active) {
            return;
        }
        for index in active.last().map_or(0, |last| last + 1)..walls.len() {
            if let Some(flat) = self.cut(&walls[index]) {
                active.push(index);
                flat.walk(walls, active, visit);
                active.pop();
            }
        }
    }
}

/// `cᵀβ` as a function of z: value at the centre and gradient.
struct Linear {
    value: f64,
    gradient: DVector<f64>,
}

impl Linear {
    /// Differences within rounding are zero, so that an end at a bound of zero is exactly there.
    fn at(&self, z: &DVector<f64>) -> f64 {
        let change = self.gradient.dot(z);
        let value = self.value + change;
        if value.abs() <= ZERO * (self.value.abs() + change.abs()) { 0.0 } else { value }
    }

    /// The part of the gradient along a flat: zero, if the function is constant on it.
    fn along(&self, flat: &Flat) -> DVector<f64> {
        let along = flat.along(&self.gradient);
        let constant = along.norm() <= DEPENDENT * self.gradient.norm();
        if constant { DVector::zeros(along.len()) } else { along }
    }

    /// Magnitude below which values within the ball `|z|² ≤ level` are rounding.
    fn rounding(&self, level: f64) -> f64 {
        ZERO * (self.value.abs() + level.sqrt() * self.gradient.norm())
    }
}

/// The points between walls with `|z|² ≤ level`: what the data and the constraints allow.
struct Allowed {
    walls: Vec<Wall>,
    level: f64,
}

impl Allowed {
    /// Visits the part of the ball on each flat: the flat and the squared radius of the part.
    fn walk(&self, start: &Flat, visit: &mut impl FnMut(&Flat, f64)) {
        start.walk(&self.walls, &mut Vec::new(), &mut |flat: &Flat, _: &[usize]| {
            let distance = flat.nearest.norm_squared();
            let meets = distance <= self.level * (1.0 + ZERO);
            if meets {
                visit(flat, (self.level - distance).max(0.0));
            }
            meets
        });
    }

    fn admits(&self, z: &DVector<f64>) -> bool {
        self.walls.iter().all(|wall| wall.admits(z))
    }

    /// Least and greatest value of a linear function; `None` if nothing is allowed.
    ///
    /// On a flat the extremes are at `z_A ± ρ w/|w|`, where w is the gradient's part along the flat and ρ the radius of
    /// the ball's part on it; or at `z_A`, if the function is constant on the flat.
    fn extremes(&self, start: &Flat, function: &Linear) -> Option<[f64; 2]> {
        let mut range: Option<[f64; 2]> = None;
        self.walk(start, &mut |flat, squared_radius| {
            let along = function.along(flat);
            let norm = along.norm();
            let step = if norm > 0.0 { squared_radius.sqrt() / norm } else { 0.0 };
            for reach in [-step, 0.0, step] {
                let z = &flat.nearest + &along * reach;
                if self.admits(&z) {
                    widen(&mut range, function.at(&z));
                }
            }
        });
        range
    }

    /// Least and greatest ratio where the denominator is positive, as far as they are attained.
    ///
    /// On a flat the extremes q are where the hyperplane `a − q b = 0` touches the ball (Fieller): with values A, B at
    /// z_A, parts u, v of the gradients along the flat and radius ρ,  `(A − q B)² = ρ² |u − q v|²`.
    fn extreme_ratios(&self, top: &Linear, bottom: &Linear) -> Option<[f64; 2]> {
        let least = bottom.rounding(self.level);
        let mut range: Option<[f64; 2]> = None;
        self.walk(&Flat::everything(top.gradient.len()), &mut |flat, squared_radius| {
            let (a, b) = (top.at(&flat.nearest), bottom.at(&flat.nearest));
            if b > least && self.admits(&flat.nearest) {
                widen(&mut range, a / b);
            }
            let (u, v) = (top.along(flat), bottom.along(flat));
            let roots = quadratic_roots(
                b * b - squared_radius * v.norm_squared(),
                a * b - squared_radius * u.dot(&v),
                a * a - squared_radius * u.norm_squared(),
            );
            for q in roots.into_iter().flatten() {
                let w = &u - &v * q;
                let z = &flat.nearest - &w * ((a - q * b) / w.norm_squared());
                let constant = w.norm() <= DEPENDENT * (&top.gradient - &bottom.gradient * q).norm();
                if !constant && bottom.at(&z) > least && self.admits(&z) {
                    widen(&mut range, q);
                }
            }
        });
        range
    }
}

fn widen(range: &mut Option<[f64; 2]>, value: f64) {
    let [low, high] = range.unwrap_or([value, value]);
    *range = Some([low.min(value), high.max(value)]);
}

/// Finite real roots of `a q² − 2 h q + c = 0`.
fn quadratic_roots(a: f64, h: f64, c: f64) -> [Option<f64>; 2] {
    let discriminant = h * h - a * c;
    if discriminant < 0.0 {
        return [None, None];
    }
    let sum = h + discriminant.sqrt().copysign(h);
    [sum / a, c / sum].map(|root| Some(root).filter(|root| root.is_finite()))
}

impl Quadratic {
    /// The quadratic with its least value, 0, at `centre`, and half its second derivative `hessian` (p × p).
    ///
    /// # Errors
    /// [`Error::Degenerate`] if the matrix is not positive definite.
    pub fn new(centre: DVector<f64>, hessian: &DMatrix<f64>) -> Result<Self, Error> {
        let p = centre.len();
        let scale: Vec<f64> = hessian.diagonal().iter().map(|d| d.sqrt()).collect();
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(Error::Degenerate);
        }
        let scaled = DMatrix::from_fn(p, p, |i, j| hessian[(i, j)] / (scale[i] * scale[j]));
        let lower = scaled.cholesky().ok_or(Error::Degenerate)?.unpack();
        let inverse = lower.solve_lower_triangular(&DMatrix::identity(p, p)).ok_or(Error::Degenerate)?;
        let root = DMatrix::from_fn(p, p, |i, j| inverse[(j, i)] / scale[i]);
        Ok(Self { centre, root })
    }

    /// The least value subject to inequalities and at most one equality; `None` if they contradict each other.
    pub fn minimise(&self, at_least: &[HalfSpace], equal: Option<&Hyperplane>) -> Option<Minimum> {
        let walls = self.walls(at_least);
        let everything = Flat::everything(self.centre.len());
        let start = match equal {
            Some(plane) => everything.cut(&self.wall(&plane.normal, plane.value))?,
            None => everything,
        };
        let mut least: Option<(DVector<f64>, f64, Vec<usize>)> = None;
        start.walk(&walls, &mut Vec::new(), &mut |flat: &Flat, active: &[usize]| {
            let value = flat.nearest.norm_squared();
            // Further walls only add to the distance.
            if least.as_ref().is_some_and(|least| value >= least.1) {
                return false;
            }
            let admitted = walls.iter().all(|wall| wall.admits(&flat.nearest));
            if admitted {
                least = Some((flat.nearest.clone(), value, active.to_vec()));
            }
            !admitted
        });
        least.map(|(z, value, active)| Minimum { at: &self.centre + &self.root * z, value, active })
    }

    /// The likelihood-ratio interval of a linear function, here `cᵀβ`: the values q with
    ///
    /// ```text
    /// min { Q(β) : cᵀβ = q, constraints } − min { Q(β) : constraints } ≤ threshold
    /// ```
    ///
    /// Without constraints it is `cᵀβ̂ ± √(threshold · cᵀH⁻¹c)`. Always bounded; `None` if the constraints contradict
    /// each other.
    pub fn linear_interval(
        &self,
        functional: &Functional,
        at_least: &[HalfSpace],
        threshold: f64,
    ) -> Option<Interval> {
        let allowed = self.allowed(at_least, threshold)?;
        let start = Flat::everything(self.centre.len());
        let [lower, upper] = allowed.extremes(&start, &self.linear(functional))?;
        Some(Interval { lower: Some(lower), upper: Some(upper) })
    }

    /// The likelihood-ratio interval of a ratio, defined as for [`Quadratic::linear_interval`]; Fieller's interval
    /// if there are no constraints.
    ///
    /// Unbounded at an end if the denominator may be zero there. If it may have either sign, every value or all but an
    /// interval are possible, and both ends are unbounded. `None` if the constraints contradict each other.
    pub fn ratio_interval(&self, ratio: &Ratio, at_least: &[HalfSpace], threshold: f64) -> Option<Interval> {
        let mut constraints = at_least.to_vec();
        if ratio.positive_denominator {
            constraints.extend(ratio.denominator.positive());
        }
        let allowed = self.allowed(&constraints, threshold)?;
        let everything = Flat::everything(self.centre.len());
        let (mut top, mut bottom) = (self.linear(&ratio.numerator), self.linear(&ratio.denominator));
        let [low, high] = allowed.extremes(&everything, &bottom)?;
        let zero = 10.0 * bottom.rounding(allowed.level);
        let unbounded = Interval { lower: None, upper: None };
        if low < -zero && high > zero {
            return Some(unbounded);
        }
        if high <= zero {
            // A ratio does not change if both its parts change sign.
            top = self.linear(&ratio.numerator.negative());
            bottom = self.linear(&ratio.denominator.negative());
        }
        let Some([lower, upper]) = allowed.extreme_ratios(&top, &bottom) else {
            return Some(unbounded);
        };
        let touches = low.abs().min(high.abs()) <= zero;
        let zero_plane = ratio.denominator.positive().filter(|_| touches);
        let at_zero = zero_plane.and_then(|half| everything.cut(&self.wall(&half.normal, half.bound)));
        let [below, above] = match at_zero.and_then(|flat| allowed.extremes(&flat, &top)) {
            Some([least, greatest]) => {
                let zero = 10.0 * top.rounding(allowed.level);
                [least < -zero, greatest > zero]
            }
            None => [false, false],
        };
        Some(Interval { lower: (!below).then_some(lower), upper: (!above).then_some(upper) })
    }

    fn allowed(&self, at_least: &[HalfSpace], threshold: f64) -> Option<Allowed> {
        let level = self.minimise(at_least, None)?.value + threshold;
        Some(Allowed { walls: self.walls(at_least), level })
    }

    fn linear(&self, functional: &Functional) -> Linear {
        Linear {
            value: functional.constant + functional.gradient.dot(&self.centre),
            gradient: self.root.tr_mul(&functional.gradient),
        }
    }

    fn wall(&self, normal: &DVector<f64>, bound: f64) -> Wall {
        let Linear { value, gradient } = self.linear(&normal.clone().into());
        let norm = gradient.norm();
        Wall { normal: gradient / norm, distance: (bound - value) / norm }
    }

    fn walls(&self, at_least: &[HalfSpace]) -> Vec<Wall> {
        at_least.iter().map(|half| self.wall(&half.normal, half.bound)).collect()
    }
}

#[cfg(test)]
mod tests;
