//! Force terms: one file for each contribution to the equation of motion.
//!
//! A term is a type that implements [`ForceTerm`] and stands in the list at the end of this file. Everything that works
//! on terms (velocities, Jacobian, fits, the gradient check) takes it from there.

mod adhesion;
mod area_elasticity;
mod contractility;
mod cortical_chirality;

pub use adhesion::Adhesion;
pub use area_elasticity::AreaElasticity;
pub use contractility::Contractility;
pub use cortical_chirality::CorticalChirality;

use crate::VertexForces;
use voronudge_geometry::{Scalar, Shape};

/// What a reflection does to the velocities of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// The mirror image of the tissue moves as the mirror image of its velocities.
    Achiral,
    /// It moves the opposite way: a mirror turns the coefficient into its negative.
    Chiral,
}

/// One contribution to the equation of motion, for a coefficient of one.
pub trait ForceTerm {
    /// Name in tables and messages.
    fn name(&self) -> &'static str;

    /// The term's formula, as plain text.
    fn formula(&self) -> &'static str;

    /// What a reflection does to it.
    fn parity(&self) -> Parity;

    /// Adds `coefficient` times the forces that one cell exerts on its own vertices.
    fn act<S: Scalar>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>);

    /// The energy of one cell whose gradient the term descends, if there is one.
    fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S>;
}

macro_rules! terms {
    ($($(#[$doc:meta])* $term:ident),+ $(,)?) => {
        /// Any force term.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Term {
            $($(#[$doc])* $term($term),)+
        }

        impl Term {
            /// Every term there is, with the default of whatever constants it has.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$term($term::default())),+]
            }
        }

        impl ForceTerm for Term {
            fn name(&self) -> &'static str {
                match self { $(Self::$term(term) => term.name()),+ }
            }

            fn formula(&self) -> &'static str {
                match self { $(Self::$term(term) => term.formula()),+ }
            }

            fn parity(&self) -> Parity {
                match self { $(Self::$term(term) => term.parity()),+ }
            }

            #[inline]
            fn act<S: Scalar>(&self, shape: Shape<S>, coefficient: S, forces: &mut VertexForces<S>) {
                match self { $(Self::$term(term) => term.act(shape, coefficient, forces)),+ }
            }

            fn energy<S: Scalar>(&self, shape: Shape<S>) -> Option<S> {
                match self { $(Self::$term(term) => term.energy(shape)),+ }
            }
        }

        $(impl From<$term> for Term {
            fn from(term: $term) -> Self {
                Self::$term(term)
            }
        })+
    };
}

terms! {
    /// Resistance of a cell's area to change.
    AreaElasticity,
    /// Adhesion between neighbours, which lengthens the perimeter.
    Adhesion,
    /// Contraction of the cortex, which shortens the perimeter.
    Contractility,
    /// The part of the contraction that acts along the cell's border.
    CorticalChirality,
}
