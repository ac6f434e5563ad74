//! `import field` and `phase-diffusion`: a pattern of convection cells that relaxes, from images to diffusivities.

use crate::program::{assert_described, succeed, voronudge};
use crate::refusal::assert_arguments_refused;
use crate::scratch::{Folder, npy, number, read, report};
use ndarray::{Array2, Array3};
use std::f64::consts::TAU;
use std::ffi::OsStr;

/// D_∥, D_⊥, D_∥^×, D_⊥^×
type Diffusivities = [f64; 4];

/// A wave of the displacement: its vector and its amplitude.
#[derive(Clone, Copy)]
struct Wave {
    q: [f64; 2],
    phase: f64,
    amplitude: [f64; 2],
}

/// −∂_t u of a wave: the equation term by term, with ε·(a, b) = (b, −a).
fn rate(
    [parallel, perpendicular, parallel_cross, perpendicular_cross]: Diffusivities,
    q: [f64; 2],
    u: [f64; 2],
) -> [f64; 2] {
    let divergence = q[0] * u[0] + q[1] * u[1];
    let square = q[0] * q[0] + q[1] * q[1];
    [
        parallel * q[0] * divergence
            + perpendicular * square * u[0]
            + parallel_cross * q[1] * divergence
            + perpendicular_cross * square * u[1],
        parallel * q[1] * divergence + perpendicular * square * u[1]
            - parallel_cross * q[0] * divergence
            - perpendicular_cross * square * u[0],
    ]
}

impl Wave {
    /// The longest waves of a box.
    fn all(lengths: [f64; 2], size: f64) -> Vec<Self> {
        let numbers = [[1, 0], [0, 1], [1, 1], [1, -1], [2, 0], [0, 2], [2, 1], [1, 2]];
        let wave = |(k, n): (usize, [i32; 2])| {
            let (turn, phase) = (2.4 * k as f64, 1.7 * k as f64);
            let q = [TAU * f64::from(n[0]) / lengths[0], TAU * f64::from(n[1]) / lengths[1]];
            Self { q, phase, amplitude: [size * turn.cos(), size * turn.sin()] }
        };
        numbers.into_iter().enumerate().map(wave).collect()
    }

    /// The wave a time later, by many small steps of fourth order.
    fn later(self, d: Diffusivities, time: f64) -> Self {
        const STEPS: usize = 200;
        let h = time / STEPS as f64;
        let mut u = self.amplitude;
        for _ in 0..STEPS {
            // exp(−Dh) to fourth order.
            let mut term = u;
            for power in 1..=4 {
                term = rate(d, self.q, term).map(|x| -h / f64::from(power) * x);
                u = [u[0] + term[0], u[1] + term[1]];
            }
        }
        Self { amplitude: u, ..self }
    }

    fn at(&self, r: [f64; 2]) -> [f64; 2] {
        let c = (self.q[0] * r[0] + self.q[1] * r[1] + self.phase).cos();
        self.amplitude.map(|a| a * c)
    }
}

fn sum(waves: &[Wave], r: [f64; 2]) -> [f64; 2] {
    waves.iter().map(|wave| wave.at(r)).fold([0.0; 2], |sum, u| [sum[0] + u[0], sum[1] + u[1]])
}

