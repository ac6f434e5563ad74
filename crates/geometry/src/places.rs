//! Points by where they are.

use crate::{Domain, Vector};
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Points of a domain, to ask which are near a place.
///
/// ```
/// use voronudge_geometry::{Domain, PeriodicBox, Places, Vector};
/// let domain = Domain::Periodic(PeriodicBox::new([10.0, 10.0])?);
/// let places = Places::new([Vector::new(0.5, 5.0), Vector::new(5.0, 5.0), Vector::new(9.5, 5.0)], domain, 2.0);
/// let mut near: Vec<usize> = places.within(Vector::new(0.1, 5.0), 1.0).map(|(point, _)| point).collect();
/// near.sort();
/// assert_eq!(near, [0, 2]);
/// # Ok::<(), voronudge_geometry::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Places {
    domain: Domain,
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Places {
    /// Points, of a periodic box with those images that are within reach of it.
    pub fn new(points: impl IntoIterator<Item = Vector<f64>>, domain: Domain, reach: f64) -> Self {
        let mut all = Vec::new();
        for (point, r) in points.into_iter().enumerate() {
            let r = domain.wrap(r);
            all.push(GeomWithData::new([r.x, r.y], point));
            let Domain::Periodic(own) = domain else { continue };
            let [width, height] = own.lengths();
            for n in (-2..=2).flat_map(|ny| (-2..=2).map(move |nx| [nx, ny])).filter(|n| *n != [0, 0]) {
                let image = r + own.translation(n);
                let near = |value: f64, length: f64| (-reach..length + reach).contains(&value);
                if near(image.x, width) && near(image.y, height) {
                    all.push(GeomWithData::new([image.x, image.y], point));
                }
            }
        }
        Self { domain, tree: RTree::bulk_load(all) }
    }

    /// The points, by their numbers, at most so far from a place, with the way to each; the distance must not exceed the reach. In a small box a point can be
    /// there more than once.
    pub fn within(
        &self,
        place: Vector<f64>,
        distance: f64,
    ) -> impl Iterator<Item = (usize, Vector<f64>)> + '_ {
        let place = self.domain.wrap(place);
        self.tree.locate_within_distance([place.x, place.y], distance * distance).map(move |found| {
            let [x, y] = *found.geom();
            (found.data, Vector::new(x, y) - place)
        })
    }
}
