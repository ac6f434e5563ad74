//! Measured, predicted and residual velocities on a grid, as an imaging velocimetry gives them.

use super::no_data;
use super::velocity_map::{VelocityField, arrow_legend};
use crate::arrows::{ArrowScale, Arrows};
use crate::colour::GREY;
use crate::map::{Legend, Map, Viewport};
use crate::markers::Marker;
use crate::numbers::quantile;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::view::{FrameView, is_finite, length};

/// Size of the crosses of missing points in pixels.
const CROSS: f64 = 2.2;
/// Stroke of these crosses.
const CROSS_WIDTH: f64 = 1.1;

/// Velocities on a rectangular grid over one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowMap<'a> {
    /// The cells to draw beneath.
    pub frame: &'a FrameView,
    /// Positions of the columns.
    pub x: Vec<f64>,
    /// Positions of the rows.
    pub y: Vec<f64>,
    /// Measured velocities row by row, the rows along `y`.
    pub measured: Vec<Option<[f64; 2]>>,
    /// Velocities that the fitted model gives at the same points.
    pub predicted: Vec<Option<[f64; 2]>>,
    /// Velocities that fits predict which did not see them.
    pub held_out: Vec<Option<[f64; 2]>>,
}

impl FlowMap<'_> {
    /// The scale at which the 95th percentile of the measured (failing those, predicted) speeds is
    /// 1.3 grid spacings long, the same for all `flows`. `None` where nothing moves.
    #[must_use]
    pub fn scale(flows: &[Self]) -> Option<ArrowScale> {
        let speeds = |field: VelocityField| flows.iter().flat_map(move |flow| flow.speeds(field));
        let spacing = quantile(flows.iter().filter_map(FlowMap::spacing), 0.5)?;
        ArrowScale::of_speeds(speeds(VelocityField::Measured), speeds(VelocityField::Predicted), spacing)
    }

    /// The scale at which the 95th percentile of the residual speeds is 1.3 grid spacings long, the
    /// same for all `flows`. `None` where no residual is known.
    #[must_use]
    pub fn residual_scale<'b>(flows: impl Iterator<Item = &'b Self> + Clone) -> Option<ArrowScale>
    where
        Self: 'b,
    {
        let spacing = quantile(flows.clone().filter_map(FlowMap::spacing), 0.5)?;
        let speeds = flows.flat_map(|flow| flow.speeds(VelocityField::Residual));
        ArrowScale::of_speeds(speeds, std::iter::empty(), spacing)
    }

    /// The known speeds of one field.
    fn speeds(&self, field: VelocityField) -> impl Iterator<Item = f64> + '_ {
        self.points(field).filter_map(|(_, velocity)| velocity).map(length)
    }

    /// Typical distance between grid points.
    fn spacing(&self) -> Option<f64> {
        let steps = |values: &[f64]| -> Vec<f64> {
            values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect()
        };
        let all = steps(&self.x).into_iter().chain(steps(&self.y));
        quantile(all, 0.5).filter(|&spacing| spacing > 0.0)
    }

    /// The grid points and the tips of all arrows of some fields but the longest.
    pub(super) fn reach(&self, fields: &[VelocityField], scale: &ArrowScale) -> Vec<[f64; 2]> {
        let arrows = fields.iter().copied().flat_map(|field| self.points(field));
        let ends = arrows.flat_map(|(place, velocity)| {
            let velocity = velocity.filter(|&velocity| length(velocity) <= scale.reference);
            let tip = velocity.map(|[x, y]| [place[0] + x * scale.stretch, place[1] + y * scale.stretch]);
            [Some(place), tip]
        });
        ends.flatten().collect()
    }

    /// The grid points with their velocity of one kind, where it is known.
    fn points(&self, field: VelocityField) -> impl Iterator<Item = ([f64; 2], Option<[f64; 2]>)> + '_ {
        let places = self.y.iter().flat_map(|&y| self.x.iter().map(move |&x| [x, y]));
        let places = places.enumerate().filter(|&(_, place)| is_finite(place));
        places.map(move |(index, place)| {
            let [measured, predicted] =
                [&self.measured, &self.predicted].map(|all| all.get(index).copied().flatten());
            (place, field.select(measured, predicted).filter(|&velocity| is_finite(velocity)))
        })
    }
}

/// Arrows of one velocity field from the points of a grid over faint cell outlines; points without
/// a velocity are grey crosses. Give all panels the same `scale` ([`FlowMap::scale`]).
#[must_use]
pub fn flow_map(
    flow: &FlowMap<'_>,
    field: VelocityField,
    scale: Option<&ArrowScale>,
    units: &Units,
) -> String {
    let fields = [VelocityField::Measured, VelocityField::Predicted];
    let view = scale.and_then(|scale| Viewport::around_with(flow.frame, &flow.reach(&fields, scale)));
    match (view, scale) {
        (Some(view), Some(scale)) => draw_flow(flow, view, (field, scale), units),
        _ => no_data(field.caption()),
    }
}

/// Draws the arrows of one field as `view` shows them, and the legend.
pub(super) fn draw_flow(
    flow: &FlowMap<'_>,
    view: Viewport,
    (field, scale): (VelocityField, &ArrowScale),
    units: &Units,
) -> String {
    let caption = field.caption();
    if flow.points(field).all(|(_, velocity)| velocity.is_none()) {
        return no_data(caption);
    }
    let mut map = Map::with_view(view, flow.frame, caption);
    map.outlines(flow.frame);
    let (mut arrows, mut crosses, mut missing) = (Arrows::default(), PathData::new(), 0);
    for (place, velocity) in flow.points(field) {
        match velocity {
            Some(velocity) => arrows.push_on(&map.view, place, velocity, scale),
            None => {
                Marker::Cross.push(&mut crosses, map.view.to_pixel(place), CROSS);
                missing += 1;
            }
        }
    }
    map.layer.path(&crosses, &cross_style());
    arrows.draw(&mut map.layer, field.colour());
    let mut legend = arrow_legend(map, flow.frame, (field.colour(), scale), units);
    let x = if flow.frame.cells.iter().all(|cell| cell.is_used()) { 4.0 } else { 160.0 };
    missing_entry(&mut legend, x, missing);
    legend.svg.finish()
}

fn cross_style() -> String {
    format!(r#"fill="none" stroke="{GREY}" stroke-width="{CROSS_WIDTH}""#)
}

fn missing_entry(legend: &mut Legend, x: f64, count: usize) {
    if count == 0 {
        return;
    }
    let y = legend.top + 37.5;
    let mut cross = PathData::new();
    Marker::Cross.push(&mut cross, [x + 4.0, y], CROSS);
    legend.svg.path(&cross, &cross_style());
    let label = format!("no velocity ({count})");
    legend.svg.text([x + 13.0, y + 4.0], &label, TextStyle::quiet(Anchor::Start));
}
