//! A small writer of compact SVG: paths in tenths of a pixel, text with subscripts.

use std::fmt::Write as _;

/// Where a text is anchored horizontally.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins at its position.
    Start,
    /// The text is centred on its position.
    Middle,
    /// The text ends at its position.
    End,
}

/// How a text is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    /// Font size in nominal pixels.
    pub size: f64,
    /// Colour, for example `#333`.
    pub colour: &'static str,
    /// Horizontal anchor.
    pub anchor: Anchor,
}

impl TextStyle {
    /// The size of ordinary labels.
    pub const LABEL: f64 = 11.5;

    /// Dark text of label size.
    #[must_use]
    pub fn label(anchor: Anchor) -> Self {
        Self { size: Self::LABEL, colour: "#222", anchor }
    }

    /// Grey text of label size.
    #[must_use]
    pub fn quiet(anchor: Anchor) -> Self {
        Self { size: Self::LABEL, colour: "#666", anchor }
    }
}

/// One SVG picture under construction.
///
/// Sizes are nominal pixels; the picture scales to the width it is given (it has a `viewBox`, no
/// fixed size).
#[derive(Debug, Clone)]
pub struct Svg {
    size: [f64; 2],
    title: String,
    table: Option<String>,
    body: String,
}

impl Svg {
    /// An empty picture of the given nominal width and height; `title` is what a screen reader says.
    #[must_use]
    pub fn new(size: [f64; 2], title: &str) -> Self {
        Self { size, title: title.to_owned(), table: None, body: String::new() }
    }

    /// Nominal width and height.
    #[must_use]
    pub fn size(&self) -> [f64; 2] {
        self.size
    }

    /// What a screen reader says.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The picture with a table in CSV of what it shows, which is not seen and goes where the picture goes.
    #[must_use]
    pub fn with_table(self, table: Option<String>) -> Self {
        Self { table, ..self }
    }

    /// The table of what it shows.
    #[must_use]
    pub fn table(&self) -> Option<String> {
        self.table.clone()
    }

    /// Adds a path with presentation attributes such as `fill="none" stroke="#333"`.
    /// An empty path adds nothing.
    pub fn path(&mut self, path: &PathData, attributes: &str) {
        if !path.is_empty() {
            let _ = writeln!(self.body, r#"<path d="{}" {attributes}/>"#, path.text);
        }
    }

    /// Adds text. `_x` or `_{xyz}` sets a subscript; everything is escaped.
    pub fn text(&mut self, at: [f64; 2], text: &str, style: TextStyle) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        if at.iter().all(|coordinate| coordinate.is_finite()) {
            let _ = writeln!(
                self.body,
                r#"<text x="{:.1}" y="{:.1}" font-size="{}" fill="{}" text-anchor="{anchor}">{}</text>"#,
                at[0],
                at[1],
                style.size,
                style.colour,
                subscripts(text, SubscriptMarkup::Svg)
            );
        }
    }

    /// Adds text with a rim of the colour `rim`, legible on any ground.
    pub fn text_with_rim(&mut self, at: [f64; 2], text: &str, style: TextStyle, rim: &str) {
        self.raw(&format!(
            "<g paint-order=\"stroke\" stroke=\"{rim}\" stroke-width=\"3\" stroke-linejoin=\"round\">"
        ));
        self.text(at, text, style);
        self.raw("</g>\n");
    }

    /// Adds SVG elements as they are. The caller vouches for them.
    pub fn raw(&mut self, elements: &str) {
        self.body.push_str(elements);
    }

    /// Puts `inner` into this picture at `corner`, clipped to its own size.
    pub fn nest(&mut self, corner: [f64; 2], inner: &Svg) {
        let _ = writeln!(
            self.body,
            r#"<svg x="{:.1}" y="{:.1}" width="{:.1}" height="{:.1}" overflow="hidden">"#,
            corner[0], corner[1], inner.size[0], inner.size[1]
        );
        self.body.push_str(&inner.body);
        self.body.push_str("</svg>\n");
    }

    /// The finished stand-alone SVG text.
    #[must_use]
    pub fn finish(self) -> String {
        let [width, height] = self.size;
        let title = escape(&self.title);
        let table =
            self.table.map_or(String::new(), |table| format!("<metadata>{}</metadata>\n", escape(&table)));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.1} {height:.1}\" \
             role=\"img\" font-family=\"sans-serif\">\n<title>{title}</title>\n{table}{}</svg>\n",
            self.body
        )
    }
}

/// The `d` attribute of a path: relative coordinates in tenths of a nominal pixel.
///
/// Shapes with a coordinate that is not finite are left out.
#[derive(Debug, Clone, Default)]
pub struct PathData {
    text: String,
    pen: [i64; 2],
}

impl PathData {
    /// An empty path.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Whether nothing has been drawn.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// Adds an open line through `points`.
    pub fn line(&mut self, points: &[[f64; 2]]) {
        self.trace(points);
    }

