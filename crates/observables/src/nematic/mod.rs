//! Nematic order of the shapes of cells, and defects of the director field.
//!
//! The shape of a cell is the traceless tensor of its sides, `Q = Σ ℓ t⊗t / P − ½` ([`voronudge_geometry::CellPolygon::shape_tensor`]). The director field is the sum of the
//! shapes of the cells around a place, weighted by Gaussians of standard deviation w of their distances. Where it vanishes the director turns by half a turn
//! around: a defect. Shapes that know nothing of each other have `1/4πw²` defects to a unit area (of either sign, all together), by the density of zeros of a Gaussian
//! field (Halperin 1981): fewer than that are a sign of order.

mod around;
mod defects;
mod director;

use crate::curve::Sums;
use crate::pairs;
use crate::{Curve, Error, Frame, Plan, Quantity, Recording};
pub use around::{Around, SQUARES};
pub use defects::Defect;
use director::DirectorField;
use rayon::prelude::*;
use voronudge_geometry::{Domain, Vector, shape_tensors};

/// What is measured of the shapes of cells as a nematic.
#[derive(Debug, Clone, PartialEq)]
pub struct Nematic {
    /// Numbers and functions.
    pub curves: Vec<Curve>,
    /// Defects of the frames whose configurations are measured.
    pub defects: Vec<Defect>,
    /// Velocities around defects of +½ and of −½, along the direction of the defect and to its left; `None` if there are none of the sign, or no velocities.
    pub flow: [Option<Around>; 2],
    /// Stresses there: `σ_xx, σ_xy, σ_yx, σ_yy` in axes of which x is that direction.
    pub stress: [Option<Around>; 2],
}

/// Stresses of the cells of a frame, row = component of the force.
pub type Stresses = Vec<[[f64; 2]; 2]>;

/// Nematic order and defects of a director smoothed over a Gaussian of a standard deviation in mean spacings. `stresses_of` tells the stresses of the cells of a frame,
/// if they are to be averaged around defects.
///
/// # Errors
/// [`Error::SmoothingWidth`] if the width is not positive, or more than the [`largest_width`].
pub fn nematic(
    recording: &Recording,
    plan: &Plan,
    width: f64,
    stresses_of: Option<&(dyn Fn(&Frame) -> Stresses + Sync)>,
) -> Result<Nematic, Error> {
    let largest = largest_width(recording, plan);
    if !(width > 0.0 && width <= largest && width.is_finite()) {
        return Err(Error::SmoothingWidth { width, largest });
    }
    let own_width = width * plan.spacing;
    let of_frame = |number: &usize| {
        let field = DirectorField::new(&recording.frames()[*number], own_width);
        defects::of_frame(recording, *number, &field, own_width)
    };
    let defects: Vec<Defect> = plan.stills.par_iter().map(of_frame).collect::<Vec<_>>().concat();
    Ok(around_defects(recording, plan, width, defects, stresses_of))
}

/// The defects of a frame, given by its number, of other shapes of its cells than their own: tensors (N), the first row `Q_xx, Q_xy` of each. The director is smoothed over a
/// Gaussian of standard deviation `width`, in the unit of the positions.
pub fn defects_of_shapes(
    recording: &Recording,
    frame: usize,
    shapes: Vec<[f64; 2]>,
    width: f64,
) -> Vec<Defect> {
    let field = DirectorField::of_shapes(&recording.frames()[frame], shapes, width);
    defects::of_frame(recording, frame, &field, width)
}

