//! The catalogue of effects: what each does, on paper and on a disordered tissue.

use crate::samples::{difference, jittered, largest, parameters, periodic};
use std::error::Error;
use std::sync::Arc;
use voronudge_geometry::{CellPolygon, Domain, Grid, Tessellation, Vector};
use voronudge_model::{
    Column, Effect, Environment, EnvironmentError, Model, Structure, VectorMap, jacobian, velocities,
};

type Outcome = Result<(), Box<dyn Error>>;

/// Positions, who is whose neighbour, and the environment.
type Tissue = (Vec<Vector<f64>>, Tessellation, Arc<Environment>);

/// A disordered tissue in a box, with everything that effects may refer to.
fn tissue(side: usize) -> Result<Tissue, Box<dyn Error>> {
    let length = side as f64;
    let positions = jittered(side, side, 0.35, 7);
    let cells = positions.len();
    let tessellation = Tessellation::new(&positions, periodic([length, length])?)?;
    let earlier = |cell: usize| {
        (!cell.is_multiple_of(5)).then(|| Vector::new((cell as f64).sin(), (cell as f64).cos()))
    };
    let environment = Environment::default()
        .about(Vector::new(length / 2.0, length / 2.0))
        .with_labels((0..cells).map(|cell| [Some(4), Some(4), Some(9), None][cell % 4]).collect())?
        .with_earlier((0..cells).map(earlier).collect())?
        .with_map(VectorMap::new(
            Grid::new([1.0, 1.0], [3.0, 3.0], [2, 2])?,
            vec![Vector::new(1.0, 2.0); 4],
        )?);
    Ok((positions, tessellation, Arc::new(environment)))
}

fn effect(id: &str) -> Result<&'static Effect, String> {
    Effect::from_id(id).ok_or(format!("no effect {id}"))
}

