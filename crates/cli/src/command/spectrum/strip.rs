//! A strip of the honeycomb with ends, and its modes at each wave number along it.

use super::lattice::Lattice;
use crate::arguments::{ChosenEffects, environment};
use crate::failure::Failure;
use crate::progress::Progress;
use clap::ValueEnum;
use ndarray::{Array1, Array2, Array3, Array4};
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use voronudge_geometry::{Domain, FieldOfView, PeriodicBox, Vector};
use voronudge_io::{DataSet, OutputDirectory, WalledSides};
use voronudge_model::{Model, Parameters, jacobian_with_images};
use voronudge_report::figure::WindingGrid;
use voronudge_simulate::moduli::{Motion, Relaxation, Settled};
use voronudge_simulate::{Simulation, Walls, recommended_time_step};
use voronudge_spectrum::{BlochMatrix, Complex64, Ends, Strip, StripMode, rows_of_honeycomb};

/// What ends the rows of `--lattice`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EndsName {
    /// Nothing: the last row meets the first.
    Periodic,
    /// A row at each end whose cells are held in place.
    Held,
    /// Torque-free walls, between which the cells have come to rest.
    Walls,
}

impl EndsName {
    fn ends(self) -> Ends {
        match self {
            Self::Periodic => Ends::Periodic,
            Self::Held => Ends::Held,
            Self::Walls => Ends::Walls,
        }
    }

    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Periodic => "periodic",
            Self::Held => "held",
            Self::Walls => "walls",
        }
    }
}

/// Wave numbers across the rows at which the periodic tissue is looked at.
const ACROSS: usize = 48;
/// Points of its loops.
const LOOP: usize = 720;
/// Points of the grid of winding numbers in each direction.
const GRID: usize = 81;
/// Wave numbers between two looks at whether to go on.
const CHUNK: usize = 8;
/// Time in 1/K_P that a honeycomb between walls is given to come to rest.
const LONGEST: f64 = 50.0;
/// Speed of the fastest cell, in ℓ₀ K_P, below which implicit steps are tried.
const SLOW: f64 = 0.1;
/// Most wave numbers that are looked at.
const MOST: usize = 10_000;

/// A honeycomb with ends.
pub(super) struct EndedLattice {
    pub strip: Strip,
    pub ends: EndsName,
    pub rows: usize,
    positions: Vec<Vector<f64>>,
    held: Vec<bool>,
    /// Speed of the fastest cell that moves.
    pub speed: f64,
}

impl EndedLattice {
    pub fn new(
        lattice: &Lattice,
        ends: EndsName,
        (parameters, effects): (&Parameters<f64>, &ChosenEffects),
    ) -> Result<Self, Failure> {
        let ([columns, rows], lengths) = (lattice.size, lattice.honeycomb.lengths());
        // Half a distance of rows from both ends.
        let right = lengths[0] * (1.0 - 0.5 / rows as f64);
        let shifted = lattice.honeycomb.positions().iter().map(|r| Vector::new(r.x + right, r.y));
        let (mut positions, mut speed) = (shifted.collect::<Vec<_>>(), 0.0);
        let cell_box = PeriodicBox::new(lengths).map_err(|error| Failure::new(error.to_string()))?;
        let tessellation = lattice.honeycomb.tessellation();
        let view = FieldOfView::everywhere().judge(tessellation, &positions);
        let surroundings = environment(tessellation, &positions, &view)?;
        let domain = Domain::Periodic(cell_box);
        let model = effects.add_to(Model::chiral_voronoi(parameters), surroundings, domain)?;
        let jacobian = if ends == EndsName::Walls {
            let settled = at_rest(positions, domain, model, parameters)?;
            let simulation = settled.simulation();
            (positions, speed) = (simulation.positions().to_vec(), settled.speed());
            let (all, mirrors) = (simulation.positions_with_images(), Walls::X.mirrors());
            let cells = positions.len();
            jacobian_with_images(simulation.tessellation(), all, simulation.model(), mirrors, cells)
        } else {
            lattice.honeycomb.jacobian(&model)
        };
        let row_of = rows_of_honeycomb(columns, rows, ends.ends());
        let strip = Strip::new(&jacobian, &positions, lengths, &row_of, effects.is_empty())?;
        let held = row_of.iter().map(Option::is_none).collect();
        Ok(Self { strip, ends, rows, positions, held, speed })
    }

