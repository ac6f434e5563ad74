//! Residual velocities of two models, side by side on one scale.

use super::flow_map::{FlowMap, draw_flow};
use super::no_data;
use super::velocity_map::{VelocityField, draw_velocities};
use crate::arrows::ArrowScale;
use crate::before_after::BeforeAfter;
use crate::map::{Map, Viewport};
use crate::units::Units;
use crate::view::FrameView;

const FIELD: VelocityField = VelocityField::Residual;

/// What the two models leave unexplained of the velocities of a frame, as arrows over the same
/// section of the plane. Give all frames the same `scale` ([`ArrowScale::residuals`] of the frames
/// before).
#[must_use]
pub fn residual_maps(
    frames: &BeforeAfter<FrameView>,
    scale: Option<&ArrowScale>,
    units: &Units,
) -> BeforeAfter<String> {
    let view = Viewport::around(&frames.before);
    let map = |frame: &FrameView| match (view, scale) {
        (Some(view), Some(scale)) => {
            draw_velocities(Map::with_view(view, frame, FIELD.caption()), frame, (FIELD, scale), units)
        }
        _ => no_data(FIELD.caption()),
    };
    BeforeAfter { before: map(&frames.before), after: map(&frames.after) }
}

/// The same of velocities on a grid. Give all flows the same `scale` ([`FlowMap::residual_scale`] of
/// the flows before).
#[must_use]
pub fn residual_flow_maps(
    flows: &BeforeAfter<FlowMap<'_>>,
    scale: Option<&ArrowScale>,
    units: &Units,
) -> BeforeAfter<String> {
    let view = scale.and_then(|scale| {
        let reach = flows.named().into_iter().flat_map(|(_, flow)| flow.reach(&[FIELD], scale));
        Viewport::around_with(flows.before.frame, &reach.collect::<Vec<_>>())
    });
    let map = |flow: &FlowMap<'_>| match (view, scale) {
        (Some(view), Some(scale)) => draw_flow(flow, view, (FIELD, scale), units),
        _ => no_data(FIELD.caption()),
    };
    BeforeAfter { before: map(&flows.before), after: map(&flows.after) }
}
