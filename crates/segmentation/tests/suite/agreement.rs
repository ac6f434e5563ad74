//! How well a tessellation tells true shapes.

use std::collections::BTreeSet;
use voronudge_geometry::{
    Domain, FieldOfView, PeriodicBox, Tessellation, Vector, areas, honeycomb, perimeters,
};
use voronudge_segmentation::{MeasuredShape, agreement};

/// True shapes that are the Voronoi polygons agree; one contact less and one more are counted as such.
#[test]
fn a_tessellation_agrees_with_itself() {
    let (mut positions, lengths) = honeycomb(6, 8);
    for (k, r) in positions.iter_mut().enumerate() {
        *r += Vector::new((7.0 * k as f64).sin(), (5.0 * k as f64).cos()) * 0.1;
    }
    let tessellation =
        Tessellation::new(&positions, Domain::Periodic(PeriodicBox::new(lengths).unwrap())).unwrap();
    let view = FieldOfView::default().judge(&tessellation, &positions);
    let (a, p) = (areas(&tessellation, &positions), perimeters(&tessellation, &positions));
    let shapes: Vec<Option<MeasuredShape>> =
        a.iter().zip(&p).map(|(&area, &perimeter)| Some(MeasuredShape { area, perimeter })).collect();
    let mut contacts: BTreeSet<[usize; 2]> =
        tessellation.edges().into_iter().map(|(a, b, _)| [a.min(b) as usize, a.max(b) as usize]).collect();
    let same = agreement(&tessellation, &positions, &view, &shapes, &contacts);
    assert_eq!((same.cells, same.precision(), same.recall()), (48, 1.0, 1.0));
    assert!((same.area_correlation - 1.0).abs() < 1e-12 && (same.perimeter_ratio - 1.0).abs() < 1e-12);
    let count = contacts.len() as f64;
    contacts.pop_first();
    let fewer = agreement(&tessellation, &positions, &view, &shapes, &contacts);
    assert!((fewer.precision() - (count - 1.0) / count).abs() < 1e-12);
    assert_eq!(fewer.recall(), 1.0);
}
