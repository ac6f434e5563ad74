//! What cells do around defects, on average, each defect turned so that it points along x.

use super::defects::Defect;
use crate::curve::Sums;
use crate::pairs::wrapped;
use crate::{Curve, Plan, Quantity, Recording};
use std::f64::consts::TAU;
use voronudge_geometry::Vector;

/// Squares along each axis, of one mean spacing each, the middle one around the defect.
pub const SQUARES: usize = 9;

/// Width of the rings of the swirl, in mean spacings, and how many.
const RING: f64 = 0.5;
const RINGS: usize = 8;

/// Cells nearer to a defect than this, in mean spacings, tell how fast it moves.
const CORE: f64 = 1.0;

/// A field around defects of one sign, on squares of one mean spacing.
#[derive(Debug, Clone, PartialEq)]
pub struct Around {
    /// Defects that it rests on.
    pub defects: usize,
    /// Side of a square.
    pub square: f64,
    /// Mean values: those of the square in column `x` and row `y` from below at `y·SQUARES + x`, each with its components; NaN where no cell was.
    pub values: Vec<Vec<f64>>,
    /// Their standard errors.
    pub standard_errors: Vec<Vec<f64>>,
    /// Cells in each square.
    pub counts: Vec<usize>,
}

/// A quantity of cells by frame and cell that turns with the axes: components, and what they are in axes turned by an angle.
pub(super) trait Turning {
    const COMPONENTS: usize;
    fn seen_from(&self, angle: f64) -> Vec<f64>;
}

impl Turning for Vector<f64> {
    const COMPONENTS: usize = 2;

    fn seen_from(&self, angle: f64) -> Vec<f64> {
        let turned = turned(*self, -angle);
        vec![turned.x, turned.y]
    }
}

/// Row and column of a tensor.
impl Turning for [[f64; 2]; 2] {
    const COMPONENTS: usize = 4;

    fn seen_from(&self, angle: f64) -> Vec<f64> {
        let (sine, cosine) = angle.sin_cos();
        let axes = [[cosine, sine], [-sine, cosine]];
        let entry = |i: usize, j: usize| {
            (0..2)
                .flat_map(|k| (0..2).map(move |l| (k, l)))
                .map(|(k, l)| axes[i][k] * self[k][l] * axes[j][l])
                .sum()
        };
        vec![entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1)]
    }
}

/// The average of a quantity of the cells around defects of a sign. Those of −½ look alike from three sides, which are averaged.
pub(super) fn around<T: Turning>(
    (recording, plan): (&Recording, &Plan),
    (defects, charge): (&[Defect], f64),
    of_cell: impl Fn(usize, usize) -> Option<T>,
) -> Around {
    let mut sums: Vec<Sums> = (0..T::COMPONENTS).map(|_| Sums::new(SQUARES * SQUARES)).collect();
    let square = plan.spacing;
    let half = 0.5 * SQUARES as f64 * square;
    let own = || defects.iter().filter(move |defect| defect.charge == charge);
    for defect in own() {
        let sides = if charge > 0.0 { 1 } else { 3 };
        each_cell(recording, defect, half * std::f64::consts::SQRT_2, |cell, d| {
            let Some(value) = of_cell(defect.frame, cell) else { return };
            let part = plan.parts[recording.frames()[defect.frame].tracks[cell]];
            for side in 0..sides {
                let angle = defect.direction + TAU * f64::from(side) / f64::from(sides);
                let place = turned(d, -angle);
                let [column, row] = [place.x, place.y].map(|x| ((x + half) / square).floor());
                let within = |k: f64| (0.0..SQUARES as f64).contains(&k);
                if within(column) && within(row) {
                    let point = row as usize * SQUARES + column as usize;
                    for (sums, value) in sums.iter_mut().zip(value.seen_from(angle)) {
                        sums.add(point, part, value, 1.0);
                    }
                }
            }
        });
    }
    let components: Vec<Vec<(f64, f64)>> = sums.iter().map(|own| own.shares().collect()).collect();
    let rows = |of: fn(&(f64, f64)) -> f64| {
        (0..SQUARES * SQUARES).map(|point| components.iter().map(|own| of(&own[point])).collect()).collect()
    };
    Around {
        defects: own().count(),
        square,
        values: rows(|own| own.0),
        standard_errors: rows(|own| own.1),
        counts: sums.first().map_or_else(Vec::new, Sums::counts),
    }
}

/// How fast cells are at the heads of comets, along and across to the left of where these point, and how they swirl around defects of either sign: anticlockwise
/// velocity by distance.
pub(super) fn motion(recording: &Recording, plan: &Plan, defects: &[Defect]) -> [Curve; 4] {
    let [mut along, mut across] = [(); 2].map(|()| Sums::new(1));
    let mut swirls = [(); 2].map(|()| Sums::new(RINGS));
    let ring = RING * plan.spacing;
    for defect in defects {
        let frame = &recording.frames()[defect.frame];
        let is_comet = defect.charge > 0.0;
        each_cell(recording, defect, RINGS as f64 * ring, |cell, d| {
            let Some(velocity) = frame.velocities[cell].filter(|_| frame.counted[cell]) else { return };
            let part = plan.parts[frame.tracks[cell]];
            let distance = d.norm();
            if is_comet && distance < CORE * plan.spacing {
                let own = turned(velocity, -defect.direction);
                along.add(0, part, own.x, 1.0);
                across.add(0, part, own.y, 1.0);
            }
            let point = (distance / ring) as usize;
            if distance > 0.0 && point < RINGS {
                let around = (d.x * velocity.y - d.y * velocity.x) / distance;
                swirls[usize::from(!is_comet)].add(point, part, around, 1.0);
            }
        });
    }
    let distances: Vec<f64> = (0..RINGS).map(|k| (k as f64 + 0.5) * ring).collect();
    [
        along.curve(Quantity::DefectVelocityAlong, vec![0.0]),
        across.curve(Quantity::DefectVelocityAcross, vec![0.0]),
        swirls[0].curve(Quantity::SwirlAroundPlus, distances.clone()),
        swirls[1].curve(Quantity::SwirlAroundMinus, distances),
    ]
}

/// Each cell within reach of a defect, and where it is from there.
fn each_cell(recording: &Recording, defect: &Defect, reach: f64, mut then: impl FnMut(usize, Vector<f64>)) {
    let frame = &recording.frames()[defect.frame];
    let domain = frame.tessellation.domain();
    for cell in frame.in_view() {
        let d = domain.shortest(wrapped(frame, cell) - defect.position);
        if d.norm() <= reach {
            then(cell, d);
        }
    }
}

/// A vector turned anticlockwise.
fn turned(d: Vector<f64>, angle: f64) -> Vector<f64> {
    let (sine, cosine) = angle.sin_cos();
    Vector::new(cosine * d.x - sine * d.y, sine * d.x + cosine * d.y)
}
