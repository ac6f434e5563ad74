//! Parts of large frames, from which it is found out first how cells were measured.
//!
//! What the noise levels are, and what a position is, takes some thousand cells; frames of many more are fitted once that is known.

use crate::objective::Patches;
use crate::{Error, Observation};

/// The same frames with a part in place of each large one; `None` if there is none.
pub(crate) fn excerpts(frames: &[Observation]) -> Result<Option<Vec<Observation>>, Error> {
    let patches: Vec<Option<Patches>> = frames.iter().map(Patches::of).collect();
    if patches.iter().all(Option::is_none) {
        return Ok(None);
    }
    let part = |(frame, patches): (&Observation, &Option<Patches>)| {
        let told = |cells: &&Vec<usize>| cells.iter().filter(|cell| frame.target(**cell).is_some()).count();
        match patches.iter().flat_map(|own| &own.cells).max_by_key(told) {
            Some(cells) => frame.excerpt(cells),
            None => Ok(frame.clone()),
        }
    };
    frames.iter().zip(&patches).map(part).collect::<Result<_, _>>().map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::Nudged;
    use crate::sample::{COEFFICIENTS, observation_of};
    use voronudge_model::Structure;

    /// The velocities of an excerpt are those that its own cells have.
    #[test]
    fn excerpts_are_fields_of_view_of_their_own() {
        let small = observation_of(20, 0.0, 0.0, 1);
        assert!(excerpts(std::slice::from_ref(&small)).unwrap().is_none());
        let found = excerpts(&[small, observation_of(92, 0.0, 0.0, 1)]).unwrap().unwrap();
        assert_eq!(found[0].positions.len(), 400);
        let part = &found[1];
        assert!((1500..=2500).contains(&part.positions.len()));
        let structure = Structure::base(1.0);
        let predicted = Nudged::as_measured(part, &structure).velocities(&COEFFICIENTS);
        let targets: Vec<_> = part.targets().collect();
        assert!(targets.len() > part.positions.len() * 3 / 4, "{}", targets.len());
        assert!(targets.iter().all(|(cell, v)| (v - predicted[*cell]).norm() < 1e-10));
        assert!(targets.iter().all(|(cell, _)| part.may_have_polygon(*cell)));
        assert!((0..part.positions.len()).any(|cell| !part.may_have_polygon(cell)));
    }
}
