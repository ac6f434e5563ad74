//! How the cells of an interval push each other on their ways, solved for what happened to each by itself ([`super::own_motion`]).

use super::block::Block;
use super::objective::MovieObjective;
use super::own_motion::{Freed, OwnMotion};
use super::tangent::Tangent;
use crate::Error;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::sync::Arc;

impl OwnMotion {
    /// At a point of a fit of cells that crawl.
    pub fn at(objective: &MovieObjective<'_>, parameters: &[f64]) -> Result<Option<Self>, Error> {
        if objective.memory.is_none() {
            return Ok(None);
        }
        let placed = objective.displaced(parameters)?;
        let coefficients = objective.space.coefficients(objective.split(parameters).0);
        let of_interval = |(interval, passage)| {
            let tangent = Tangent::of_ways(objective, interval, passage, coefficients.as_slice());
            Freed::new(&tangent, &objective.states.intervals[interval].led)
        };
        let intervals: Vec<Freed> = placed.passages.par_iter().enumerate().map(of_interval).collect();
        Ok((!intervals.is_empty()).then(|| Self { intervals: Arc::new(intervals) }))
    }
}

impl Freed {
    /// From where cells end by their ways.
    fn new(tangent: &Tangent, led: &[bool]) -> Self {
        let cells = led.len();
        // The row of U of a cell: cells and blocks.
        let pushed = |cell: usize| {
            let by_ways =
                move |(column, block): (usize, &'_ Block)| Some((column.checked_sub(2 * cells)?, *block));
            tangent.row(cell).filter_map(by_ways)
        };
        let row = |cell: usize| -> Vec<(usize, Block)> {
            if !led[cell] {
                return Vec::new();
            }
            let near: Vec<usize> = pushed(cell).map(|(other, _)| other).collect();
            let mut transposed = DMatrix::zeros(2 * near.len(), 2 * near.len());
            for (i, one) in near.iter().enumerate() {
                for (other, [xx, xy, yx, yy]) in pushed(*one) {
                    let Some(j) = near.iter().position(|cell| *cell == other) else { continue };
                    (transposed[(2 * j, 2 * i)], transposed[(2 * j + 1, 2 * i)]) = (xx, xy);
                    (transposed[(2 * j, 2 * i + 1)], transposed[(2 * j + 1, 2 * i + 1)]) = (yx, yy);
                }
            }
            let own = near.iter().position(|other| *other == cell).unwrap_or(0);
            let mut unit = DMatrix::zeros(2 * near.len(), 2);
            (unit[(2 * own, 0)], unit[(2 * own + 1, 1)]) = (1.0, 1.0);
            let freed = transposed.lu().solve(&unit).unwrap_or(unit);
            let block = |k: usize| {
                [freed[(2 * k, 0)], freed[(2 * k + 1, 0)], freed[(2 * k, 1)], freed[(2 * k + 1, 1)]]
            };
            near.iter().enumerate().map(|(k, other)| (*other, block(k))).collect()
        };
        let mut own = Self { start: vec![0], column: Vec::new(), block: Vec::new() };
        for all in (0..cells).map(row) {
            for (other, block) in all {
                own.column.push(other as u32);
                own.block.push(block);
            }
            own.start.push(own.column.len());
        }
        own
    }
}
