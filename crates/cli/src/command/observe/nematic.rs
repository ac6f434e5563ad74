//! Shapes of cells as a nematic: what is asked of them, arrays, and the section of the page.

use super::curves::figure;
use crate::arguments::{ParameterArguments, named};
use crate::command::drawing::{borders, cells_view};
use crate::command::recorded::Recorded;
use crate::failure::Failure;
use clap::Args;
use ndarray::{Array2, Array4};
use std::path::Path;
use voronudge_geometry::shape_tensors;
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_model::{Model, Parameters, cell_stresses};
use voronudge_observables::{
    Around, Defect, Frame, Nematic, Plan, Quantity, SQUARES, largest_width, nematic,
};
use voronudge_report::Units;
use voronudge_report::figure::{AroundDefects, DefectMark, around_defects, defect_map};
use voronudge_report::infer_report::Quantity as Amount;
use voronudge_report::observe_report::ObservedNematic;
use voronudge_report::page::{Block, Figure, Section};

/// Smoothing width in mean spacings, if none is given.
const WIDTH: f64 = 1.5;

/// Names of the signs of defects in files.
const SIGNS: [&str; 2] = ["plus", "minus"];

#[derive(Debug, Args)]
pub(super) struct NematicArguments {
    /// Standard deviation of the Gaussian that smooths cell shapes to a director, in mean cell spacings [default:
    /// 1.5, less in small boxes].
    #[arg(long, value_name = "WIDTH", allow_negative_numbers = true, help_heading = "Measurements")]
    director_width: Option<f64>,
    /// Also average the stresses of a model around defects. Its parameters are the options under Model.
    #[arg(long, help_heading = "Measurements")]
    stress: bool,
    #[command(flatten)]
    parameters: ParameterArguments,
}

/// What was measured, and how.
pub(super) struct Measured {
    pub nematic: Nematic,
    width: f64,
    model: Option<Parameters<f64>>,
}

impl NematicArguments {
    /// Parameters of the model whose stresses are asked for.
    pub fn model(&self) -> Result<Option<Parameters<f64>>, Failure> {
        if !self.stress && self.parameters.is_given() {
            return Err(Failure::new("parameters of a model are given, but nothing is asked of it")
                .with_hint("add --stress, or leave them out"));
        }
        self.stress.then(|| self.parameters.resolve()).transpose()
    }

    pub fn parameters_file(&self) -> Option<&Path> {
        self.parameters.file()
    }

    /// Order and defects.
    pub fn measure(
        &self,
        recorded: &Recorded,
        plan: &Plan,
        model: Option<Parameters<f64>>,
    ) -> Result<Measured, Failure> {
        let usual = || WIDTH.min(largest_width(&recorded.recording, plan));
        let width = self.director_width.unwrap_or_else(usual);
        let tissue = model.as_ref().map(Model::chiral_voronoi);
        let stresses = tissue
            .as_ref()
            .map(|tissue| move |frame: &Frame| cell_stresses(&frame.tessellation, &frame.positions, tissue));
        let stresses = stresses.as_ref().map(|of| of as _);
        let nematic = nematic(&recorded.recording, plan, width, stresses)?;
        Ok(Measured { nematic, width: width * plan.spacing(), model })
    }
}

impl Measured {
    pub fn record(&self, units: &Units) -> ObservedNematic {
        let count = |charge: f64| self.nematic.defects.iter().filter(|own| own.charge == charge).count();
        ObservedNematic {
            smoothing_width: Amount { value: self.width, unit: units.length.clone() },
            plus: count(0.5),
            minus: count(-0.5),
            stress_of: self.model.as_ref().map(named),
        }
    }

