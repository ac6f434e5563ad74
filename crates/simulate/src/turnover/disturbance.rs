//! How much a birth changes velocities at once.

use super::places::Places;
use super::{Injection, LivingTissue};
use crate::Error;
use crate::driving::stream;

impl LivingTissue {
    /// How much one birth would change the velocities at this moment, for each of a number of draws of its place (in the unit of
    /// velocities): the largest `|v′ − v|` over the cells, or the speed of the new cell if that is larger.
    ///
    /// The tissue stays as it is. Births beside a mother are drawn with the weight of births at her place, births on vertices with that
    /// of theirs.
    ///
    /// # Errors
    /// [`Error::Turnover`] for a distance that is not positive; [`Error::Tessellation`] if a new cell lies on another.
    pub fn birth_disturbance(
        &self,
        injection: Injection,
        draws: usize,
        seed: u64,
    ) -> Result<Vec<f64>, Error> {
        injection.check()?;
        let mut rng = stream(seed, self.simulation.state().steps, u64::MAX - 1);
        let length = self.turnover.proliferation_length();
        let before = self.simulation.velocities();
        (0..draws)
            .map(|_| {
                let births = Places::new(self, &[], 1, 0.0).by(injection).weighted(length, &mut rng)?;
                let mut positions = self.simulation.positions().to_vec();
                positions.extend(births.iter().map(|birth| birth.place));
                let mut headings = self.simulation.state().headings.clone();
                headings.extend(headings.first().copied());
                let mut after = self.simulation.clone();
                after.replace_cells(positions, headings)?;
                let velocities = after.velocities();
                let changes = velocities.iter().zip(before).map(|(v, before)| (v - before).norm());
                let own = velocities[before.len()..].iter().map(|v| v.norm());
                Ok(changes.chain(own).fold(0.0, f64::max))
            })
            .collect()
    }
}
