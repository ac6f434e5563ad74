//! Pictures of the plane: equal aspect, clipped to the cells, a scale bar and a legend beneath.

use crate::colour::GREEN;
use crate::markers::Marker;
use crate::numbers::{nice_below, significant};
use crate::svg::{Anchor, PathData, Svg, TextStyle};
use crate::units::Units;
use crate::view::{CellStatus, CellView, FrameView, is_finite};

/// Radius of the ring at a cell that was not detected, in pixels.
const RING: f64 = 3.4;

/// Nominal width of every map in pixels.
pub const MAP_WIDTH: f64 = 380.0;
/// Greatest nominal height of the mapped area in pixels.
const MAX_HEIGHT: f64 = 480.0;
/// Cells of a frame up to which each is drawn.
pub(crate) const MOST_DRAWN: usize = 12_000;
/// Line distance of hatching in pixels.
const HATCH: f64 = 4.0;

/// The mapping from the tissue's plane (y up) to the picture (y down), the same in x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewport {
    corner: [f64; 2],
    scale: f64,
    size: [f64; 2],
    spacing: f64,
}

impl Viewport {
    /// The viewport that shows all cell centres and a margin of one cell; `None` without cells.
    #[must_use]
    pub fn around(frame: &FrameView) -> Option<Self> {
        Self::around_with(frame, &[])
    }

    /// The viewport that also shows further `points`; `None` without cells and points.
    #[must_use]
    pub fn around_with(frame: &FrameView, points: &[[f64; 2]]) -> Option<Self> {
        let centres = || {
            let centres = frame.cells.iter().map(|cell| cell.centre).chain(points.iter().copied());
            centres.filter(|&at| is_finite(at))
        };
        let bounds = |axis: usize| {
            let low = centres().map(|at| at[axis]).fold(f64::INFINITY, f64::min);
            let high = centres().map(|at| at[axis]).fold(f64::NEG_INFINITY, f64::max);
            [low, high]
        };
        let [x, y] = [bounds(0), bounds(1)];
        let extent = [x[1] - x[0], y[1] - y[0]];
        if !is_finite(extent) {
            return None;
        }
        let guess = (extent[0] * extent[1] / centres().count() as f64).sqrt();
        let fallback = [guess, extent[0].max(extent[1]), 1.0];
        let spacing = frame
            .spacing()
            .or_else(|| fallback.into_iter().find(|&length| length.is_finite() && length > 0.0))?;
        let margin = 0.85 * spacing;
        let [width, height] = extent.map(|length| length + 2.0 * margin);
        let scale = (MAP_WIDTH / width).min(MAX_HEIGHT / height);
        let corner = [x[0] - margin, y[1] + margin];
        Some(Self { corner, scale, size: [width * scale, height * scale], spacing })
    }

    /// The viewport that shows the cells of all frames; `None` without cells.
    #[must_use]
    pub fn around_all(frames: &[FrameView]) -> Option<Self> {
        let (first, others) = frames.split_first()?;
        let centres = others.iter().flat_map(|frame| &frame.cells).map(|cell| cell.centre);
        Self::around_with(first, &centres.collect::<Vec<_>>())
    }

    /// Lower left and upper right corner in the plane.
    #[must_use]
    pub fn corners(&self) -> [[f64; 2]; 2] {
        let [width, height] = self.size.map(|pixels| pixels / self.scale);
        let [left, top] = self.corner;
        [[left, top - height], [left + width, top]]
    }

    /// Place in the picture of a point of the plane.
    #[must_use]
    pub fn to_pixel(&self, point: [f64; 2]) -> [f64; 2] {
        [(point[0] - self.corner[0]) * self.scale, (self.corner[1] - point[1]) * self.scale]
    }

    /// Pixels per unit of length.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Typical distance between cells, in units of length.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The placed polygon of a cell; `None` where it is not closed or is absurdly far away.
    #[must_use]
    pub fn polygon(&self, cell: &CellView) -> Option<Vec<[f64; 2]>> {
        let reach = 4.0 * MAP_WIDTH;
        let polygon: Vec<[f64; 2]> = cell.polygon.iter().map(|&vertex| self.to_pixel(vertex)).collect();
        let near = polygon.iter().all(|at| at.iter().all(|x| x.abs() < reach));
        (polygon.len() >= 3 && near).then_some(polygon)
    }
}

/// A map under construction: draw on `layer`, then [`Map::with_legend`].
#[derive(Debug, Clone)]
pub struct Map {
    /// The mapping to use.
    pub view: Viewport,
    /// The drawing area, clipped to the viewport.
    pub layer: Svg,
    title: String,
    /// Lines that [`Legend::left_out`] needs.
    entries: usize,
}

