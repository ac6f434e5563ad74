//! Avalanches of T1 transitions: what is asked of them, the array, and the section of the page.

use crate::arguments::positive;
use crate::command::recorded::Recorded;
use crate::failure::Failure;
use clap::Args;
use ndarray::Array2;
use voronudge_io::{DataSet, OutputDirectory};
use voronudge_model::{Model, Parameters, stress};
use voronudge_observables::{Avalanche, Avalanches, Curve, Exchange, Plan, Quantity, avalanches, drops};
use voronudge_report::Units;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREY, VERMILLION};
use voronudge_report::figure::{ErrorPoint, PointSeries, PointsAndCurves, points_and_curves};
use voronudge_report::infer_report::Quantity as Amount;
use voronudge_report::markers::Marker;
use voronudge_report::observe_report::ObservedAvalanches;
use voronudge_report::page::{Block, Figure, Section};
use voronudge_report::units::label_with_unit;

#[derive(Debug, Args)]
pub(super) struct AvalancheArguments {
    /// Time within which T1 transitions belong together: to one avalanche if their cells touch, and to one burst
    /// wherever they are [default: the time between two frames].
    #[arg(long, value_name = "TIME", allow_negative_numbers = true, help_heading = "Measurements")]
    burst_time: Option<f64>,
}

/// What was found.
pub(super) struct Found {
    pub avalanches: Avalanches,
    threshold: f64,
    drops: Option<Vec<f64>>,
}

impl AvalancheArguments {
    /// Checks what is asked.
    pub fn check(&self) -> Result<(), Failure> {
        self.burst_time.map(|time| positive("--burst-time", time)).transpose().map(|_| ())
    }

    /// The avalanches of transitions, with falls of the shear stress of a model, if one is given; none where there are no transitions.
    pub fn measure(
        &self,
        recorded: &Recorded,
        (plan, exchanges): (&Plan, &[Exchange]),
        model: Option<&Parameters<f64>>,
        seed: u64,
    ) -> Option<Found> {
        if exchanges.is_empty() {
            return None;
        }
        let threshold = self.burst_time.unwrap_or_else(|| plan.interval());
        let recording = &recorded.recording;
        let mut avalanches = avalanches(recording, plan, exchanges, threshold, seed);
        let drops = model.map(Model::chiral_voronoi).map(|model| {
            let shear = recording.frames().iter().map(|frame| {
                let [[_, xy], [yx, _]] =
                    stress(&frame.tessellation, &frame.positions, &model, |cell| frame.counted[cell]);
                0.5 * (xy + yx)
            });
            let (drops, mean) = drops(recording, &avalanches.whole, &shear.collect::<Vec<_>>());
            avalanches.curves.push(mean);
            drops
        });
        Some(Found { avalanches, threshold, drops })
    }
}

impl Found {
    pub fn record(&self, units: &Units) -> ObservedAvalanches {
        ObservedAvalanches {
            threshold: Amount { value: self.threshold, unit: units.time.clone() },
            avalanches: self.avalanches.local.len(),
            bursts: self.avalanches.whole.len(),
        }
    }

    /// `avalanches.npy` (n, 10): 0 of an avalanche in space and 1 of a burst anywhere, frames of the first and the last transition, transitions, cells, duration, x, y, extent and, of
    /// bursts, the fall of the shear stress, in the axes of the data.
    pub fn write(&self, out: &mut OutputDirectory, data: &DataSet, frames: &[usize]) -> Result<(), Failure> {
        let flip = data.y_sign();
        let row = |kind: f64, own: &Avalanche, drop: f64| {
            let [first, last] = own.frames.map(|frame| frames[frame] as f64);
            let place = own.position;
            let (size, cells) = (own.size as f64, own.cells as f64);
            [kind, first, last, size, cells, own.duration, place.x, flip * place.y, own.extent, drop]
        };
        let fall = |burst: usize| self.drops.as_ref().map_or(f64::NAN, |drops| flip * drops[burst]);
        let local = self.avalanches.local.iter().map(|own| row(0.0, own, f64::NAN));
        let whole = self.avalanches.whole.iter().enumerate().map(|(burst, own)| row(1.0, own, fall(burst)));
        let rows: Vec<[f64; 10]> = local.chain(whole).collect();
        let table = Array2::from_shape_fn((rows.len(), 10), |(row, column)| rows[row][column]);
        Ok(out.write_array("avalanches.npy", table.view())?)
    }

