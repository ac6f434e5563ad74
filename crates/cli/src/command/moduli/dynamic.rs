//! Storage and loss moduli over replicas, and the media nearest to them.

use super::names::NAMES;
use super::replicas::over_replicas;
use voronudge_report::chart::AxisScale;
use voronudge_report::colour::{BLUE, VERMILLION};
use voronudge_report::figure::{
    CurveSeries, ErrorPoint, PointSeries, PointsAndCurves, Stroke, points_and_curves,
};
use voronudge_report::markers::Marker;
use voronudge_report::moduli_report::{DynamicModulusRecord, DynamicRecord, Estimate, MediumRecord};
use voronudge_report::page::Figure;
use voronudge_report::units::label_with_unit;
use voronudge_simulate::moduli::{Dynamic, DynamicModulus};
use voronudge_theory::{Arrangement, ShearResponse, ViscoelasticMedium};

/// Means over replicas at each frequency; `replicas` hold the same frequencies.
pub(super) fn records(replicas: &[&[Dynamic]]) -> Vec<DynamicRecord> {
    let Some(first) = replicas.first() else { return Vec::new() };
    let at = |(k, own): (usize, &Dynamic)| {
        let moduli = NAMES.iter().enumerate().filter_map(|(which, &(name, symbol))| {
            let measured: Vec<_> = replicas.iter().filter_map(|own| own[k].moduli[which]).collect();
            let estimate = |value: fn(&DynamicModulus) -> f64, error: fn(&DynamicModulus) -> f64| {
                let [values, errors] = [value, error].map(|of| measured.iter().map(of).collect::<Vec<_>>());
                let (value, error) = over_replicas(&values, &errors);
                Estimate { value, error, replicas: values }
            };
            (!measured.is_empty()).then(|| DynamicModulusRecord {
                name,
                symbol,
                storage: estimate(|own| own.storage, |own| own.storage_error),
                loss: estimate(|own| own.loss, |own| own.loss_error),
            })
        });
        DynamicRecord { frequency: own.frequency, moduli: moduli.collect() }
    };
    first.iter().enumerate().map(at).collect()
}

/// The shear moduli, as the theory of media takes them.
fn responses(records: &[DynamicRecord]) -> Vec<ShearResponse> {
    let of = |record: &DynamicRecord| {
        let [shear, odd] = shears(record)?;
        Some(ShearResponse {
            frequency: record.frequency,
            storage: [shear.storage.value, odd.storage.value],
            loss: [shear.loss.value, odd.loss.value],
        })
    };
    records.iter().filter_map(of).collect()
}

fn shears(record: &DynamicRecord) -> Option<[&DynamicModulusRecord; 2]> {
    let named = |name: &str| record.moduli.iter().find(|own| own.name == name);
    Some([named("shear")?, named("odd_shear")?])
}

const ARRANGEMENTS: [(Arrangement, &str, &str, Stroke); 2] = [
    (Arrangement::KelvinVoigt, "kelvin_voigt", "Kelvin–Voigt", Stroke::Dashed),
    (Arrangement::Maxwell, "maxwell", "Maxwell", Stroke::Dotted),
];

/// The nearest medium of each arrangement; none for one frequency, which both meet.
pub(super) fn media(records: &[DynamicRecord]) -> Vec<MediumRecord> {
    let responses = responses(records);
    if responses.len() < 2 {
        return Vec::new();
    }
    let nearest = |(arrangement, name, ..): (Arrangement, &'static str, _, _)| {
        let medium = ViscoelasticMedium::fitted(arrangement, &responses)?;
        let ViscoelasticMedium { elasticity, viscosity, .. } = medium;
        Some(MediumRecord { arrangement: name, elasticity, viscosity, missed: medium.missed(&responses) })
    };
    ARRANGEMENTS.into_iter().filter_map(nearest).collect()
}

/// μ* and Kᵒ* against the frequency.
pub(super) fn figures(records: &[DynamicRecord], media: &[MediumRecord], unit: &str) -> Vec<Figure> {
    let frequencies = records.iter().map(|own| own.frequency);
    let (low, high) =
        frequencies.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), own| (low.min(own), high.max(own)));
    if records.is_empty() {
        return Vec::new();
    }
    let fine: Vec<f64> = (0..=120).map(|k| low * (high / low).powf(f64::from(k) / 120.0)).collect();
    let panel = |which: usize, symbol: &str, caption: &str| {
        let labels = [format!("{symbol}′, in phase"), format!("{symbol}″, out of phase")];
        let series =
            [(0, BLUE, Marker::Circle), (1, VERMILLION, Marker::Diamond)].map(|(loss, colour, marker)| {
                let point = |record: &DynamicRecord| {
                    let own = shears(record)?[which];
                    let estimate = if loss == 1 { &own.loss } else { &own.storage };
                    let error = [None, Some(estimate.error)];
                    Some(ErrorPoint { at: [record.frequency, estimate.value], error })
                };
                let points = records.iter().filter_map(point).collect();
                PointSeries { label: &labels[loss], colour, marker, points }
            });
        let curves = media.iter().flat_map(|own| {
            let (arrangement, _, name, stroke) =
                if own.arrangement == ARRANGEMENTS[0].1 { ARRANGEMENTS[0] } else { ARRANGEMENTS[1] };
            let MediumRecord { elasticity, viscosity, .. } = *own;
            let medium = ViscoelasticMedium { arrangement, elasticity, viscosity };
            let fine = &fine;
            [(0, BLUE, name), (1, VERMILLION, "")].map(|(loss, colour, label)| {
                let at = |&frequency: &f64| {
                    let response = medium.response(frequency);
                    let of = if loss == 1 { response.loss } else { response.storage };
                    [frequency, of[which]]
                };
                CurveSeries { label, colour, stroke, points: fine.iter().map(at).collect() }
            })
        });
        let svg = points_and_curves(&PointsAndCurves {
            title: caption,
            labels: [
                &label_with_unit("angular frequency ω", unit),
                &label_with_unit(&format!("{symbol}*"), unit),
            ],
            scales: [AxisScale::Logarithmic, AxisScale::Linear],
            series: &series,
            curves: &curves.collect::<Vec<_>>(),
        });
        Figure::new(svg, caption)
    };
    vec![
        panel(0, "μ", "Shear modulus against the frequency of the strain"),
        panel(1, "Kᵒ", "Odd shear modulus against the frequency of the strain"),
    ]
}
