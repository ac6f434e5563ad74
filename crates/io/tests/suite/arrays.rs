//! `.npy` files: every layout in, every broken file told.

use ndarray::{Array2, Array3, ArrayD, IxDyn, ShapeBuilder, array};
use voronudge_io::{read_integers, read_reals, read_vectors};

use crate::{Scratch, assert_told};

/// A version 1 file from its parts, padded the way numpy does.
fn npy(dictionary: &str, body: &[u8]) -> Vec<u8> {
    let mut text = dictionary.to_owned();
    while !(10 + text.len() + 1).is_multiple_of(64) {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(body);
    bytes
}

fn dictionary(descr: &str, order: &str, shape: &str) -> String {
    format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}")
}

fn vectors() -> Array3<f64> {
    Array3::from_shape_fn((2, 3, 2), |(f, c, a)| (100 * f + 10 * c + a) as f64 + 0.25)
}

#[test]
fn float64_written_elsewhere_is_read_exactly() {
    let scratch = Scratch::new();
    let mut array = vectors();
    array[[1, 2, 0]] = f64::NAN;
    let path = scratch.write_array("a.npy", &array);
    let read = read_reals(&path).unwrap();
    assert_eq!(read.shape(), [2, 3, 2]);
    assert!(read.iter().zip(&array).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn fortran_order_is_put_in_standard_order() {
    let scratch = Scratch::new();
    let standard = vectors();
    let mut fortran = Array3::zeros((2, 3, 2).f());
    fortran.assign(&standard);
    let path = scratch.write_array("a.npy", &fortran);
    let bytes = std::fs::read(&path).unwrap();
    assert!(String::from_utf8_lossy(&bytes).contains("'fortran_order': True"));
    let read = read_vectors(&path).unwrap();
    assert!(read.is_standard_layout());
    assert_eq!(read, standard);
}

#[test]
fn float32_is_widened() {
    let scratch = Scratch::new();
    let path = scratch.write_array("a.npy", &vectors().mapv(|v| v as f32));
    // Quarters are exact in single precision.
    assert_eq!(read_vectors(&path).unwrap(), vectors());
}

#[test]
fn every_number_type_and_byte_order_gives_the_same_numbers() {
    let scratch = Scratch::new();
    let values: [i64; 4] = [0, 1, 77, 127];
    let signed: [i64; 4] = [-128, -1, 5, 127];
    for size in [1_usize, 2, 4, 8] {
        for big in [false, true] {
            for (kind, numbers) in [("u", values), ("i", signed)] {
                let sign = if big { ">" } else { "<" };
                let body: Vec<u8> = numbers
                    .iter()
                    .flat_map(|value| {
                        let bytes = value.to_le_bytes();
                        let mut word = bytes[..size].to_vec();
                        if big {
                            word.reverse();
                        }
                        word
                    })
                    .collect();
                let header = dictionary(&format!("{sign}{kind}{size}"), "False", "(4,)");
                let path = scratch.write("a.npy", npy(&header, &body));
                assert_eq!(read_integers(&path).unwrap().as_slice().unwrap(), numbers);
                let reals = read_reals(&path).unwrap();
                assert_eq!(reals.as_slice().unwrap(), numbers.map(|n| n as f64));
            }
        }
    }
}

#[test]
fn big_endian_floats_are_read() {
    let scratch = Scratch::new();
    let numbers = [1.5_f64, -2e300, f64::NAN];
    let body: Vec<u8> = numbers.iter().flat_map(|v| v.to_be_bytes()).collect();
    let path = scratch.write("a.npy", npy(&dictionary(">f8", "False", "(3,)"), &body));
    let read = read_reals(&path).unwrap();
    assert_eq!((read[0], read[1], read[2].is_nan()), (1.5, -2e300, true));
    let body: Vec<u8> = [1.5_f32, -2.25].iter().flat_map(|v| v.to_be_bytes()).collect();
    let path = scratch.write("b.npy", npy(&dictionary(">f4", "False", "(2,)"), &body));
    assert_eq!(read_reals(&path).unwrap(), array![1.5, -2.25].into_dyn());
}

#[test]
fn versions_two_and_three_and_python_two_are_read() {
    let scratch = Scratch::new();
    for version in [2_u8, 3] {
        let text = dictionary("<f8", "False", "(1L,)");
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes.extend(4.0_f64.to_le_bytes());
        let path = scratch.write("a.npy", bytes);
        assert_eq!(read_reals(&path).unwrap(), array![4.0].into_dyn());
    }
}

#[test]
fn one_frame_may_leave_out_its_axis() {
    let scratch = Scratch::new();
    let path = scratch.write_array("a.npy", &array![[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]);
    assert_eq!(read_vectors(&path).unwrap().dim(), (1, 3, 2));
}

#[test]
fn missing_file_and_folder_are_told() {
    let scratch = Scratch::new();
    let missing = scratch.path("nowhere.npy");
    assert_told(read_reals(&missing), &["nowhere.npy: no such file"], "check the spelling");
    assert_told(read_reals(scratch.root()), &["is a folder, a file is needed"], "inside the folder");
}

#[test]
fn empty_file_is_told() {
    let scratch = Scratch::new();
    let path = scratch.write("a.npy", b"");
    assert_told(read_reals(&path), &["a.npy: is empty (0 bytes)"], "cut");
}

#[test]
fn wrong_magic_is_told_with_a_guess_at_the_format() {
    let scratch = Scratch::new();
    let path = scratch.write("a.npy", b"PK\x03\x04 zip");
    let facts = ["a.npy: is not a .npy file", "50 4b 03 04"];
    assert_told(read_reals(&path), &facts, ".npz");
    let path = scratch.write("a.npy", [0x1f, 0x8b, 8, 0, 0, 0, 0]);
    assert_told(read_reals(&path), &["is not a .npy file"], "decompress");
    let path = scratch.write("a.npy", "1.0,2.0\n");
    assert_told(read_reals(&path), &["is not a .npy file"], "numpy.save");
}

#[test]
fn a_file_cut_anywhere_is_told_and_never_read() {
    let scratch = Scratch::new();
    let whole = std::fs::read(scratch.write_array("a.npy", &vectors())).unwrap();
    for length in 0..whole.len() {
        let path = scratch.write("a.npy", &whole[..length]);
        let error = read_vectors(&path).unwrap_err();
        let message = error.to_string();
        assert!(
            ["is empty", "ends inside its header", "is truncated"].iter().any(|fact| message.contains(fact)),
            "{length}: {message}"
        );
        assert!(error.hint().unwrap().contains("cut"));
    }
    let path = scratch.write("a.npy", &whole[..whole.len() - 16]);
    let facts = ["(2, 3, 2) of <f8, 96 bytes, but 80 bytes follow"];
    assert_told(read_vectors(&path), &facts, "write it again");
}

#[test]
fn a_huge_claim_is_refused_without_allocating() {
    let scratch = Scratch::new();
    // 16 TB: an allocation of this size would abort the test.
    let header = dictionary("<f8", "False", "(1000000000000, 2)");
    let path = scratch.write("a.npy", npy(&header, &[0; 16]));
    let facts = ["(1000000000000, 2)", "16000000000000 bytes, but 16 bytes"];
    assert_told(read_vectors(&path), &facts, "cut");
    let most = usize::MAX;
    let header = dictionary("<f8", "False", &format!("({most}, {most}, {most})"));
    let path = scratch.write("a.npy", npy(&header, &[0; 16]));
    assert_told(read_reals(&path), &["more bytes than can be counted, but 16 bytes"], "cut");
    let header = dictionary("<f8", "False", &format!("(0, {most}, {most})"));
    let path = scratch.write("a.npy", npy(&header, &[]));
    assert_told(read_reals(&path), &["impossible shape"], "numpy.save");
    let header = dictionary("<f8", "False", "(99999999999999999999999,)");
    let path = scratch.write("a.npy", npy(&header, &[]));
    assert_told(read_reals(&path), &["malformed", "shape is"], "numpy.save");
}

#[test]
fn bytes_behind_the_array_are_told() {
    let scratch = Scratch::new();
    let path = scratch.write("a.npy", npy(&dictionary("<f8", "False", "(2,)"), &[0; 19]));
    assert_told(read_reals(&path), &["has 3 bytes behind the array of shape (2,)"], "numpy.save");
}

#[test]
fn unsupported_types_are_named() {
    let scratch = Scratch::new();
    for descr in ["<c16", "|b1", "<U5", "<f2", "|O", "<M8[ns]", "=f8", ""] {
        let path = scratch.write("a.npy", npy(&dictionary(descr, "False", "(2,)"), &[0; 32]));
        let fact = format!("has elements of type {descr}, float32, float64 or");
        assert_told(read_reals(&path), &["a.npy", &fact], "astype");
    }
    let header = "{'descr': [('x', '<f8'), ('y', '<f8')], 'fortran_order': False, 'shape': (1,), }";
    let path = scratch.write("a.npy", npy(header, &[0; 16]));
    assert_told(read_reals(&path), &["type [('x', '<f8'), ('y'"], "astype");
    let path = scratch.write_array("a.npy", &array![1.0, 2.0]);
    let facts = ["type <f8, integers of up to 64 bits are needed"];
    assert_told(read_integers(&path), &facts, "int64");
}

#[test]
fn an_integer_beyond_a_label_is_told() {
    let scratch = Scratch::new();
    let path = scratch.write_array("a.npy", &array![1_u64, u64::MAX]);
    let facts = ["holds the integer 18446744073709551615"];
    assert_told(read_integers(&path), &facts, "renumber");
}

#[test]
fn malformed_headers_are_told() {
    let scratch = Scratch::new();
    for (header, fact) in [
        ("nonsense", "no dictionary"),
        ("{'descr': '<f8', 'fortran_order': False}", "no entry 'shape'"),
        ("{'descr': '<f8', 'shape': (2,)}", "no entry 'fortran_order'"),
        ("{'fortran_order': False, 'shape': (2,)}", "no entry 'descr'"),
        ("{'descr': '<f8', 'fortran_order': 1, 'shape': (2,)}", "fortran_order is 1"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': (-2,)}", "shape is (-2,)"),
        ("{'descr': '<f8', 'fortran_order': False, 'shape': 2}", "shape is 2"),
        ("{'descr': '<f8', 'extra': 1}", "unknown entry \"'extra'\""),
        ("{'descr'}", "has no colon"),
    ] {
        let path = scratch.write("a.npy", npy(header, &[0; 16]));
        assert_told(read_reals(&path), &["malformed .npy header", fact], "again");
    }
    let mut bytes = npy(&dictionary("<f8", "False", "(2,)"), &[0; 16]);
    bytes[6] = 9;
    let path = scratch.write("a.npy", bytes);
    assert_told(read_reals(&path), &["format version 9.0"], "again");
}

#[test]
fn wrong_shapes_of_vectors_are_told_with_what_was_expected() {
    let scratch = Scratch::new();
    let shape = |lengths: &[usize]| scratch.write_array("a.npy", &ArrayD::<f64>::zeros(IxDyn(lengths)));
    let expected = "expected (cells, 2) or (frames, cells, 2)";
    let dimensions = "axes are frames, cells";
    for (lengths, facts, advice) in [
        (&[5][..], &["shape (5,) with 1 dim", expected][..], dimensions),
        (&[1, 2, 3, 2], &["(1, 2, 3, 2) with 4 dim", expected], dimensions),
        (&[], &["shape () with 0 dim"], dimensions),
        (&[5, 4], &["(5, 4)", "last axis must hold x, y"], dimensions),
        (&[4, 5, 3], &["(4, 5, 3)", expected], "z, leave it out"),
        (&[2, 5], &["(2, 5)", expected], "transpose"),
        (&[0, 2], &["(0, 2): no cells"], "empty selection"),
        (&[0, 5, 2], &["(0, 5, 2): no frames"], "empty selection"),
    ] {
        assert_told(read_vectors(&shape(lengths)), facts, advice);
    }
}

#[test]
fn random_bytes_never_break_the_reader() {
    let scratch = Scratch::new();
    let array: Array2<f64> = Array2::zeros((3, 2));
    let whole = std::fs::read(scratch.write_array("a.npy", &array)).unwrap();
    // A linear congruential generator is random enough to flip bytes of the header.
    let mut state = 1_u64;
    for _ in 0..2000 {
        let mut bytes = whole.clone();
        for _ in 0..2 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let place = (state >> 33) as usize % 128;
            bytes[place] = (state >> 56) as u8;
        }
        let path = scratch.write("b.npy", bytes);
        // Either outcome is right; a panic or an abort is not.
        let _ = read_vectors(&path);
    }
}
