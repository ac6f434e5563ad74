//! Which motions of a movie a model explains.

use super::instants::{ABSENT, Instant, Interval, indices};
use super::movie::Movie;
use crate::Observation;
use voronudge_geometry::Visibility;

/// One cell over the time between two frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    /// Frame at the beginning.
    pub interval: usize,
    /// Number of the track.
    pub track: u32,
    /// Index among the cells of both frames.
    pub cells: [u32; 2],
    /// Index among the cells of the interval.
    pub between: u32,
}

/// Which motions a model explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Explained {
    /// Those of cells that have the same certain surroundings from beginning to end: what a model is fitted to.
    Certain,
    /// Those of all cells with a polygon: to see how they move where the model is known.
    All,
}

/// The motions over one interval that the model can explain: of cells whose surroundings are certain at both frames and half-way, and, unless all are wanted,
/// are the same cells from beginning to end, as are those of their neighbours.
pub(super) fn motions(
    movie: &Movie,
    interval: usize,
    (instants, between): (&[Instant], &Interval),
    which: Explained,
) -> Vec<Motion> {
    let [first, last] = [&instants[interval], &instants[interval + 1]];
    let of_both: Vec<u32> = between.ends.iter().map(|ends| first.tracks[ends[0] as usize]).collect();
    let all: [(&Observation, &[u32]); 3] =
        [(&first.cells, &first.tracks), (&last.cells, &last.tracks), (&between.halfway, &of_both)];
    let index = all.map(|(_, tracks)| indices(movie, tracks.iter().copied()));
    let stays = |track: u32| index.iter().all(|own| own[track as usize] != ABSENT);
    // Cells whose polygon lacks a neighbour at some time.
    let mut doubtful = vec![false; movie.tracks.len()];
    for (cells, tracks) in &all {
        for (cell, track) in tracks.iter().enumerate() {
            let neighbours = cells.tessellation.neighbours(cell);
            doubtful[*track as usize] |=
                !(stays(*track) && neighbours.iter().all(|n| stays(tracks[*n as usize])));
        }
    }
    let is_explained = |track: &u32| {
        all.iter().zip(&index).all(|((cells, tracks), own)| {
            let cell = own[*track as usize];
            let certain = |n: &u32| !doubtful[tracks[*n as usize] as usize];
            cell != ABSENT
                && cells.visibility[cell as usize] == Visibility::Counted
                && (which == Explained::All
                    || !doubtful[*track as usize]
                        && cells.tessellation.neighbours(cell as usize).iter().all(certain))
        })
    };
    (0..movie.tracks.len() as u32)
        .filter(is_explained)
        .map(|track| {
            let [begin, end, between] = [0, 1, 2].map(|time: usize| index[time][track as usize]);
            Motion { interval, track, cells: [begin, end], between }
        })
        .collect()
}

/// Which cells of each frame have a motion to or from there.
pub(super) fn explained(instants: &[Instant], motions: &[Motion]) -> Vec<Vec<bool>> {
    let mut explained: Vec<Vec<bool>> =
        instants.iter().map(|instant| vec![false; instant.tracks.len()]).collect();
    for motion in motions {
        for (end, cell) in motion.cells.iter().enumerate() {
            explained[motion.interval + end][*cell as usize] = true;
        }
    }
    explained
}

#[cfg(test)]
mod tests {
    use super::super::movie::{Drift, Movie};
    use super::super::sample::Filmed;
    use super::super::states::States;
    use super::*;
    use voronudge_geometry::FieldOfView;

    /// Where tracks end, a model is not fitted to the motions around; but of all cells with a polygon that go on it can be told how they crawl.
    #[test]
    fn all_motions_are_those_of_cells_that_go_on() {
        let (mut film, domain, _) = Filmed { size: [100, 3], step: 0.1, error: 0.01, seed: 4 }.film();
        let lost = |cell: &usize| cell.is_multiple_of(10);
        (0..100).filter(lost).for_each(|cell| film[2][cell] = None);
        let times = vec![0.0, 0.1, 0.2];
        let movie = Movie::new(times, &film, domain, FieldOfView::default(), Drift::None).unwrap();
        let in_last = |which| {
            let states = States::of(&movie, which).unwrap();
            let own = states.motions.iter().filter(|motion| motion.interval == 1).count();
            (own, states.crawling(&movie, 4))
        };
        let ((all, crawling), (certain, _)) = (in_last(Explained::All), in_last(Explained::Certain));
        assert_eq!(all, 90);
        assert!(certain < 60, "{certain}");
        assert!(crawling.polarities.block[2].iter().all(|block| *block != super::super::polarities::NONE));
    }
}