    pub fn section(&self, units: &Units) -> Section {
        let both = |title, labels, pairs: &[[Quantity; 2]], names: &[[&str; 2]], caption: &str| {
            self.picture((title, labels), pairs, names, caption)
        };
        let names = [["avalanches", "the same transitions at each other's times"], ["bursts", "at any time"]];
        let sizes = [
            [Quantity::AvalancheSizes, Quantity::AvalancheSizesShuffled],
            [Quantity::BurstSizes, Quantity::BurstSizesShuffled],
        ];
        let by_time = [
            [Quantity::AvalancheThreshold, Quantity::AvalancheThresholdShuffled],
            [Quantity::BurstThreshold, Quantity::BurstThresholdShuffled],
        ];
        let size = "T1 transitions s";
        let time = label_with_unit("longest time between transitions", &units.time);
        let figures = vec![
            both(
                "sizes of avalanches",
                [size, "share P(s)"],
                &sizes[..1],
                &names[..1],
                "How many T1 transitions an avalanche has: a chain of which each touches the next, in space and within the threshold in time.",
            ),
            both(
                "sizes of bursts in the whole field",
                [size, "share P(s)"],
                &sizes[1..],
                &names[1..],
                "How many T1 transitions follow each other within the threshold, wherever they are.",
            ),
            both(
                "size against the threshold",
                [&time, "⟨s²⟩/⟨s⟩"],
                &by_time[..1],
                &names[..1],
                "Mean size of the avalanche that a T1 transition belongs to, against the time within which two have to touch. Where it depends on this time, so do the \
                 avalanches.",
            ),
            both(
                "size against the threshold, whole field",
                [&time, "⟨s²⟩/⟨s⟩"],
                &by_time[1..],
                &names[1..],
                "The same of bursts. In a larger field more transitions follow each other.",
            ),
        ];
        Section::new("Avalanches of T1 transitions").with(Block::pairs(figures))
    }

    fn curve(&self, of: Quantity) -> Option<&Curve> {
        self.avalanches.curves.iter().find(|curve| curve.of == of)
    }

    fn picture(
        &self,
        (title, labels): (&str, [&str; 2]),
        pairs: &[[Quantity; 2]],
        names: &[[&str; 2]],
        caption: &str,
    ) -> Figure {
        let looks = [
            [(BLUE, Marker::Circle), (GREY, Marker::Square)],
            [(VERMILLION, Marker::Diamond), (GREY, Marker::Square)],
        ];
        let one = |of: Quantity, name, (colour, marker)| {
            let points = self.curve(of).map_or_else(Vec::new, points);
            PointSeries { label: name, colour, marker, points }
        };
        let series: Vec<PointSeries<'_>> = (pairs.iter().zip(names).zip(looks))
            .flat_map(|((pair, names), looks)| [0, 1].map(|k| one(pair[k], names[k], looks[k])))
            .collect();
        let svg = points_and_curves(&PointsAndCurves {
            title,
            labels,
            scales: [AxisScale::Logarithmic; 2],
            series: &series,
            curves: &[],
        });
        Figure::new(svg, caption)
    }
}

/// What is above zero, with bars that do not reach it.
fn points(curve: &Curve) -> Vec<ErrorPoint> {
    (0..curve.at.len())
        .filter(|k| curve.value[*k] > 0.0)
        .map(|k| {
            let error = curve.standard_error[k];
            let told = Some(error).filter(|error| error.is_finite() && *error < 0.95 * curve.value[k]);
            ErrorPoint { at: [curve.at[k], curve.value[k]], error: [None, told] }
        })
        .collect()
}
