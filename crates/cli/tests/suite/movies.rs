//! Movies in pages and as images: there for every command with frames, and the same for any number of threads.

use crate::program::{fixture, succeed};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, report};
use serde_json::Value;
use std::fs;

const LINE: &str = "simulate --cells 60 --box 10 6 --time 2 --frames 6 --dt 0.01 --P_0 4 --alpha 1 --quiet";

/// What the page in a folder holds of the cells.
fn movie(folder: &Folder) -> Value {
    let page = fs::read_to_string(folder.file("report.html")).unwrap();
    let (_, after) = page.split_once("data-part=\"data\">").unwrap();
    serde_json::from_str(after.split_once("</script>").unwrap().0).unwrap()
}

fn names(movie: &Value) -> Vec<&str> {
    movie["quantities"].as_array().unwrap().iter().map(|own| own["name"].as_str().unwrap()).collect()
}

#[test]
fn a_run_is_the_same_movie_on_any_number_of_threads() {
    for surroundings in ["", "--walls x", "--shear-rate 1"] {
        let run = |threads: usize| {
            let out = Folder::new();
            let line = format!("{LINE} {surroundings} --movie vorticity --threads {threads}");
            succeed(&line, &[("--out", out.path())]);
            (fs::read(out.file("movie.gif")).unwrap(), movie(&out))
        };
        let ((image, shown), (of_two, shown_of_two)) = (run(1), run(2));
        assert!(image.starts_with(b"GIF89a") && image == of_two);
        assert_eq!(shown, shown_of_two);
        assert_eq!(shown["frames"].as_array().unwrap().len(), 6);
        assert_eq!(shown["frames"][5]["cells"], 60);
        assert_eq!(names(&shown), ["shape index", "area", "neighbours", "speed", "vorticity"]);
        // The unit of length is the cell size, that of time the inverse of K_P.
        assert_eq!(shown["time_unit"], "K_P⁻¹");
    }
}

#[test]
fn fits_show_residuals_and_what_is_known_of_each_cell() {
    let out = Folder::new();
    let data = fixture("reference-small");
    succeed("infer --movie residual --quiet", &[("", &data), ("--out", out.path())]);
    let shown = movie(&out);
    assert_eq!(names(&shown)[0], "residual");
    assert_eq!(shown["frames"].as_array().unwrap().len(), 1);
    assert!(shown["frames"][0]["time"].is_null());
    assert!(fs::read(out.file("movie.gif")).unwrap().starts_with(b"GIF89a"));
}

#[test]
fn a_movie_of_an_earlier_run_goes_and_other_files_stay() {
    let out = Folder::new();
    succeed(&format!("{LINE} --movie area"), &[("--out", out.path())]);
    assert!(out.file("movie.gif").exists());
    out.write("movie.mp4", "");
    succeed(LINE, &[("--out", out.path())]);
    assert!(!out.file("movie.gif").exists() && out.file("movie.mp4").exists());
}

#[test]
fn colours_of_which_nothing_is_known_are_told() {
    let line = LINE.split_whitespace().chain(["--movie", "residual"]);
    assert!(assert_arguments_refused(line, &["--movie residual", "nothing is fitted"]).contains("shape"));
    // Each cell has a neighbour whose velocity was not measured.
    let (data, out) = (Folder::copy_of("reference-small"), Folder::new());
    data.change("velocities.npy", |v| {
        v.rows_mut().into_iter().step_by(2).for_each(|mut own| own.fill(f64::NAN))
    });
    let line = "infer --fix K_A=0.1 --complete false --movie vorticity --quiet";
    succeed(line, &[("", data.path()), ("--out", out.path())]);
    assert!(!out.file("movie.gif").exists());
    let warnings = report(out.path())["warnings"].to_string();
    assert!(
        warnings.contains("no movie.gif was written: the vorticity of the cells is not known here"),
        "{warnings}"
    );
}

#[test]
fn figures_are_written_with_their_numbers() {
    let out = Folder::new();
    succeed(&format!("{LINE} --figures"), &[("--out", out.path())]);
    let names =
        || fs::read_dir(out.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let figures: Vec<String> = names().filter(|name| name.ends_with(".svg")).collect();
    let page = fs::read_to_string(out.file("report.html")).unwrap();
    assert_eq!(figures.len(), page.matches("<figure").count(), "{figures:?}");
    for name in &figures {
        let picture = fs::read_to_string(out.file(name)).unwrap();
        assert!(picture.starts_with("<svg") && page.contains(&picture), "{name}");
        let table = out.file(&name.replace(".svg", ".csv"));
        assert_eq!(picture.contains("<metadata>"), table.exists(), "{name}");
    }
    let table = names().find(|name| name.contains("mean-square-displacement") && name.ends_with(".csv"));
    let table = fs::read_to_string(out.file(&table.unwrap())).unwrap();
    assert!(table.starts_with("series,lag") && table.lines().count() > 3, "{table}");
}
