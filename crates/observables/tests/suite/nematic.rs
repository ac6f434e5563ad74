//! Defects of fields that are known, and of shapes that know nothing of each other.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::{FRAC_PI_3, PI, TAU};
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Vector};
use voronudge_observables::{
    Curve, Defect, Frame, Images, Nematic, Plan, Quantity, Recording, SQUARES, around_defects,
    defects_of_shapes, nematic,
};

const SIDE: usize = 24;

/// A frame of displaced cells of a square lattice of unit spacing.
fn tissue(seed: u64) -> Recording {
    let mut rng = Pcg64::seed_from_u64(seed);
    let cells: Vec<_> = (0..SIDE * SIDE)
        .map(|k| {
            let mut jitter = || 0.6 * (rng.random::<f64>() - 0.5);
            Some(Vector::new((k % SIDE) as f64 + jitter(), (k / SIDE) as f64 + jitter()))
        })
        .collect();
    let domain = Domain::Periodic(PeriodicBox::new([SIDE as f64; 2]).unwrap());
    Recording::new(&[0.0], vec![cells], &[domain], &FieldOfView::default(), Images::Nearest).unwrap()
}

fn found(recording: &Recording, shape: impl FnMut(&Vector<f64>) -> [f64; 2], width: f64) -> Vec<Defect> {
    let frame = &recording.frames()[0];
    let shapes = frame.positions.iter().map(shape).collect();
    defects_of_shapes(recording, 0, shapes, width)
}

fn of(all: &Nematic, quantity: Quantity) -> &Curve {
    all.curves.iter().find(|curve| curve.of == quantity).unwrap()
}

fn net(defects: &[Defect]) -> f64 {
    defects.iter().map(|own| own.charge).sum()
}

/// Four defects of a field of sines turned by an angle: comets turn by twice the angle of the director, arms by two thirds of it the other way.
#[test]
fn defects_are_where_they_were_put_and_point_where_they_should() {
    let recording = tissue(3);
    let side = SIDE as f64;
    for turn in [0.0, 0.7, -2.0] {
        let shape = |r: &Vector<f64>| {
            let (q, phase): (f64, f64) = (TAU / side, turn);
            let [x, y] = [(q * (r.x - 5.3)).sin(), (q * (r.y - 9.1)).sin()];
            [phase.cos() * x - phase.sin() * y, phase.sin() * x + phase.cos() * y]
        };
        let defects = found(&recording, shape, 1.5);
        assert_eq!(defects.len(), 4, "{defects:?}");
        let half = 0.5 * side;
        for (charge, x, y, direction, period) in [
            (0.5, 0.0, 0.0, PI + turn, TAU),
            (0.5, half, half, turn, TAU),
            (-0.5, half, 0.0, FRAC_PI_3 + turn / 3.0, 2.0 * FRAC_PI_3),
            (-0.5, 0.0, half, turn / 3.0, 2.0 * FRAC_PI_3),
        ] {
            let place = Vector::new(5.3 + x, 9.1 + y);
            let domain = recording.frames()[0].tessellation.domain();
            let near = |own: &&Defect| domain.shortest(own.position - place).norm() < 0.5;
            let own = defects.iter().find(near).unwrap();
            assert_eq!(own.charge, charge);
            let miss = (own.direction - direction) / period;
            assert!((miss - miss.round()).abs() * period < 0.15, "{own:?} {direction}");
        }
    }
}

/// Zeros of a Gaussian field: `1/4πw²` to a unit area, and as many of either sign.
#[test]
fn shapes_that_know_nothing_of_each_other_have_the_defects_of_a_gaussian_field() {
    let mut rng = Pcg64::seed_from_u64(7);
    for width in [1.5, 2.5] {
        let mut count = 0;
        let sets = 40;
        for seed in 0..sets {
            let angle = |_: &Vector<f64>| {
                let (angle, size) = (TAU * rng.random::<f64>(), rng.random::<f64>());
                [size * angle.cos(), size * angle.sin()]
            };
            let defects = found(&tissue(seed), angle, width);
            assert_eq!(net(&defects), 0.0);
            count += defects.len();
        }
        let expected = (sets as usize * SIDE * SIDE) as f64 / (4.0 * PI * width * width);
        let ratio = count as f64 / expected;
        // Zeros repel each other, so that their number scatters by less than its root.
        assert!((ratio - 1.0).abs() < 3.0 / expected.sqrt(), "{width}: {count} of {expected}");
    }
}

