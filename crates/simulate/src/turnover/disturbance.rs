//! How much a birth changes velocities at once.

use super::places::Places;
use super::{Injection, LivingTissue};
use crate::Error;
use crate::driving::stream;

impl LivingTissue {
    /// How much one birth would change the velocities at this moment, for each of a number of draws of its place (in the unit of
    /// velocities): the largest `|v′ − v|` over the cells, or the speed of the new cell if that is larger.
    ///
    /// The tissue stays as it is. Births beside a mother, and divisions in two, are drawn with the weight of births at her place, births on vertices with that
    /// of theirs. Only cells with cycles divide in two, near the end of one.
    ///
    /// # Errors
    /// [`Error::Turnover`] for a distance that is not positive; [`Error::NoPlace`] for divisions in two where cells have no cycles; [`Error::Tessellation`] if a new cell lies on another.
    pub fn birth_disturbance(
        &self,
        injection: Injection,
        draws: usize,
        seed: u64,
    ) -> Result<Vec<f64>, Error> {
        injection.check()?;
        if matches!(injection, Injection::Cycle(_)) && self.cycles.is_empty() {
            return Err(Error::NoPlace { time: self.simulation.time(), births: 1, time_step: 0.0 });
        }
        let mut rng = stream(seed, self.simulation.state().steps, u64::MAX - 1);
        let length = self.turnover.proliferation_length();
        let before = self.simulation.velocities();
        (0..draws)
            .map(|_| {
                let mut places = Places::new(self, &[], 1, 0.0).by(injection);
                let births = match injection {
                    Injection::Cycle(cycle) => vec![places.in_two_near_the_end(cycle, length, &mut rng)?],
                    _ => places.weighted(length, &mut rng)?,
                };
                let mut positions = self.simulation.positions().to_vec();
                positions.extend(births.iter().map(|birth| birth.place));
                let mut headings = self.simulation.state().headings.clone();
                headings.extend(headings.first().copied());
                let mut after = self.simulation.clone();
                let mut cycles = self.cycles.clone();
                if let Injection::Cycle(cycle) = self.turnover.injection {
                    cycles.push(cycle.newborn(&mut rng));
                    for birth in &births {
                        if let (Some(mother), Some(place)) = (birth.mother, birth.sister) {
                            positions[mother] = place;
                            cycles[mother] = cycle.newborn(&mut rng);
                        }
                    }
                    after.replace_cells_with(positions, headings, cycle.factors(&cycles))?;
                } else {
                    after.replace_cells(positions, headings)?;
                }
                let velocities = after.velocities();
                let changes = velocities.iter().zip(before).map(|(v, before)| (v - before).norm());
                let own = velocities[before.len()..].iter().map(|v| v.norm());
                Ok(changes.chain(own).fold(0.0, f64::max))
            })
            .collect()
    }
}
