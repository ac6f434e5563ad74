//! Motions as they would be measured: of sites, or of points on the way from sites to centroids.

use super::motions::Motion;
use super::objective::MovieObjective;
use super::placed::Placed;
use crate::Error;
use rayon::prelude::*;
use voronudge_geometry::Vector;

impl MovieObjective<'_> {
    /// The mean velocity of each motion between the points at which the cell would be measured, without the translation.
    ///
    /// # Errors
    /// [`Error::Geometry`] if cells end where they make no tessellation.
    pub fn seen_velocities(
        &self,
        placed: &Placed<'_>,
        displacements: &[f64],
    ) -> Result<Vec<Vector<f64>>, Error> {
        let motions = &self.states.motions;
        if self.movie.share() == 0.0 {
            let of_site = |motion: &Motion| self.mean_velocity(placed, motion, displacements);
            return Ok(motions.par_iter().map(of_site).collect());
        }
        let together: Vec<&[Motion]> = motions.chunk_by(|one, next| one.interval == next.interval).collect();
        let of_interval = |motions: &&[Motion]| self.seen_over(motions, placed, displacements);
        let found: Vec<Result<Vec<_>, Error>> = together.par_iter().map(of_interval).collect();
        Ok(found.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }

    /// Those of one interval. Cells that the model moves end where it says, others where they are in the next frame.
    fn seen_over(
        &self,
        motions: &[Motion],
        placed: &Placed<'_>,
        displacements: &[f64],
    ) -> Result<Vec<Vector<f64>>, Error> {
        let interval = motions[0].interval;
        let (drift, span) = (self.drift(interval, displacements), self.span(interval));
        let [first, last] = [0, 1].map(|end| &placed.instants[interval + end].0);
        let moved: Vec<Vector<f64>> = (motions.iter())
            .map(|motion| self.mean_velocity(placed, motion, displacements) * span + drift)
            .collect();
        let is_known = |moved: &Vector<f64>| moved.norm_squared().is_finite();
        let mut ends = last.positions.clone();
        for (motion, moved) in motions.iter().zip(&moved).filter(|(_, moved)| is_known(moved)) {
            ends[motion.cells[1] as usize] = first.positions[motion.cells[0] as usize] + moved;
        }
        let cells = |end: usize| &self.states.instants[interval + end].cells;
        let tessellation =
            cells(1).moved_to(&ends).map_err(|source| Error::Geometry { frame: interval + 1, source })?;
        let from = cells(0).seen_from(&first.tessellation, &first.positions);
        let to = cells(1).seen_from(&tessellation, &ends);
        let velocity = |(motion, moved): (&Motion, &Vector<f64>)| {
            // Where nothing is known of the site, nothing is of the centroid.
            let seen = to[motion.cells[1] as usize] - from[motion.cells[0] as usize];
            (if is_known(moved) { seen } else { *moved } - drift) / span
        };
        Ok(motions.iter().zip(&moved).map(velocity).collect())
    }
}
