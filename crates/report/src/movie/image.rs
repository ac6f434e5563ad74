//! A movie as an animated image: polygons of one colour each, their outlines, and what colours and lengths mean.

use super::lettering::{LETTER, letters, width};
use super::{CellMovie, Colouring, Quantity};
use crate::colour::{ColourScale, GREEN, INK};
use crate::error::ReportError;
use crate::map::GREY;
use crate::numbers::{Ticks, nice_below, significant};
use crate::view::{CellStatus, FrameView};
use gif::{Encoder, Frame, Repeat};
use zeno::{Command, Fill, Format, Mask, Point, Stroke, Style};

/// Width of the image in pixels, and most of the height of the cells.
const WIDTH: f64 = 640.0;
const MAX_HEIGHT: f64 = 800.0;
/// Height of what is written beneath the cells.
const STRIP: usize = 104;
/// Width of the outlines in pixels.
const LINE: f32 = 1.3;
/// Frames of fewer than this last longer.
const FEW: usize = 25;

/// Shades of each colour: as it is, and under a third and two thirds of a line.
const SHADES: usize = 3;
/// Colours beyond those of the values: none, and that of cells left out.
const WHITE: usize = ColourScale::LEVELS;
const LEFT_OUT: usize = WHITE + 1;
/// Places of further colours in the palette.
const LINES: u8 = ((LEFT_OUT + 1) * SHADES) as u8;
const MARKS: u8 = LINES + 1;

impl CellMovie {
    /// The movie as an animated GIF, 640 pixels wide, some ten frames a second; `None` if what it is to be coloured by is not
    /// known of any cell. Time, a scale bar and the colours stand beneath the cells.
    ///
    /// # Errors
    ///
    /// [`ReportError::Image`] if it cannot be encoded.
    pub fn gif(&self, colouring: Colouring) -> Result<Option<Vec<u8>>, ReportError> {
        let Some(quantity) = self.quantities.iter().find(|own| own.colouring == colouring) else {
            return Ok(None);
        };
        let [low, high] = self.view.corners();
        let extent = [high[0] - low[0], high[1] - low[1]];
        let scale = (WIDTH / extent[0]).min(MAX_HEIGHT / extent[1]);
        // Even numbers, as codecs of movies want them.
        let [across, down] = extent.map(|length| 2 * (length * scale / 2.0).ceil() as usize);
        let size = [across.max(WIDTH as usize), down];
        let corner = [low[0] - 0.5 * (size[0] as f64 / scale - extent[0]), high[1]];
        let canvas = Canvas { movie: self, quantity, size, scale, corner };
        let [width, height] = [size[0] as u16, (size[1] + STRIP) as u16];
        let mut encoder = Encoder::new(Vec::new(), width, height, &palette(&quantity.colours))?;
        encoder.set_repeat(Repeat::Infinite)?;
        let delay = if self.frames.len() < FEW { 20 } else { 10 };
        for (index, frame) in self.frames.iter().enumerate() {
            let pixels = canvas.draw(index, frame);
            encoder
                .write_frame(&Frame { delay, ..Frame::from_indexed_pixels(width, height, pixels, None) })?;
        }
        Ok(Some(encoder.into_inner()?))
    }
}

/// One image after another of the same size.
struct Canvas<'a> {
    movie: &'a CellMovie,
    quantity: &'a Quantity,
    /// Of the cells, in pixels.
    size: [usize; 2],
    scale: f64,
    /// Upper left corner in the plane.
    corner: [f64; 2],
}

