//! The classes of the study: what is wrong with the data.

use super::Window;

/// A kind of data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Class {
    /// What it is called on the command line and in tables.
    pub name: &'static str,
    /// What it is, in words of a table.
    pub words: &'static str,
    /// How it is measured.
    pub recipe: Recipe,
}

/// How a tissue is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// How much of it is seen.
    pub view: View,
    /// Which point of a cell its position is.
    pub point: Point,
    /// What goes wrong when cells are detected and tracked.
    pub flaws: Flaws,
    /// What is known of the motion.
    pub motion: Motion,
    /// Whether cells crawl: each has a velocity of its own whose direction diffuses.
    pub crawls: bool,
    /// What acts that the model lacks.
    pub lack: Lack,
}

/// What acts that the model lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// Nothing.
    Nothing,
    /// An effect that changes from seed to seed.
    Effect,
    /// The preferred perimeter changes evenly along both axes, in a tissue larger than what is seen.
    Ramp,
}

/// How much of a tissue is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// A periodic box, all of it.
    Whole,
    /// A square of a larger tissue.
    Window,
}

/// Which point of a cell its position is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Point {
    /// The centre of its Voronoi polygon, as the model has it.
    Site,
    /// The centroid of that polygon.
    Centroid,
}

/// What goes wrong when cells are detected and tracked: shares of the cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flaws {
    /// Never detected.
    pub missed: f64,
    /// Taken for one with their nearest neighbour: detections in the middle of two cells.
    pub merged: f64,
    /// Detected as two.
    pub split: f64,
    /// Not detected in a frame, of each frame. Half of the tracks go on under another name.
    pub gaps: f64,
    /// Tracks that go on under another name, of each frame.
    pub breaks: f64,
}

/// What is known of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// The velocity of every detection, in a single frame.
    Velocities,
    /// Velocities on a grid, averaged over a window, in a single frame.
    Flow(Window),
    /// Positions only, in several frames between which a cell moves by some multiple of ℓ₀ in the mean.
    Tracks {
        /// Number of frames.
        frames: usize,
        /// Mean distance that a cell moves from the first frame to the second.
        step: f64,
    },
}

/// Nothing goes wrong.
const NONE: Flaws = Flaws { missed: 0.0, merged: 0.0, split: 0.0, gaps: 0.0, breaks: 0.0 };
/// Frames of a film of tracks.
const FRAMES: usize = 6;

const COMPLETE: Recipe = Recipe {
    view: View::Whole,
    point: Point::Site,
    flaws: NONE,
    motion: Motion::Velocities,
    crawls: false,
    lack: Lack::Nothing,
};

const fn missed(missed: f64) -> Recipe {
    Recipe { flaws: Flaws { missed, ..NONE }, ..COMPLETE }
}

const fn flow(window: Window) -> Recipe {
    Recipe { motion: Motion::Flow(window), ..COMPLETE }
}

const fn tracks(step: f64) -> Recipe {
    Recipe { motion: Motion::Tracks { frames: FRAMES, step }, ..COMPLETE }
}

const fn crawling(frames: usize, step: f64) -> Recipe {
    Recipe { motion: Motion::Tracks { frames, step }, crawls: true, ..COMPLETE }
}

const fn class(name: &'static str, words: &'static str, recipe: Recipe) -> Class {
    Class { name, words, recipe }
}

/// What may act that the model lacks, in the order of the seeds.
pub const EFFECTS: [&str; 6] =
    ["nematic_stress", "drift", "alpha_area", "odd_nematic_stress", "p0_gradient", "short_range_repulsion"];

/// All classes of the study.
pub const CLASSES: [Class; 26] = [
    class("complete", "complete, periodic", COMPLETE),
    class("open", "open field of view", Recipe { view: View::Window, ..COMPLETE }),
    class("missed-2", "2 % not detected", missed(0.02)),
    class("missed-5", "5 % not detected", missed(0.05)),
    class("missed-15", "15 % not detected", missed(0.15)),
    class(
        "open-missed-2",
        "open field of view, 2 % not detected",
        Recipe { view: View::Window, ..missed(0.02) },
    ),
    class(
        "merged-split",
        "2 % merged, 2 % split",
        Recipe { flaws: Flaws { merged: 0.02, split: 0.02, ..NONE }, ..COMPLETE },
    ),
    class("flow-gaussian-35", "flow, Gaussian window of 0.35 ℓ₀", flow(Window::Gaussian(0.35))),
    class("flow-gaussian-50", "flow, Gaussian window of 0.5 ℓ₀", flow(Window::Gaussian(0.5))),
    class("flow-gaussian-70", "flow, Gaussian window of 0.7 ℓ₀", flow(Window::Gaussian(0.7))),
    class("flow-square", "flow, square window of 1.5 spacings", flow(Window::Square(1.5))),
    class("centroids", "centroids", Recipe { point: Point::Centroid, ..COMPLETE }),
    class("tracks-05", "tracks, steps of 0.05 ℓ₀", tracks(0.05)),
    class("tracks-15", "tracks, steps of 0.15 ℓ₀", tracks(0.15)),
    class("tracks-30", "tracks, steps of 0.3 ℓ₀", tracks(0.3)),
    class(
        "broken-tracks",
        "tracks, steps of 0.1 ℓ₀, 3 % gaps, 3 % breaks",
        Recipe { flaws: Flaws { gaps: 0.03, breaks: 0.03, ..NONE }, ..tracks(0.1) },
    ),
    class(
        "all-at-once",
        "open, centroids, tracks, steps of 0.1 ℓ₀, 1 % missed, 3 % gaps, 3 % breaks",
        Recipe {
            view: View::Window,
            point: Point::Centroid,
            flaws: Flaws { missed: 0.01, gaps: 0.03, breaks: 0.03, ..NONE },
            ..tracks(0.1)
        },
    ),
    class(
        "open-missed-2-effect",
        "open field of view, 2 % not detected, an effect of 15 %",
        Recipe { view: View::Window, lack: Lack::Effect, ..missed(0.02) },
    ),
    class(
        "open-missed-2-ramp",
        "open field of view, 2 % not detected, P₀ that changes evenly, 15 % along each axis",
        Recipe { view: View::Window, lack: Lack::Ramp, ..missed(0.02) },
    ),
    class(
        "flow-square-effect",
        "flow, square window of 1.5 spacings, an effect of 15 %",
        Recipe { lack: Lack::Effect, ..flow(Window::Square(1.5)) },
    ),
    class(
        "tracks-effect",
        "tracks, steps of 0.1 ℓ₀, an effect of 15 %",
        Recipe { lack: Lack::Effect, ..tracks(0.1) },
    ),
    class("active-05", "crawling cells, 6 frames, steps of 0.05 ℓ₀", crawling(FRAMES, 0.05)),
    class("active-10", "crawling cells, 6 frames, steps of 0.1 ℓ₀", crawling(FRAMES, 0.1)),
    class("active-20", "crawling cells, 6 frames, steps of 0.2 ℓ₀", crawling(FRAMES, 0.2)),
    class("active-long", "crawling cells, 12 frames, steps of 0.1 ℓ₀", crawling(2 * FRAMES, 0.1)),
    class(
        "active-missed-2",
        "crawling cells, 12 frames, steps of 0.1 ℓ₀, 2 % not detected",
        Recipe { flaws: Flaws { missed: 0.02, ..NONE }, ..crawling(2 * FRAMES, 0.1) },
    ),
];

impl Class {
    /// The class of a name.
    pub fn named(name: &str) -> Option<Self> {
        CLASSES.into_iter().find(|class| class.name == name)
    }
}
