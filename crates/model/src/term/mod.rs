//! Force terms: the contributions to the equation of motion in which velocities are linear.
//!
//! A term is a type that implements [`ShapeTerm`] (forces along the gradients of a cell's area and perimeter), [`ModulatedTerm`] (the same
//! with a coefficient that differs from cell to cell) or [`RingTerm`] (any forces of a cell on its ring) and stands in the list at the end of this file. Everything that works
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

use crate::effect::{columns_of, *};
use crate::{CellElement, RingForces, Site, VertexForces};
use voronudge_geometry::{Arithmetic, Elementary, Scalar, Shape};

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

/// A shape term whose coefficient differs from cell to cell.
pub trait ModulatedTerm: ForceTerm {
    /// The shape term.
    fn term(&self) -> Term;

    /// What its coefficient is multiplied by, for a cell.
    fn weight<S: Elementary>(&self, site: &Site<'_, S>) -> S;
}

/// What the forces of a ring term depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// On where the cell is, and on measured data: the ring makes no difference.
    Place,
    /// Each force of a pair on the displacement between these two alone, and on measured data.
    Pair,
    /// On all of the ring, and on measured data, not on where the cell is.
    Ring,
}

/// A term with any forces of one cell on its vertices, its neighbours and itself, which may depend on the polygon, the
/// position and the environment of the cell.
pub trait RingTerm: ForceTerm {
    /// Adds `coefficient` times the forces.
    fn act<S: Elementary>(&self, cell: &CellElement<'_, S>, coefficient: S, forces: &mut RingForces<'_, S>);

    /// What the forces depend on, so that they are not differentiated by anything else.
    fn reach(&self) -> Reach {
        Reach::Ring
    }
}

macro_rules! terms {
    (
        shape: [$($shape:ident),+ $(,)?],
        modulated: [$($modulated:ident),+ $(,)?],
        ring: [$($ring:ident),+ $(,)?] $(,)?
    ) => {
        /// Any force term.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Term {
            $(#[doc = concat!("See [`", stringify!($shape), "`].")] $shape($shape),)+
            $(#[doc = concat!("See [`", stringify!($modulated), "`].")] $modulated($modulated),)+
            $(#[doc = concat!("See [`", stringify!($ring), "`].")] $ring($ring),)+
        }

        impl Term {
            /// Every term there is, with the default of whatever constants it has.
            pub fn all() -> Vec<Self> {
                vec![
                    $(Self::$shape($shape::default()),)+
                    $(Self::$modulated($modulated::default()),)+
                    $(Self::$ring($ring::default()),)+
                ]
            }

            /// Whether the term descends an energy.
            pub fn has_energy(&self) -> bool {
                self.energy(Shape { area: 1.0, perimeter: 4.0 }).is_some()
            }

            /// Whether the term is a [`ShapeTerm`].
            pub fn is_shape_term(&self) -> bool {
                matches!(self, $(Self::$shape(_))|+)
            }

            /// What the term depends on, if it is a [`RingTerm`].
            pub fn reach(&self) -> Option<Reach> {
                match self {
                    $(Self::$ring(term) => Some(term.reach()),)+
                    _ => None,
                }
            }

            /// Whether the term is a [`RingTerm`].
            pub fn is_ring_term(&self) -> bool {
                self.reach().is_some()
            }

            /// The shape term of a [`ModulatedTerm`] and its weight for a cell.
            pub(crate) fn modulated<S: Elementary>(&self, site: &Site<'_, S>) -> Option<(Self, S)> {
                match self {
                    $(Self::$modulated(term) => Some((term.term(), term.weight(site))),)+
                    _ => None,
                }
            }

            /// What a [`ShapeTerm`] does; other terms add nothing here.
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

            /// What a [`RingTerm`] does; other terms add nothing here.
            pub(crate) fn act_on_ring<S: Elementary>(
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
                match self {
                    $(Self::$shape(term) => term.name(),)+
                    $(Self::$modulated(term) => term.name(),)+
                    $(Self::$ring(term) => term.name(),)+
                }
            }

            fn formula(&self) -> &'static str {
                match self {
                    $(Self::$shape(term) => term.formula(),)+
                    $(Self::$modulated(term) => term.formula(),)+
                    $(Self::$ring(term) => term.formula(),)+
                }
            }

            fn parity(&self) -> Parity {
                match self {
                    $(Self::$shape(term) => term.parity(),)+
                    $(Self::$modulated(term) => term.parity(),)+
                    $(Self::$ring(term) => term.parity(),)+
                }
            }

            fn conserves_momentum(&self) -> bool {
                match self {
                    $(Self::$shape(term) => term.conserves_momentum(),)+
                    $(Self::$modulated(term) => term.conserves_momentum(),)+
                    $(Self::$ring(term) => term.conserves_momentum(),)+
                }
            }

            fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
                match self {
                    $(Self::$shape(term) => term.energy(shape),)+
                    $(Self::$modulated(term) => term.energy(shape),)+
                    $(Self::$ring(term) => term.energy(shape),)+
                }
            }
        }

        columns_of!(Term: $($shape,)+ $($modulated,)+ $($ring,)+);
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
    modulated: [AdhesionGradient, ContractilityGradient, ChiralityGradient, CoordinationTension, LabelParameter],
    ring: [
        Drift,
        Expansion,
        Rotation,
        Shear,
        PolynomialFlow,
        DensityGradient,
        OddDiffusion,
        AlphaPressure,
        NematicStress,
        OddNematicStress,
        ShortRangeRepulsion,
        OddPairForce,
        EdgeTension,
        ChiralEdgeTension,
        Persistence,
        Alignment,
        ExternalField,
        BoundaryTension,
        BoundaryTorque,
        WaveFlow,
        RadialShell,
    ],
}
