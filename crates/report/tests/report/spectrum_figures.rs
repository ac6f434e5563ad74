//! Figures of linear modes.

use voronudge_report::figure::{
    BandPart, DispersionPart, DispersionPoint, DrawnMode, SpectrumPoint, StripPoint, StripSide, WindingGrid,
    complex_spectrum, density_of_states, dispersion, mode_map, strip_bands, strip_spectrum,
};
use voronudge_report::{CellStatus, CellView, FrameView, Units};

fn units() -> Units {
    Units { length: "um".into(), time: "h".into() }
}

fn points(count: usize) -> Vec<SpectrumPoint> {
    let point = |k: usize| SpectrumPoint {
        rate: if k == 399 { -9e3 } else { -(k as f64) },
        frequency: (k as f64).sin(),
        participation: Some(if k.is_multiple_of(5) { 0.02 } else { 0.6 }),
    };
    (0..count).map(point).collect()
}

#[test]
fn localised_modes_and_outliers_are_told_apart() {
    let svg = complex_spectrum(&points(400), "1/h");
    assert!(svg.contains("a localised mode") && svg.contains("outside the axes"), "{svg}");
    let unknown: Vec<_> =
        points(20).into_iter().map(|point| SpectrumPoint { participation: None, ..point }).collect();
    let svg = complex_spectrum(&unknown, "1/h");
    assert!(!svg.contains("a localised mode") && !svg.contains("outside"));
    assert!(complex_spectrum(&[], "1/h").contains("no data"));
    let rest = [SpectrumPoint { rate: 0.0, frequency: 0.0, participation: None }];
    assert!(complex_spectrum(&rest, "1/h").contains("rate of growth"));
}

#[test]
fn densities_are_shares_per_unit() {
    let values: Vec<f64> = (0..50).map(|k| k as f64 / 50.0).collect();
    let svg = density_of_states("density", "angular frequency", "1/h", &values);
    assert!(svg.contains("angular frequency") && svg.contains("h⁻¹"));
    assert!(density_of_states("density", "rate", "1/h", &[]).contains("no data"));
    assert!(density_of_states("density", "rate", "1/h", &[f64::NAN]).contains("no data"));
}

#[test]
fn dispersion_has_a_key_for_what_it_draws() {
    let point = |k: usize| DispersionPoint {
        distance: k as f64,
        corner: [Some("Γ"), None, Some("K")][k % 3],
        exact: [[k as f64, 0.0], [2.0 * k as f64, 0.0]],
        theory: Some([[k as f64, 0.0], [2.0 * k as f64, 0.0]]),
    };
    let with: Vec<_> = (0..9).map(point).collect();
    let svg = dispersion(&with, DispersionPart::Decay, "1/h");
    assert!(svg.contains("mean-field theory") && svg.contains(">Γ<") && svg.contains(">K<"));
    let without: Vec<_> = with.iter().map(|point| DispersionPoint { theory: None, ..*point }).collect();
    assert!(!dispersion(&without, DispersionPart::Frequency, "1/h").contains("mean-field theory"));
    assert!(dispersion(&[], DispersionPart::Decay, "1/h").contains("no data"));
}

fn frame(cells: usize) -> FrameView {
    let cell = |k: usize| {
        let centre = [(k % 50) as f64, (k / 50) as f64];
        CellView {
            number: Some(k),
            centre,
            polygon: vec![
                [centre[0] - 0.5, centre[1] - 0.5],
                [centre[0] + 0.5, centre[1] - 0.5],
                [centre[0] + 0.5, centre[1] + 0.5],
                [centre[0] - 0.5, centre[1] + 0.5],
            ],
            area: 1.0,
            perimeter: 4.0,
            status: CellStatus::Used,
            measured: None,
            vorticity: None,
            predicted: None,
            polarity: None,
            held_out: None,
            nudge: [0.0; 2],
        }
    };
    FrameView { label: "frame 0".into(), cells: (0..cells).map(cell).collect(), ..FrameView::default() }
}

#[test]
fn modes_that_oscillate_move_unless_there_are_too_many_cells() {
    let mode = |cells: usize, frequency: f64| DrawnMode {
        title: "mode".into(),
        displacements: vec![[[1.0, 0.0], [0.0, 1.0]]; cells],
        frequency,
    };
    let moving = mode_map(&frame(100), &mode(100, 2.0), &units());
    assert_eq!(moving.matches("<animateMotion").count(), 100);
    let many = mode_map(&frame(1600), &mode(1600, 2.0), &units());
    assert!(!many.contains("<animateMotion"));
    let still = mode_map(&frame(100), &mode(100, 0.0), &units());
    assert!(!still.contains("<circle") && !still.contains("clockwise"));
    let absent = DrawnMode { displacements: vec![[[f64::NAN; 2]; 2]; 100], ..mode(100, 1.0) };
    assert!(mode_map(&frame(100), &absent, &units()).contains("no data"));
}

#[test]
fn strips_have_keys_for_what_is_in_them() {
    let point = |k: usize| StripPoint {
        value: [-(k as f64), (k as f64).cos()],
        side: [StripSide::Left, StripSide::Right, StripSide::Neither][k % 3],
        of_edge: k == 4,
    };
    let points: Vec<_> = (0..9).map(point).collect();
    let circle = |k: usize| [-4.0 + 3.0 * (0.1 * k as f64).cos(), (0.1 * k as f64).sin()];
    let loops = vec![(0..63).map(circle).collect()];
    let grid = WindingGrid {
        real: vec![-5.0, -4.0, -3.0],
        imaginary: vec![0.0, 0.3],
        numbers: vec![1, 1, 0, 0, 1, -1],
    };
    let svg = strip_spectrum(&points, &loops, &grid, "1/h");
    for label in
        ["piles up left", "piles up right", "fills the strip", "right edge", "winds by +1", "winds by −1"]
    {
        assert!(svg.contains(label), "{label}");
    }
    assert!(!svg.contains("left edge"));
    assert!(strip_spectrum(&[], &[], &WindingGrid::default(), "1/h").contains("no data"));
    for part in [BandPart::Rate, BandPart::Frequency] {
        let periodic = vec![vec![[0.5, 1.0]; 3]; 2];
        let svg = strip_bands(&[-1.0, 1.0], &[points.clone(), points.clone()], &periodic, part, &units());
        assert!(svg.contains("wave number") && svg.contains("piles up left") && svg.contains("periodic"));
        assert!(strip_bands(&[], &[], &[], part, &units()).contains("no data"));
    }
}
