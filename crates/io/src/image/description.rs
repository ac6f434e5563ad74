//! What the headers of ImageJ, OME-TIFF and tifffile say of pixels, time and axes.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use crate::error::{ImageFault, excerpt};
use crate::note::Note;
use crate::stated::{Stated, is_pixel};

/// Pixels that differ by more than this share along x and y are not square.
const SQUARE: f64 = 1e-3;
/// In micrometres: resolutions that make larger pixels are those of printers.
const LARGEST_PIXEL: f64 = 20.0;

/// The tags of the first page that say something of the image.
#[derive(Debug, Clone, Default)]
pub(super) struct Tags {
    pub(super) description: String,
    /// Pixels for each unit of length along x and y.
    pub(super) resolution: Option<[f64; 2]>,
    /// 2 for inches, 3 for centimetres.
    pub(super) unit: Option<u16>,
}

/// What was understood of an image.
#[derive(Debug, Clone, Default)]
pub(crate) struct Described {
    pub(crate) stated: Stated,
    pub(crate) notes: Vec<Note>,
}

/// How many images there are along each axis.
#[derive(Debug, Clone, Copy)]
struct Axes {
    channels: u64,
    slices: u64,
    frames: u64,
}

/// Units and axes of a file with so many pages.
pub(super) fn describe(tags: &Tags, pages: usize) -> Result<Described, ImageFault> {
    let text = tags.description.trim_start_matches('\u{feff}').trim_start();
    if text.starts_with("ImageJ=") {
        of_imagej(text, tags, pages)
    } else if text.starts_with('<') && text.contains("<OME") {
        of_ome(text, pages)
    } else {
        Ok(of_others(text, tags, pages))
    }
}

/// Whether frames of a grey movie were written as planes of colours, as tifffile does with three or four of them.
pub(super) fn has_frames_as_planes(tags: &Tags, samples: usize) -> bool {
    let text: String = tags.description.chars().filter(|letter| !letter.is_whitespace()).collect();
    text.starts_with(&format!("{{\"shape\":[{samples},"))
}

fn of_imagej(text: &str, tags: &Tags, pages: usize) -> Result<Described, ImageFault> {
    const BY: &str = "ImageJ";
    let entries: BTreeMap<&str, &str> = text
        .lines()
        .filter_map(|line| line.split_once('='))
        .map(|(key, value)| (key, value.trim()))
        .collect();
    let count = |key| entries.get(key).and_then(|value| value.parse::<u64>().ok()).unwrap_or(1);
    let number = |key| entries.get(key).and_then(|value| value.parse::<f64>().ok());
    if entries.contains_key("images") && count("images") != pages as u64 {
        return Err(ImageFault::OtherPages { pages, stated: count("images"), by: BY });
    }
    let axes = Axes { channels: count("channels"), slices: count("slices"), frames: count("frames") };
    let mut notes = Vec::new();
    axes.check(BY, &mut notes)?;
    let unit = entries.get("unit").map(|unit| unescaped(unit)).filter(|unit| !unit.is_empty());
    let mut stated = Stated { by: BY, ..Stated::default() };
    match (unit, tags.resolution) {
        (Some(unit), _) if is_pixel(&unit) => {}
        (Some(unit), _) if unit == "inch" => {
            notes.push(Note::guessed("a resolution in inches is meant for print"))
        }
        (Some(unit), Some(resolution)) => {
            stated.pixel_size = Some(square(resolution.map(f64::recip), BY)?);
            stated.length_unit = Some(excerpt(&unit));
        }
        _ => {}
    }
    stated.frame_interval = number("finterval").filter(|interval| interval.is_finite() && *interval > 0.0);
    // ImageJ does not write its default.
    stated.time_unit = Some(entries.get("tunit").map_or("sec".into(), |unit| excerpt(&unescaped(unit))));
    Ok(Described { stated, notes })
}

