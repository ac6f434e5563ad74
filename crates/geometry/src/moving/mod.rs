//! The tessellation of cells that move: repaired by flips, which cost a tenth to a quarter of a tessellation anew.

mod diagonal;
mod exchange;
mod hull;
mod lawson;
pub(crate) mod repair;
mod scan;
mod splice;
mod split;
mod vertices;

use crate::{Domain, Error, PeriodicBox, Tessellation, Vector};
use rayon::prelude::*;
use repair::Repair;
use split::CHUNK;

/// Into how many parts a displacement is cut if it turns triangles over.
const PARTS: u32 = 4;

/// A tessellation that follows its cells.
///
/// After a small displacement most neighbours are the same. One pass over the cells finds the edges that are no longer
/// Delaunay edges; Lawson's flips repair them, with exact predicates. A displacement that turns a triangle over is made in
/// four parts; if that does not help, the tessellation is built anew. Each way gives the same arrays as
/// [`Tessellation::new`], so nothing depends on the path of the cells.
///
/// An open field is built anew where its hull changes, or four cells lie on a circle.
///
/// ```
/// use voronudge_geometry::{Domain, MovingTessellation, PeriodicBox, Renewal, Tessellation, Vector};
/// let mut positions: Vec<_> = (0..400)
///     .map(|i| Vector::new((i % 20) as f64 + 0.3 * (i as f64).sin(), (i / 20) as f64 + 0.3 * (2.0 * i as f64).cos()))
///     .collect();
/// let domain = Domain::Periodic(PeriodicBox::new([20.0, 20.0])?);
/// let mut moving = MovingTessellation::new(&positions, domain)?;
/// for (i, r) in positions.iter_mut().enumerate() {
///     *r += Vector::new((3.0 * i as f64).cos(), (5.0 * i as f64).sin()) * 0.05;
/// }
/// assert!(matches!(moving.renew(&positions)?, Renewal::Flipped(flips) if flips > 0));
/// assert_eq!(*moving.tessellation(), Tessellation::new(&positions, domain)?);
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MovingTessellation {
    tessellation: Tessellation,
    /// The positions that the tessellation is of.
    positions: Vec<Vector<f64>>,
    repair: Repair,
    /// Whether the tessellation is that of the positions.
    sound: bool,
}

/// How a tessellation was renewed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renewal {
    /// By this number of flips: zero if no neighbour has changed.
    Flipped(usize),
    /// Anew.
    Rebuilt,
}

impl MovingTessellation {
    /// Tessellates positions (N, in any unit).
    ///
    /// # Errors
    /// As [`Tessellation::new`].
    pub fn new(positions: &[Vector<f64>], domain: Domain) -> Result<Self, Error> {
        Ok(Self::of(Tessellation::new(positions, domain)?, positions))
    }

    /// Follows the cells from where a tessellation is of them (N).
    pub fn of(tessellation: Tessellation, positions: &[Vector<f64>]) -> Self {
        Self { tessellation, positions: positions.to_vec(), repair: Repair::default(), sound: true }
    }

    /// The tessellation of the positions given last.
    #[inline]
    pub fn tessellation(&self) -> &Tessellation {
        &self.tessellation
    }

    /// Gives the tessellation away.
    pub fn into_tessellation(self) -> Tessellation {
        self.tessellation
    }

    /// Follows the cells to new positions (N) in the same domain.
    ///
    /// # Errors
    /// As [`Tessellation::new`]. The tessellation must then be renewed before it is used again.
    pub fn renew(&mut self, positions: &[Vector<f64>]) -> Result<Renewal, Error> {
        self.renew_in(positions, self.tessellation.domain())
    }

    /// Follows the cells to new positions (N) while the box changes, as under shear.
    ///
    /// # Errors
    /// As [`MovingTessellation::renew`].
    pub fn renew_in(&mut self, positions: &[Vector<f64>], domain: Domain) -> Result<Renewal, Error> {
        let renewal = self.follow(positions, domain);
        self.sound = renewal.is_ok();
        self.positions.resize(positions.len(), Vector::zeros());
        let chunks = self.positions.par_chunks_mut(CHUNK).zip(positions.par_chunks(CHUNK));
        chunks.for_each(|(own, given)| own.copy_from_slice(given));
        renewal
    }

    fn follow(&mut self, positions: &[Vector<f64>], domain: Domain) -> Result<Renewal, Error> {
        let before = self.tessellation.domain();
        if self.sound && positions.len() == self.tessellation.len() {
            self.tessellation.set_domain(domain);
            if let Some(flips) = self.repair.attempt(&mut self.tessellation, positions) {
                return Ok(Renewal::Flipped(flips));
            }
            if let Some(flips) = self.follow_in_parts(positions, before, domain) {
                return Ok(Renewal::Flipped(flips));
            }
        }
        self.tessellation.set_domain(domain);
        self.tessellation.renew(positions)?;
        Ok(Renewal::Rebuilt)
    }

    /// Goes to the new positions by equal parts of the displacement.
    fn follow_in_parts(&mut self, to: &[Vector<f64>], before: Domain, after: Domain) -> Option<usize> {
        let (Domain::Periodic(before), Domain::Periodic(after)) = (before, after) else {
            return None;
        };
        let mut flips = 0;
        let mut between = Vec::with_capacity(to.len());
        for part in 1..=PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            let here = if part == PARTS {
                between.clear();
                between.extend_from_slice(to);
                after
            } else {
                between.clear();
                between.extend(self.positions.iter().zip(to).map(|(from, to)| from + (to - from) * share));
                let mix = |from: f64, to: f64| from + (to - from) * share;
                let lengths = [0, 1].map(|axis| mix(before.lengths()[axis], after.lengths()[axis]));
                PeriodicBox::sheared(lengths, mix(before.offset(), after.offset())).ok()?
            };
            self.tessellation.set_domain(Domain::Periodic(here));
            flips += self.repair.attempt(&mut self.tessellation, &between)?;
        }
        Some(flips)
    }
}
