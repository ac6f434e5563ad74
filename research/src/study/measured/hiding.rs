//! Detections of a measured data set hidden on purpose: which are found again?

use super::count::Count;
use super::latent::{self, Place};
use super::program::{Program, Run};
use crate::Outcome;
use ndarray::{Array3, Axis, Slice};
use rand::seq::SliceRandom;
use std::error::Error;
use std::ops::Range;
use std::path::Path;
use voronudge_geometry::{Domain, Vector};
use voronudge_io::{Boundary, DataSet, OutputDirectory, Source, YAxis};
use voronudge_simulate::generator;

/// Farther than this from a hidden cell, in ℓ₀, a latent cell is another one.
const NEAR: f64 = 0.3;
/// A cell is inside if the directions to others within this many spacings leave no gap of a right angle.
const AROUND: f64 = 2.5;

/// Frames of a measured data set.
pub struct Movie {
    data: DataSet,
    spacing: f64,
}

impl Movie {
    /// Some frames of an open data set: of a single one with velocities by central differences.
    pub fn read(folder: &Path, first: usize, frames: usize) -> Result<Self, Box<dyn Error>> {
        let source = Source { folder: Some(folder.to_path_buf()), ..Source::default() };
        let mut data = source.load()?;
        if data.boundary != Boundary::Open || data.flow.is_some() {
            return Err("cells are hidden in open fields of view of cells".into());
        }
        if first + frames > data.frames() || frames == 0 {
            return Err(format!("the data set has {} frames", data.frames()).into());
        }
        if frames == 1 {
            if first == 0 || first + 1 == data.frames() {
                return Err("central differences need the frames before and after".into());
            }
            let around = |frame: usize| frames_of(&data.positions, frame..frame + 1);
            // NaN where the cell is absent, in this frame or beside it.
            let absent = around(first) * 0.0;
            data.velocities =
                Some((around(first + 1) - around(first - 1)) / (2.0 * data.frame_interval) + absent);
        } else {
            data.velocities = None;
        }
        data.labels = None;
        // In memory y is up; so it is in the sets made from this one.
        data.y_axis = YAxis::Up;
        data.positions = frames_of(&data.positions, first..first + frames);
        let spacing = spacing(&data.positions);
        Ok(Self { data, spacing })
    }

    fn place(&self, frame: usize, cell: usize) -> Option<Vector<f64>> {
        place(&self.data.positions, frame, cell)
    }

    /// Detections that can be found again: inside, and of a movie within a track.
    fn candidates(&self) -> Vec<(usize, usize)> {
        let (frames, cells) = (self.data.frames(), self.data.cells());
        let mut candidates = Vec::new();
        for frame in if frames == 1 { 0..1 } else { 1..frames - 1 } {
            let present: Vec<_> = (0..cells).filter_map(|cell| self.place(frame, cell)).collect();
            for cell in 0..cells {
                let is_tracked = frames == 1
                    || [frame - 1, frame + 1].iter().all(|other| self.place(*other, cell).is_some());
                let is_inside = |at: Vector<f64>| is_surrounded(at, &present, AROUND * self.spacing);
                if is_tracked && self.place(frame, cell).is_some_and(is_inside) {
                    candidates.push((frame, cell));
                }
            }
        }
        candidates
    }

    /// The same data without some detections.
    fn without(&self, hidden: &[(usize, usize)]) -> DataSet {
        let mut data = self.data.clone();
        for (frame, cell) in hidden {
            for array in std::iter::once(&mut data.positions).chain(&mut data.velocities) {
                (0..2).for_each(|axis| array[[*frame, *cell, axis]] = f64::NAN);
            }
        }
        data
    }
}

fn frames_of(array: &Array3<f64>, frames: Range<usize>) -> Array3<f64> {
    array.slice_axis(Axis(0), Slice::from(frames)).to_owned()
}

fn place(positions: &Array3<f64>, frame: usize, cell: usize) -> Option<Vector<f64>> {
    let at = Vector::new(positions[[frame, cell, 0]], positions[[frame, cell, 1]]);
    at.x.is_finite().then_some(at)
}