fn of_ome(text: &str, pages: usize) -> Result<Described, ImageFault> {
    const BY: &str = "OME";
    let broken = |detail: String| ImageFault::Description { by: BY, detail };
    let document = Document::parse(text).map_err(|error| broken(excerpt(&error.to_string())))?;
    let all = |name: &'static str| document.descendants().filter(move |node| node.tag_name().name() == name);
    let images = all("Image").count();
    if images > 1 {
        return Err(ImageFault::Axes { detail: format!("{images} images"), by: BY });
    }
    let Some(pixels) = all("Pixels").next() else { return Err(broken("no Pixels".into())) };
    let count = |key| pixels.attribute(key).and_then(|value| value.parse::<u64>().ok()).unwrap_or(1);
    let axes = Axes { channels: count("SizeC"), slices: count("SizeZ"), frames: count("SizeT") };
    let mut notes = Vec::new();
    axes.check(BY, &mut notes)?;
    let stated_pages = axes.channels.saturating_mul(axes.slices).saturating_mul(axes.frames);
    if stated_pages != pages as u64 {
        return Err(ImageFault::OtherPages { pages, stated: stated_pages, by: BY });
    }
    for plane in all("TiffData") {
        let index = |key| plane.attribute(key).and_then(|value| value.parse::<u64>().ok());
        if let Some(page) = index("IFD")
            && page != index("FirstT").unwrap_or(0).saturating_add(index("FirstZ").unwrap_or(0))
        {
            return Err(ImageFault::Axes { detail: "pages out of order".into(), by: BY });
        }
    }
    let mut stated = Stated { by: BY, ..Stated::default() };
    let sizes = [positive(pixels, "PhysicalSizeX"), positive(pixels, "PhysicalSizeY")];
    let unit = pixels.attribute("PhysicalSizeXUnit").unwrap_or("µm");
    if let Some(size) = sizes[0].or(sizes[1])
        && !is_pixel(unit)
    {
        stated.pixel_size = Some(square(sizes.map(|own| own.unwrap_or(size)), BY)?);
        stated.length_unit = Some(excerpt(unit));
    }
    stated.frame_interval = positive(pixels, "TimeIncrement");
    stated.time_unit = Some(excerpt(pixels.attribute("TimeIncrementUnit").unwrap_or("s")));
    Ok(Described { stated, notes })
}

/// tifffile writes axes by letters; others write resolutions, which are mostly those of printers.
fn of_others(text: &str, tags: &Tags, pages: usize) -> Described {
    let mut notes = Vec::new();
    let axes = text.split_once("\"axes\":").and_then(|(_, rest)| rest.split('"').nth(1));
    if let Some(axes) = axes.filter(|axes| axes.contains('Z') && !axes.contains('T') && pages > 1) {
        notes.push(Note::doubtful(format!(
            "axes are {} (tifffile): the planes along z are taken for frames",
            excerpt(axes)
        )));
    }
    let micrometres = match tags.unit {
        Some(2) => Some(25_400.0),
        Some(3) => Some(10_000.0),
        _ => None,
    };
    if let (Some(unit), Some([x, _])) = (micrometres, tags.resolution)
        && unit / x < LARGEST_PIXEL
    {
        let size = unit / x;
        notes.push(Note::doubtful(format!(
            "the resolution of the file makes pixels of {size:.4} µm; it is not taken without --pixel-size {size:.4} --length-unit um"
        )));
    }
    Described { stated: Stated::default(), notes }
}

impl Axes {
    /// One layer of one channel is needed.
    fn check(self, by: &'static str, notes: &mut Vec<Note>) -> Result<(), ImageFault> {
        let Self { channels, slices, frames } = self;
        if channels > 1 {
            return Err(ImageFault::Axes { detail: format!("{channels} channels"), by });
        }
        if slices > 1 && frames > 1 {
            return Err(ImageFault::Axes {
                detail: format!("{slices} slices in each of {frames} frames"),
                by,
            });
        }
        if slices > 1 {
            notes.push(Note::doubtful(format!(
                "{slices} slices along z ({by}) are taken for frames in time; if they are layers of one moment, take one of them"
            )));
        } else if frames > 1 {
            notes.push(Note::read(format!("{frames} frames ({by})")));
        }
        Ok(())
    }
}

/// The side of a pixel.
fn square([x, y]: [f64; 2], by: &'static str) -> Result<f64, ImageFault> {
    if (x - y).abs() > SQUARE * x.max(y) {
        return Err(ImageFault::NotSquare { size: [x, y], by });
    }
    Ok(x)
}