/// The fields of all columns of an effect, each for a coefficient of one on top of the base model.
fn fields(id: &str, tissue: &Tissue) -> Result<Vec<Vec<f64>>, String> {
    let (positions, tessellation, environment) = tissue;
    let base = Model::chiral_voronoi(&parameters()).within(environment);
    let without = velocities(tessellation, positions, &base);
    let columns = effect(id)?.columns(environment, tessellation.domain())?;
    Ok(columns
        .into_iter()
        .map(|column| {
            let v = velocities(tessellation, positions, &base.clone().with(column, 1.0));
            v.iter().zip(&without).flat_map(|(v, v0)| [v.x - v0.x, v.y - v0.y]).collect()
        })
        .collect())
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

#[test]
fn ids_are_unique_and_entries_complete() {
    for (k, effect) in Effect::all().iter().enumerate() {
        assert!(Effect::all()[..k].iter().all(|other| other.id != effect.id), "{}", effect.id);
        assert!(
            effect.meaning.ends_with('.') && !effect.formula.is_empty() && !effect.coefficients.is_empty()
        );
        assert_eq!(Effect::from_id(effect.id).map(|found| found.id), Some(effect.id));
    }
    assert!(Effect::from_id("phlogiston").is_none());
}

#[test]
fn the_table_of_the_documentation_lists_every_effect() -> Outcome {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/effects.md"))?;
    let listed: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`').map(|(id, _)| id)).collect();
    let ids: Vec<&str> = Effect::all().iter().map(|effect| effect.id).collect();
    assert_eq!(listed, ids);
    Ok(())
}

#[test]
fn a_coefficient_of_zero_changes_nothing() -> Outcome {
    let (positions, tessellation, environment) = tissue(8)?;
    let base = Model::chiral_voronoi(&parameters()).within(&environment);
    let without = velocities(&tessellation, &positions, &base);
    for effect in Effect::all() {
        for column in effect.columns(&environment, tessellation.domain()).unwrap_or_default() {
            let v = velocities(&tessellation, &positions, &base.clone().with(column, 0.0));
            assert!(difference(&v, &without) < 1e-14 * largest(&without), "{}", effect.id);
        }
    }
    Ok(())
}

#[test]
fn effects_that_do_not_apply_say_why() -> Outcome {
    let cell_box = periodic([8.0, 8.0])?;
    let nothing = Environment::default();
    for (id, domain, reason) in [
        ("label_parameter", cell_box, "no labels"),
        ("persistence", cell_box, "no earlier velocities"),
        ("alignment", Domain::Open, "no earlier velocities"),
        ("external_field", cell_box, "no external field"),
        ("rotation", cell_box, "not periodic"),
        ("boundary_tension", cell_box, "not periodic"),
        ("boundary_torque", Domain::Open, "no edge"),
    ] {
        let Err(found) = effect(id)?.applies(&nothing, domain) else { return Err(id.into()) };
        assert!(found.contains(reason), "{id}: {found}");
    }
    let same = Environment::default().with_labels(vec![Some(1); 5])?;
    assert!(effect("label_parameter")?.applies(&same, cell_box).is_err());
    assert_eq!(effect("p0_gradient")?.columns(&nothing, cell_box)?.len(), 4);
    assert_eq!(effect("p0_gradient")?.columns(&nothing, Domain::Open)?.len(), 2);
    Ok(())
}

#[test]
fn data_for_another_number_of_cells_are_refused() -> Outcome {
    let environment = Environment::default().with_labels(vec![None; 5])?;
    let error = environment.clone().with_earlier(vec![None; 6]);
    assert!(matches!(error, Err(EnvironmentError::Cells { found: 6, expected: 5, .. })));
    assert!(environment.check(5).is_ok() && environment.check(4).is_err());
    let map = VectorMap::new(Grid::new([0.0, 0.0], [1.0, 1.0], [2, 2])?, vec![Vector::zeros(); 3]);
    assert!(matches!(map, Err(EnvironmentError::Map { found: 3, expected: 4 })));
    assert!(environment.with_cell_size(0.0).is_err());
    Ok(())
}

#[test]
fn near_aliases_are_nearly_parallel() -> Outcome {
    let tissue = tissue(14)?;
    let base: Vec<Vec<f64>> = Structure::base(1.0)
        .columns(&tissue.1, &tissue.0, &tissue.2)
        .iter()
        .map(|field| field.iter().flat_map(|v| [v.x, v.y]).collect())
        .collect();
    let one = |id: &str| -> Result<Vec<f64>, Box<dyn Error>> {
        Ok(fields(id, &tissue)?.into_iter().next().ok_or("no column")?)
    };
    let rho = correlation(&one("edge_tension")?, &base[1]);
    assert!(rho < -0.9, "edge tension, adhesion: {rho}");
    let rho = correlation(&one("alpha_adhesion")?, &base[3]);
    assert!(rho.abs() > 0.9, "alpha_adhesion, alpha: {rho}");
    let rho = correlation(&one("chiral_edge_tension")?, &base[3]);
    assert!(rho.abs() > 0.9, "chiral edge tension, alpha: {rho}");
    for (p0, kp) in fields("p0_gradient", &tissue)?.iter().zip(fields("kp_gradient", &tissue)?) {
        assert!(correlation(p0, &kp) < -0.98, "{}", correlation(p0, &kp));
    }
    // The gain is an exact alias of all parameters together.
    let v0 = velocities(&tissue.1, &tissue.0, &Model::chiral_voronoi(&parameters()));
    let v0: Vec<f64> = v0.iter().flat_map(|v| [v.x, v.y]).collect();
    assert!((correlation(&one("flow_gain")?, &v0) - 1.0).abs() < 1e-14);
    Ok(())
}

#[test]
fn a_constant_pressure_torque_is_a_gauge() -> Outcome {
    let (positions, tessellation, environment) = tissue(8)?;
    let field = |environment: &Arc<Environment>| -> Result<Vec<Vector<f64>>, Box<dyn Error>> {
        let columns = effect("alpha_pressure")?.columns(environment, tessellation.domain())?;
        let Some(Column::Term(term)) = columns.first() else { return Err("not a term".into()) };
        Ok(velocities(&tessellation, &positions, &Model::single(*term).within(environment)))
    };
    let (one, other) = (field(&environment)?, field(&Arc::new(Environment::default().with_cell_size(1.7)?))?);
    assert!(difference(&one, &other) < 1e-12 * largest(&one));
    Ok(())
}

#[test]
fn internal_drag_solves_its_equation_and_conserves_momentum() -> Outcome {
    let (positions, tessellation, environment) = tissue(12)?;
    let base = Model::chiral_voronoi(&parameters()).within(&environment);
    let force = velocities(&tessellation, &positions, &base);
    let column = effect("internal_drag")?.columns(&environment, tessellation.domain())?[0];
    for drag in [0.0, 0.1, 3.0, 100.0] {
        let v = velocities(&tessellation, &positions, &base.clone().with(column, drag));
        for cell in 0..positions.len() {
            let neighbours = tessellation.neighbours(cell);
            let friction: Vector<f64> = neighbours.iter().map(|&j| v[cell] - v[j as usize]).sum();
            assert!((v[cell] + friction * drag - force[cell]).amax() < 1e-12 * largest(&force));
        }
        let (before, after): (Vector<f64>, Vector<f64>) = (force.iter().sum(), v.iter().sum());
        assert!((before - after).amax() < 1e-11 * largest(&force));
        assert!(largest(&v) <= largest(&force));
    }
    Ok(())
}

#[test]
fn evaluation_is_exact_in_all_coefficients() -> Outcome {
    let (positions, tessellation, environment) = tissue(8)?;
    let mut columns = Vec::new();
    for id in ["internal_drag", "time_lag", "p0_gradient", "flow_blur", "size_friction", "centroid_bias"] {
        columns.extend(effect(id)?.columns(&environment, tessellation.domain())?);
    }
    columns.extend(effect("cell_centre_chirality")?.columns(&environment, tessellation.domain())?);
    columns.extend(effect("friction_gradient")?.columns(&environment, tessellation.domain())?);
    let structure = Structure::base(1.0).with(&columns);
    assert_eq!(structure.dimension(), 4 + columns.len());
    let coefficients: Vec<f64> = (0..structure.dimension())
        .map(|k| if k < 4 { 0.5 + k as f64 } else { 0.02 + 0.003 * k as f64 })
        .collect();
    let at = |coefficients: &[f64]| {
        velocities(&tessellation, &positions, &structure.model(coefficients, &environment))
    };
    let fields = structure.columns(&tessellation, &positions, &environment);
    let found = structure.evaluate(&tessellation, &positions, &fields, &coefficients, &environment);
    let v = at(&coefficients);
    assert!(difference(&found.velocities, &v) < 1e-12 * largest(&v));
    assert_eq!(found.by_coefficient.len(), structure.dimension());
    for (k, slope) in found.by_coefficient.iter().enumerate() {
        let step = 1e-4;
        let shifted = |sign: f64| {
            let mut c = coefficients.clone();
            c[k] += sign * step;
            at(&c)
        };
        // Central differences leave errors of order step².
        let expected: Vec<_> =
            shifted(1.0).iter().zip(shifted(-1.0)).map(|(a, b)| (a - b) / (2.0 * step)).collect();
        assert!(difference(slope, &expected) < 1e-6 * largest(&expected), "coefficient {k}");
    }
    Ok(())
}

#[test]
fn a_lag_and_a_bias_are_displacements_to_first_order() -> Outcome {
    let (positions, tessellation, environment) = tissue(8)?;
    let base = Model::chiral_voronoi(&parameters()).within(&environment);
    let v = velocities(&tessellation, &positions, &base);
    let mut polygon = CellPolygon::default();
    let centroid = |cell: usize| -> Vector<f64> {
        polygon.fill(&tessellation, &positions, cell);
        let c: Vec<Vector<f64>> = polygon.vertices().collect();
        let pairs = || c.iter().zip(c.iter().cycle().skip(1));
        pairs().map(|(p, q)| (p + q) * p.perp(q)).sum::<Vector<f64>>() / (6.0 * polygon.shape().area)
    };
    let offsets: Vec<Vector<f64>> = (0..positions.len()).map(centroid).collect();
    let back: Vec<Vector<f64>> = offsets.iter().map(|u| -u).collect();
    for (id, along) in [("time_lag", &v), ("centroid_bias", &back)] {
        let column = effect(id)?.columns(&environment, tessellation.domain())?[0];
        let with = velocities(&tessellation, &positions, &base.clone().with(column, 1.0));
        let expected = jacobian(&tessellation, &positions, &base).apply(along);
        let added: Vec<_> = with.iter().zip(&v).map(|(with, v)| with - v).collect();
        assert!(difference(&added, &expected) < 1e-11 * largest(&expected), "{id}");
    }
    Ok(())
}

#[test]
fn a_map_is_interpolated_and_ends() -> Outcome {
    let values: Vec<Vector<f64>> = (0..6).map(|k| Vector::new(f64::from(k % 3), f64::from(k / 3))).collect();
    let map = VectorMap::new(Grid::new([1.0, 1.0], [2.0, 2.0], [3, 2])?, values)?;
    let close = |a: Vector<f64>, b: [f64; 2]| (a - Vector::from(b)).amax() < 1e-14;
    assert!(close(map.at(Vector::new(2.0, 1.5), Domain::Open), [0.5, 0.25]));
    assert!(close(map.at(Vector::new(5.0, 3.0), Domain::Open), [2.0, 1.0]));
    assert!(close(map.at(Vector::new(5.1, 3.0), Domain::Open), [0.0, 0.0]));
    let cell_box = periodic([8.0, 8.0])?;
    assert!(close(map.at(Vector::new(2.0 - 8.0, 1.5 + 16.0), cell_box), [0.5, 0.25]));
    Ok(())
}
