//! The catalogue of effects that the base model may lack: one file for each.
//!
//! An effect is a set of [`Column`]s, terms or responses, that belong to one cause. Its file holds the types with their
//! formulas and its entry in the catalogue. The list of all effects is at the end of this file.

mod alignment;
mod alpha_adhesion;
mod alpha_area;
mod alpha_gradient;
mod alpha_pressure;
mod boundary_tension;
mod boundary_torque;
mod cell_centre_chirality;
mod centroid_bias;
mod chiral_edge_tension;
mod contact_inhibition;
mod coordination_tension;
mod density_gradient;
mod drift;
mod edge_tension;
mod equivariant_expansion;
mod expansion;
mod external_field;
mod flow_blur;
mod flow_gain;
mod friction_gradient;
mod heterogeneity;
mod internal_drag;
mod kp_gradient;
mod label_parameter;
mod nematic_stress;
mod nonlinear_area;
mod nonlinear_contractility;
mod odd_diffusion;
mod odd_nematic_stress;
mod odd_pair_force;
mod p0_gradient;
mod persistence;
mod polarity;
mod polarity_alignment;
mod profile;
mod quadratic_distortion;
mod random_motion;
mod rotation;
mod shear;
mod short_range_repulsion;
mod size_friction;
mod smooth_field;
mod time_lag;
mod velocity_alignment;

pub use alignment::Alignment;
pub use alpha_adhesion::AlphaAdhesion;
pub use alpha_area::AlphaArea;
pub use alpha_gradient::ChiralityGradient;
pub use alpha_pressure::AlphaPressure;
pub use boundary_tension::BoundaryTension;
pub use boundary_torque::BoundaryTorque;
pub use cell_centre_chirality::CellCentreChirality;
pub use centroid_bias::CentroidBias;
pub use chiral_edge_tension::ChiralEdgeTension;
pub use contact_inhibition::away_from_contacts;
pub use coordination_tension::CoordinationTension;
pub use density_gradient::DensityGradient;
pub use drift::Drift;
pub use edge_tension::EdgeTension;
pub use equivariant_expansion::{PairDirection, RadialShell};
pub use expansion::Expansion;
pub use external_field::ExternalField;
pub use flow_blur::FlowBlur;
pub use flow_gain::FlowGain;
pub use friction_gradient::FrictionGradient;
pub use internal_drag::InternalDrag;
pub use kp_gradient::ContractilityGradient;
pub use label_parameter::{LabelParameter, LabelledParameter};
pub use nematic_stress::NematicStress;
pub use nonlinear_area::NonlinearArea;
pub use nonlinear_contractility::NonlinearContractility;
pub use odd_diffusion::OddDiffusion;
pub use odd_nematic_stress::OddNematicStress;
pub use odd_pair_force::OddPairForce;
pub use p0_gradient::AdhesionGradient;
pub use persistence::Persistence;
pub use profile::{Phase, Profile, Wave};
pub use quadratic_distortion::PolynomialFlow;
pub use rotation::Rotation;
pub use shear::Shear;
pub use short_range_repulsion::ShortRangeRepulsion;
pub use size_friction::SizeFriction;
pub use smooth_field::{Polarisation, WaveFlow};
pub use time_lag::TimeLag;

use crate::{CellParameter, Environment, Model, Parity, Response, Term};
use voronudge_geometry::Domain;

/// One coefficient's contribution to the velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Column {
    /// A force term.
    Term(Term),
    /// A response to the velocities of the terms.
    Response(Response),
}

/// Makes columns of the types of one kind, by its name among the variants of [`Column`].
macro_rules! columns_of {
    ($kind:ident: $($own:ident,)+) => {
        $(impl From<$own> for $kind {
            fn from(own: $own) -> Self {
                Self::$own(own)
            }
        }

        impl From<$own> for Column {
            fn from(own: $own) -> Self {
                Self::$kind($kind::$own(own))
            }
        })+
    };
}
pub(crate) use columns_of;

/// What an effect stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Something that the tissue does.
    Mechanism,
    /// Something that the measurement does.
    Observation,
    /// A form that fits without saying why; never named as a mechanism.
    Description,
}

/// The unit of a coefficient, as powers of a length and of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unit {
    /// Power of the unit of length.
    pub length: i8,
    /// Power of the unit of time.
    pub time: i8,
}

/// Another effect, or a parameter of the base model, that gives nearly the same velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alias {
    /// Its id, or the name of the parameter.
    pub of: &'static str,
    /// The measurement that tells the two apart.
    pub told_apart_by: &'static str,
}

/// The columns of an effect, or why it cannot be tested.
type Columns = fn(&Environment, Domain) -> Result<Vec<Column>, &'static str>;

/// Why an effect cannot be part of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EffectError {
    /// It refers to what is not given here.
    #[error("{0}")]
    NotHere(&'static str),
    /// Too few coefficients, or too many.
    #[error("{found} coefficients are given, but there are {expected}")]
    Coefficients {
        /// Number given.
        found: usize,
        /// Number of columns.
        expected: usize,
        /// What they are.
        names: &'static str,
    },
}

impl EffectError {
    /// Advice on what to change.
    pub fn hint(&self) -> String {
        match self {
            Self::NotHere(_) => "docs/effects.md tells what each effect needs".into(),
            Self::Coefficients { names, .. } => format!("the coefficients are: {names}"),
        }
    }
}

