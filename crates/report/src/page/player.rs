//! Cells that can be played, stepped through, coloured and asked for their numbers.

use serde::Serialize;

use super::Figure;
use crate::error::ReportError;
use crate::movie::CellMovie;
use crate::view::CellStatus;

const SCRIPT: &str = include_str!("../../templates/player.js");

/// A movie in a page. Without a script, and in print, a still stands in its place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Player {
    /// Stand-alone SVG.
    still: String,
    caption: String,
    /// What it is, for those who do not see it.
    label: String,
    frames: usize,
    /// Frames a second at first.
    speed: u32,
    has_marks: bool,
    has_borders: bool,
    data: String,
    script: &'static str,
}

impl Player {
    /// A movie with what stands in its place, and beneath it.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the numbers cannot be written.
    pub(super) fn new(movie: &CellMovie, still: &Figure) -> Result<Self, ReportError> {
        let frames = movie.frames();
        let data = movie.to_json()?;
        let mut words = vec![still.caption.clone(), movie.what_is_left_out()];
        if frames.len() > 1 {
            words.push(format!(
                "Space plays, the arrow keys step. The movie is {} kB of this page.",
                data.len().div_ceil(1000)
            ));
        }
        words.retain(|sentence| !sentence.is_empty());
        let cells = || frames.iter().flat_map(|frame| &frame.cells);
        Ok(Self {
            still: still.svg.clone(),
            caption: words.join(" "),
            label: format!("cells, {} frames; what is known of each cell stands beneath", frames.len()),
            frames: frames.len(),
            speed: if frames.len() < 25 { 5 } else { 10 },
            has_marks: cells().any(|cell| cell.status != CellStatus::Used),
            has_borders: frames.iter().any(|frame| frame.outline.is_some() || !frame.region.is_empty()),
            data,
            script: SCRIPT,
        })
    }

    /// What stands in its place.
    pub(super) fn into_still(self) -> Figure {
        Figure { svg: self.still, caption: self.caption }
    }
}
