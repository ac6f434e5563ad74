//! The sets as measured are what they are said to be.

use claims::measured::{CLASSES, Class, Kind, MeasuredSet, Velocities};
use ndarray::Axis;
use voronudge_geometry::{PeriodicBox, Vector};
use voronudge_io::{Boundary, Source};

const CELLS: usize = 100;

fn set(name: &str, seed: u64) -> MeasuredSet {
    Class::named(name).unwrap().measure(seed, Some(CELLS)).unwrap()
}

/// The detections of a frame.
fn detections(set: &MeasuredSet, frame: usize) -> Vec<Vector<f64>> {
    let positions = set.positions.index_axis(Axis(0), frame);
    let rows = positions.rows().into_iter().filter(|row| row[0].is_finite());
    rows.map(|row| Vector::new(row[0], row[1])).collect()
}

fn hidden(set: &MeasuredSet, kind: Kind) -> usize {
    set.truth.hidden.iter().filter(|hidden| hidden.kind == kind).count()
}

#[test]
fn a_set_is_read_as_written_and_declares_nothing() {
    for class in CLASSES {
        let set = class.measure(3, Some(64)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let written = set.clone().write(folder.path()).unwrap();
        let data = Source { folder: Some(written.data), ..Source::default() }.load().unwrap();
        assert_eq!(data.positions.dim(), set.positions.dim(), "{}", class.name);
        assert_eq!(data.velocities.is_some(), matches!(set.velocities, Velocities::OfCells(_)));
        assert_eq!(data.flow.is_some(), matches!(set.velocities, Velocities::OnGrid(..)));
        assert_eq!(data.boundary == Boundary::Open, set.cell_box.is_none());
        assert!(data.position_noise.is_none() && data.velocity_noise.is_none());
    }
}

#[test]
fn classes_share_tissues_and_no_errors() {
    let (complete, missed) = (set("complete", 1), set("missed-5", 1));
    assert_eq!(complete.truth.parameters, missed.truth.parameters);
    assert_eq!([detections(&complete, 0).len(), detections(&missed, 0).len()], [CELLS, CELLS - 5]);
    let cell_box = PeriodicBox::new([10.0; 2]).unwrap();
    let sites: Vec<_> = missed.truth.hidden.iter().map(|own| Vector::from(own.sites[0])).collect();
    for own in detections(&complete, 0) {
        let distance = |other: &Vector<f64>| cell_box.shortest(other - own).norm();
        let nearest = |all: &[Vector<f64>]| all.iter().map(distance).fold(f64::INFINITY, f64::min);
        let (to_detection, to_hidden) = (nearest(&detections(&missed, 0)), nearest(&sites));
        assert!(
            to_detection > 0.0 && (to_hidden < 0.1) == (to_detection > 0.2),
            "{to_detection} {to_hidden}"
        );
    }
    assert_eq!(set("missed-5", 1).positions, missed.positions);
}

#[test]
fn merged_and_split_cells_keep_the_number_of_detections() {
    let set = set("merged-split", 2);
    assert_eq!((hidden(&set, Kind::Merged), set.truth.doubled), (2, 2));
    assert!(set.truth.hidden.iter().all(|own| own.sites.len() == 2));
    assert_eq!(detections(&set, 0).len(), CELLS);
}

#[test]
fn centroids_differ_from_sites_as_in_tissues() {
    let (sites, centroids) = (set("complete", 4), set("centroids", 4));
    let cell_box = PeriodicBox::new([10.0; 2]).unwrap();
    let pairs = detections(&sites, 0).into_iter().zip(detections(&centroids, 0));
    let squares: f64 = pairs.map(|(a, b)| cell_box.shortest(b - a).norm_squared()).sum();
    let noise = 4.0 * sites.truth.noise[0].powi(2);
    let rms = (squares / CELLS as f64 - noise).sqrt();
    assert!((0.04..0.12).contains(&rms), "{rms}");
}

#[test]
fn tracks_have_the_steps_they_are_named_after() {
    for (name, step) in [("tracks-05", 0.05), ("tracks-30", 0.3)] {
        let set = set(name, 5);
        assert!((set.truth.mean_step / step - 1.0).abs() < 0.06, "{name} {}", set.truth.mean_step);
        assert_eq!(set.positions.dim(), (6, CELLS, 2));
        let cell_box = PeriodicBox::new([10.0; 2]).unwrap();
        let (first, second) = (detections(&set, 0), detections(&set, 1));
        let steps = first.iter().zip(&second).map(|(a, b)| cell_box.shortest(b - a).norm());
        let mean = steps.sum::<f64>() / CELLS as f64;
        assert!((mean / step - 1.0).abs() < 0.3, "{name} {mean}");
    }
}

#[test]
fn broken_tracks_have_gaps_and_other_names() {
    let set = set("broken-tracks", 6);
    let gaps = hidden(&set, Kind::Gap);
    // 600 cells and frames, of which 3 % are missing.
    assert!((6..=32).contains(&gaps), "{gaps}");
    let seen: usize = (0..6).map(|frame| detections(&set, frame).len()).sum();
    assert_eq!(seen, 6 * CELLS - gaps);
    let tracks = set.positions.len_of(Axis(1));
    assert!((CELLS + 5..CELLS + 50).contains(&tracks), "{tracks}");
}

#[test]
fn an_open_field_is_part_of_a_tissue() {
    let set = set("all-at-once", 7);
    let seen = detections(&set, 0);
    assert!((85..=110).contains(&seen.len()), "{}", seen.len());
    assert!(seen.iter().all(|at| at.iter().all(|x| (0.0..10.0).contains(x))));
    assert!(hidden(&set, Kind::Gap) > 0);
}
