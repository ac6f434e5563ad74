//! What a page holds of a movie is what went in, and no more than it may be; the image has every frame.

use crate::{discover_sample, sample};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use voronudge_report::movie::{
    CellMovie, Colouring, MOST_FRAMES, MOST_IN_ALL, MOST_IN_FRAME, UNKNOWN, chosen,
};
use voronudge_report::{CellView, DiscoverFigures, DiscoverPage, FrameView, InferPage, Uncertainty, Units};

fn units() -> Units {
    Units { length: "um".into(), time: "min".into() }
}

/// Frames of `side` × `side` cells at times of their own, each a little farther.
pub fn frames(count: usize, side: usize) -> Vec<FrameView> {
    let frame = |index: usize| {
        let mut frame = sample::frame(&format!("frame {index}"), side);
        frame.time = Some(2.5 * index as f64);
        for cell in &mut frame.cells {
            let moved = [0.1 * index as f64, -0.05 * index as f64];
            cell.centre = [cell.centre[0] + moved[0], cell.centre[1] + moved[1]];
            cell.polygon.iter_mut().for_each(|at| *at = [at[0] + moved[0], at[1] + moved[1]]);
        }
        frame
    };
    (0..count).map(frame).collect()
}

pub fn movie(count: usize, side: usize) -> Result<CellMovie, &'static str> {
    CellMovie::new(frames(count, side), count, &units()).ok_or("no cells")
}

/// Numbers of a movie, taken one after another.
struct Numbers {
    bytes: Vec<u8>,
    taken: usize,
}

impl Numbers {
    fn take<const N: usize>(&mut self, count: usize) -> Vec<[u8; N]> {
        let from = self.taken;
        self.taken += count * N;
        self.bytes[from..self.taken].as_chunks::<N>().0.to_vec()
    }

    fn steps(&mut self, count: usize) -> Vec<u16> {
        self.take(count).into_iter().map(u16::from_le_bytes).collect()
    }
}

fn pair(value: &Value) -> [f64; 2] {
    [0, 1].map(|end| value[end].as_f64().unwrap_or(f64::NAN))
}

/// Whether a step stands for a value, to half a step.
fn agrees(step: u16, value: f64, [low, high]: [f64; 2]) -> bool {
    if step == UNKNOWN {
        return !value.is_finite();
    }
    let width = (high - low) / 65534.0;
    (low + f64::from(step) * width - value).abs() <= 0.5001 * width + 1e-12 * high.abs()
}

#[test]
fn what_the_page_embeds_is_what_went_in() {
    let frames = frames(3, 9);
    let report = sample::report();
    let movie = CellMovie::new(frames.clone(), 3, &units()).unwrap();
    let uncertainty = Uncertainty::default();
    let page = sample::page(&report, &frames[..1], &uncertainty);
    let html = InferPage { movie: Some(&movie), ..page }.render().unwrap();
    let (_, after) = html.split_once("data-part=\"data\">").unwrap();
    let (json, _) = after.split_once("</script>").unwrap();
    let header: Value = serde_json::from_str(json).unwrap();
    let mut numbers = Numbers { bytes: STANDARD.decode(header["data"].as_str().unwrap()).unwrap(), taken: 0 };
    let grid = [0, 1].map(|axis| [0, 1].map(|end| header["grid"][end][axis].as_f64().unwrap()));
    for (index, frame) in frames.iter().enumerate() {
        let told = &header["frames"][index];
        assert_eq!((told["label"].as_str(), told["time"].as_f64()), (Some(&*frame.label), frame.time));
        let cells = frame.cells.len();
        let own = numbers.take::<4>(cells).into_iter().map(|bytes| Some(u32::from_le_bytes(bytes) as usize));
        assert!(own.eq(frame.cells.iter().map(|cell| cell.number)));
        let status = numbers.take::<1>(cells);
        assert!(status.iter().zip(&frame.cells).all(|([code], cell)| (*code == 0) == cell.is_used()));
        let sides = numbers.take::<1>(cells);
        assert!(
            sides.iter().zip(&frame.cells).all(|([count], cell)| usize::from(*count) == cell.polygon.len())
        );
        let corners = frame.cells.iter().flat_map(|cell| &cell.polygon);
        let points: Vec<[f64; 2]> =
            frame.cells.iter().map(|cell| cell.centre).chain(corners.copied()).collect();
        let steps = numbers.steps(2 * points.len());
        let near =
            |(step, at): (&[u16], &[f64; 2])| (0..2).all(|axis| agrees(step[axis], at[axis], grid[axis]));
        assert!(steps.chunks(2).zip(&points).all(near));
        for quantity in movie.quantities() {
            let told = header["quantities"].as_array().unwrap();
            let told = told.iter().find(|told| told["name"] == *quantity.name).unwrap();
            let steps = numbers.steps(cells);
            let range = pair(&told["range"]);
            assert!(
                steps.iter().zip(&quantity.values[index]).all(|(step, value)| agrees(*step, *value, range))
            );
        }
        for (field, told) in movie.arrows().iter().zip(header["arrows"].as_array().unwrap()) {
            let most = told["most"].as_f64().unwrap();
            for (step, vector) in numbers.steps(2 * cells).chunks(2).zip(&field.vectors[index]) {
                let vector = vector.unwrap_or([f64::NAN; 2]);
                assert!((0..2).all(|axis| agrees(step[axis], vector[axis], [-most, most])));
            }
        }
    }
    assert_eq!(numbers.taken, numbers.bytes.len());
    let names: Vec<&str> = movie.quantities().iter().map(|own| &*own.name).collect();
    assert_eq!(names, ["residual", "shape index", "area", "neighbours", "speed", "vorticity"]);
}

