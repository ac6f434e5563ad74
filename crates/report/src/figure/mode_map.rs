//! A linear mode on the tessellation.

use std::fmt::Write as _;

use super::no_data;
use crate::arrows::Arrows;
use crate::colour::{BLUE, INK, VERMILLION};
use crate::map::{Legend, Map};
use crate::numbers::quantile;
use crate::svg::{Anchor, PathData, TextStyle};
use crate::units::Units;
use crate::view::FrameView;

/// Cells up to which a map moves.
const MOST_ANIMATED: usize = 1500;
/// Corners of a drawn ellipse.
const CORNERS: usize = 24;
/// Seconds that one period takes on the page.
const PERIOD: f64 = 4.0;

/// A mode as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnMode {
    /// What it is, for example `the mode that grows fastest`.
    pub title: String,
    /// Real and imaginary part of the displacement of each cell of the frame; not finite where it does not move.
    pub displacements: Vec<[[f64; 2]; 2]>,
    /// Angular frequency; zero if the mode does not oscillate.
    pub frequency: f64,
}

/// Displacements of the cells over faint outlines: arrows, or ellipses that the cells of a mode that oscillates run through,
/// with a dot that moves where a browser shows the page. The amplitude is arbitrary. Blue is counter-clockwise.
#[must_use]
pub fn mode_map(frame: &FrameView, mode: &DrawnMode, units: &Units) -> String {
    let Some(mut map) = Map::new(frame, &mode.title) else {
        return no_data(&mode.title);
    };
    let reach = |parts: &[[f64; 2]; 2]| parts.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    let Some(largest) = quantile(mode.displacements.iter().map(reach), 0.98).filter(|&size| size > 0.0)
    else {
        return no_data(&mode.title);
    };
    map.outlines(frame);
    let stretch = 0.55 * map.view.spacing() * map.view.scale() / largest;
    if mode.frequency == 0.0 {
        let mut arrows = Arrows::default();
        for (cell, [real, _]) in frame.cells.iter().zip(&mode.displacements) {
            let drawn = [2.0 * stretch * real[0], -2.0 * stretch * real[1]];
            arrows.push(map.view.to_pixel(cell.centre), drawn);
        }
        arrows.draw(&mut map.layer, INK);
    } else {
        draw_orbits(&mut map, frame, mode, stretch);
    }
    let mut legend = map.with_legend(48.0);
    legend.scale_bar(units);
    let at = [150.0, legend.top + 19.0];
    legend.svg.text(at, "amplitude arbitrary", TextStyle::quiet(Anchor::Start));
    if mode.frequency != 0.0 {
        sense_entry(&mut legend, 154.0, "counter-clockwise", BLUE);
        sense_entry(&mut legend, 280.0, "clockwise", VERMILLION);
    }
    legend.left_out(4.0, frame);
    legend.svg.finish()
}

/// What a cell runs through, `Re u cos ωt − Im u sin ωt`, as pixels from its centre.
struct Orbit {
    places: Vec<[f64; 2]>,
    counter_clockwise: bool,
}

impl Orbit {
    fn new([real, imaginary]: &[[f64; 2]; 2], sign: f64, stretch: f64) -> Option<Self> {
        let place = |step: usize| {
            let (sin, cos) = (std::f64::consts::TAU * step as f64 / CORNERS as f64).sin_cos();
            let along = |axis: usize| stretch * (real[axis] * cos - sign * imaginary[axis] * sin);
            [along(0), -along(1)]
        };
        let places: Vec<[f64; 2]> = (0..CORNERS).map(place).collect();
        let sense = sign * (real[1] * imaginary[0] - real[0] * imaginary[1]);
        let size = places.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
        (size.is_finite() && size > 0.8).then_some(Self { places, counter_clockwise: sense >= 0.0 })
    }
}

fn draw_orbits(map: &mut Map, frame: &FrameView, mode: &DrawnMode, stretch: f64) {
    let mut ellipses = [PathData::new(), PathData::new()];
    let mut dots = String::new();
    let moves = frame.cells.len() <= MOST_ANIMATED;
    for (cell, parts) in frame.cells.iter().zip(&mode.displacements) {
        let Some(orbit) = Orbit::new(parts, mode.frequency.signum(), stretch) else { continue };
        let centre = map.view.to_pixel(cell.centre);
        let at: Vec<[f64; 2]> = orbit.places.iter().map(|[x, y]| [centre[0] + x, centre[1] + y]).collect();
        ellipses[usize::from(orbit.counter_clockwise)].polygon(&at);
        let colour = if orbit.counter_clockwise { BLUE } else { VERMILLION };
        let [x, y] = at[0];
        let _ = write!(dots, r#"<circle cx="{x:.1}" cy="{y:.1}" r="2" fill="{colour}">"#);
        if moves {
            // Relative to where the dot begins.
            let mut path = String::from("M0 0");
            for place in &orbit.places[1..] {
                let _ = write!(
                    path,
                    "L{:.1} {:.1}",
                    place[0] - orbit.places[0][0],
                    place[1] - orbit.places[0][1]
                );
            }
            let _ =
                write!(dots, r#"<animateMotion dur="{PERIOD}s" repeatCount="indefinite" path="{path}z"/>"#);
        }
        dots.push_str("</circle>\n");
    }
    for (path, colour) in ellipses.iter().zip([VERMILLION, BLUE]) {
        map.layer.path(path, &format!(r#"fill="none" stroke="{colour}" stroke-width=".9" opacity=".75""#));
    }
    map.layer.raw(&dots);
}

fn sense_entry(legend: &mut Legend, x: f64, label: &str, colour: &str) {
    let y = legend.top + 37.5;
    let mut mark = PathData::new();
    crate::markers::Marker::Circle.push(&mut mark, [x, y], 4.0);
    legend.svg.path(&mark, &format!(r#"fill="none" stroke="{colour}" stroke-width="1.2""#));
    legend.svg.text([x + 9.0, y + 4.0], label, TextStyle::quiet(Anchor::Start));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u = (1, i): Re u cos − Im u sin = (cos, −sin), which runs clockwise for a positive frequency.
    #[test]
    fn the_sense_of_an_orbit_is_that_of_its_motion() {
        let parts = [[1.0, 0.0], [0.0, 1.0]];
        let orbit = Orbit::new(&parts, 1.0, 10.0).unwrap();
        assert!(!orbit.counter_clockwise);
        // On the page y points down.
        assert!(orbit.places[1][0] > 0.0 && orbit.places[1][1] > 0.0);
        assert!(Orbit::new(&parts, -1.0, 10.0).unwrap().counter_clockwise);
        assert!(Orbit::new(&[[f64::NAN; 2]; 2], 1.0, 10.0).is_none());
    }
}