impl Canvas<'_> {
    /// Places in the palette, row by row.
    fn draw(&self, index: usize, frame: &FrameView) -> Vec<u8> {
        let mut levels = vec![WHITE as u8; self.size[0] * self.size[1]];
        let [mut outlines, mut rings] = [Vec::new(), Vec::new()];
        for (cell, &value) in frame.cells.iter().zip(&self.quantity.values[index]) {
            let path = self.path(&cell.polygon);
            let level = match cell.status {
                CellStatus::Used => self.quantity.colours.level(value).unwrap_or(WHITE),
                CellStatus::NotDetected => WHITE,
                CellStatus::LeftOut | CellStatus::Uncertain => LEFT_OUT,
            };
            self.cover(&path, Fill::NonZero.into(), |pixel, coverage| {
                if coverage > 127 {
                    levels[pixel] = level as u8;
                }
            });
            if cell.status == CellStatus::NotDetected {
                let circle = |k: usize| {
                    let angle = k as f64 / 24.0 * std::f64::consts::TAU;
                    let reach = 0.22 * self.movie.view.spacing();
                    [cell.centre[0] + reach * angle.cos(), cell.centre[1] + reach * angle.sin()]
                };
                rings.extend(self.path(&(0..24).map(circle).collect::<Vec<_>>()));
            }
            outlines.extend(path);
        }
        let mut pixels: Vec<u8> = levels.iter().map(|level| level * SHADES as u8).collect();
        self.cover(&outlines, Stroke::new(LINE).into(), |pixel, coverage| {
            pixels[pixel] = match (usize::from(coverage) * SHADES + 127) / 255 {
                SHADES => LINES,
                shade => pixels[pixel] + shade as u8,
            };
        });
        self.cover(&rings, Stroke::new(2.0 * LINE).into(), |pixel, coverage| {
            if coverage > 127 {
                pixels[pixel] = MARKS;
            }
        });
        pixels.resize(self.size[0] * (self.size[1] + STRIP), (WHITE * SHADES) as u8);
        self.legend(frame, &mut pixels);
        pixels
    }

    /// A closed line; nothing if a corner is not in the picture or near it.
    fn path(&self, corners: &[[f64; 2]]) -> Vec<Command> {
        let place = |at: &[f64; 2]| {
            let [x, y] = [(at[0] - self.corner[0]) * self.scale, (self.corner[1] - at[1]) * self.scale];
            Point::new(x as f32, y as f32)
        };
        let points: Vec<Point> = corners.iter().map(place).collect();
        let reach = 2.0 * WIDTH as f32;
        if points.len() < 3 || points.iter().any(|at| !(at.x.abs() < reach && at.y.abs() < reach)) {
            return Vec::new();
        }
        let lines = points[1..].iter().map(|&to| Command::LineTo(to));
        std::iter::once(Command::MoveTo(points[0])).chain(lines).chain([Command::Close]).collect()
    }

    /// Tells of each pixel that a path touches by how much it covers it, of 255.
    fn cover(&self, path: &Vec<Command>, style: Style<'_>, mut pixel: impl FnMut(usize, u8)) {
        if path.is_empty() {
            return;
        }
        let (mask, placed) = Mask::new(path).format(Format::Alpha).style(style).render();
        let [across, down] = self.size;
        for (y, row) in mask.chunks((placed.width as usize).max(1)).enumerate() {
            let Ok(y) = usize::try_from(i64::from(placed.top) + y as i64) else { continue };
            if y >= down {
                break;
            }
            for (x, &coverage) in row.iter().enumerate() {
                if coverage == 0 {
                    continue;
                }
                let x = i64::from(placed.left) + x as i64;
                if (0..across as i64).contains(&x) {
                    pixel(y * across + x as usize, coverage);
                }
            }
        }
    }

    /// Scale bar and time, then the colours and what they stand for.
    fn legend(&self, frame: &FrameView, pixels: &mut [u8]) {
        let (across, top) = (self.size[0], self.size[1] + 8);
        let rows = pixels.len() / across;
        let mut set = |x: usize, y: usize, place: u8| {
            if x < across && y < rows {
                pixels[y * across + x] = place;
            }
        };
        let units = &self.movie.units;
        if let Some(length) = nice_below(0.25 * across as f64 / self.scale) {
            let end = 8 + (length * self.scale).round() as usize;
            (8..=end).for_each(|x| (6..8).for_each(|y| set(x, top + y, LINES)));
            (1..13).for_each(|y| [8, end].into_iter().for_each(|x| set(x, top + y, LINES)));
            let text = format!("{} {}", significant(length, 1), units.length_text());
            letters([end + 10, top], &text, |x, y| set(x, y, LINES));
        }
        let time = match frame.time {
            Some(time) => format!("t = {} {}", significant(time, 3), units.time_text()),
            None => frame.label.clone(),
        };
        letters([across.saturating_sub(width(&time) + 8), top], &time, |x, y| set(x, y, LINES));
        let [left, right] = [40, across - 40];
        let bar = top + LETTER + 6;
        for x in left..right {
            let level = (x - left) * ColourScale::LEVELS / (right - left);
            (0..12).for_each(|y| set(x, bar + y, (level * SHADES) as u8));
        }
        let [low, high] = self.quantity.colours.limits();
        let ticks = Ticks::new([low, high], 6);
        for (position, label) in ticks.labelled() {
            let x = left + ((position - low) / (high - low) * (right - left) as f64) as usize;
            (12..16).for_each(|y| set(x, bar + y, LINES));
            let start = x.saturating_sub(width(&label) / 2).min(across.saturating_sub(width(&label)));
            letters([start, bar + 18], &label, |x, y| set(x, y, LINES));
        }
        let label = ticks.axis_label(&self.quantity.label());
        let start = (across.saturating_sub(width(&label))) / 2;
        letters([start, bar + 24 + LETTER], &label, |x, y| set(x, y, LINES));
    }
}

/// Red, green and blue of each place.
fn palette(colours: &ColourScale) -> Vec<u8> {
    let levels = (0..ColourScale::LEVELS).map(|level| colours.colour(level));
    let all = levels.chain(["#ffffff".into(), GREY.into()]);
    let ink = parts(INK);
    let shaded = all.flat_map(|colour| {
        let own = parts(&colour);
        (0..SHADES).flat_map(move |shade| {
            let mix = |channel: usize| {
                let [from, to] = [own[channel], ink[channel]].map(usize::from);
                ((from * (SHADES - shade) + to * shade) / SHADES) as u8
            };
            [mix(0), mix(1), mix(2)]
        })
    });
    shaded.chain(ink).chain(parts(GREEN)).collect()
}

/// The parts of a colour `#rrggbb`.
fn parts(colour: &str) -> [u8; 3] {
    [1, 3, 5].map(|start| {
        let digits = colour.get(start..start + 2);
        digits.and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or_default()
    })
}
