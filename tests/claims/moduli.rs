//! Moduli measured on the simulated model against those of the mean-field theory.

use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::moduli::{self, Elastic, Motion, Relaxation, Settings};
use voronudge_simulate::{RandomPlacement, Simulation, generator, honeycomb};
use voronudge_theory::MeanField;

fn parameters(area_elasticity: f64, preferred_perimeter: f64, chirality: f64) -> Parameters<f64> {
    Parameters { area_elasticity, preferred_perimeter, chirality, ..Parameters::default() }
}

fn theory(p: &Parameters<f64>) -> MeanField {
    MeanField::new(voronudge_theory::Parameters {
        area_elasticity: p.area_elasticity,
        perimeter_elasticity: p.perimeter_elasticity,
        preferred_perimeter: p.preferred_perimeter,
        chirality: p.chirality,
    })
    .unwrap()
}

/// Random cells, brought to rest if that can be done.
fn disordered(cells: usize, seed: u64, p: &Parameters<f64>) -> Elastic {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2]).unwrap();
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed)).unwrap();
    let simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(p)).unwrap();
    let relaxation = Relaxation { time_step: 0.02, longest: 100.0, ..Relaxation::default() };
    moduli::elastic(&simulation, &Settings { relaxation, ..Settings::default() }).unwrap()
}

#[test]
fn a_honeycomb_has_the_moduli_and_the_prestress_of_the_theory() {
    for (k_a, p_0, alpha) in [(0.0, 3.0, 0.3), (0.0, 3.5, -1.0), (0.2, 3.3, 0.7)] {
        let p = parameters(k_a, p_0, alpha);
        let (positions, cell_box) = honeycomb(30).unwrap();
        let domain = Domain::Periodic(cell_box);
        let simulation = Simulation::new(positions, domain, Model::chiral_voronoi(&p)).unwrap();
        // A larger strain would show in the terms of third order.
        let settings = Settings { strain: 2e-4, ..Settings::default() };
        let measured = moduli::elastic(&simulation, &settings).unwrap();
        let expected = theory(&p).moduli();
        let expected = [expected.bulk, expected.odd_bulk, expected.shear, expected.odd_shear];
        for of in [measured.moduli, measured.affine] {
            for (found, expected) in of.to_array().into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{of:?} against {expected:?}");
            }
        }
        assert!(measured.nonlinearity.to_array().iter().all(|x| x.abs() < 1e-6));
        let prestress = theory(&p).prestress();
        for (found, expected) in measured.prestress.iter().flatten().zip(prestress.iter().flatten()) {
            assert!((found - expected).abs() < 1e-6, "{:?} against {prestress:?}", measured.prestress);
        }
        // Isotropic in all responses.
        let r = measured.response;
        assert!((r[2][1] - r[3][2]).abs() < 1e-6 && (r[2][2] + r[3][1]).abs() < 1e-6);
    }
}

/// Disordered solids at P_0 = 3.0 against the honeycomb. Displacements that follow the strain give its moduli; in relaxing, a
/// disordered solid loses a sixth to a third of |Kᵒ| and hardly any of μ. docs/commands/moduli.md has more of them.
#[test]
fn disordered_solids_are_about_as_stiff_as_the_honeycomb() {
    let p = parameters(0.1, 3.0, 2.0);
    let solids: Vec<Elastic> = (1..=4).map(|seed| disordered(100, seed, &p)).collect();
    assert!(solids.iter().all(|solid| solid.motion == Motion::AtRest && solid.restless == 0));
    let ratio = |of: fn(&Elastic) -> f64, expected: f64| solids.iter().map(of).sum::<f64>() / 4.0 / expected;
    let expected = theory(&p).moduli();
    let near_one = |ratio: f64| (ratio - 1.0).abs() < 0.15;
    assert!(near_one(ratio(|solid| solid.affine.shear, expected.shear)));
    assert!(near_one(ratio(|solid| solid.affine.odd_shear, expected.odd_shear)));
    assert!(near_one(ratio(|solid| solid.moduli.bulk, expected.bulk)));
    assert!(near_one(ratio(|solid| solid.moduli.shear, expected.shear)));
    let odd_shear = ratio(|solid| solid.moduli.odd_shear, expected.odd_shear);
    assert!((0.65..1.0).contains(&odd_shear), "{odd_shear}");
}

/// Beyond the limit of the solid a small shear modulus may be left: the cells need not have come to rest.
#[test]
fn without_chirality_nothing_is_odd_and_the_solid_softens_towards_the_liquid() {
    let [stiff, soft] = [3.0, 4.0].map(|p_0| disordered(36, 3, &parameters(0.1, p_0, 0.0)));
    assert_eq!(stiff.motion, Motion::AtRest);
    // Forces with a potential: the response is that of a symmetric matrix.
    let odd = [stiff.moduli.odd_bulk, stiff.moduli.odd_shear];
    assert!(odd.iter().all(|x| x.abs() < 1e-4 * stiff.moduli.shear), "{stiff:?}");
    assert!(stiff.moduli.shear > 10.0 * soft.moduli.shear, "{} {}", stiff.moduli.shear, soft.moduli.shear);
}
