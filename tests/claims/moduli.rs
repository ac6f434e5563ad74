//! Moduli measured on the simulated model against those of the mean-field theory.

use voronudge_geometry::{Domain, PeriodicBox};
use voronudge_model::{Model, Parameters};
use voronudge_simulate::moduli::{self, Elastic, Moduli, Motion, Relaxation, Settings};
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

/// A disordered solid: random cells that came to rest.
fn solid(cells: usize, seed: u64, p: &Parameters<f64>) -> Elastic {
    let cell_box = PeriodicBox::new([(cells as f64).sqrt(); 2]).unwrap();
    let positions = RandomPlacement::new(cells, cell_box).draw(&mut generator(seed)).unwrap();
    let simulation =
        Simulation::new(positions, Domain::Periodic(cell_box), Model::chiral_voronoi(p)).unwrap();
    let relaxation = Relaxation { time_step: 0.04, ..Relaxation::default() };
    let elastic = moduli::elastic(&simulation, &Settings { relaxation, ..Settings::default() }).unwrap();
    assert_eq!((elastic.motion, elastic.restless), (Motion::AtRest, 0), "{elastic:?}");
    elastic
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

/// The mean of a few disordered solids at P_0 = 3.0 is within 15 % of the honeycomb; docs/commands/moduli.md has more of them.
#[test]
fn disordered_solids_are_about_as_stiff_as_the_honeycomb() {
    let p = parameters(0.1, 3.0, 0.5);
    let solids: Vec<Moduli> = (1..=4).map(|seed| solid(100, seed, &p).moduli).collect();
    let mean = |of: fn(&Moduli) -> f64| solids.iter().map(of).sum::<f64>() / solids.len() as f64;
    let expected = theory(&p).moduli();
    let (shear, odd_shear) = (mean(|m| m.shear), mean(|m| m.odd_shear));
    assert!((shear / expected.shear - 1.0).abs() < 0.15, "{shear} against {}", expected.shear);
    assert!((odd_shear / expected.odd_shear - 1.0).abs() < 0.15, "{odd_shear} against {}", expected.odd_shear);
}

/// A mirror turns the chirality round and with it the odd moduli; without chirality there are none.
#[test]
fn without_chirality_nothing_is_odd_and_the_solid_softens_towards_the_liquid() {
    let [stiff, soft] = [3.0, 4.0].map(|p_0| solid(64, 3, &parameters(0.1, p_0, 0.0)));
    for elastic in [&stiff, &soft] {
        // Forces with a potential: the response is that of a symmetric matrix.
        let odd = [elastic.moduli.odd_bulk, elastic.moduli.odd_shear];
        assert!(odd.iter().all(|x| x.abs() < 1e-4 * stiff.moduli.shear), "{elastic:?}");
    }
    assert!(stiff.moduli.shear > 10.0 * soft.moduli.shear, "{} {}", stiff.moduli.shear, soft.moduli.shear);
}