    /// The lattice as data: where its cells are, and its walls.
    pub fn data_set(&self, lattice: &Lattice) -> DataSet {
        let positions = &self.positions;
        DataSet {
            positions: Array3::from_shape_fn((1, positions.len(), 2), |(_, cell, axis)| {
                positions[cell][axis]
            }),
            walls: (self.ends == EndsName::Walls).then_some(WalledSides::X),
            ..lattice.data_set()
        }
    }

    /// Whether a cell is held where it is.
    pub fn is_held(&self, cell: usize) -> bool {
        self.held[cell]
    }
}

/// Cells of a honeycomb between walls, come to rest.
fn at_rest(
    positions: Vec<Vector<f64>>,
    domain: Domain,
    model: Model<f64>,
    parameters: &Parameters<f64>,
) -> Result<Settled, Failure> {
    let rate = parameters.perimeter_elasticity.abs().max(f64::MIN_POSITIVE);
    let usual = Relaxation::default();
    let relaxation = Relaxation {
        time_step: recommended_time_step(parameters, 1.0),
        longest: LONGEST / rate,
        tolerance: usual.tolerance * rate,
        slow: SLOW * rate,
    };
    let simulation = Simulation::new(positions, domain, model)?.with_walls(Walls::X)?;
    let settled = Settled::new(&simulation, &relaxation, &|| ControlFlow::Continue(()))?;
    if settled.motion() == Motion::Flowing {
        return Err(Failure::new(format!(
            "the honeycomb between walls does not come to rest: after a time of {:.3e} the fastest cell moves at {:.1e}",
            relaxation.longest,
            settled.speed()
        ))
        .with_hint(
            "chirality drives currents along torque-free walls; lower P_0 or the chirality, or take --ends held",
        ));
    }
    Ok(settled)
}

/// The modes of a strip at all wave numbers along it, and at one of them in detail.
pub(super) struct Bands {
    pub wave_numbers: Vec<f64>,
    pub modes: Vec<Vec<StripMode>>,
    /// The values of the periodic tissue at each wave number.
    pub periodic: Vec<Vec<[Complex64; 2]>>,
    /// The wave number that is shown.
    pub shown_at: f64,
    pub shown: Vec<StripMode>,
    /// Both values of the periodic tissue there, once around the zone.
    pub loops: [Vec<[f64; 2]>; 2],
    pub winding: WindingGrid,
}

/// Refuses wave numbers that cannot be.
pub(super) fn check(count: usize, shown_at: Option<f64>) -> Result<(), Failure> {
    if !(1..=MOST).contains(&count) {
        return Err(Failure::new(format!("--wave-numbers {count} is not between 1 and {MOST}"))
            .with_hint("64 shows the bands; --wave-number Q looks at one"));
    }
    if let Some(q) = shown_at.filter(|q| !q.is_finite()) {
        return Err(Failure::new(format!("--wave-number {q} is not finite"))
            .with_hint("give a wave number along the rows in 1/ℓ₀; 0 to 2.92 is all there is"));
    }
    Ok(())
}

impl Bands {
    pub fn new(
        strip: &Strip,
        (count, shown_at): (usize, Option<f64>),
        progress: &mut Progress,
    ) -> Result<Self, Failure> {
        let wave_numbers = strip.wave_numbers(count);
        let mut modes = Vec::new();
        for chunk in wave_numbers.chunks(CHUNK) {
            modes.extend(strip.bands(chunk)?);
            let (done, all) = (modes.len() as u64, wave_numbers.len() as u64);
            if progress.step("wave numbers", done, all).is_break() {
                return Err(Failure::interrupted());
            }
        }
        let shown_at = shown_at.unwrap_or_else(|| most_piled_up(&wave_numbers, &modes));
        let shown = strip.modes(shown_at)?;
        let periodic = strip.periodic(shown_at);
        let loops = [0, 1].map(|branch| {
            let values = around(&periodic, LOOP).into_iter().map(|values| values[branch]);
            let mut line: Vec<[f64; 2]> = values.map(|value| [value.re, value.im]).collect();
            line.extend(line.first().copied());
            line
        });
        let winding = winding_grid(&periodic, &loops)?;
        let periodic = wave_numbers.iter().map(|&q| around(&strip.periodic(q), ACROSS)).collect();
        Ok(Self { wave_numbers, modes, periodic, shown_at, shown, loops, winding })
    }

