//! Which cells are detected, where, and under which name.

use super::film::{Film, root_mean_square};
use super::polygon::centroids;
use super::{Flaws, Hidden, Kind, Point, Recipe};
use crate::Noise;
use rand::Rng;
use rand::seq::SliceRandom;
use rand_distr::{Distribution, Normal, NormalError};
use rand_pcg::Pcg64;
use voronudge_geometry::Vector;

/// Distance of the two detections of a cell from its centre, in ℓ₀: the centroids of the halves of a square.
const HALF: f64 = 0.25;
/// Share of the tracks that go on under their name after a gap of one frame.
const RECONNECTED: f64 = 0.5;

/// A detection in a frame.
pub(super) struct Detection {
    pub track: usize,
    pub position: Vector<f64>,
    pub velocity: Vector<f64>,
}

/// What is taken for a cell.
#[derive(Clone, Copy)]
enum Object {
    Cell(usize),
    Merged([usize; 2]),
    Half(usize, Vector<f64>),
}

/// The name under which something was seen, and the frame.
#[derive(Clone, Copy)]
struct Name {
    track: usize,
    frame: usize,
}

/// Looks at one frame after another.
pub(super) struct Detector<'a> {
    film: &'a Film,
    points: Vec<Vec<Vector<f64>>>,
    flaws: Flaws,
    errors: [Normal<f64>; 2],
    rng: &'a mut Pcg64,
    objects: Vec<Object>,
    missed: Vec<usize>,
    names: Vec<Option<Name>>,
    tracks: usize,
    /// Cells that were not seen, or not by themselves.
    pub hidden: Vec<Hidden>,
    /// Cells that are detected as two.
    pub doubled: usize,
}

impl<'a> Detector<'a> {
    pub fn new(
        film: &'a Film,
        recipe: &Recipe,
        noise: Noise,
        rng: &'a mut Pcg64,
    ) -> Result<Self, NormalError> {
        let flaws = recipe.flaws;
        let cells = film.frames[0].sites.len();
        let count = |share: f64| (share * cells as f64).round() as usize;
        let mut order: Vec<usize> = (0..cells).collect();
        order.shuffle(rng);
        let mut taken = vec![false; cells];
        let draw = |taken: &mut Vec<bool>| {
            let cell = order.iter().copied().find(|cell| !taken[*cell])?;
            taken[cell] = true;
            Some(cell)
        };
        let missed: Vec<usize> = (0..count(flaws.missed)).filter_map(|_| draw(&mut taken)).collect();
        let mut objects = Vec::with_capacity(cells);
        for _ in 0..count(flaws.merged) {
            let pair = draw(&mut taken).and_then(|cell| Some([cell, nearest(film, cell, &taken)?]));
            if let Some(pair) = pair {
                taken[pair[1]] = true;
                objects.push(Object::Merged(pair));
            }
        }
        let doubled = count(flaws.split);
        for cell in (0..doubled).filter_map(|_| draw(&mut taken)).collect::<Vec<_>>() {
            let angle = rng.random_range(0.0..std::f64::consts::TAU);
            let aside = Vector::new(angle.cos(), angle.sin()) * HALF;
            objects.extend([aside, -aside].map(|aside| Object::Half(cell, aside)));
        }
        objects.extend((0..cells).filter(|cell| !taken[*cell]).map(Object::Cell));
        let points = (0..film.frames.len())
            .map(|frame| match recipe.point {
                Point::Site => film.frames[frame].sites.clone(),
                Point::Centroid => centroids(film, frame),
            })
            .collect();
        let speed = root_mean_square(&film.frames[0].velocities);
        let errors = [Normal::new(0.0, noise.position)?, Normal::new(0.0, noise.velocity * speed)?];
        let names = vec![None; objects.len()];
        let hidden = Vec::new();
        Ok(Self { film, points, flaws, errors, rng, objects, missed, names, tracks: 0, hidden, doubled })
    }

    /// The detections of a frame at places that are in view.
    pub fn look(&mut self, frame: usize, is_in_view: impl Fn(Vector<f64>) -> bool) -> Vec<Detection> {
        for cell in self.missed.clone() {
            self.hide(frame, &[cell], Kind::Missed, &is_in_view);
        }
        let mut detections = Vec::with_capacity(self.objects.len());
        for (index, object) in self.objects.clone().into_iter().enumerate() {
            if self.rng.random_bool(self.flaws.gaps) {
                if let Object::Cell(cell) = object {
                    self.hide(frame, &[cell], Kind::Gap, &is_in_view);
                }
                continue;
            }
            if let Object::Merged(pair) = object {
                self.hide(frame, &pair, Kind::Merged, &is_in_view);
            }
            let (place, velocity) = self.seen(object, frame);
            let [of_position, of_velocity] = self.errors.map(|normal| self.error(normal));
            let (position, velocity) = (place + of_position, velocity + of_velocity);
            if is_in_view(position) {
                let track = self.track(index, frame);
                detections.push(Detection { track, position, velocity });
            }
        }
        detections
    }

    /// Notes cells that are in view and not seen.
    fn hide(&mut self, frame: usize, cells: &[usize], kind: Kind, is_in_view: impl Fn(Vector<f64>) -> bool) {
        let sites = cells.iter().map(|cell| self.film.frames[frame].sites[*cell]);
        let sites: Vec<_> = sites.filter(|site| is_in_view(*site)).map(|site| [site.x, site.y]).collect();
        if !sites.is_empty() {
            self.hidden.push(Hidden { frame, kind, sites });
        }
    }

    fn error(&mut self, of: Normal<f64>) -> Vector<f64> {
        Vector::new(of.sample(self.rng), of.sample(self.rng))
    }

    /// The track of an object that is seen in a frame: the one that it had, or a new one.
    fn track(&mut self, object: usize, frame: usize) -> usize {
        let name = self.names[object].filter(|name| name.frame + 2 >= frame);
        let known = name.filter(|name| {
            let kept = if name.frame + 1 == frame { 1.0 - self.flaws.breaks } else { RECONNECTED };
            self.rng.random_bool(kept)
        });
        let track = known.map_or(self.tracks, |name| name.track);
        self.tracks = self.tracks.max(track + 1);
        self.names[object] = Some(Name { track, frame });
        track
    }

    /// Where something is, and its velocity.
    fn seen(&self, object: Object, frame: usize) -> (Vector<f64>, Vector<f64>) {
        let (points, velocities) = (&self.points[frame], &self.film.frames[frame].velocities);
        match object {
            Object::Cell(cell) => (points[cell], velocities[cell]),
            Object::Half(cell, aside) => (points[cell] + aside, velocities[cell]),
            Object::Merged([a, b]) => {
                let apart = self.film.cell_box.shortest(points[b] - points[a]);
                (points[a] + apart * 0.5, (velocities[a] + velocities[b]) * 0.5)
            }
        }
    }
}

/// The nearest cell that is not taken yet.
fn nearest(film: &Film, cell: usize, taken: &[bool]) -> Option<usize> {
    let sites = &film.frames[0].sites;
    let distance = |other: usize| film.cell_box.shortest(sites[other] - sites[cell]).norm();
    (0..sites.len()).filter(|other| !taken[*other]).min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
}
