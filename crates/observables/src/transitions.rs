//! T1 transitions: exchanges of neighbours.

use voronudge_geometry::Tessellation;

/// Counts T1 transitions along a trajectory: contacts of a state that the state before did not have. Each transition makes
/// one contact and ends another.
///
/// Transitions there and back between two states are not seen. A contact that flickers counts each time it is made.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Tessellation, Vector};
/// use voronudge_observables::TransitionCounter;
/// let tissue = |shift: f64| {
///     let positions: Vec<_> =
///         (0..16).map(|i| Vector::new((i % 4) as f64 + shift * (i / 4 % 2) as f64, (i / 4) as f64)).collect();
///     Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new([4.0, 4.0])?))
/// };
/// let mut counter = TransitionCounter::default();
/// assert_eq!(counter.count(&tissue(0.1)?), 0);
/// assert_eq!(counter.count(&tissue(-0.1)?), 16); // each square's diagonal
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct TransitionCounter {
    before: Option<Tessellation>,
}

impl TransitionCounter {
    /// The transitions from the state given before to this one; none for the first.
    pub fn count(&mut self, now: &Tessellation) -> usize {
        match &mut self.before {
            Some(before) => {
                let count = new_contacts(before, now);
                before.clone_from(now);
                count
            }
            None => {
                self.before = Some(now.clone());
                0
            }
        }
    }
}

fn new_contacts(before: &Tessellation, now: &Tessellation) -> usize {
    let ends: usize = (0..now.len().min(before.len()))
        .map(|cell| {
            let had = |h: usize| {
                let contact = (now.neighbour(h), now.image(h));
                before.ring(cell).any(|g| (before.neighbour(g), before.image(g)) == contact)
            };
            now.ring(cell).filter(|&h| !had(h)).count()
        })
        .sum();
    ends / 2
}