    /// Writes strip_wave_numbers.npy, strip_eigenvalues.npy, strip_edge.npy, strip_localisation.npy, periodic_eigenvalues.npy, and of the wave number that is
    /// shown strip_profiles.npy, strip_rows.npy and winding.npy.
    pub fn write(&self, out: &mut OutputDirectory, strip: &Strip) -> Result<(), Failure> {
        let (count, order, h) = (self.wave_numbers.len(), 2 * strip.places().len(), strip.spacing());
        let of = |[q, index]: [usize; 2]| &self.modes[q][index];
        out.write_array("strip_wave_numbers.npy", Array1::from_vec(self.wave_numbers.clone()).view())?;
        let values = Array3::from_shape_fn((count, order, 2), |(q, index, part)| {
            let value = of([q, index]).value;
            if part == 0 { value.re } else { value.im }
        });
        out.write_array("strip_eigenvalues.npy", values.view())?;
        let edge = Array3::from_shape_fn((count, order, 2), |(q, index, part)| {
            let own = of([q, index]).localisation;
            if part == 0 { own.edge } else { own.side }
        });
        out.write_array("strip_edge.npy", edge.view())?;
        let localisation = Array3::from_shape_fn((count, order, 5), |(q, index, part)| {
            let mode = of([q, index]);
            let roots = |own: fn(&voronudge_spectrum::MiddleRoots) -> f64| {
                mode.middle_roots.as_ref().map_or(f64::NAN, |roots| own(roots) / h)
            };
            match part {
                0 => mode.localisation.centre,
                1 => mode.localisation.growth,
                2 => roots(|roots| roots.below),
                3 => roots(|roots| roots.above),
                _ => f64::from(mode.winding),
            }
        });
        out.write_array("strip_localisation.npy", localisation.view())?;
        let periodic = Array4::from_shape_fn((count, ACROSS, 2, 2), |(q, across, branch, part)| {
            let value = self.periodic[q][across][branch];
            if part == 0 { value.re } else { value.im }
        });
        out.write_array("periodic_eigenvalues.npy", periodic.view())?;
        let profiles =
            Array2::from_shape_fn((order, order / 2), |(index, row)| self.shown[index].profile[row]);
        out.write_array("strip_profiles.npy", profiles.view())?;
        out.write_array("strip_rows.npy", Array1::from_vec(strip.places().to_vec()).view())?;
        let (across, grid) = (self.winding.real.len(), &self.winding);
        let table = Array2::from_shape_fn((grid.numbers.len(), 3), |(point, part)| match part {
            0 => grid.real[point % across],
            1 => grid.imaginary[point / across],
            _ => f64::from(grid.numbers[point]),
        });
        out.write_array("winding.npy", table.view())?;
        Ok(())
    }
}

/// Both values of the periodic tissue at wave numbers once around the zone.
fn around(periodic: &BlochMatrix, steps: usize) -> Vec<[Complex64; 2]> {
    let beta = |step: usize| Complex64::from_polar(1.0, TAU * step as f64 / steps as f64);
    (0..steps).map(|step| periodic.eigenvalues(beta(step))).collect()
}

/// The wave number, not below zero, at which the periodic tissue has modes grow fastest across the strip, in the mean square.
fn most_piled_up(wave_numbers: &[f64], modes: &[Vec<StripMode>]) -> f64 {
    let size = |modes: &[StripMode]| -> f64 {
        let of_strip = modes.iter().filter(|mode| !mode.is_of_edge(mode.profile.len()));
        of_strip.filter_map(|mode| mode.middle_roots).map(|roots| roots.growth().powi(2)).sum()
    };
    let own = wave_numbers.iter().zip(modes).filter(|(q, _)| **q >= 0.0);
    let largest = own.max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)));
    largest.map_or(0.0, |(q, _)| *q)
}

/// Winding numbers on a grid that holds the loops.
fn winding_grid(periodic: &BlochMatrix, loops: &[Vec<[f64; 2]>; 2]) -> Result<WindingGrid, Failure> {
    let ends = |part: usize| {
        let values = || loops.iter().flatten().map(move |value| value[part]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let room = 0.05 * (high - low).max(1e-9);
        (0..GRID).map(|k| low - room + (high - low + 2.0 * room) * k as f64 / (GRID - 1) as f64).collect()
    };
    let (real, imaginary): (Vec<f64>, Vec<f64>) = (ends(0), ends(1));
    let mut numbers = Vec::new();
    for im in &imaginary {
        for re in &real {
            numbers.push(periodic.winding(Complex64::new(*re, *im))?);
        }
    }
    Ok(WindingGrid { real, imaginary, numbers })
}
