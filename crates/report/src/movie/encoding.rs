//! A movie as a page holds it: JSON for what it is, and numbers of 16 bits in base64.
//!
//! The numbers lie one frame after another, each as follows (little-endian; N cells, S corners of all their polygons):
//!
//! | numbers | of | what |
//! |---|---|---|
//! | N | 32 bits | number of the cell in the data; all bits set if it has none |
//! | N | 8 bits | 0 used, 1 left out, 2 not detected, 3 uncertain |
//! | N | 8 bits | corners of the polygon; 0 if it is not closed or reaches far out of the picture |
//! | 2N | 16 bits | x and y of the centres, from one corner of `grid` to the other in 65534 steps |
//! | 2S | 16 bits | x and y of the corners, likewise |
//! | N for each quantity | 16 bits | its value, in 65534 steps over its `range`; [`UNKNOWN`] if there is none |
//! | 2N for each field of arrows | 16 bits | its components, in 65534 steps from `-most` to `most`; [`UNKNOWN`] likewise |

use super::{ArrowField, CellMovie, Quantity};
use crate::colour::{ColourScale, GREEN};
use crate::map::GREY;
use crate::numbers::Ticks;
use crate::view::{CellStatus, CellView, is_finite};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use schemars::JsonSchema;
use serde::Serialize;

/// Stands for a number that is not known.
pub const UNKNOWN: u16 = u16::MAX;
/// Steps from the least to the greatest number.
const STEPS: f64 = 65534.0;
/// How far corners are kept beyond the centres of the cells, in spacings.
const ROOM: f64 = 4.0;

#[derive(Serialize, JsonSchema)]
struct Header<'a> {
    frames: Vec<FrameHeader<'a>>,
    /// The frame to begin with.
    first: usize,
    /// Lower left and upper right corner of the picture and of the grid, in the unit of length.
    view: [[f64; 2]; 2],
    grid: [[f64; 2]; 2],
    spacing: f64,
    outline: Option<[[f64; 2]; 2]>,
    region: &'a [Vec<[f64; 2]>],
    length_unit: String,
    time_unit: String,
    quantities: Vec<QuantityHeader<'a>>,
    arrows: Vec<ArrowHeader<'a>>,
    /// Colours of those left out and of those not detected.
    left_out: &'static str,
    not_detected: &'static str,
    data: String,
}

#[derive(Serialize, JsonSchema)]
struct FrameHeader<'a> {
    label: &'a str,
    time: Option<f64>,
    cells: usize,
    corners: usize,
}

#[derive(Serialize, JsonSchema)]
struct QuantityHeader<'a> {
    name: &'a str,
    unit: &'a str,
    label: String,
    whole: bool,
    range: [f64; 2],
    limits: [f64; 2],
    extended: [bool; 2],
    ticks: Vec<(f64, String)>,
    colours: Vec<String>,
}

#[derive(Serialize, JsonSchema)]
struct ArrowHeader<'a> {
    name: &'a str,
    unit: String,
    colour: &'a str,
    most: f64,
    stretch: f64,
    reference: f64,
    text: &'a str,
}

