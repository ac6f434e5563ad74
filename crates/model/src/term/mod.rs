//! Force terms: the contributions to the equation of motion in which velocities are linear.
//!
//! A term is a type that implements [`ShapeTerm`] (forces along the gradients of a cell's area and perimeter) or
//! [`RingTerm`] (any forces of a cell on its ring) and stands in the list at the end of this file. Everything that works
//! on terms (velocities, Jacobian, fits, the gradient check) takes it from there. The terms of the base model stand in
//! this folder, those of the catalogue of effects in `effect/`.

mod adhesion;
mod area_elasticity;
mod contractility;
mod cortical_chirality;

pub use adhesion::Adhesion;
pub use area_elasticity::AreaElasticity;
pub use contractility::Contractility;
pub use cortical_chirality::CorticalChirality;

use crate::effect::*;
use crate::{CellElement, RingForces, VertexForces};
use voronudge_geometry::{Arithmetic, Scalar, Shape};

/// What a reflection does to the velocities of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// The mirror image of the tissue moves as the mirror image of its velocities.
    Achiral,
    /// It moves the opposite way: a mirror turns the coefficient into its negative.
    Chiral,
    /// It refers to directions of the frame, so that a mirror or a rotation leads to other columns.
    Oriented,
    /// Of an effect: some of its columns are achiral, others chiral.
    Mixed,
}

/// One contribution to the equation of motion, for a coefficient of one.
pub trait ForceTerm {
    /// Name in tables and messages.
    fn name(&self) -> &'static str;

    /// The term's formula, as plain text.
    fn formula(&self) -> &'static str;

    /// What a reflection does to it.
    fn parity(&self) -> Parity;

    /// Whether its velocities sum to zero in a periodic box.
    fn conserves_momentum(&self) -> bool {
        true
    }

    /// The energy of one cell whose gradient the term descends, if there is one.
    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
        let _ = shape;
        None
    }
}

/// A term whose forces are multiples of the gradients of a cell's area and perimeter, by the cell's area and perimeter.
pub trait ShapeTerm: ForceTerm {
    /// Adds `coefficient` times the forces that one cell exerts on its own vertices.
    fn act<S: Arithmetic>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>);
}

/// A term with any forces of one cell on its vertices, its neighbours and itself, which may depend on the polygon, the
/// position and the environment of the cell.
pub trait RingTerm: ForceTerm {
    /// Adds `coefficient` times the forces.
    fn act<S: Scalar>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>);
}

macro_rules! terms {
    (shape: [$($shape:ident),+ $(,)?], ring: [$($ring:ident),+ $(,)?] $(,)?) => {
        /// Any force term.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Term {
            $(#[doc = concat!("See [`", stringify!($shape), "`].")] $shape($shape),)+
            $(#[doc = concat!("See [`", stringify!($ring), "`].")] $ring($ring),)+
        }

        impl Term {
            /// Every term there is, with the default of whatever constants it has.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$shape($shape::default()),)+ $(Self::$ring($ring::default()),)+]
            }

            /// Whether the term descends an energy.
            pub fn has_energy(&self) -> bool {
                self.energy(Shape { area: 1.0, perimeter: 4.0 }).is_some()
            }

            /// Whether the term is a [`RingTerm`].
            pub fn is_ring_term(&self) -> bool {
                match self {
                    $(Self::$shape(_) => false,)+
                    $(Self::$ring(_) => true,)+
                }
            }

            /// What a [`ShapeTerm`] does; a [`RingTerm`] adds nothing here.
            #[inline(always)]
            pub(crate) fn act_on_shape<S: Arithmetic>(
                &self,
                shape: Shape<S>,
                coefficient: S,
                forces: &mut VertexForces<S>,
            ) {
                match self {
                    $(Self::$shape(term) => ShapeTerm::act(term, shape, coefficient, forces),)+
                    _ => {}
                }
            }

            /// What a [`RingTerm`] does; a [`ShapeTerm`] adds nothing here.
            pub(crate) fn act_on_ring<S: Scalar>(
                &self,
                cell: &CellElement<'_, S>,
                coefficient: S,
                forces: &mut RingForces<'_, S>,
            ) {
                match self {
                    $(Self::$ring(term) => RingTerm::act(term, cell, coefficient, forces),)+
                    _ => {}
                }
            }
        }

        impl ForceTerm for Term {
            fn name(&self) -> &'static str {
                match self { $(Self::$shape(term) => term.name(),)+ $(Self::$ring(term) => term.name(),)+ }
            }

            fn formula(&self) -> &'static str {
                match self { $(Self::$shape(term) => term.formula(),)+ $(Self::$ring(term) => term.formula(),)+ }
            }

            fn parity(&self) -> Parity {
                match self { $(Self::$shape(term) => term.parity(),)+ $(Self::$ring(term) => term.parity(),)+ }
            }

            fn conserves_momentum(&self) -> bool {
                match self {
                    $(Self::$shape(term) => term.conserves_momentum(),)+
                    $(Self::$ring(term) => term.conserves_momentum(),)+
                }
            }

            fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
                match self {
                    $(Self::$shape(term) => term.energy(shape),)+
                    $(Self::$ring(term) => term.energy(shape),)+
                }
            }
        }

        $(impl From<$shape> for Term {
            fn from(term: $shape) -> Self {
                Self::$shape(term)
            }
        }

        impl From<$shape> for Column {
            fn from(term: $shape) -> Self {
                Self::Term(Term::$shape(term))
            }
        })+

        $(impl From<$ring> for Term {
            fn from(term: $ring) -> Self {
                Self::$ring(term)
            }
        }

        impl From<$ring> for Column {
            fn from(term: $ring) -> Self {
                Self::Term(Term::$ring(term))
            }
        })+
    };
}

terms! {
    shape: [
        AreaElasticity,
        Adhesion,
        Contractility,
        CorticalChirality,
        AlphaAdhesion,
        AlphaArea,
        NonlinearContractility,
        NonlinearArea,
    ],
    ring: [
        Drift,
        Expansion,
        Rotation,
        Shear,
        PolynomialFlow,
        DensityGradient,
        OddDiffusion,
        AlphaPressure,
        AdhesionGradient,
        ContractilityGradient,
        ChiralityGradient,
        NematicStress,
        OddNematicStress,
        ShortRangeRepulsion,
        OddPairForce,
        EdgeTension,
        ChiralEdgeTension,
        CoordinationTension,
        Persistence,
        Alignment,
        LabelParameter,
        ExternalField,
        BoundaryTension,
        BoundaryTorque,
        WaveFlow,
        RadialShell,
    ],
}
