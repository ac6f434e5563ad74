//! Delaunay triangulations of points in the plane by two libraries: one that is fast, and one that is exact.

use crate::Vector;
use delaunator::{EMPTY, next_halfedge, prev_halfedge};
use spade::handles::FixedVertexHandle;
use spade::{DelaunayTriangulation, HasPosition, Point2, Triangulation};

/// A triangulation that knows the neighbours of each point.
pub(super) trait Mesh: Sized {
    /// Triangulates points, or gives nothing if the triangulation lacks one: two may coincide.
    fn of(points: &[Vector<f64>]) -> Option<Self>;

    /// Replaces `neighbours` by those of a point, counter-clockwise, and tells whether they are all around it. For a point on the hull they
    /// begin after the gap.
    fn ring(&self, point: usize, neighbours: &mut Vec<u32>) -> bool;
}

/// Largest coordinate whose fourth powers can be added up. Beyond, delaunator might not come to an end.
const LARGEST: f64 = 1e60;

/// By delaunator, whose in-circle tests are rounded: less than half the time of [`Exact`], but almost cocircular points may be connected wrongly.
pub(super) struct Fast {
    /// The points from which half-edges come. Three in a row make a triangle, clockwise.
    from: Vec<usize>,
    twin: Vec<usize>,
    /// A half-edge from each point; of one on the hull, the clockwise end of its ring.
    outgoing: Vec<usize>,
}

impl Mesh for Fast {
    fn of(points: &[Vector<f64>]) -> Option<Self> {
        if points.iter().any(|r| r.amax() > LARGEST) {
            return None;
        }
        let copies: Vec<_> = points.iter().map(|r| delaunator::Point { x: r.x, y: r.y }).collect();
        let delaunator::Triangulation { triangles: from, halfedges: twin, .. } =
            delaunator::triangulate(&copies);
        let mut outgoing = vec![EMPTY; points.len()];
        for (edge, &point) in from.iter().enumerate() {
            outgoing[point] = edge;
        }
        for (edge, _) in twin.iter().enumerate().filter(|(_, twin)| **twin == EMPTY) {
            let next = next_halfedge(edge);
            outgoing[from[next]] = next;
        }
        (!outgoing.contains(&EMPTY)).then_some(Self { from, twin, outgoing })
    }

    #[inline]
    fn ring(&self, point: usize, neighbours: &mut Vec<u32>) -> bool {
        neighbours.clear();
        let first = self.outgoing[point];
        let mut edge = first;
        loop {
            neighbours.push(self.from[next_halfedge(edge)] as u32);
            match self.twin[edge] {
                EMPTY => {
                    neighbours.insert(0, self.from[prev_halfedge(first)] as u32);
                    return false;
                }
                twin => edge = next_halfedge(twin),
            }
            if edge == first {
                return true;
            }
        }
    }
}

/// By spade, with exact predicates.
pub(super) struct Exact {
    delaunay: DelaunayTriangulation<Vertex>,
    handles: Vec<FixedVertexHandle>,
}

struct Vertex {
    position: Point2<f64>,
    point: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

impl Exact {
    /// Whether all points are on a line.
    pub fn is_flat(&self) -> bool {
        self.delaunay.num_inner_faces() == 0
    }
}

impl Mesh for Exact {
    fn of(points: &[Vector<f64>]) -> Option<Self> {
        let vertices = (0..).zip(points).map(|(point, r)| Vertex { position: flushed(*r), point }).collect();
        let delaunay = DelaunayTriangulation::<Vertex>::bulk_load(vertices).ok()?;
        let mut handles: Vec<_> =
            delaunay.vertices().map(|vertex| (vertex.data().point, vertex.fix())).collect();
        handles.sort_unstable_by_key(|(point, _)| *point);
        let handles: Vec<_> = handles.into_iter().map(|(_, handle)| handle).collect();
        (handles.len() == points.len()).then_some(Self { delaunay, handles })
    }

    fn ring(&self, point: usize, neighbours: &mut Vec<u32>) -> bool {
        neighbours.clear();
        let mut gap = None;
        for edge in self.delaunay.vertex(self.handles[point]).out_edges() {
            neighbours.push(edge.to().data().point);
            // The face to the left of an edge is the corner between it and the next edge.
            if edge.is_outer_edge() {
                gap = Some(neighbours.len());
            }
        }
        neighbours.rotate_left(gap.unwrap_or(0));
        gap.is_none()
    }
}

/// spade refuses magnitudes below 1e-142, which are zero for any unit of length.
pub(super) fn flushed(r: Vector<f64>) -> Point2<f64> {
    let flush = |x: f64| if x.abs() < 1e-140 { 0.0 } else { x };
    Point2::new(flush(r.x), flush(r.y))
}