/// Cells around a comet move as a field of its own frame says, and stresses turn as tensors do.
#[test]
fn what_cells_do_around_defects_is_seen_from_these() {
    let mut recording = tissue(5);
    let plan = Plan::of(&recording).unwrap();
    let directions = [0.4, 2.9];
    let comet = |k: usize| Defect {
        frame: 0,
        position: Vector::new(6.0 + 12.0 * k as f64, 8.0),
        charge: 0.5,
        direction: directions[k],
        cell: 0,
    };
    let defects = [comet(0), comet(1)];
    let domain = recording.frames()[0].tessellation.domain();
    // 0.3 ahead and 0.1 to the left, and a rotation at a rate of 0.2.
    let velocity = |r: &Vector<f64>| {
        let own = defects.iter().min_by(|a, b| {
            let far = |own: &Defect| domain.shortest(r - own.position).norm();
            far(a).total_cmp(&far(b))
        });
        let own = own.unwrap();
        let (sine, cosine) = own.direction.sin_cos();
        let d = domain.shortest(r - own.position);
        let swirl = Vector::new(-d.y, d.x) * 0.2;
        Some(Vector::new(0.3 * cosine - 0.1 * sine, 0.3 * sine + 0.1 * cosine) + swirl)
    };
    let all: Vec<_> = recording.frames()[0].positions.iter().map(velocity).collect();
    recording = recording.with_velocities(&[all]).unwrap();
    let measured = around_defects(&recording, &plan, 1.5, defects.to_vec(), None);
    let flow = measured.flow[0].as_ref().unwrap();
    assert!(measured.flow[1].is_none());
    assert_eq!(flow.defects, 2);
    for (point, own) in flow.values.iter().enumerate().filter(|(point, _)| flow.counts[*point] > 0) {
        let place = |k: usize| k as f64 - (SQUARES / 2) as f64;
        let [x, y] = [place(point % SQUARES), place(point / SQUARES)];
        if x.abs().max(y.abs()) < 4.0 {
            assert!(
                (own[0] - 0.3 + 0.2 * y).abs() < 0.11 && (own[1] - 0.1 - 0.2 * x).abs() < 0.11,
                "{x} {y} {own:?}"
            );
        }
    }
    let [along, across, swirl] =
        [Quantity::DefectVelocityAlong, Quantity::DefectVelocityAcross, Quantity::SwirlAroundPlus]
            .map(|quantity| of(&measured, quantity));
    assert!((along.value[0] - 0.3).abs() < 0.1 && (across.value[0] - 0.1).abs() < 0.1);
    for (distance, value) in swirl.at.iter().zip(&swirl.value).skip(1) {
        assert!((value - 0.2 * distance).abs() < 0.08, "{distance}: {value}");
    }
    let tension = |frame: &Frame| {
        // One along the direction of the first comet.
        let (sine, cosine) = directions[0].sin_cos();
        vec![[[cosine * cosine, cosine * sine], [cosine * sine, sine * sine]]; frame.positions.len()]
    };
    let measured = around_defects(&recording, &plan, 1.5, defects[..1].to_vec(), Some(&tension));
    let stress = measured.stress[0].as_ref().unwrap();
    let centre = &stress.values[SQUARES * SQUARES / 2];
    assert!(centre.iter().zip([1.0, 0.0, 0.0, 0.0]).all(|(own, expected)| (own - expected).abs() < 1e-12));
}

/// The mirror image of a tissue has the same numbers but for the velocity to the left, which changes its sign.
#[test]
fn a_mirror_image_turns_left_into_right() {
    let measured = |mirror: f64| {
        let of = |frame: &Frame| -> Vec<_> {
            let x = |r: &Vector<f64>| Vector::new(mirror * r.x, r.y);
            frame.positions.iter().map(|r| Some(x(r))).collect()
        };
        let own = tissue(11);
        let domain = own.frames()[0].tessellation.domain();
        let places = of(&own.frames()[0]);
        let velocities = own.frames()[0]
            .positions
            .iter()
            .map(|r| Some(Vector::new(mirror * r.y.sin(), (0.7 * r.x).cos())))
            .collect();
        let seen = Recording::new(&[0.0], vec![places], &[domain], &FieldOfView::default(), Images::Nearest);
        let seen = seen.unwrap().with_velocities(&[velocities]).unwrap();
        nematic(&seen, &Plan::of(&seen).unwrap(), 1.5, None).unwrap()
    };
    let (own, other) = (measured(1.0), measured(-1.0));
    assert!(own.defects.len() > 10 && own.defects.len() == other.defects.len());
    assert_eq!(net(&own.defects), 0.0);
    for (own, other) in own.curves.iter().zip(&other.curves) {
        let sign = match own.of {
            Quantity::DefectVelocityAcross | Quantity::SwirlAroundPlus | Quantity::SwirlAroundMinus => -1.0,
            _ => 1.0,
        };
        for (a, b) in own.value.iter().zip(&other.value) {
            assert!((a - sign * b).abs() < 1e-9 || (a.is_nan() && b.is_nan()), "{:?}: {a} {b}", own.of);
        }
    }
}

/// In an open field they are told, and counted to an area, where all that has a say is seen.
#[test]
fn an_open_field_has_as_many_defects_to_a_unit_area() {
    let mut rng = Pcg64::seed_from_u64(9);
    let (mut ratios, sets, width) = (0.0, 40, 1.5);
    for seed in 0..sets {
        let cells = tissue(seed).frames()[0].positions.iter().copied().map(Some).collect();
        let recording =
            Recording::new(&[0.0], vec![cells], &[Domain::Open], &FieldOfView::default(), Images::Nearest)
                .unwrap();
        let plan = Plan::of(&recording).unwrap();
        let shape = |_: &Vector<f64>| {
            let angle = TAU * rng.random::<f64>();
            [angle.cos(), angle.sin()]
        };
        let defects = found(&recording, shape, width);
        let measured = around_defects(&recording, &plan, width / plan.spacing(), defects, None);
        ratios += of(&measured, Quantity::DefectDensity).value[0] * 4.0 * PI * width * width;
    }
    let ratio = ratios / sets as f64;
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
}