#[test]
fn a_page_with_a_movie_is_one_file() {
    let (report, frames) = (discover_sample::attributed(), [discover_sample::frames("frame 6", 8)]);
    let movie =
        movie(4, 8).unwrap().with_residuals(["residual before", "residual after"], self::frames(4, 8));
    let names: Vec<&str> = movie.quantities().iter().map(|own| &*own.name).collect();
    assert_eq!(names[..2], ["residual before", "residual after"]);
    assert_eq!(movie.quantities()[0].colours.limits(), movie.quantities()[1].colours.limits());
    let figures = DiscoverFigures { movie: Some(movie), ..discover_sample::figures() };
    let page =
        DiscoverPage { title: "embryo", report: &report, frames: &frames, flows: &[], figures: &figures };
    let html = page.render().unwrap();
    let without_namespaces = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for foreign in ["http:", "https:", " src=", "<link", "@import", "url(", "fetch(", "XMLHttpRequest"] {
        assert!(!without_namespaces.contains(foreign), "{foreign}");
    }
    for part in [
        "data-part=\"play\"",
        "data-part=\"slider\"",
        "class=\"still\"",
        "class=\"live\" data-part=\"live\" hidden",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn one_frame_has_no_transport() {
    let (report, frames, uncertainty) = (sample::report(), frames(1, 8), Uncertainty::default());
    let movie = movie(1, 8).unwrap();
    let page = sample::page(&report, &frames, &uncertainty);
    let html = InferPage { movie: Some(&movie), ..page }.render().unwrap();
    assert!(html.contains("data-part=\"canvas\"") && html.contains("data-part=\"colour\""));
    assert!(!html.contains("data-part=\"play\"") && !html.contains("data-part=\"slider\""));
}

#[test]
fn the_size_is_bounded_and_what_is_left_out_is_said() {
    for (frames, cells) in [(1, 1), (10, 0), (100_000, 7), (300, 500), (50, 100_000), (0, 5)] {
        let kept = chosen(frames, cells);
        assert!(kept.len() <= MOST_FRAMES && kept.len() * cells.min(MOST_IN_FRAME) <= MOST_IN_ALL);
        assert_eq!(kept.last().copied(), frames.checked_sub(1));
        assert!(kept.windows(3).all(|three| three[1] - three[0] == three[2] - three[1]));
    }
    let full = movie(10, 63).unwrap();
    let cells: usize = full.frames().iter().map(|frame| frame.cells.len()).sum();
    assert!((39_000..=MOST_IN_ALL).contains(&cells));
    let size = full.to_json().unwrap().len();
    assert!(size < 90 * cells + 20_000, "{size}");
    assert_eq!(full.what_is_left_out(), "");
    let some = CellMovie::new(frames(2, 70), 9, &units()).unwrap();
    assert!(some.frames().iter().all(|frame| (3000..=4400).contains(&frame.cells.len())));
    assert_eq!(
        some.what_is_left_out(),
        "Shown are 2 of 9 frames and about 4000 of 4900 cells, in the middle."
    );
}

#[test]
fn unknown_numbers_do_no_harm() {
    let movie = CellMovie::new(vec![sample::degenerate_frame()], 1, &units()).unwrap();
    let json = movie.to_json().unwrap();
    assert!(!json.contains('<') && !json.contains("NaN"));
    assert!(movie.still().starts_with("<svg"));
    assert!(movie.gif(Colouring::Area).unwrap().is_none());
    assert!(CellMovie::new(Vec::new(), 0, &units()).is_none());
    assert!(CellMovie::new(vec![FrameView::default()], 1, &units()).is_none());
}

#[test]
fn the_image_has_every_frame_and_the_colours_of_the_cells() {
    let movie = movie(4, 8).unwrap();
    let image = movie.gif(Colouring::Shape).unwrap().unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(image.as_slice()).unwrap();
    assert_eq!((decoder.width(), decoder.height() & 1), (640, 0));
    let (mut count, mut first) = (0, Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        if count == 0 {
            first = frame.buffer.to_vec();
        }
        count += 1;
    }
    assert_eq!(count, 4);
    // In the middle of a cell its colour, without a line: three shades of each of 64.
    let [low, high] = voronudge_report::map::Viewport::around_all(movie.frames()).unwrap().corners();
    let scale = 640.0 / (high[0] - low[0]);
    let quantity = movie.quantities().iter().find(|own| own.colouring == Colouring::Shape).unwrap();
    let of_cell = |cell: &CellView| {
        let middle =
            |axis: usize| cell.polygon.iter().map(|at| at[axis]).sum::<f64>() / cell.polygon.len() as f64;
        let [x, y] = [(middle(0) - low[0]) * scale, (high[1] - middle(1)) * scale];
        usize::from(first[y as usize * 640 + x as usize])
    };
    let used = movie.frames()[0].cells.iter().zip(&quantity.values[0]).filter(|(cell, _)| cell.is_used());
    let mut checked = 0;
    for (cell, &value) in used.filter(|(cell, _)| !cell.polygon.is_empty()) {
        assert_eq!(of_cell(cell), 3 * quantity.colours.level(value).unwrap());
        checked += 1;
    }
    assert!(checked > 20);
    assert_eq!(movie.gif(Colouring::Shape).unwrap().unwrap(), image);
}