/// Convection cells of a hexagonal pattern that relaxes are rendered, found again as extrema, followed, and their diffusivities inferred.
#[test]
#[ignore = "slow"]
fn from_images_of_convection_cells_to_cross_diffusivities() {
    const TRUE: Diffusivities = [300.0, 120.0, -80.0, 70.0];
    let (columns, rows, cells) = (168_usize, 144_usize, [12.0, 12.0]);
    let lengths = [columns as f64, rows as f64];
    let first = Wave::all(lengths, 0.35);
    let frames = 8;
    // Rows of cells are half a spacing apart: the lattice of the waves (2, 0)/… and (1, ±1)/….
    let g = [TAU * cells[0] / lengths[0], TAU * cells[1] / (2.0 * lengths[1])];
    let stream = Array3::from_shape_fn((frames, rows, columns), |(frame, row, column)| {
        let waves: Vec<Wave> = first.iter().map(|wave| wave.later(TRUE, frame as f64)).collect();
        // Rows are counted downwards.
        let r = [column as f64 + 0.5, -(row as f64 + 0.5)];
        let u = sum(&waves, r);
        let [x, y] = [r[0] - u[0], r[1] - u[1]];
        (2.0 * g[1] * y).cos() + 2.0 * (g[0] * x).cos() * (g[1] * y).cos()
    });
    let (source, data, out) = (Folder::new(), Folder::new(), Folder::new());
    source.write_array("stream.npy", &stream);
    succeed("import field --periodic", &[("", &source.file("stream.npy")), ("--out", data.path())]);
    let found = report(data.path());
    assert_described(&found);
    let positions: Array3<f64> = read(&data.file("positions.npy"));
    assert_eq!(number(&found, "/tracks") as usize, positions.dim().1);
    assert_eq!(number(&found, "/linked") as usize, (frames - 1) * positions.dim().1);
    let outcome = succeed("phase-diffusion --wave-vectors 8", &[("", data.path()), ("--out", out.path())]);
    let found = report(out.path());
    assert_described(&found);
    assert_eq!(out.names(), ["report.html", "report.json"]);
    let names = ["D_parallel", "D_perp", "D_parallel_cross", "D_perp_cross"];
    for (name, truth) in names.into_iter().zip(TRUE) {
        let value = number(&found, &format!("/diffusivities/{name}/value"));
        let error = number(&found, &format!("/diffusivities/{name}/standard_error"));
        // Cells are where the pattern is displaced to, not where it was: of second order in u.
        assert!((value - truth).abs() < 3.0 * error + 3.0, "{name}: {value} ± {error}, {truth}");
        assert!(error < 12.0, "{name}: {value} ± {error}");
    }
    assert!(number(&found, "/chirality_significance") > 5.0);
    assert!(outcome.stdout.contains("The pattern is chiral"), "{}", outcome.stdout);
    // D_∥^× = −A/ζ.
    assert!(number(&found, "/moduli/A/value") > 0.0);
}

/// `infer` on a pattern whose diffusivities are those of a honeycomb of the model gives moduli that agree, sign included.
#[test]
fn inferred_parameters_imply_the_diffusivities_of_the_pattern() {
    // d = √2/3^{3/4}, P_MF = 6d; K_A = 0, K_P = 1, P_0 = 3.2, α = 0.3.
    let d = 2f64.sqrt() / 3f64.powf(0.75);
    let (p_0, alpha) = (3.2, 0.3);
    let (bulk, shear, odd) = (1.5 * p_0 * d, 2.25 * d * (6.0 * d - p_0), -(3f64.sqrt()) * alpha);
    let spacing = 3f64.sqrt() * d;
    let (columns, rows) = (24, 28);
    let lengths = [columns as f64 * spacing, rows as f64 * 1.5 * d];
    let waves: Vec<Wave> = Wave::all(lengths, 0.02).into_iter().take(4).collect();
    let place = |k: usize| {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        [spacing * (column + 0.5 * (row % 2.0)), 1.5 * d * row]
    };
    let count = columns * rows;
    let positions =
        Array2::from_shape_fn((count, 2), |(k, axis)| place(k)[axis] + sum(&waves, place(k))[axis]);
    let rates: Vec<Wave> = waves
        .iter()
        .map(|wave| Wave {
            amplitude: rate([bulk, shear, 0.0, odd], wave.q, wave.amplitude).map(|x| -x),
            ..*wave
        })
        .collect();
    let velocities = Array2::from_shape_fn((count, 2), |(k, axis)| sum(&rates, place(k))[axis]);
    let settings = format!(
        "boundary = \"periodic\"\nbox = [{}, {}]\nposition_noise = 1e-4\nvelocity_noise = 3e-4\n",
        lengths[0], lengths[1]
    );
    let (data, out) = (Folder::data_set(&positions, &settings), Folder::new());
    data.write_array("velocities.npy", &velocities);
    let outcome = voronudge([
        OsStr::new("infer"),
        data.path().as_os_str(),
        OsStr::new("--fix"),
        OsStr::new("K_A=0"),
        OsStr::new("--out"),
        out.path().as_os_str(),
    ]);
    assert!(matches!(outcome.code, Some(0 | 1)), "{}", outcome.stderr);
    let found = report(out.path());
    assert_described(&found);
    for (name, truth) in [("B", bulk), ("mu", shear), ("K_o", odd), ("D_perp_cross", odd)] {
        let value = number(&found, &format!("/implied_moduli/{name}/value"));
        // The model's rates have terms of fourth order in q, which the equation lacks: (q ℓ₀)² is 0.06 and 0.12 here.
        assert!((value - truth).abs() < 0.06 * bulk, "{name}: {value}, {truth}");
    }
    assert_eq!(number(&found, "/implied_moduli/A/value"), 0.0);
    assert!(number(&found, "/implied_moduli/K_o/ci95/1") < 0.0);
}

