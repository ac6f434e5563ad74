//! What the polygons alone say of faulty detections, learned from the polygons of the data themselves.
//!
//! Each kind of fault has a feature. Its distribution where the fault is, is that which the fault makes when it is put into
//! these data: each cell hidden, each pair of neighbours taken for one, and so on. Its distribution elsewhere is that of the
//! data. Both are taken for normal, with medians and median deviations, which a few real faults do not move.

use super::ChangeKind;
use super::scene::Scene;
use voronudge_geometry::{CellPolygon, Tessellation, Vector, Visibility, circumcentre};

/// Bound of a log ratio of densities: tails are not known better.
const LARGEST_RATIO: f64 = 7.0;

/// Features that are needed to know a distribution.
const FEWEST: usize = 12;

/// The median absolute deviation of a normal distribution, in standard deviations.
const DEVIATION: f64 = 0.6745;

/// Standard deviations beyond the usual that a hole of several cells is.
const LARGE_HOLE: f64 = 4.0;

/// A Voronoi vertex whose empty circle is larger than those of the vertices next to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Void {
    pub centre: Vector<f64>,
    /// Radius of the circle, in roots of the mean area of the cells around.
    pub radius: f64,
}

/// Two normal distributions, centre and width, of a feature: with a fault, and without.
#[derive(Debug, Clone, Copy)]
struct Contrast {
    faulty: [f64; 2],
    sound: [f64; 2],
}

/// What the polygons of a data set say of faults.
#[derive(Debug, Clone)]
pub(super) struct Polygons {
    contrasts: Vec<(ChangeKind, Contrast)>,
    /// Spread of a coordinate of a hidden cell about the centre of the largest circle.
    pub spread: f64,
    /// Voids for each cell.
    pub voids: f64,
    /// Radius beyond which more than one cell is missing.
    pub largest_void: f64,
}

