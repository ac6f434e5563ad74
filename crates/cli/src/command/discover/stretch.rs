//! Which frames of a long movie are searched.

use crate::run::Run;
use ndarray::{Array3, ArrayView2};
use std::ops::Range;

/// Motions from one frame to the next that a search takes, where nobody says which frames it is to take; and the fewest frames for all that.
const MOST_MOTIONS: usize = 5000;
const FEWEST_FRAMES: usize = 4;

/// The frames around the middle of a movie that a search can take in minutes, said where these are not all.
///
/// Mean velocities from each frame to the next (frames, cells, 2) are numbers where a cell was followed.
pub(super) fn middle(means: &Array3<f64>, run: &mut Run) -> Range<usize> {
    let followed = |frame: ArrayView2<'_, f64>| frame.rows().into_iter().filter(|v| v[0].is_finite()).count();
    let mut motions: Vec<usize> = means.outer_iter().map(followed).collect();
    // None leads out of the last frame.
    let all = motions.len();
    motions.truncate(all - 1);
    let intervals = around_middle(&motions);
    let frames = intervals.start..intervals.end + 1;
    if frames.len() < all {
        let taken: usize = motions[intervals].iter().sum();
        run.warn(format!(
            "of {} frames the search takes those from {} to {}, in which cells are followed {taken} times from one frame to the next; \
             search others with --frames, too, which should lead to the same",
            all,
            frames.start,
            frames.end - 1,
        ));
    }
    frames
}

/// Intervals around the middle one, as many as have few motions enough together.
fn around_middle(motions: &[usize]) -> Range<usize> {
    let middle = motions.len() / 2;
    let mut range = middle..(middle + 1).min(motions.len());
    let mut total: usize = motions[range.clone()].iter().sum();
    loop {
        let ends = [range.end, range.start.wrapping_sub(1)];
        // On the side where less was taken.
        let ends = if range.end - middle > middle - range.start { [ends[1], ends[0]] } else { ends };
        let Some(next) = ends.into_iter().find(|next| *next < motions.len()) else { return range };
        if total + motions[next] > MOST_MOTIONS && range.len() + 1 >= FEWEST_FRAMES {
            return range;
        }
        total += motions[next];
        range = range.start.min(next)..range.end.max(next + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_movie_is_searched_around_its_middle_and_a_short_one_as_a_whole() {
        assert_eq!(around_middle(&[400; 11]), 0..11);
        assert_eq!(around_middle(&[1000; 85]), 40..45);
        let growing: Vec<usize> = (0..85).map(|k| 230 + 9 * k).collect();
        let taken = around_middle(&growing);
        let total: usize = growing[taken.clone()].iter().sum();
        assert!(taken.contains(&42) && total <= MOST_MOTIONS && total + 1000 > MOST_MOTIONS, "{taken:?}");
        // However many cells there are, a few frames are taken.
        assert_eq!(around_middle(&[100_000; 9]), 3..6);
        assert_eq!(around_middle(&[7]), 0..1);
    }
}
