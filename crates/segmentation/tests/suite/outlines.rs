//! Outlines of cells.

use voronudge_geometry::Vector;
use voronudge_segmentation::{Outline, outline_contacts, outline_interfaces};

#[test]
fn a_rectangle_far_away() {
    let corners =
        [[0.0, 0.0], [0.0, 2.0], [3.0, 2.0], [3.0, 0.0]].map(|[x, y]| Vector::new(x + 1e6, y - 1e6));
    let outline = Outline::new(&corners).unwrap();
    assert!((outline.area - 6.0).abs() < 1e-9 && (outline.perimeter - 10.0).abs() < 1e-9);
    assert!((outline.centroid - Vector::new(1e6 + 1.5, 1.0 - 1e6)).norm() < 1e-9);
    assert_eq!(Outline::new(&corners[..2]), None);
    assert_eq!(Outline::new(&[corners[0], corners[1], corners[0]]), None);
}

#[test]
fn cells_touch_along_sides_and_not_at_corners() {
    let square = |x: f64, y: f64| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[a, b]| Vector::new(x + a, y + b)).to_vec()
    };
    let contacts = outline_contacts(&[square(0.0, 0.0), square(1.0, 0.0), square(1.0, 1.0)], 1e-6);
    assert_eq!(contacts.into_iter().collect::<Vec<_>>(), [[0, 1], [1, 2]]);
}

/// A bent line is one interface.
#[test]
fn sides_of_two_outlines_are_joined() {
    let polygon =
        |top: f64| [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, top]].map(|[x, y]| Vector::new(x, y)).to_vec();
    let found = outline_interfaces(&[polygon(3.0), polygon(-2.0)], 1e-6);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].cells, found[0].length, found[0].middle), ([0, 1], 2.0, Vector::new(1.0, 0.0)));
    assert!((found[0].extent.x.abs() - 2.0 / 12f64.sqrt()).abs() < 1e-12 && found[0].extent.y == 0.0);
}