/// An entry of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    /// Name in reports and on the command line.
    pub id: &'static str,
    /// Formula as plain text.
    pub formula: &'static str,
    /// What it stands for, in one plain sentence.
    pub meaning: &'static str,
    /// What it stands for.
    pub kind: Kind,
    /// What a reflection does to it.
    pub parity: Parity,
    /// Its coefficients, in the order of the columns.
    pub coefficients: &'static str,
    /// The unit of its coefficients.
    pub unit: Unit,
    /// Near aliases.
    pub aliases: &'static [Alias],
    columns: Columns,
}

impl Effect {
    /// Whether it acts on cells at the edge of the tissue alone.
    pub fn acts_at_edge(&self) -> bool {
        matches!(self.id, "boundary_tension" | "boundary_torque")
    }

    /// The columns, one for each coefficient.
    ///
    /// # Errors
    /// The reason why the effect cannot be tested here, such as `no labels were given`.
    pub fn columns(&self, environment: &Environment, domain: Domain) -> Result<Vec<Column>, &'static str> {
        (self.columns)(environment, domain)
    }

    /// A model with the effect, of one coefficient for each column.
    ///
    /// # Errors
    /// [`EffectError`] if it needs what the environment does not have, or other coefficients.
    pub fn add_to(
        &self,
        model: Model<f64>,
        environment: &Environment,
        domain: Domain,
        coefficients: &[f64],
    ) -> Result<Model<f64>, EffectError> {
        let columns = self.columns(environment, domain).map_err(EffectError::NotHere)?;
        if columns.len() != coefficients.len() {
            let (found, expected) = (coefficients.len(), columns.len());
            return Err(EffectError::Coefficients { found, expected, names: self.coefficients });
        }
        Ok(columns
            .into_iter()
            .zip(coefficients)
            .fold(model, |model, (column, &value)| model.with(column, value)))
    }

    /// Whether the effect can be tested.
    ///
    /// # Errors
    /// The reason why not.
    pub fn applies(&self, environment: &Environment, domain: Domain) -> Result<(), &'static str> {
        self.columns(environment, domain).map(|_| ())
    }

    /// Whether it is about the polarity of cells, an unknown state that a fit of tracks finds, and has no columns.
    pub fn is_of_polarity(&self) -> bool {
        self.id == polarity::EFFECT.id || self.turns_polarity()
    }

    /// Whether it is about what turns polarities, which only cells that have one can tell.
    pub fn turns_polarity(&self) -> bool {
        let all = [polarity_alignment::EFFECT, contact_inhibition::EFFECT, velocity_alignment::EFFECT];
        all.iter().any(|effect| effect.id == self.id)
    }

    /// Whether it is about what moves cells at random, which tracks show in what the dynamics scatter by; it has no columns.
    pub fn is_random_motion(&self) -> bool {
        self.id == random_motion::EFFECT.id
    }

    /// The parameter in which cells differ, if that is what it says; it then has no columns.
    pub fn differing_parameter(&self) -> Option<CellParameter> {
        heterogeneity::parameter(self)
    }

    /// All effects of the catalogue.
    pub fn all() -> &'static [Self] {
        CATALOGUE
    }

    /// The effect of an id.
    pub fn from_id(id: &str) -> Option<&'static Self> {
        CATALOGUE.iter().find(|effect| effect.id == id)
    }
}

fn open_only(domain: Domain) -> Result<(), &'static str> {
    match domain {
        Domain::Open => Ok(()),
        Domain::Periodic(_) => Err("it is not periodic, and the tissue is in a periodic box"),
    }
}

/// Every effect, in the order of the documentation.
static CATALOGUE: &[Effect] = &[
    drift::EFFECT,
    expansion::EFFECT,
    rotation::EFFECT,
    shear::EFFECT,
    quadratic_distortion::EFFECT,
    density_gradient::EFFECT,
    odd_diffusion::EFFECT,
    alpha_adhesion::EFFECT,
    alpha_pressure::EFFECT,
    alpha_area::EFFECT,
    cell_centre_chirality::EFFECT,
    p0_gradient::EFFECT,
    kp_gradient::EFFECT,
    alpha_gradient::EFFECT,
    friction_gradient::EFFECT,
    size_friction::EFFECT,
    nematic_stress::EFFECT,
    odd_nematic_stress::EFFECT,
    short_range_repulsion::EFFECT,
    odd_pair_force::EFFECT,
    internal_drag::EFFECT,
    edge_tension::EFFECT,
    chiral_edge_tension::EFFECT,
    coordination_tension::EFFECT,
    nonlinear_contractility::EFFECT,
    nonlinear_area::EFFECT,
    persistence::EFFECT,
    alignment::EFFECT,
    polarity::EFFECT,
    polarity_alignment::EFFECT,
    contact_inhibition::EFFECT,
    velocity_alignment::EFFECT,
    random_motion::EFFECT,
    heterogeneity::ADHESION,
    heterogeneity::AREA,
    heterogeneity::CHIRALITY,
    flow_blur::EFFECT,
    flow_gain::EFFECT,
    time_lag::EFFECT,
    centroid_bias::EFFECT,
    label_parameter::EFFECT,
    external_field::EFFECT,
    boundary_tension::EFFECT,
    boundary_torque::EFFECT,
    smooth_field::EFFECT,
    equivariant_expansion::EFFECT,
];
