//! The key of a chart: samples of lines, areas and marks with their names, in lines above it.

use crate::chart::Chart;
use crate::svg::{Anchor, PathData, Svg, TextStyle};

/// Width and height of a sample in pixels.
pub const SAMPLE: [f64; 2] = [26.0, 14.0];
/// Height of a line of the key in pixels.
const LINE: f64 = 18.0;
/// About the width of a letter in pixels.
pub(crate) const LETTER: f64 = 6.2;

/// One entry of a key.
#[derive(Debug, Clone)]
pub struct KeyEntry {
    /// A picture of the size [`SAMPLE`].
    pub sample: Svg,
    /// What it stands for; `_x` sets a subscript.
    pub label: String,
}

impl KeyEntry {
    /// An entry whose sample `draw` draws; it is given the middle of the sample.
    #[must_use]
    pub fn new(label: &str, draw: impl FnOnce(&mut Svg, [f64; 2])) -> Self {
        let mut sample = Svg::new(SAMPLE, "");
        draw(&mut sample, SAMPLE.map(|length| length / 2.0));
        Self { sample, label: label.to_owned() }
    }

    /// A line with the given attributes.
    #[must_use]
    pub fn line(label: &str, attributes: &str) -> Self {
        Self::new(label, |svg, [_, y]| {
            let mut line = PathData::new();
            line.line(&[[1.0, y], [SAMPLE[0] - 1.0, y]]);
            svg.path(&line, &format!(r#"fill="none" {attributes}"#));
        })
    }

    /// A small area with the given attributes.
    #[must_use]
    pub fn area(label: &str, attributes: &str) -> Self {
        Self::new(label, |svg, _| {
            let mut area = PathData::new();
            area.rectangle([1.0, 1.5], [SAMPLE[0] - 1.0, SAMPLE[1] - 1.5]);
            svg.path(&area, attributes);
        })
    }

    fn width(&self) -> f64 {
        let letters = self.label.chars().filter(|letter| !matches!(letter, '_' | '{' | '}')).count();
        SAMPLE[0] + 6.0 + LETTER * letters as f64
    }
}

impl Chart {
    /// The finished picture with a key above it, in as many lines as it needs; without entries the
    /// picture as it is.
    #[must_use]
    pub fn finish_with_key(self, entries: &[KeyEntry]) -> String {
        self.with_key(entries).finish()
    }

    /// The picture with a key above it, to be drawn on further.
    #[must_use]
    pub fn with_key(self, entries: &[KeyEntry]) -> Svg {
        let [[left, _], [right, _]] = self.plot();
        let picture = self.into_svg();
        if entries.is_empty() {
            return picture;
        }
        let [width, height] = picture.size();
        let mut lines: Vec<Vec<(f64, &KeyEntry)>> = vec![Vec::new()];
        let mut x = left;
        for entry in entries {
            if x > left && x + entry.width() > right {
                lines.push(Vec::new());
                x = left;
            }
            if let Some(line) = lines.last_mut() {
                line.push((x, entry));
            }
            x += entry.width() + 14.0;
        }
        let strip = LINE * lines.len() as f64 + 2.0;
        let mut svg = Svg::new([width, height + strip], picture.title()).with_table(picture.table());
        for (line, entries) in lines.iter().enumerate() {
            let top = 4.0 + LINE * line as f64;
            for (x, entry) in entries {
                svg.nest([*x, top], &entry.sample);
                let at = [x + SAMPLE[0] + 6.0, top + 11.0];
                svg.text(at, &entry.label, TextStyle::label(Anchor::Start));
            }
        }
        svg.nest([0.0, strip], &picture);
        svg
    }
}
