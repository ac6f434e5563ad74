//! The figures of a channel.

use super::report::Findings;
use super::request::ChannelRequest;
use voronudge_infer::DecayShape;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, GREEN, GREY, INK, VERMILLION};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::page::Figure;
use voronudge_simulate::measure::{ChannelProfile, Estimate, ShapesByAge};

/// What is drawn.
#[derive(Clone, Copy)]
pub(super) struct Figures<'a> {
    pub request: &'a ChannelRequest,
    pub findings: &'a Findings,
    pub full: &'a ChannelProfile,
    pub folded: &'a ChannelProfile,
    pub by_age: &'a ShapesByAge,
}

/// Largest changes of a velocity by births on vertices, beside a mother, and in two where cells have cycles.
pub(super) type Disturbances<'a> = (&'a Vec<f64>, &'a Vec<f64>, Option<&'a Vec<f64>>);

/// Points of a curve that is a formula.
const STEPS: usize = 200;

impl Figures<'_> {
    pub fn density(&self) -> Figure {
        let label = format!("density (cells per {})", self.request.units.powers(2, 0));
        let points = [series("simulated", BLUE, Marker::Circle, &self.folded.centres, &self.folded.density)];
        let mut curves = self.decay("density", "exponential decay", BLUE);
        if let Some(continuum) = &self.findings.continuum {
            curves.push(curve(
                "continuum, mean-field moduli",
                GREY,
                Stroke::Dashed,
                continuum.flow.density.clone(),
            ));
        }
        if let Some(liquid) = &self.findings.liquid {
            let points = liquid.flow.density.clone();
            curves.push(curve("continuum, equation of state", VERMILLION, Stroke::Solid, points));
        }
        let svg = self.chart("density across the channel", [&self.distance(), &label], &points, &curves);
        Figure::new(
            svg,
            "Cells per area against the distance from the edge, both halves of the channel together. Bars are standard errors.",
        )
    }

    pub fn velocities(&self) -> Figure {
        let [v_x, v_y] = &self.folded.velocity;
        let mut points = [
            series("v_x, towards the middle", BLUE, Marker::Circle, &self.folded.centres, v_x),
            series("v_y, along the edge", VERMILLION, Marker::Diamond, &self.folded.centres, v_y),
        ];
        self.leave_out_edge_current(&mut points[1..]);
        let mut curves = self.decay("velocity_x", "exponential decay", BLUE);
        curves.extend(self.decay("velocity_y", "", VERMILLION));
        if let Some(continuum) = &self.findings.continuum {
            let [x, y] = continuum.flow.velocity.clone();
            curves.push(curve("continuum, mean-field moduli", BLUE, Stroke::Dashed, x));
            curves.push(curve("", VERMILLION, Stroke::Dashed, y));
        }
        if let Some(liquid) = &self.findings.liquid {
            let [x, y] = liquid.flow.velocity.clone();
            curves.push(curve("continuum, equation of state", BLUE, Stroke::Dotted, x));
            curves.push(curve("", VERMILLION, Stroke::Dotted, y));
        }
        let svg = self.chart("velocities", [&self.distance(), &self.velocity("velocity")], &points, &curves);
        let caption = "Mean velocities against the distance from the edge, both halves together, with signs as at the left edge: the \
                       channel is the same after a rotation by half a turn, which turns both components round.";
        Figure::new(
            svg,
            &self.with_note(
                caption,
                "v_y is left out where the edge current along the wall outweighs all else.",
            ),
        )
    }

    pub fn rates(&self) -> Figure {
        let label = format!("rate ({})", self.request.units.powers(0, -1));
        let points = [
            series("births", GREEN, Marker::Triangle, &self.folded.centres, &self.folded.birth_rate),
            series("extrusions", VERMILLION, Marker::Square, &self.folded.centres, &self.folded.death_rate),
        ];
        let extrusion = &self.request.turnover.extrusion;
        let given = self.along(|d| extrusion.at(d));
        let curves = [curve("rate of extrusion, as given", INK, Stroke::Dotted, given)];
        let svg = self.chart("births and extrusions", [&self.distance(), &label], &points, &curves);
        Figure::new(svg, "Births and extrusions per cell and time, as counted.")
    }

    pub fn conservation(&self) -> Figure {
        let label = format!("rate ({})", self.request.units.powers(0, -1));
        let points = [
            series("∂_x(ρ v_x)/ρ", BLUE, Marker::Circle, &self.folded.faces, &self.folded.flux_rate),
            series(
                "births − extrusions",
                VERMILLION,
                Marker::Diamond,
                &self.folded.faces,
                &self.folded.net_rate,
            ),
        ];
        let svg = self.chart("conservation of cells", [&self.distance(), &label], &points, &[]);
        Figure::new(
            svg,
            "What flows away from a place, per cell, and the net proliferation counted there: the same in the steady state, since cells \
             are conserved. Both are averages that fall off over the width of a bin on either side.",
        )
    }

    /// What moves along the channel between a place and the middle, and what drives it.
    pub fn momentum(&self) -> Figure {
        let units = &self.request.units;
        let label = format!("transport to the middle ({})", units.powers(0, -1));
        let faces = &self.folded.faces;
        let mut points = [
            series("∫ρ v_y dx", BLUE, Marker::Circle, faces, &self.folded.transport),
            series("shear stress", GREY, Marker::Square, faces, &self.folded.shear_stress),
            series("torques of the cells", VERMILLION, Marker::Diamond, faces, &self.folded.torque),
        ];
        self.leave_out_edge_current(&mut points);
        let curves: Vec<_> = (self.findings.liquid.iter())
            .map(|liquid| {
                let name = "torques of uniform tissues of the density there";
                curve(name, INK, Stroke::Dotted, liquid.transport.clone())
            })
            .collect();
        let svg = self.chart(
            "what drives the flow along the channel",
            [&self.distance(), &label],
            &points,
            &curves,
        );
        let caption = "Cells that flow along the channel between a distance and the middle, per time; the difference of the shear stress \
                       between the ends of that stretch, which balances their friction in the steady state; and half the difference of \
                       the density of torques, the part of the stress that cells bring about by turning.";
        Figure::new(svg, &self.with_note(caption, "Left out is the edge current beside the wall."))
    }

    /// Both velocities from edge to edge.
    pub fn edge_to_edge(&self) -> Figure {
        let [v_x, v_y] = &self.full.velocity;
        let points = [
            series("v_x", BLUE, Marker::Circle, &self.full.centres, v_x),
            series("v_y", VERMILLION, Marker::Diamond, &self.full.centres, v_y),
        ];
        let x = format!("x ({})", self.request.units.length_text());
        let svg = self.chart("from edge to edge", [&x, &self.velocity("velocity")], &points, &[]);
        let caption = "The same from edge to edge, not folded. Cells converge on the middle and slide past each other along it.";
        Figure::new(svg, &self.with_note(caption, "Along the walls runs an edge current."))
    }

    pub fn ratio(&self) -> Figure {
        let [v_x, v_y] = &self.folded.velocity;
        let place = |at: (&Estimate, &Estimate)| ErrorPoint {
            at: [at.0.value, at.1.value],
            error: [at.0.error, at.1.error],
        };
        let record = self.findings.report.chirality_from_flow.as_ref();
        let from = self.findings.from;
        let pick = |inner: bool| {
            let pairs = self.folded.centres.iter().zip(v_x.iter().zip(v_y));
            pairs.filter(|(d, _)| (**d >= from) == inner).map(|(_, at)| place(at)).collect()
        };
        let mut points = vec![
            PointSeries {
                label: "counts for the line",
                colour: BLUE,
                marker: Marker::Circle,
                points: pick(true),
            },
            PointSeries {
                label: "where cells are born",
                colour: GREY,
                marker: Marker::Square,
                points: pick(false),
            },
        ];
        if self.walled() {
            points.truncate(1);
        }
        let farthest = v_x.iter().map(|at| at.value).filter(|v| v.is_finite()).fold(0.0, f64::max);
        let through = |slope: f64| vec![[0.0, 0.0], [1.2 * farthest, 1.2 * farthest * slope]];
        let mut curves = Vec::new();
        if let Some(record) = record {
            curves.push(curve("line through the points", BLUE, Stroke::Solid, through(record.slope)));
        }
        if let Some(continuum) = &self.findings.continuum {
            curves.push(curve("α/(3 − a P_0/ℓ_0)", INK, Stroke::Dashed, through(continuum.record.ratio)));
        }
        let svg =
            self.chart("v_y against v_x", [&self.velocity("v_x"), &self.velocity("v_y")], &points, &curves);
        let caption = "Velocity along the edge against velocity towards the middle, one point for each distance. The dashed line is \
                       what the mean-field theory says for the chirality put in.";
        Figure::new(
            svg,
            &self.with_note(caption, "Points within the edge current along the wall are left out."),
        )
    }

    /// The share of births that disturb velocities by no more than the abscissa.
    pub fn disturbance(&self, (vertex, division, in_two): Disturbances<'_>) -> Figure {
        let cumulative = |values: &[f64]| -> Vec<[f64; 2]> {
            let mut sorted = values.to_vec();
            sorted.sort_by(f64::total_cmp);
            let share = |index: usize| (index + 1) as f64 / values.len() as f64;
            std::iter::once([0.0, 0.0])
                .chain(sorted.iter().enumerate().map(|(i, v)| [*v, share(i)]))
                .collect()
        };
        let beside = format!(
            "beside a mother, {} {}",
            self.request.division_distance,
            self.request.units.length_text()
        );
        let mut curves = vec![
            curve("on a vertex", BLUE, Stroke::Solid, cumulative(vertex)),
            curve(&beside, VERMILLION, Stroke::Dashed, cumulative(division)),
        ];
        if let Some(in_two) = in_two {
            curves.push(curve("division in two", GREEN, Stroke::Dotted, cumulative(in_two)));
        }
        let label = self.velocity("largest change of a velocity");
        let svg = self.chart("disturbance by a birth", [&label, "share of births below"], &[], &curves);
        Figure::new(
            svg,
            "How much one birth changes the velocity of a cell at once, at the end of the run, for random places of births: a new cell on \
             a vertex disturbs its surroundings less than one beside its mother.",
        )
    }

    /// Whether young cells have other shapes than old ones.
    pub fn shapes(&self) -> Figure {
        let ShapesByAge { distances, ages, shape_index, .. } = self.by_age;
        let unit = self.request.units.length_text();
        let colours = [BLUE, VERMILLION, GREEN, GREY, INK, BLUE];
        let markers = [Marker::Circle, Marker::Diamond, Marker::Square, Marker::Triangle];
        let oldest = ages.len() - 1;
        // The middle of a class of ages in its logarithm; of the oldest, and of the youngest, as if classes went on alike.
        let at = |class: usize| match class {
            class if class == oldest => ages[oldest - 1] * 2f64.sqrt(),
            class => ages[class] / 2f64.sqrt(),
        };
        let shown: Vec<usize> =
            (0..distances.len()).filter(|row| row % 2 == 0 || row + 1 == distances.len()).collect();
        let labels: Vec<String> = (shown.iter())
            .map(|&row| {
                let low = row.checked_sub(1).map_or(0.0, |before| distances[before]);
                match distances[row] {
                    high if high.is_finite() => format!("{low} to {high} {unit}"),
                    _ => format!("beyond {low} {unit}"),
                }
            })
            .collect();
        let points: Vec<_> = (shown.iter().zip(&labels).enumerate())
            .map(|(order, (&row, label))| PointSeries {
                label,
                colour: colours[order],
                marker: markers[order % markers.len()],
                points: (shape_index[row].iter().enumerate())
                    .filter(|(_, own)| own.value.is_finite())
                    .map(|(class, own)| ErrorPoint { at: [at(class), own.value], error: [None, own.error] })
                    .collect(),
            })
            .collect();
        let age = format!("age ({})", self.request.units.time_text());
        let svg = points_and_curves(&PointsAndCurves {
            title: "shapes of young and old cells",
            labels: [&age, "P/√A"],
            scales: [AxisScale::Logarithmic, AxisScale::Linear],
            series: &points,
            curves: &[],
        });
        Figure::new(
            svg,
            "Mean perimeter over the root of the area against the age of cells, for distances from the edge. The last points are of all older cells.",
        )
    }

    fn walled(&self) -> bool {
        self.request.walls.is_some()
    }

    /// Leaves out the points beside a wall, where the edge current outweighs all else.
    fn leave_out_edge_current(&self, series: &mut [PointSeries<'_>]) {
        if self.walled() {
            series.iter_mut().for_each(|own| own.points.retain(|point| point.at[0] >= self.findings.from));
        }
    }

    /// A caption, with what is to be added between walls.
    fn with_note(&self, caption: &str, between_walls: &str) -> String {
        if self.walled() { format!("{caption} {between_walls}") } else { caption.into() }
    }

    fn chart(
        &self,
        title: &str,
        labels: [&str; 2],
        series: &[PointSeries<'_>],
        curves: &[CurveSeries<'_>],
    ) -> String {
        points_and_curves(&PointsAndCurves { title, labels, scales: [AxisScale::Linear; 2], series, curves })
    }

    fn decay(&self, name: &str, label: &'static str, colour: &'static str) -> Vec<CurveSeries<'static>> {
        let found = self.findings.fits.iter().find(|(own, ..)| *own == name);
        let draw = |(_, fit, shape): &(&str, voronudge_infer::DecayFit, DecayShape)| {
            let from = self.findings.report.decays.get(name).map_or(0.0, |record| record.from);
            let points = self.along(|d| fit.at(d, self.findings.report.width, *shape));
            curve(label, colour, Stroke::Solid, points.into_iter().filter(|at| at[0] >= from).collect())
        };
        found.map(draw).into_iter().collect()
    }

    fn along(&self, value: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let middle = 0.5 * self.findings.report.width;
        (0..=STEPS).map(|step| middle * step as f64 / STEPS as f64).map(|d| [d, value(d)]).collect()
    }

    fn distance(&self) -> String {
        format!("distance from the edge ({})", self.request.units.length_text())
    }

    fn velocity(&self, what: &str) -> String {
        format!("{what} ({})", self.request.units.velocity_text())
    }
}

fn series<'a>(
    label: &'a str,
    colour: &'a str,
    marker: Marker,
    places: &[f64],
    values: &[Estimate],
) -> PointSeries<'a> {
    let point = |(x, at): (&f64, &Estimate)| ErrorPoint { at: [*x, at.value], error: [None, at.error] };
    PointSeries { label, colour, marker, points: places.iter().zip(values).map(point).collect() }
}

fn curve<'a>(label: &'a str, colour: &'a str, stroke: Stroke, points: Vec<[f64; 2]>) -> CurveSeries<'a> {
    CurveSeries { label, colour, stroke, points }
}