/// A simulated honeycomb of the model relaxes with the diffusivities that the mean-field theory has for it.
#[test]
fn a_simulated_honeycomb_has_the_diffusivities_of_the_theory() {
    let d = 2f64.sqrt() / 3f64.powf(0.75);
    let (p_0, alpha, spacing) = (3.2, 0.3, 3f64.sqrt() * d);
    let (columns, rows) = (24, 28);
    let lengths = [columns as f64 * spacing, rows as f64 * 1.5 * d];
    let waves = Wave::all(lengths, 0.001);
    let place = |k: usize| {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        [spacing * (column + 0.5 * (row % 2.0)), 1.5 * d * row]
    };
    let lattice = Array2::from_shape_fn((columns * rows, 2), |(k, axis)| place(k)[axis]);
    let displaced =
        Array2::from_shape_fn((columns * rows, 2), |(k, axis)| place(k)[axis] + sum(&waves, place(k))[axis]);
    let start = Folder::data_set(
        &displaced,
        &format!("boundary = \"periodic\"\nbox = [{}, {}]\n", lengths[0], lengths[1]),
    );
    start.write_array("lattice.npy", &lattice);
    let (run, out) = (Folder::new(), Folder::new());
    let line = format!("simulate --time 6 --dt 0.01 --frames 12 --K_A 0 --P_0 {p_0} --alpha {alpha}");
    succeed(&line, &[("--start", start.path()), ("--out", run.path())]);
    let paths = [("", run.path()), ("--reference", &start.file("lattice.npy")), ("--out", out.path())];
    succeed("phase-diffusion --wave-vectors 8 --order fourth", &paths);
    let found = report(out.path());
    let (bulk, shear, odd) = (1.5 * p_0 * d, 2.25 * d * (6.0 * d - p_0), -(3f64.sqrt()) * alpha);
    for (name, truth) in [("B", bulk), ("mu", shear), ("K_o", odd), ("A", 0.0)] {
        let value = number(&found, &format!("/moduli/{name}/value"));
        // What is left of terms of sixth order in q: (q ℓ₀)⁴ is 0.07 for the shortest of the waves.
        assert!((value - truth).abs() < 0.01 * bulk, "{name}: {value}, {truth}");
    }
}

#[test]
fn impossible_fields_and_patterns_are_refused() {
    let source = Folder::new();
    let refused = |bytes: Vec<u8>, flags: &[&str], facts: &[&str]| {
        let file = source.write("field.npy", bytes);
        let words = [OsStr::new("import"), OsStr::new("field"), file.as_os_str()];
        assert_arguments_refused(words.into_iter().chain(flags.iter().map(OsStr::new)), facts);
    };
    let constant = npy("<f8", "False", "(12, 20)", &[0; 12 * 20 * 8]);
    refused(constant.clone(), &[], &["frame 0 has 0 cells"]);
    refused(constant.clone(), &["--smoothing", "-1"], &["smoothing"]);
    refused(constant.clone(), &["--prominence", "0"], &["prominence"]);
    refused(constant, &["--link-limit", "-2"], &["link_limit"]);
    let mut missing = vec![0; 12 * 20 * 8];
    missing[8 * 23..8 * 24].copy_from_slice(&f64::NAN.to_le_bytes());
    refused(npy("<f8", "False", "(12, 20)", &missing), &[], &["row 1, column 3", "NaN"]);

    let positions = Array3::from_shape_fn((4, 30, 2), |(t, k, axis)| {
        let place = [(k % 6) as f64, (k / 6) as f64];
        place[axis] + 0.1 * ((7 * k + 3 * t + 5 * axis) as f64).sin()
    });
    let pattern = |settings: &str, flags: &[&str], facts: &[&str]| {
        let data = Folder::data_set(&positions, settings);
        let words = [OsStr::new("phase-diffusion"), data.path().as_os_str()];
        assert_arguments_refused(words.into_iter().chain(flags.iter().map(OsStr::new)), facts);
    };
    let periodic = "boundary = \"periodic\"\nbox = [6.0, 5.0]\n";
    pattern("boundary = \"open\"\n", &[], &["open", "periodic"]);
    pattern(periodic, &["--frames", "0,1"], &["2 frames", "at least 3"]);
    pattern(periodic, &["--wave-vectors", "30"], &["30 cells"]);
    pattern(periodic, &["--wave-vectors", "0"], &["--wave-vectors"]);
}
