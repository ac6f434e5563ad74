//! The same numbers in another layout or precision give the same results.

use crate::program::{fixture, succeed};
use crate::scratch::{Folder, names, npy, read};
use ndarray::{Array2, ShapeBuilder};
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

type Arrays = Vec<(String, Vec<u8>)>;

/// The arrays that both commands make of a data set.
fn results(data: &Path) -> Arrays {
    ["infer --fix K_A=0.1 --quiet", "evaluate --jacobian --quiet"]
        .into_iter()
        .flat_map(|line| {
            let out = Folder::new();
            succeed(line, &[("", data), ("--out", out.path())]);
            let arrays = names(out.path()).into_iter().filter(|name| name.ends_with(".npy"));
            arrays.map(|name| (name.clone(), fs::read(out.file(&name)).unwrap())).collect::<Vec<_>>()
        })
        .collect()
}

/// Those of the data set as it stands.
static STANDARD: LazyLock<Arrays> = LazyLock::new(|| results(&fixture("chiral-liquid-clean")));

const ARRAYS: [&str; 2] = ["positions.npy", "velocities.npy"];

#[test]
fn fortran_order_changes_nothing() {
    let data = Folder::copy_of("chiral-liquid-clean");
    for name in ARRAYS {
        let standard: Array2<f64> = read(&data.file(name));
        let mut fortran = Array2::zeros(standard.raw_dim().f());
        fortran.assign(&standard);
        data.write_array(name, &fortran);
        let header = fs::read(data.file(name)).unwrap();
        assert!(String::from_utf8_lossy(&header[..128]).contains("'fortran_order': True"));
    }
    assert!(results(data.path()) == *STANDARD);
}

#[test]
fn single_precision_is_widened_in_either_order() {
    let data = Folder::copy_of("chiral-liquid-clean");
    // What single precision can hold, in double precision.
    for name in ARRAYS {
        data.change(name, |array| array.mapv_inplace(|value| f64::from(value as f32)));
    }
    let expected = results(data.path());
    for fortran in [false, true] {
        let single = Folder::copy_of("chiral-liquid-clean");
        for name in ARRAYS {
            let double: Array2<f64> = read(&data.file(name));
            let mut array = Array2::<f32>::zeros(double.raw_dim().set_f(fortran));
            array.zip_mut_with(&double, |narrow, wide| *narrow = *wide as f32);
            single.write_array(name, &array);
        }
        assert!(results(single.path()) == expected, "fortran order: {fortran}");
    }
}

#[test]
fn big_endian_numbers_are_read() {
    let data = Folder::copy_of("chiral-liquid-clean");
    for name in ARRAYS {
        let array: Array2<f64> = read(&data.file(name));
        let body: Vec<u8> = array.iter().flat_map(|value| value.to_be_bytes()).collect();
        data.write(name, npy(">f8", "False", "(100, 2)", &body));
    }
    assert!(results(data.path()) == *STANDARD);
}

#[test]
fn one_frame_with_an_axis_of_frames_is_one_frame_without() {
    let data = Folder::copy_of("chiral-liquid-clean");
    for name in ARRAYS {
        let array: Array2<f64> = read(&data.file(name));
        data.write_array(name, &array.insert_axis(ndarray::Axis(0)));
    }
    assert!(results(data.path()) == *STANDARD);
}

#[test]
fn files_given_one_by_one_are_the_folder() {
    let data = Folder::copy_of("chiral-liquid-clean");
    let out = [Folder::new(), Folder::new()];
    succeed("evaluate --quiet", &[("", data.path()), ("--out", out[0].path())]);
    data.remove("dataset.toml");
    let positions = data.file("positions.npy");
    succeed("evaluate --quiet --box 10 10", &[("--positions", &positions), ("--out", out[1].path())]);
    for name in ["velocities.npy", "areas.npy", "perimeters.npy", "stress.npy"] {
        assert!(fs::read(out[0].file(name)).unwrap() == fs::read(out[1].file(name)).unwrap(), "{name}");
    }
}