/// Median distance to the nearest cell in the first frame.
fn spacing(positions: &Array3<f64>) -> f64 {
    let cells: Vec<_> = (0..positions.len_of(Axis(1))).filter_map(|cell| place(positions, 0, cell)).collect();
    let nearest = |own: &Vector<f64>| {
        let others = cells.iter().map(|other| (other - own).norm()).filter(|distance| *distance > 0.0);
        others.fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = cells.iter().map(nearest).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(0.0)
}

fn is_surrounded(at: Vector<f64>, cells: &[Vector<f64>], reach: f64) -> bool {
    let near = cells.iter().map(|cell| cell - at).filter(|to| to.norm() > 0.0 && to.norm() < reach);
    let mut angles: Vec<f64> = near.map(|to| to.y.atan2(to.x)).collect();
    angles.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else {
        return false;
    };
    let around = first + std::f64::consts::TAU - last;
    angles.windows(2).map(|pair| pair[1] - pair[0]).fold(around, f64::max) < std::f64::consts::FRAC_PI_2
}

/// What a run says of cells that were not seen, and its ℓ₀.
struct Found {
    latent: Vec<Place>,
    unit: f64,
    seconds: f64,
}

fn found(program: &Program, data: &DataSet, folder: &Path) -> Result<Found, Box<dyn Error>> {
    let (input, out) = (folder.join("data"), folder.join("infer"));
    let mut directory = OutputDirectory::create(&input)?;
    data.save(&mut directory)?;
    directory.commit()?;
    let Run { report, seconds, message } = program.run(&["infer"], &input, &out)?;
    let report = report.ok_or(message)?;
    let unit = report["length_scale"]["value"].as_f64().ok_or("a report without a length scale")?;
    let latent =
        latent::read(&input, &out, Domain::Open, unit)?.ok_or("the program names no latent cells")?;
    Ok(Found { latent, unit, seconds })
}

/// Hides a share of the detections that can be found again, for each seed anew, and prints what is found.
pub fn run(program: &Program, movie: &Movie, share: f64, seeds: Range<u64>, folder: &Path) -> Outcome {
    let candidates = movie.candidates();
    let count = (share * candidates.len() as f64).round() as usize;
    let complete = found(program, &movie.data, &folder.join("nothing-hidden"))?;
    println!(
        "{} frames, {} detections that can be hidden; {} latent cells and {:.1} s with none hidden\n",
        movie.data.frames(),
        candidates.len(),
        complete.latent.len(),
        complete.seconds
    );
    println!(
        "| seed | hidden | found again | latent cells that are hidden ones or were there before | s |\n|---|---|---|---|---|"
    );
    let near = NEAR * complete.unit;
    let is_known = |own: &Place| {
        let same = complete.latent.iter().filter(|other| other.frame == own.frame);
        same.map(|other| (other.at - own.at).norm()).any(|distance| distance <= near)
    };
    let (mut recall, mut precision) = (Vec::new(), Vec::new());
    for seed in seeds {
        let mut order = candidates.clone();
        order.shuffle(&mut generator(seed));
        let hidden = &order[..count];
        let Found { latent, seconds, .. } =
            found(program, &movie.without(hidden), &folder.join(format!("hidden-{seed}")))?;
        let place = |&(frame, cell): &(usize, usize)| Some(Place { frame, at: movie.place(frame, cell)? });
        let places: Vec<Place> = hidden.iter().filter_map(place).collect();
        let matched = latent::matches(&latent, &places, Domain::Open, near);
        let is_right = |index: usize| matched.contains(&Some(index)) || is_known(&latent[index]);
        recall.push(Count::of(matched.iter().map(Option::is_some)));
        precision.push(Count::of((0..latent.len()).map(is_right)));
        let (recall, precision) = (recall[recall.len() - 1], precision[precision.len() - 1]);
        println!("| {seed} | {count} | {recall} | {precision} | {seconds:.1} |");
    }
    let (recall, precision): (Count, Count) = (recall.into_iter().sum(), precision.into_iter().sum());
    println!("| all | | {recall} | {precision} | |");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_at_a_rim_are_not_surrounded() {
        let square: Vec<_> = (0..9).map(|k| Vector::new(f64::from(k % 3), f64::from(k / 3))).collect();
        let inside: Vec<bool> = square.iter().map(|at| is_surrounded(*at, &square, 1.5)).collect();
        assert_eq!(inside.iter().filter(|own| **own).count(), 1);
        assert!(inside[4]);
    }
}