/// As [`nematic`], of defects that are known, told by a director smoothed over `width` mean spacings.
pub fn around_defects(
    recording: &Recording,
    plan: &Plan,
    width: f64,
    defects: Vec<Defect>,
    stresses_of: Option<&(dyn Fn(&Frame) -> Stresses + Sync)>,
) -> Nematic {
    let frames = recording.frames();
    let velocity = |frame: usize, cell: usize| frames[frame].velocities[cell];
    let sides = [0.5, -0.5].map(|charge| (defects.iter().any(|own| own.charge == charge), charge));
    let flow = sides.map(|(any, charge)| {
        (any && recording.has_velocities())
            .then(|| around::around::<Vector<f64>>((recording, plan), (&defects, charge), velocity))
    });
    let all: Option<Vec<Option<Stresses>>> = stresses_of.map(|of| {
        let needed = |frame: usize| defects.iter().any(|own| own.frame == frame);
        (0..frames.len()).into_par_iter().map(|frame| needed(frame).then(|| of(&frames[frame]))).collect()
    });
    let stress = sides.map(|(any, charge)| {
        let all = all.as_ref().filter(|_| any)?;
        let of_cell = |frame: usize, cell: usize| all[frame].as_ref().map(|own| own[cell]);
        Some(around::around((recording, plan), (&defects, charge), of_cell))
    });
    let mut curves = shapes(recording, plan);
    curves.push(pairs::shape_correlation(recording, plan));
    curves.push(density(recording, plan, &defects, width * plan.spacing));
    if recording.has_velocities() && !defects.is_empty() {
        curves.extend(around::motion(recording, plan, &defects));
    }
    curves.retain(|curve| curve.value.iter().any(|value| value.is_finite()));
    Nematic { curves, defects, flow, stress }
}

/// The largest width over which a director can be smoothed, in mean spacings: a quarter of the side of a periodic box.
pub fn largest_width(recording: &Recording, plan: &Plan) -> f64 {
    let of_frame = |frame: &Frame| match frame.tessellation.domain() {
        Domain::Periodic(own) => 0.25 * own.lengths()[0].min(own.lengths()[1]) / plan.spacing,
        Domain::Open => f64::INFINITY,
    };
    recording.frames().iter().map(of_frame).fold(f64::INFINITY, f64::min)
}

/// How long cells are, and how much along one axis.
fn shapes(recording: &Recording, plan: &Plan) -> Vec<Curve> {
    let mut lengths = Sums::new(1);
    let mut orders = Vec::new();
    for frame in plan.stills.iter().map(|frame| &recording.frames()[*frame]) {
        let all = shape_tensors(&frame.tessellation, &frame.positions);
        let (mut sum, mut moduli) = (Vector::zeros(), 0.0);
        for cell in frame.in_view() {
            let [x, y] = all[cell];
            let own = Vector::new(x, y);
            sum += own;
            moduli += own.norm();
            lengths.add(0, plan.parts[frame.tracks[cell]], 2.0 * own.norm(), 1.0);
        }
        orders.push(sum.norm() / moduli);
    }
    // Frames are not independent of each other, and parts have orders of their own: no error is told.
    let order = Curve {
        of: Quantity::NematicOrder,
        at: vec![0.0],
        value: vec![orders.iter().sum::<f64>() / orders.len() as f64],
        standard_error: vec![f64::NAN],
        count: vec![orders.len()],
    };
    vec![lengths.curve(Quantity::Elongation, vec![0.0]), order]
}

/// Defects of either sign to a unit area of the triangles in which they are told.
fn density(recording: &Recording, plan: &Plan, defects: &[Defect], width: f64) -> Curve {
    let mut sums = Sums::new(1);
    for frame in plan.stills.iter().map(|frame| &recording.frames()[*frame]) {
        for triangle in defects::triangles(frame, width) {
            let part = plan.parts[frame.tracks[triangle.cells[0]]];
            sums.add(0, part, 0.0, triangle.area());
        }
    }
    for defect in defects {
        let track = recording.frames()[defect.frame].tracks[defect.cell];
        sums.add(0, plan.parts[track], 1.0, 0.0);
    }
    let mut curve = sums.curve(Quantity::DefectDensity, vec![0.0]);
    curve.count = vec![defects.len()];
    curve
}