impl Map {
    /// An empty map of a frame; `None` if the frame has no cell with a finite position.
    #[must_use]
    pub fn new(frame: &FrameView, title: &str) -> Option<Self> {
        Some(Self::with_view(Viewport::around(frame)?, frame, title))
    }

    /// An empty map of a frame as `view` shows it.
    #[must_use]
    pub fn with_view(view: Viewport, frame: &FrameView, title: &str) -> Self {
        let title = format!("{title}, {}", frame.label);
        let entries = entries(frame).into_iter().flatten().count();
        Self { view, layer: Svg::new(view.size, &title), title, entries }
    }

    /// Draws faint outlines of all cells, unless there are so many that they are all one sees, those left out on grey, uncertain ones hatched, the box
    /// and the field of view.
    pub fn outlines(&mut self, frame: &FrameView) {
        let [mut used, mut left_out, mut hatching] = std::array::from_fn(|_| PathData::new());
        let all = frame.cells.len() <= MOST_DRAWN;
        for cell in frame.cells.iter().filter(|cell| all || !cell.is_used()) {
            if let Some(polygon) = self.view.polygon(cell) {
                let left_out = match cell.status {
                    CellStatus::LeftOut | CellStatus::Uncertain => &mut left_out,
                    CellStatus::Used | CellStatus::NotDetected => &mut used,
                };
                left_out.polygon(&polygon);
                if cell.status == CellStatus::Uncertain {
                    hatch(&mut hatching, &polygon);
                }
            }
        }
        let stroke = r##"stroke="#c4c4c4" stroke-width=".6" stroke-linejoin="round""##;
        self.layer.path(&left_out, &format!(r##"fill="{GREY}" {stroke}"##));
        self.layer.path(&hatching, HATCH_STYLE);
        self.layer.path(&used, &format!(r#"fill="none" {stroke}"#));
        self.not_detected(frame);
        self.boundary(frame);
    }

    /// Draws the polygons of cells that were not detected, with a ring at their centres.
    pub fn not_detected(&mut self, frame: &FrameView) {
        let [mut polygons, mut rings] = [PathData::new(), PathData::new()];
        for cell in frame.not_detected() {
            if let Some(polygon) = self.view.polygon(cell) {
                polygons.polygon(&polygon);
            }
            Marker::Circle.push(&mut rings, self.view.to_pixel(cell.centre), RING);
        }
        self.layer.path(&polygons, &format!(r#"fill="{GREEN}" fill-opacity=".16" stroke="none""#));
        self.layer.path(&rings, &format!(r#"fill="none" stroke="{GREEN}" stroke-width="1.4""#));
    }

    /// Draws the outline of the periodic box, dashed, and of the field of view, where the frame has them.
    pub fn boundary(&mut self, frame: &FrameView) {
        if let Some([low, high]) = frame.outline {
            let mut path = PathData::new();
            path.rectangle(self.view.to_pixel(low), self.view.to_pixel(high));
            self.layer.path(&path, r##"fill="none" stroke="#666" stroke-dasharray="4 3""##);
        }
        let mut border = PathData::new();
        for corners in &frame.region {
            border.polygon(&corners.iter().map(|&at| self.view.to_pixel(at)).collect::<Vec<_>>());
        }
        self.layer.path(&border, REGION_STYLE);
    }

    /// Closes the drawing area and adds an empty legend strip of the given height beneath it.
    #[must_use]
    pub fn with_legend(self, height: f64) -> Legend {
        let [width, map_height] = self.view.size;
        let height = height + ENTRY * self.entries.saturating_sub(1) as f64;
        let mut svg = Svg::new([MAP_WIDTH, map_height + height], &self.title);
        let left = (MAP_WIDTH - width) / 2.0;
        svg.nest([left, 0.0], &self.layer);
        let mut border = PathData::new();
        border.rectangle([left + 0.4, 0.4], [left + width - 0.4, map_height - 0.4]);
        svg.path(&border, r##"fill="none" stroke="#bbb" stroke-width=".8""##);
        Legend { svg, top: map_height, scale: self.view.scale }
    }
}

/// The strip beneath a map, with the whole picture it belongs to.
#[derive(Debug, Clone)]
pub struct Legend {
    /// The whole picture.
    pub svg: Svg,
    /// Where the strip begins.
    pub top: f64,
    scale: f64,
}

impl Legend {
    /// Pixels per unit of length of the map above.
    #[must_use]
    pub fn pixels_per_length(&self) -> f64 {
        self.scale
    }

    /// Draws a scale bar of round length, at most a quarter of the map wide, at the left.
    pub fn scale_bar(&mut self, units: &Units) {
        let Some(length) = nice_below(0.25 * MAP_WIDTH / self.scale) else {
            return;
        };
        let end = 4.0 + length * self.scale;
        let y = self.top + 15.0;
        let mut bar = PathData::new();
        bar.line(&[[4.0, y - 4.0], [4.0, y + 4.0]]);
        bar.line(&[[4.0, y], [end, y]]);
        bar.line(&[[end, y - 4.0], [end, y + 4.0]]);
        self.svg.path(&bar, r##"fill="none" stroke="#222" stroke-width="1.6""##);
        let label = format!("{} {}", significant(length, 1), units.length_text());
        self.svg.text([end + 7.0, y + 4.0], &label, TextStyle::label(Anchor::Start));
    }

    /// Draws the entries for uncertain cells, cells left out, cells not detected and the field of view, from the second line on
    /// at `x`, as far as the frame has them.
    pub fn left_out(&mut self, x: f64, frame: &FrameView) {
        let mut y = self.top + 32.0;
        for (sample, label) in entries(frame).into_iter().flatten() {
            let corners = [[x, y], [x + 14.0, y], [x + 14.0, y + 11.0], [x, y + 11.0]];
            let [mut outline, mut lines] = [PathData::new(), PathData::new()];
            let style = match sample {
                Sample::Region => REGION_STYLE.to_owned(),
                Sample::Ring => {
                    format!(r#"fill="{GREEN}" fill-opacity=".16" stroke="{GREEN}" stroke-width="1.4""#)
                }
                Sample::Grey | Sample::Hatched => {
                    format!(r##"fill="{GREY}" stroke="#999" stroke-width=".7""##)
                }
            };
            match sample {
                Sample::Ring => Marker::Circle.push(&mut outline, [x + 7.0, y + 5.5], RING),
                _ => outline.polygon(&corners),
            }
            self.svg.path(&outline, &style);
            if sample == Sample::Hatched {
                hatch(&mut lines, &corners);
                self.svg.path(&lines, HATCH_STYLE);
            }
            self.svg.text([x + 20.0, y + 9.5], &label, TextStyle::quiet(Anchor::Start));
            y += ENTRY;
        }
    }
}

/// What an entry of the legend shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sample {
    Hatched,
    Grey,
    Ring,
    Region,
}

/// Entries for what the frame has: uncertain cells, cells left out or not detected, a field of view.
fn entries(frame: &FrameView) -> [Option<(Sample, String)>; 4] {
    let cells = |status: CellStatus, sample: Sample, label: &str| {
        let count = frame.count(status);
        (count > 0).then(|| (sample, format!("{label} ({count})")))
    };
    [
        cells(CellStatus::Uncertain, Sample::Hatched, "uncertain"),
        cells(CellStatus::LeftOut, Sample::Grey, "left out"),
        cells(CellStatus::NotDetected, Sample::Ring, "not detected"),
        (!frame.region.is_empty()).then(|| (Sample::Region, "field of view".to_owned())),
    ]
}

/// Height of an entry of the legend in pixels.
const ENTRY: f64 = 14.0;
/// Fill of cells left out.
pub const GREY: &str = "#ebebeb";
/// Presentation attributes of the border of the field of view.
const REGION_STYLE: &str = r##"fill="none" stroke="#222" stroke-width="1.1" stroke-linejoin="round""##;

/// Presentation attributes of hatch lines.
pub const HATCH_STYLE: &str = r##"fill="none" stroke="#9a9a9a" stroke-width=".7""##;

/// Adds diagonal lines across a convex polygon.
pub fn hatch(path: &mut PathData, polygon: &[[f64; 2]]) {
    let level = |at: [f64; 2]| at[0] + at[1];
    let low = polygon.iter().map(|&at| level(at)).fold(f64::INFINITY, f64::min);
    let high = polygon.iter().map(|&at| level(at)).fold(f64::NEG_INFINITY, f64::max);
    if !(high - low).is_finite() || high - low > 4.0 * MAP_WIDTH {
        return;
    }
    let mut line = (low / HATCH).ceil();
    while line * HATCH < high {
        let target = line * HATCH;
        let ends: Vec<[f64; 2]> = (0..polygon.len())
            .filter_map(|index| {
                let [from, to] = [polygon[index], polygon[(index + 1) % polygon.len()]];
                let [a, b] = [level(from) - target, level(to) - target];
                ((a < 0.0) != (b < 0.0)).then(|| {
                    let share = a / (a - b);
                    [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]
                })
            })
            .collect();
        if let [from, to] = ends[..] {
            path.line(&[from, to]);
        }
        line += 1.0;
    }
}