    /// `defects.npy` (n, 5): frame, x, y, charge and direction, in the axes of the data; `flow_around_*.npy` and `stress_around_*.npy` (9, 9, components, 2): mean and
    /// standard error.
    pub fn write(&self, out: &mut OutputDirectory, data: &DataSet, frames: &[usize]) -> Result<(), Failure> {
        let flip = data.y_sign();
        let row = |own: &Defect| {
            let place = own.position;
            [frames[own.frame] as f64, place.x, flip * place.y, own.charge, flip * own.direction]
        };
        let rows: Vec<[f64; 5]> = self.nematic.defects.iter().map(row).collect();
        let table = Array2::from_shape_fn((rows.len(), 5), |(row, column)| rows[row][column]);
        out.write_array("defects.npy", table.view())?;
        for (what, all) in [("flow", &self.nematic.flow), ("stress", &self.nematic.stress)] {
            for (sign, own) in SIGNS.iter().zip(all) {
                if let Some(own) = own {
                    out.write_array(&format!("{what}_around_{sign}.npy"), on_squares(own).view())?;
                }
            }
        }
        Ok(())
    }

    pub fn section(&self, frame: &Frame, frame_label: String, units: &Units) -> Section {
        let mut view =
            cells_view(frame_label, &frame.tessellation, &frame.positions, |cell| frame.counted[cell]);
        view.region = borders(frame.region.as_ref(), 1.0);
        let mut shapes = shape_tensors(&frame.tessellation, &frame.positions);
        for (shape, counts) in shapes.iter_mut().zip(&frame.counted) {
            if !counts {
                *shape = [f64::NAN; 2];
            }
        }
        let mark = |own: &Defect| DefectMark {
            place: [own.position.x, own.position.y],
            is_plus: own.charge > 0.0,
            direction: own.direction,
        };
        let marks: Vec<DefectMark> =
            self.nematic.defects.iter().filter(|own| own.frame == 0).map(mark).collect();
        let caption = "Long axes of the cells of the first frame; a line is the longer, the longer its cell is. Around a defect of the smoothed director the axes \
            turn by half a turn.";
        let mut figures = vec![Figure::new(defect_map(&view, &shapes, &marks, units), caption)];
        for (is_plus, (flow, stress)) in
            [true, false].into_iter().zip(self.nematic.flow.iter().zip(&self.nematic.stress))
        {
            if let Some(flow) = flow {
                figures
                    .push(Figure::new(picture(is_plus, flow, stress.as_ref(), units), &said(is_plus, flow)));
            }
        }
        let curves = [Quantity::NematicCorrelation, Quantity::SwirlAroundPlus, Quantity::SwirlAroundMinus];
        let found = curves.iter().filter_map(|of| self.nematic.curves.iter().find(|curve| curve.of == *of));
        figures.extend(found.filter_map(|curve| figure(curve, units)));
        Section::new("Shapes as a nematic").with(Block::pairs(figures))
    }
}

fn picture(is_plus: bool, flow: &Around, stress: Option<&Around>, units: &Units) -> String {
    let velocity = |own: &Vec<f64>| own.iter().all(|v| v.is_finite()).then(|| [own[0], own[1]]);
    let velocities: Vec<_> = flow.values.iter().map(velocity).collect();
    let tension: Option<Vec<f64>> =
        stress.map(|own| own.values.iter().map(|entry| 0.5 * (entry[0] + entry[3])).collect());
    let around = AroundDefects {
        is_plus,
        square: flow.square,
        squares: SQUARES,
        velocities: &velocities,
        tension: tension.as_deref(),
    };
    around_defects(&around, units)
}

fn said(is_plus: bool, flow: &Around) -> String {
    let sort = match is_plus {
        true => "+½, each turned so that the head of its comet points to the right",
        false => "−½, each turned so that an arm points to the right, all three in turn",
    };
    format!("Mean velocity of cells around {} defects of {sort}.", flow.defects)
}

/// (rows, columns, components, 2): means and standard errors.
fn on_squares(around: &Around) -> Array4<f64> {
    let components = around.values.first().map_or(0, Vec::len);
    Array4::from_shape_fn((SQUARES, SQUARES, components, 2), |(row, column, component, which)| {
        let point = row * SQUARES + column;
        [&around.values, &around.standard_errors][which][point][component]
    })
}