    /// Adds a closed polygon.
    pub fn polygon(&mut self, points: &[[f64; 2]]) {
        if self.trace(points) {
            self.text.push('z');
            if let Some(start) = points.first().and_then(|&point| tenths(point)) {
                self.pen = start;
            }
        }
    }

    /// Adds an axis-parallel rectangle given two opposite corners.
    pub fn rectangle(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) {
        self.polygon(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
    }

    /// Adds a point: a line of no length, to be stroked with round caps.
    pub fn dot(&mut self, at: [f64; 2]) {
        if self.trace(&[at]) {
            self.text.push_str("h0");
        }
    }

    fn trace(&mut self, points: &[[f64; 2]]) -> bool {
        let Some(places) = points.iter().map(|&point| tenths(point)).collect::<Option<Vec<_>>>() else {
            return false;
        };
        if places.is_empty() {
            return false;
        }
        for (index, place) in places.into_iter().enumerate() {
            let step = [place[0] - self.pen[0], place[1] - self.pen[1]];
            match index {
                0 if self.text.is_empty() => self.text.push('M'),
                0 => self.text.push('m'),
                1 => self.text.push('l'),
                _ if step[0] >= 0 => self.text.push(' '),
                _ => {}
            }
            push_tenths(&mut self.text, step[0]);
            if step[1] >= 0 {
                self.text.push(' ');
            }
            push_tenths(&mut self.text, step[1]);
            self.pen = place;
        }
        true
    }
}

/// The markup that [`subscripts`] writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SubscriptMarkup {
    /// `<sub>` elements.
    Html,
    /// Shifted `<tspan>` elements.
    Svg,
}

/// `text` escaped, with `_x` and `_{xyz}` turned into subscripts.
#[must_use]
pub fn subscripts(text: &str, markup: SubscriptMarkup) -> String {
    let mut result = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('_') {
        result.push_str(&escape(before));
        let braced = after.strip_prefix('{').and_then(|inner| inner.split_once('}'));
        let first = after.chars().next().filter(|letter| letter.is_alphanumeric());
        let (index, remainder) = match (braced, first) {
            (Some(parts), _) => parts,
            (None, Some(letter)) => after.split_at(letter.len_utf8()),
            (None, None) => {
                result.push('_');
                rest = after;
                continue;
            }
        };
        let index = escape(index);
        let _ = match markup {
            SubscriptMarkup::Html => write!(result, "<sub>{index}</sub>"),
            SubscriptMarkup::Svg => write!(
                result,
                r#"<tspan dy=".25em" font-size="75%">{index}</tspan><tspan dy="-.19em">&#8203;</tspan>"#
            ),
        };
        rest = remainder;
    }
    result.push_str(&escape(rest));
    result
}

/// `text` with the characters that mean something in XML and HTML replaced.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}

/// The text of the first element of this name without attributes.
pub(crate) fn element(markup: &str, name: &str) -> Option<String> {
    let (_, rest) = markup.split_once(&format!("<{name}>"))?;
    let (text, _) = rest.split_once(&format!("</{name}>"))?;
    let plain = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&#39;", "'");
    Some(plain.replace("&amp;", "&"))
}

/// A point in tenths of a pixel; far points are drawn in to ±10⁶ px.
fn tenths(point: [f64; 2]) -> Option<[i64; 2]> {
    point
        .iter()
        .all(|coordinate| coordinate.is_finite())
        .then(|| point.map(|coordinate| (coordinate.clamp(-1e6, 1e6) * 10.0).round() as i64))
}

fn push_tenths(text: &mut String, value: i64) {
    let magnitude = value.unsigned_abs();
    if value < 0 {
        text.push('-');
    }
    let (whole, tenth) = (magnitude / 10, magnitude % 10);
    let _ = match (whole, tenth) {
        (whole, 0) => write!(text, "{whole}"),
        (0, tenth) => write!(text, ".{tenth}"),
        (whole, tenth) => write!(text, "{whole}.{tenth}"),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_relative_and_rounded() {
        let mut path = PathData::new();
        path.polygon(&[[10.04, 20.0], [15.26, 20.5], [9.0, 30.0]]);
        path.line(&[[10.0, 20.0], [11.0, 19.0]]);
        assert_eq!(path.text, "M10 20l5.3 .5-6.3 9.5zm0 0l1-1");
    }

    #[test]
    fn paths_leave_out_what_is_not_finite() {
        let mut path = PathData::new();
        path.polygon(&[[0.0, 0.0], [f64::NAN, 1.0], [1.0, 1.0]]);
        path.dot([f64::INFINITY, 0.0]);
        path.line(&[]);
        assert!(path.is_empty());
    }

    #[test]
    fn subscripts_are_set_and_text_is_escaped() {
        assert_eq!(subscripts("K_P α < 1", SubscriptMarkup::Html), "K<sub>P</sub> α &lt; 1");
        assert_eq!(subscripts("x_{ab}c_", SubscriptMarkup::Html), "x<sub>ab</sub>c_");
    }
}