fn positive(node: Node<'_, '_>, attribute: &str) -> Option<f64> {
    let value: f64 = node.attribute(attribute)?.trim().parse().ok()?;
    (value.is_finite() && value > 0.0).then_some(value)
}

/// ImageJ writes letters beyond ASCII as `\u00B5`.
fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\u");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let letter =
            part.get(..4).and_then(|digits| u32::from_str_radix(digits, 16).ok()).and_then(char::from_u32);
        match letter {
            Some(letter) => {
                out.push(letter);
                out.push_str(&part[4..]);
            }
            None => {
                out.push_str("\\u");
                out.push_str(part);
            }
        }
    }
    out
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail anywhere")]
mod tests {
    use super::*;

    fn imagej(text: &str, resolution: [f64; 2], pages: usize) -> Result<Described, ImageFault> {
        let description = format!("ImageJ=1.54f\n{text}");
        describe(&Tags { description, resolution: Some(resolution), unit: Some(1) }, pages)
    }

    #[test]
    fn imagej_says_units_and_axes() {
        let text = "images=4\nframes=4\nhyperstack=true\nunit=\\u00B5m\nfinterval=2.5\n";
        let read = imagej(text, [4.0, 4.0], 4).unwrap();
        assert_eq!((read.stated.pixel_size, read.stated.frame_interval), (Some(0.25), Some(2.5)));
        assert_eq!(read.stated.length_unit.as_deref(), Some("µm"));
        assert_eq!(read.stated.time_unit.as_deref(), Some("sec"));
        let read = imagej("images=4\nslices=4\nunit=pixel\n", [1.0, 1.0], 4).unwrap();
        assert_eq!(read.stated.pixel_size, None);
        assert!(read.notes[0].text.contains("4 slices along z (ImageJ) are taken for frames"));
        let fault =
            |text, resolution, pages| imagej(text, resolution, pages).err().map(|fault| fault.to_string());
        for (text, resolution, pages, fact) in [
            ("images=4\nchannels=2\nframes=2", [1.0, 1.0], 4, "2 channels"),
            ("images=4\nslices=2\nframes=2", [1.0, 1.0], 4, "2 slices in each of 2 frames"),
            ("images=9\nframes=9", [1.0, 1.0], 1, "9 images"),
            ("unit=um", [4.0, 2.0], 1, "0.25 × 0.5"),
        ] {
            let fault = fault(text, resolution, pages).unwrap_or_default();
            assert!(fault.contains(fact), "{fact}: {fault}");
        }
    }

    #[test]
    fn ome_says_units_and_axes() {
        let ome = |attributes: &str, pages| {
            let description =
                format!("<?xml version=\"1.0\"?><OME><Image><Pixels {attributes}/></Image></OME>");
            describe(&Tags { description, ..Tags::default() }, pages)
        };
        let attributes = "SizeC=\"1\" SizeZ=\"1\" SizeT=\"3\" PhysicalSizeX=\"0.65\" TimeIncrement=\"60\"";
        let read = ome(attributes, 3).unwrap();
        assert_eq!((read.stated.pixel_size, read.stated.frame_interval), (Some(0.65), Some(60.0)));
        assert_eq!(read.stated.length_unit.as_deref(), Some("µm"));
        let fault = |attributes, pages| {
            ome(attributes, pages).err().map(|fault| fault.to_string()).unwrap_or_default()
        };
        assert!(fault("SizeC=\"2\" SizeT=\"2\"", 4).contains("2 channels"));
        assert!(fault("SizeT=\"5\"", 1).contains("5 images"));
        assert!(fault("PhysicalSizeX=\"1\" PhysicalSizeY=\"2\"", 1).contains("1 × 2"));
    }

    #[test]
    fn resolutions_of_printers_are_left_alone() {
        let plain = |resolution, unit| {
            let tags = Tags { resolution: Some([resolution; 2]), unit: Some(unit), ..Tags::default() };
            describe(&tags, 1).map(|read| read.notes.len())
        };
        assert_eq!(plain(72.0, 2), Ok(0));
        assert_eq!(plain(1.0, 1), Ok(0));
        assert_eq!(plain(20_000.0, 3), Ok(1));
    }
}