impl CellMovie {
    /// The movie as JSON without the character `<`, so that it can stand in a script element.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`](crate::ReportError::Json) if it cannot be written.
    pub fn to_json(&self) -> Result<String, crate::ReportError> {
        let [low, high] = self.view.corners();
        let room = ROOM * self.view.spacing();
        let grid = [low.map(|x| x - room), high.map(|x| x + room)];
        let ranges: Vec<[f64; 2]> = self.quantities.iter().map(range).collect();
        let most: Vec<f64> = self.arrows.iter().map(largest).collect();
        let mut bytes = Vec::new();
        let mut frames = Vec::new();
        for (index, frame) in self.frames.iter().enumerate() {
            let corners: Vec<usize> = frame.cells.iter().map(|cell| corners(cell, grid)).collect();
            for cell in &frame.cells {
                let number = cell.number.and_then(|number| u32::try_from(number).ok()).unwrap_or(u32::MAX);
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(frame.cells.iter().map(|cell| code(cell.status)));
            // No polygon that is kept has as many as 256 corners.
            bytes.extend(corners.iter().map(|&count| count as u8));
            let mut push = |value: f64, range: [f64; 2]| bytes.extend(step(value, range).to_le_bytes());
            let mut point =
                |at: [f64; 2]| (0..2).for_each(|axis| push(at[axis], [grid[0][axis], grid[1][axis]]));
            frame.cells.iter().for_each(|cell| point(cell.centre));
            let closed = frame.cells.iter().zip(&corners).filter(|(_, count)| **count > 0);
            closed.for_each(|(cell, _)| cell.polygon.iter().copied().for_each(&mut point));
            for (quantity, &range) in self.quantities.iter().zip(&ranges) {
                quantity.values[index].iter().for_each(|&value| push(value, range));
            }
            for (field, &most) in self.arrows.iter().zip(&most) {
                let components = |v: &Option<[f64; 2]>| v.unwrap_or([f64::NAN; 2]);
                field.vectors[index].iter().flat_map(components).for_each(|value| push(value, [-most, most]));
            }
            frames.push(FrameHeader {
                label: &frame.label,
                time: frame.time,
                cells: frame.cells.len(),
                corners: corners.iter().sum(),
            });
        }
        let first = self.frames.first();
        let header = Header {
            frames,
            first: self.first_shown(),
            view: [low, high],
            grid,
            spacing: self.view.spacing(),
            outline: first.and_then(|frame| frame.outline),
            region: first.map_or(&[], |frame| &frame.region),
            length_unit: self.units.length_text(),
            time_unit: self.units.time_text(),
            quantities: self.quantities.iter().zip(ranges).map(QuantityHeader::new).collect(),
            arrows: self.arrows.iter().zip(most).map(|own| self.arrow_header(own)).collect(),
            left_out: GREY,
            not_detected: GREEN,
            data: STANDARD.encode(bytes),
        };
        Ok(serde_json::to_string(&header)?.replace('<', "\\u003c"))
    }

    fn arrow_header<'a>(&self, (field, most): (&'a ArrowField, f64)) -> ArrowHeader<'a> {
        let scale = field.scale();
        ArrowHeader {
            name: &field.name,
            unit: self.units.velocity_text(),
            colour: field.colour,
            most,
            stretch: scale.stretch,
            reference: scale.reference,
            text: &field.reference,
        }
    }
}

impl<'a> QuantityHeader<'a> {
    fn new((quantity, range): (&'a Quantity, [f64; 2])) -> Self {
        let limits = quantity.colours.limits();
        let ticks = Ticks::new(limits, 5);
        Self {
            name: &quantity.name,
            unit: &quantity.unit,
            label: ticks.axis_label(&quantity.label()),
            whole: quantity.colouring == super::Colouring::Neighbours,
            range,
            limits,
            extended: quantity.colours.extended(),
            ticks: ticks.labelled(),
            colours: (0..ColourScale::LEVELS).map(|level| quantity.colours.colour(level)).collect(),
        }
    }
}

/// Corners of the polygon of a cell that are kept.
fn corners(cell: &CellView, [low, high]: [[f64; 2]; 2]) -> usize {
    let is_near = |at: &[f64; 2]| (0..2).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]));
    let count = cell.polygon.len();
    if (3..256).contains(&count) && cell.polygon.iter().all(is_near) { count } else { 0 }
}

fn code(status: CellStatus) -> u8 {
    match status {
        CellStatus::Used => 0,
        CellStatus::LeftOut => 1,
        CellStatus::NotDetected => 2,
        CellStatus::Uncertain => 3,
    }
}

/// The step of a number in a range.
fn step(value: f64, [low, high]: [f64; 2]) -> u16 {
    if !value.is_finite() {
        return UNKNOWN;
    }
    ((value - low) / (high - low) * STEPS).round().clamp(0.0, STEPS) as u16
}

/// The least and the greatest value, with some room if they are the same.
fn range(quantity: &Quantity) -> [f64; 2] {
    let finite = quantity.values.iter().flatten().copied().filter(|value| value.is_finite());
    let ends = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    match ends {
        [low, high] if low < high => ends,
        [low, _] if low.is_finite() => [low - 1.0, low + 1.0],
        _ => [0.0, 1.0],
    }
}

/// The largest component.
fn largest(field: &ArrowField) -> f64 {
    let components = field.vectors.iter().flatten().flatten().filter(|v| is_finite(**v)).flatten();
    components.fold(0.0, |most: f64, x| most.max(x.abs())).max(f64::MIN_POSITIVE)
}