impl Polygons {
    /// From the frames as detected; `None` if there are too few cells.
    pub fn new(scenes: &[Scene<'_>]) -> Option<Self> {
        let (mut holes, mut circles, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
        let (mut areas, mut joint, mut close, mut shared, mut cells) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new(), 0);
        for scene in scenes {
            let frame = &scene.observation;
            let (tessellation, positions) = (&frame.tessellation, &frame.positions);
            circles.extend(voids(scene).iter().map(|void| void.radius.ln()));
            let own = voronudge_geometry::areas(tessellation, positions);
            for cell in (0..positions.len()).filter(|cell| frame.visibility[*cell] == Visibility::Counted) {
                cells += 1;
                areas.push(own[cell].ln());
                if let Some((centre, radius)) = hole(tessellation, positions, cell) {
                    holes.push((radius / size_of_others(tessellation, &own, cell)).ln());
                    offsets.extend([centre.x.abs(), centre.y.abs()]);
                }
                let nearest = tessellation
                    .ring(cell)
                    .min_by(|a, b| {
                        let distance = |h: usize| tessellation.displacement(positions, cell, h).norm();
                        distance(*a).total_cmp(&distance(*b))
                    })
                    .map(|h| tessellation.neighbour(h));
                close.extend(nearest.map(|other| (own[cell] + own[other]).ln()));
                for other in tessellation.neighbours(cell).iter().map(|other| *other as usize) {
                    if other > cell {
                        joint.push((own[cell] + own[other]).ln());
                    }
                }
                shared.extend(area_of_stray(tessellation, positions, cell).map(f64::ln));
            }
        }
        let voids = circles.len() as f64 / f64::from(cells.max(1));
        offsets.sort_unstable_by(f64::total_cmp);
        let spread = offsets.get(offsets.len() / 2)? / DEVIATION;
        let [of_holes, of_circles, of_areas] = [holes, circles, areas].map(centre_and_width);
        let [of_joint, of_close, of_shared] = [joint, close, shared].map(centre_and_width);
        let contrast = |faulty: Option<[f64; 2]>, sound: Option<[f64; 2]>| {
            Some(Contrast { faulty: faulty?, sound: sound? })
        };
        let contrasts = vec![
            (ChangeKind::Inserted, contrast(of_holes, of_circles)?),
            (ChangeKind::Deleted, contrast(of_shared, of_areas)?),
            (ChangeKind::Split, contrast(of_joint, of_areas)?),
            (ChangeKind::Merged, contrast(of_areas, of_close)?),
        ];
        let largest_void =
            of_holes.map_or(f64::INFINITY, |[centre, width]| (centre + LARGE_HOLE * width).exp());
        Some(Self { contrasts, spread, voids, largest_void })
    }

    /// `log p(feature | fault) / p(feature | none)`: of the radius of the largest empty circle for a missing cell, in roots of the mean
    /// area around, of the area
    /// of the polygon or the sum of both for others.
    pub fn log_ratio(&self, kind: ChangeKind, feature: f64) -> f64 {
        let own = self.contrasts.iter().find(|(other, _)| *other == kind);
        own.map_or(0.0, |(_, contrast)| contrast.log_ratio(feature.ln()))
    }
}

impl Contrast {
    /// Beyond the centre of either distribution that one stays as it is at its centre, so that the ratio is monotonic.
    fn log_ratio(&self, x: f64) -> f64 {
        let towards = (self.faulty[0] - self.sound[0]).signum();
        let log_density = |[centre, width]: [f64; 2], outwards: f64| {
            let away = if (x - centre) * outwards > 0.0 { 0.0 } else { (x - centre) / width };
            -0.5 * away * away - width.ln()
        };
        let ratio = log_density(self.faulty, towards) - log_density(self.sound, -towards);
        ratio.clamp(-LARGEST_RATIO, LARGEST_RATIO)
    }
}

/// Median, and the standard deviation that belongs to the median absolute deviation.
fn centre_and_width(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.retain(|value| value.is_finite());
    if values.len() < FEWEST {
        return None;
    }
    let middle = values.len() / 2;
    let median = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    values.iter_mut().for_each(|value| *value = (*value - median).abs());
    let deviation = *values.select_nth_unstable_by(middle, f64::total_cmp).1;
    (deviation > 0.0).then_some([median, deviation / DEVIATION])
}

/// The root of the mean area of some cells and their neighbours: cells are not of one size throughout a tissue.
pub(super) fn size_around(tessellation: &Tessellation, areas: &[f64], cells: &[usize]) -> f64 {
    let (sum, count) = sum_around(tessellation, areas, cells);
    (sum / count as f64).sqrt()
}

/// The same of the neighbours of a cell and theirs, as if it were hidden and its area theirs.
fn size_of_others(tessellation: &Tessellation, areas: &[f64], cell: usize) -> f64 {
    let ring: Vec<usize> = tessellation.neighbours(cell).iter().map(|other| *other as usize).collect();
    let (sum, count) = sum_around(tessellation, areas, &ring);
    (sum / (count - 1).max(1) as f64).sqrt()
}

/// Area and number of some cells and their neighbours whose polygons are closed.
fn sum_around(tessellation: &Tessellation, areas: &[f64], cells: &[usize]) -> (f64, usize) {
    let mut all: Vec<usize> = cells.to_vec();
    all.extend(cells.iter().flat_map(|cell| tessellation.neighbours(*cell)).map(|other| *other as usize));
    all.sort_unstable();
    all.dedup();
    let closed = all.into_iter().map(|cell| areas[cell]).filter(|area| area.is_finite());
    closed.fold((0.0, 0), |(sum, count), area| (sum + area, count + 1))
}

/// All voids of a scene between cells that can be trusted.
pub(super) fn voids(scene: &Scene<'_>) -> Vec<Void> {
    let frame = &scene.observation;
    let (tessellation, positions) = (&frame.tessellation, &frame.positions);
    let mut polygon = CellPolygon::<f64>::default();
    // The vertex between the neighbour of a half-edge and the next one of the ring.
    let mut vertices = vec![Vector::new(f64::NAN, f64::NAN); tessellation.half_edges()];
    for cell in (0..tessellation.len()).filter(|cell| tessellation.is_closed(*cell)) {
        polygon.fill(tessellation, positions, cell);
        tessellation.ring(cell).zip(polygon.vertices()).for_each(|(h, vertex)| vertices[h] = vertex);
    }
    let areas = voronudge_geometry::areas(tessellation, positions);
    // A hole that a cell leaves may be so large that its neighbours do not count.
    let trusted = |cell: usize| frame.visibility[cell].has_certain_polygon_or_hole();
    let turned = |cell: usize, h: usize, by: usize| {
        let ring = tessellation.ring(cell);
        ring.start + (h - ring.start + by) % ring.len()
    };
    let mut found = Vec::new();
    for cell in (0..tessellation.len()).filter(|cell| trusted(*cell)) {
        for h in tessellation.ring(cell) {
            let after = turned(cell, h, 1);
            let others = [tessellation.neighbour(h), tessellation.neighbour(after)];
            // The lowest cell speaks for the vertex.
            if others.iter().any(|other| *other < cell || !trusted(*other)) {
                continue;
            }
            // Around the neighbour of h, this vertex comes before the one that the cell is not at.
            let twin = tessellation.twin(h);
            let sides = tessellation.ring(others[0]).len();
            let beyond = turned(others[0], twin, sides - 2);
            let before = turned(cell, h, tessellation.ring(cell).len() - 1);
            let radius = vertices[h].norm();
            if [before, after, beyond].iter().all(|next| radius >= vertices[*next].norm()) {
                let size = size_around(tessellation, &areas, &[cell, others[0], others[1]]);
                found.push(Void { centre: positions[cell] + vertices[h], radius: radius / size });
            }
        }
    }
    found
}

/// The largest empty circle that opens where a cell is taken away: its centre relative to the cell, and its radius.
fn hole(tessellation: &Tessellation, positions: &[Vector<f64>], cell: usize) -> Option<(Vector<f64>, f64)> {
    let ring: Vec<Vector<f64>> = tessellation.displacements(positions, cell).collect();
    let n = ring.len();
    let triples = (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
    triples
        .filter_map(|corners| {
            let [a, b, c] = corners.map(|corner| ring[corner]);
            let relative = circumcentre(b - a, c - a);
            let (centre, radius) = (a + relative, relative.norm());
            let others = (0..n).filter(|other| !corners.contains(other));
            // The circles that open are the empty ones that the cell was in.
            let opens = radius.is_finite()
                && centre.norm() < radius
                && others.map(|other| (ring[other] - centre).norm()).all(|distance| distance >= radius);
            opens.then_some((centre, radius))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The area that a stray detection takes near a cell: of the polygon of a point half way to the centre of the first triangle, cut
/// from the polygon of the cell and its neighbours.
fn area_of_stray(tessellation: &Tessellation, positions: &[Vector<f64>], cell: usize) -> Option<f64> {
    let ring: Vec<Vector<f64>> = tessellation.displacements(positions, cell).collect();
    let stray = (ring.first()? + ring.get(1)?) / 3.0;
    // Half-planes nearer to the stray than to the cell or one of its neighbours, from a square that is large enough.
    let size = ring.iter().map(|r| r.norm()).fold(0.0, f64::max);
    let mut polygon: Vec<Vector<f64>> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| stray + Vector::new(x, y) * size)
        .to_vec();
    for site in ring.iter().copied().chain([Vector::zeros()]) {
        let (middle, normal) = ((stray + site) * 0.5, site - stray);
        let side = |p: Vector<f64>| (p - middle).dot(&normal);
        let mut cut = Vec::with_capacity(polygon.len() + 1);
        for (k, p) in polygon.iter().enumerate() {
            let q = polygon[(k + 1) % polygon.len()];
            let (here, there) = (side(*p), side(q));
            if here <= 0.0 {
                cut.push(*p);
            }
            if (here <= 0.0) != (there <= 0.0) {
                cut.push(p + (q - p) * (here / (here - there)));
            }
        }
        polygon = cut;
        if polygon.is_empty() {
            return None;
        }
    }
    let twice: f64 = (0..polygon.len())
        .map(|k| voronudge_geometry::cross(polygon[k], polygon[(k + 1) % polygon.len()]))
        .sum();
    Some(0.5 * twice)
}
