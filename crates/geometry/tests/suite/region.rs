//! Parts of the plane that are seen.

use voronudge_geometry::{Error, Region, Vector};

fn corners(all: &[[f64; 2]]) -> Vec<Vector<f64>> {
    all.iter().map(|r| Vector::from(*r)).collect()
}

/// An L: the square of side 4 without its upper right quarter.
fn bracket() -> Region {
    let all = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]];
    Region::polygon(corners(&all)).unwrap()
}

#[test]
fn disks_are_inside_if_no_point_of_them_is_outside() {
    let region = bracket();
    assert!((region.area() - 12.0).abs() < 1e-12);
    assert!(region.holds_disk(Vector::new(1.0, 1.0), 1.0));
    assert!(!region.holds_disk(Vector::new(1.0, 1.0), 1.0 + 1e-9));
    assert!(!region.holds_disk(Vector::new(3.0, 3.0), 0.5), "in the quarter that is missing");
    // Nearest to the corner that turns inwards.
    let diagonal = 0.5f64.sqrt();
    assert!(region.holds_disk(Vector::new(1.5, 1.5), diagonal - 1e-9));
    assert!(!region.holds_disk(Vector::new(1.5, 1.5), diagonal + 1e-9));
    assert!(!region.holds_disk(Vector::new(1.0, 1.0), f64::NAN));
    assert!(!region.holds_disk(Vector::new(f64::NAN, 1.0), 0.1));
    assert!(region.scaled(2.0).holds_disk(Vector::new(2.0, 2.0), 2.0));
}

#[test]
fn the_sense_of_rotation_and_a_repeated_corner_do_not_matter() {
    let mut backwards: Vec<Vector<f64>> = bracket().loops()[0].clone();
    backwards.reverse();
    backwards.push(backwards[0]);
    let turned = Region::polygon(backwards).unwrap();
    for r in [[0.5, 3.5], [3.0, 3.0], [3.5, 1.0], [-0.5, 1.0], [1.0, 2.0]].map(Vector::from) {
        assert_eq!(turned.contains(r), bracket().contains(r), "{r}");
        assert!((turned.distance_from_border(r) - bracket().distance_from_border(r)).abs() < 1e-12);
    }
    let flipped = Region::rectangle([3.0, 2.0, 1.0, 0.0]).unwrap();
    assert!(flipped.holds_disk(Vector::new(2.0, 1.0), 0.99));
}

#[test]
fn polygons_that_are_none_are_refused() {
    let polygon = |all: &[[f64; 2]]| Region::polygon(corners(all));
    assert_eq!(polygon(&[[0.0, 0.0], [1.0, 0.0]]), Err(Error::RegionCorners { found: 2 }));
    assert_eq!(polygon(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), Err(Error::RegionArea));
    assert_eq!(Region::rectangle([1.0, 0.0, 1.0, 5.0]), Err(Error::RegionArea));
    let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
    assert_eq!(polygon(&bow), Err(Error::RegionCrossing { first: 0, second: 2 }));
    let spike = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [2.0, -1.0], [0.0, -1.0]];
    assert_eq!(polygon(&spike), Err(Error::RegionCrossing { first: 0, second: 2 }));
    let touching = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    assert_eq!(polygon(&touching), Err(Error::RegionCrossing { first: 0, second: 2 }));
    let infinite = polygon(&[[0.0, 0.0], [1.0, f64::INFINITY], [2.0, 0.0]]);
    assert_eq!(infinite, Err(Error::RegionCorner { corner: 1, x: 1.0, y: f64::INFINITY }));
}
