//! Turnover near the edges of a channel drives a flow to the middle and, in a chiral tissue, along the edges.

use claims::channel::{BIRTH_LAYER, Case, DECAY_LENGTHS, line};
use voronudge_infer::{DecayPoint, DecayShape, fit_decay};
use voronudge_simulate::measure::{ChannelProfile, Estimate};
use voronudge_theory::ChannelTurnover;

/// The paper's HT1080 cells in a small channel: the density is highest at the edges, cells converge on the middle, `v_y` has the sign of
/// +α, `v_x` is what conservation says and decays as fast as extrusion, and the slope gives back α.
///
/// The slope scatters by 5 % to 8 % between seeds at this length of the run and is 2 % to 10 % too steep in longer ones; 15 % is asked for.
/// `v_x` follows from counts of some 700 births; 20 % at its peak are four standard errors.
#[test]
fn a_channel_of_ht1080_cells_flows_as_in_the_paper() {
    let case = Case { lengths: [10.0, 16.0], preferred_perimeter: 4.0, chirality: 2.9, time: 40.0 };
    let profile = case.folded_profile(1).unwrap();
    let mean = |values: &[Estimate]| values.iter().map(|at| at.value).sum::<f64>() / values.len() as f64;
    assert!(mean(&profile.density[..2]) > 1.25 * mean(&profile.density[10..]));
    let [v_x, v_y] = &profile.velocity;
    assert!(v_x[1..8].iter().all(|at| at.value > 0.1));
    assert!(mean(&v_y[..8]) > 0.3);
    let turnover = ChannelTurnover {
        width: 10.0,
        extrusion_rate: claims::channel::EXTRUSION_RATE,
        extrusion_length: DECAY_LENGTHS[0],
        proliferation_length: DECAY_LENGTHS[1],
    };
    let peak = v_x.iter().map(|at| at.value).fold(0.0, f64::max);
    let expected = profile.centres.iter().map(|d| turnover.velocity(*d)).fold(0.0, f64::max);
    // The density at the edges, where cells are extruded, is a fifth above the mean: more is extruded, and more flows.
    assert!((0.7..1.2).contains(&(peak / expected)), "{peak} {expected}");
    let length = decay_length(&profile, &profile.velocity[0], 10.0);
    assert!((1.1..1.8).contains(&length), "{length}");
    let slope = line(&profile, BIRTH_LAYER).unwrap().slope;
    let chirality = case.chirality_of_flow(slope).unwrap();
    assert!((chirality / 2.9 - 1.0).abs() < 0.15, "{chirality}");
    // The forces between the cells balance their friction: what flows along the channel is what the shear stress drives.
    let [transport, stress] = [&profile.transport, &profile.shear_stress].map(|values| values[4].value);
    assert!(transport > 0.5 && (stress / transport - 1.0).abs() < 0.15, "{transport} {stress}");
}

/// α changes `v_y` and not `v_x` (Extended Data Fig. m5F, G), and the mirror image of a tissue flows the other way along the edges.
#[test]
fn chirality_drives_the_flow_along_the_edges_only() {
    let flow = |chirality: f64| {
        let case = Case { lengths: [8.0, 12.0], preferred_perimeter: 3.5, chirality, time: 40.0 };
        let profile = case.folded_profile(2).unwrap();
        // Averages over the flank of the flow.
        [0, 1].map(|axis| profile.velocity[axis][1..8].iter().map(|at| at.value).sum::<f64>() / 7.0)
    };
    let [achiral, weak, strong, mirrored] = [0.0, 0.5, 1.0, -1.0].map(flow);
    for [v_x, _] in [weak, strong, mirrored] {
        // Counts of 600 births: 5 %, and three times that.
        assert!((v_x / achiral[0] - 1.0).abs() < 0.15, "{v_x} {}", achiral[0]);
    }
    assert!(achiral[1].abs() < 0.04, "{achiral:?}");
    assert!(
        weak[1] > 0.08 && strong[1] > 1.3 * weak[1] && mirrored[1] < -0.1,
        "{weak:?} {strong:?} {mirrored:?}"
    );
}

fn decay_length(profile: &ChannelProfile, values: &[Estimate], width: f64) -> f64 {
    let points = profile.centres.iter().zip(values).filter(|(d, _)| **d >= BIRTH_LAYER);
    let points: Vec<_> = points
        .map(|(&distance, at)| DecayPoint { distance, value: at.value, error: at.error.unwrap() })
        .collect();
    fit_decay(&points, width, DecayShape::Odd).unwrap().length
}
