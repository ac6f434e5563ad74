//! Moduli as a page.

use super::Arguments;
use super::dynamic;
use super::report::{headline, title};
use voronudge_report::ModuliReport;
use voronudge_report::figure::moduli;
use voronudge_report::moduli_report::{
    DynamicModulusRecord, DynamicRecord, Estimate, MediumRecord, ModulusRecord, ReplicaRecord,
};
use voronudge_report::numbers::{NO_VALUE, significant};
use voronudge_report::page::{Block, Card, Figure, Page, Section, Table};

const INTRODUCTION: &str = "The tissue is strained by small amounts of both signs and comes to rest again; the moduli are the change of its mean stress, per present \
    area, with the prestress taken off. A tissue that does not come to rest is strained while it flows, and its stress averaged over time.";

const GUIDE: [[&str; 2]; 4] = [
    [
        "B and A",
        "(σ_{xx} + σ_{yy})/2 = B ∇·u and (σ_{yx} − σ_{xy})/2 = A ∇·u: the tension and the torque that a dilation makes.",
    ],
    [
        "μ and Kᵒ",
        "(σ_{xx} − σ_{yy})/2 = μ e_1 + Kᵒ e_2 and (σ_{xy} + σ_{yx})/2 = μ e_2 − Kᵒ e_1, with e_1 = ∂_xu_x − ∂_yu_y and e_2 = ∂_xu_y + ∂_yu_x.",
    ],
    [
        "Standard error",
        "Of the mean over replicas; of a single tissue at rest from both signs and both sizes of the strain, of one that flows from the average over time.",
    ],
    [
        "Nonlinearity",
        "What the larger strain gives less what the smaller gives. If it is not small, cells changed neighbours under the strain.",
    ],
];

pub(super) fn page(arguments: &Arguments, report: &ModuliReport) -> Page {
    let unit = report.units.powers(0, -1);
    let figure = Figure::new(
        moduli(&report.moduli, &unit),
        "Change of the mean stress by strain. B: pressure of a dilation, A: torque of a dilation, μ: shear stress along a \
         shear, Kᵒ: shear stress at 45° to it.",
    );
    let header = ["", "mean", "standard error", "mean-field theory", "without relaxation", "nonlinearity"];
    let moduli = Section::new("Moduli")
        .with(figure)
        .with(Block::table(Table::new(header).rows(report.moduli.iter().chain(&report.viscosities).map(row))))
        .with(Block::remark(format!("Moduli in {unit} (friction is absorbed); viscosities have no unit.")));
    let prestress = [("measured", Some(report.prestress)), ("honeycomb", report.mean_field_prestress)];
    let prestress = prestress.into_iter().filter_map(|(name, own)| Some([name.into(), stress(own?, &unit)]));
    let replicas = report.replicas.iter().map(replica);
    Page {
        cards: cards(report, &unit),
        guide: vec![Block::paragraph(INTRODUCTION), Block::terms(&GUIDE)],
        sections: vec![
            moduli,
            dynamic_section(report, &unit),
            Section::new("Prestress").with(Block::facts(prestress)),
            Section::new("Replicas").with(Block::facts(replicas)),
        ],
        ..Page::new(title(arguments), headline(report), &report.run)
    }
}

fn cards(report: &ModuliReport, unit: &str) -> Vec<Card> {
    let card = |(record, unit): (&ModulusRecord, &str)| {
        let value = format!("{} {unit}", significant(record.value, 3));
        Card::new(record.symbol, value.trim_end(), format!("± {}", significant(record.error, 1)))
    };
    let moduli = report.moduli.iter().map(|record| (record, unit));
    moduli.chain(report.viscosities.iter().map(|record| (record, ""))).map(card).collect()
}

fn row(record: &ModulusRecord) -> [String; 6] {
    let text = |value: Option<f64>, digits| value.map_or(NO_VALUE.into(), |value| significant(value, digits));
    [
        format!("{}, {}", record.symbol, record.name.replace('_', " ")),
        significant(record.value, 4),
        significant(record.error, 2),
        text(record.mean_field, 4),
        text(record.affine, 4),
        text(record.nonlinearity, 2),
    ]
}

/// Without content if no frequency was asked for.
fn dynamic_section(report: &ModuliReport, unit: &str) -> Section {
    let section = Section::new("Storage and loss moduli");
    if report.dynamic.is_empty() {
        return section;
    }
    let omega = format!("ω ({unit})");
    let media = ["medium", "μ", "Kᵒ", "η", "ηᵒ", "misses the moduli by"];
    section
        .with(Block::remark(
            "A strain sin ωt makes the stress G′ sin ωt + G″ cos ωt. Of a tissue at rest this is its exact linear response; one that flows is sheared for \
             many periods. Curves are the nearest media of one elasticity and one viscosity.",
        ))
        .with(Block::pairs(dynamic::figures(&report.dynamic, &report.media, unit)))
        .with(Block::table(
            Table::new([&omega, "μ′", "μ″", "Kᵒ′", "Kᵒ″"]).rows(report.dynamic.iter().map(frequency_row)),
        ))
        .with(Block::table(Table::new(media).rows(report.media.iter().map(medium_row))))
}

/// ω, and both shear moduli in phase and out of phase.
fn frequency_row(record: &DynamicRecord) -> [String; 5] {
    let text = |name: &str, of: fn(&DynamicModulusRecord) -> &Estimate| {
        let found = record.moduli.iter().find(|own| own.name == name).map(of);
        found.map_or(NO_VALUE.into(), |own| {
            format!("{} ± {}", significant(own.value, 4), significant(own.error, 1))
        })
    };
    [
        significant(record.frequency, 4),
        text("shear", |own| &own.storage),
        text("shear", |own| &own.loss),
        text("odd_shear", |own| &own.storage),
        text("odd_shear", |own| &own.loss),
    ]
}

fn medium_row(record: &MediumRecord) -> Vec<String> {
    let name = match record.arrangement {
        "maxwell" => "Maxwell (in series)",
        _ => "Kelvin–Voigt (in parallel)",
    };
    let numbers = record.elasticity.into_iter().chain(record.viscosity);
    let missed = format!("{} %", significant(100.0 * record.missed, 2));
    [name.to_owned()].into_iter().chain(numbers.map(|value| significant(value, 3))).chain([missed]).collect()
}

fn stress(stress: [[f64; 2]; 2], unit: &str) -> String {
    let [[xx, xy], [yx, yy]] = stress.map(|row| row.map(|value| significant(value, 4)));
    format!("σ_{{xx}} {xx}, σ_{{xy}} {xy}, σ_{{yx}} {yx}, σ_{{yy}} {yy} {unit}")
}

fn replica(own: &ReplicaRecord) -> [String; 2] {
    let restless = match own.restless {
        0 => String::new(),
        count => format!("; {count} of 12 strained states did not come to rest"),
    };
    let motion = own.motion.replace('_', " ");
    [format!("seed {}", own.seed), format!("{motion}, fastest cell {}{restless}", significant(own.speed, 2))]
}
