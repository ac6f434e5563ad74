//! Pages of samples in a browser.

use crate::chromium::assert_sound;
use crate::{discover_sample, movies, sample};
use std::error::Error;
use voronudge_report::page::{Block, Figure, Page, Section};
use voronudge_report::{DiscoverFigures, DiscoverPage, FrameView, InferPage, Uncertainty};

#[test]
fn pages_fit_their_window_and_movies_play() {
    assert_sound(&pages().unwrap(), "µm²").unwrap();
}

/// Pages of all kinds: a movie of a fit, one frame, unknown numbers, a search, a simulation.
fn pages() -> Result<Vec<(&'static str, String)>, Box<dyn Error>> {
    let uncertainty = Uncertainty::default();
    let (report, bad) = (sample::report(), sample::degenerate_report());
    let (frames, degenerate) = (movies::frames(2, 10), [sample::degenerate_frame()]);
    let (movie, single) = (movies::movie(5, 10)?, movies::movie(1, 10)?);
    let infer = sample::page(&report, &frames, &uncertainty);
    let doubtful: &[FrameView] = &degenerate;
    let before_after = [discover_sample::frames("frame 6", 10)];
    let search = discover_sample::attributed();
    let mut after = movies::frames(5, 10);
    let cells = after.iter_mut().flat_map(|frame| &mut frame.cells);
    cells.for_each(|cell| cell.predicted = cell.predicted.map(|[x, y]| [0.9 * x, y + 0.1]));
    let movie_of_both = movies::movie(5, 10)?.with_residuals(["residual before", "residual after"], after);
    let figures = DiscoverFigures { movie: Some(movie_of_both), ..discover_sample::figures() };
    let discover = DiscoverPage {
        title: "embryo",
        report: &search,
        frames: &before_after,
        flows: &[],
        figures: &figures,
    };
    let figure = Figure::new(movie.still(), "Cells.");
    let tissue = Block::group("beside", [Block::player(&movie, &figure)?, figure.clone().into()]);
    let simulate = Page {
        sections: vec![
            Section::new("The tissue").with(tissue),
            Section::new("In time").with(Block::pairs([figure.clone()])),
        ],
        ..Page::new("100 cells", "The cells move at 2.75 ℓ₀ K_P.", &report.run)
    };
    Ok(vec![
        ("infer.html", InferPage { movie: Some(&movie), ..infer }.render()?),
        ("one-frame.html", InferPage { movie: Some(&single), ..infer }.render()?),
        ("degenerate.html", sample::page(&bad, doubtful, &uncertainty).render()?),
        ("discover.html", discover.render()?),
        ("simulate.html", simulate.render()?),
    ])
}
