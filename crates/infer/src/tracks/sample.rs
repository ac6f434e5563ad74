//! Movies of simulated tissues for the tests of this module.

use super::follow;
use super::inference::Followed;
use super::movie::{Drift, Movie};
use crate::search::Watch;
use crate::{Activity, Constraints, CrossValidation, FitParameter, Request};
use rand_distr::{Distribution, Normal};
use std::ops::ControlFlow;
use voronudge_geometry::{CellPolygon, Domain, FieldOfView, PeriodicBox, Tessellation, Vector};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::{Driving, RandomPlacement, Simulation, generator};

/// P_0 and α of the tissue.
pub const TRUTH: [f64; 2] = [4.0, 2.9];

/// A liquid tissue that is seen in some frames.
pub struct Filmed {
    /// Cells, frames.
    pub size: [usize; 2],
    /// Root mean square step from frame to frame, and error of a coordinate.
    pub step: f64,
    pub error: f64,
    pub seed: u64,
}

/// What is seen of a cell.
#[derive(Clone, Copy, PartialEq)]
enum Point {
    Site,
    Centroid,
}

impl Filmed {
    /// Positions in each frame, the box, and K_P α in units of the velocities.
    pub fn film(&self) -> (Vec<Vec<Option<Vector<f64>>>>, Domain, f64) {
        let (film, domain, unit) = self.film_of(Point::Site, Driving::default());
        (film, domain, TRUTH[1] * unit)
    }

    /// The same, and the velocity of one in units of the velocities.
    fn film_of(&self, point: Point, driving: Driving) -> (Vec<Vec<Option<Vector<f64>>>>, Domain, f64) {
        let [cells, frames] = self.size;
        let side = (cells as f64).sqrt();
        let domain = Domain::Periodic(PeriodicBox::new([side, side]).unwrap());
        let mut rng = generator(self.seed);
        let start =
            RandomPlacement::new(cells, PeriodicBox::new([side, side]).unwrap()).draw(&mut rng).unwrap();
        let truth = Parameters {
            area_elasticity: 0.0,
            perimeter_elasticity: 1.0,
            preferred_perimeter: TRUTH[0],
            preferred_area: 1.0,
            chirality: TRUTH[1],
        };
        let mut tissue = Simulation::new(start, domain, Model::chiral_voronoi(&truth)).unwrap();
        tissue = tissue.with_driving(Driving { seed: self.seed, ..driving }).unwrap();
        (0..1000).for_each(|_| tissue.step(0.01).unwrap());
        let speed = tissue.velocities().iter().map(|v| v.norm_squared()).sum::<f64>() / cells as f64;
        let interval = self.step / speed.sqrt();
        let fine = (interval / 0.003).ceil();
        let noise = Normal::new(0.0, self.error).unwrap();
        let mut film = Vec::new();
        for frame in 0..frames {
            if frame > 0 {
                (0..fine as usize).for_each(|_| tissue.step(interval / fine).unwrap());
            }
            let mut seen =
                |r: &Vector<f64>| Some(r + Vector::new(noise.sample(&mut rng), noise.sample(&mut rng)));
            let mut places = tissue.positions_with_images().to_vec();
            if point == Point::Centroid {
                let tessellation = Tessellation::new(&places, domain).unwrap();
                let mut polygon = CellPolygon::default();
                let centroid = |cell: usize| {
                    polygon.fill(&tessellation, &places, cell);
                    places[cell] + polygon.centroid()
                };
                places = (0..cells).map(centroid).collect();
            }
            film.push(places.iter().map(&mut seen).collect());
        }
        (film, domain, 1.0 / speed.sqrt())
    }

    /// The same of cells that crawl, as a movie; K_P α, v₀ and D_r in its units.
    pub fn movie_of_crawling(&self, speed: f64, rotational_diffusion: f64) -> (Movie, [f64; 3]) {
        self.movie_of_driven(Driving { speed, rotational_diffusion, ..Driving::default() })
    }

    /// The same of cells that are driven in any way.
    pub fn movie_of_driven(&self, driving: Driving) -> (Movie, [f64; 3]) {
        let (movie, unit) = self.movie_of(Point::Site, driving);
        (movie, [TRUTH[1], driving.speed, driving.rotational_diffusion].map(|own| own * unit))
    }

    /// The same as a movie whose velocities are of order one, and K_P α.
    pub fn movie(&self) -> (Movie, f64) {
        self.movie_with_chirality(Point::Site)
    }

    /// The same of the centroids of cells.
    pub fn movie_of_centroids(&self) -> (Movie, f64) {
        self.movie_with_chirality(Point::Centroid)
    }

    fn movie_with_chirality(&self, point: Point) -> (Movie, f64) {
        let (movie, unit) = self.movie_of(point, Driving::default());
        (movie, TRUTH[1] * unit)
    }

    fn movie_of(&self, point: Point, driving: Driving) -> (Movie, f64) {
        let (film, domain, unit) = self.film_of(point, driving);
        let times = (0..film.len()).map(|k| k as f64 * self.step).collect();
        (Movie::new(times, &film, domain, FieldOfView::default(), Drift::None).unwrap(), unit)
    }
}

/// A small tissue that crawls, and a fit of it without cross-validation, K_A held at zero.
pub fn followed(activity: Activity) -> (Movie, Request, Followed) {
    let (movie, _) = Filmed { size: [64, 4], step: 0.05, error: 0.005, seed: 5 }.movie_of_crawling(2.0, 1.0);
    let request = Request {
        activity,
        cross_validation: CrossValidation::Skipped,
        ..Request::new(Constraints::fixed([(FitParameter::AreaElasticity, 0.0)]))
    };
    let mut silent = |_: crate::Progress<'_>| ControlFlow::Continue(());
    let (_, followed) = follow(&movie, &request, None, &mut Watch { observe: &mut silent }).unwrap();
    (movie, request, followed)
}
