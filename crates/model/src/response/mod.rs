//! Responses: effects that act on the velocities of the terms instead of adding a force.
//!
//! ```text
//! v₀ = Σ_t c_t X_t(r)                        terms
//! F  = v₀ + Σ_k c_k R_k(v₀, r)               additive responses
//! (I + ξ L) v = F                            implicit responses
//! ```
//!
//! A response is generic over the scalar, so its velocities and their derivatives by the coefficients are exact. Its
//! types stand in `effect/`; the list of all is at the end of this file.

use crate::effect::{columns_of, *};
use crate::has_velocity::has_velocity;
use crate::{BlockMatrix, Model, Parity, RowAssembly, VelocityAssembly, assemble};
use num_dual::Dual;
use voronudge_geometry::{Scalar, Tessellation, Vector};

/// Velocities of a model's terms, and what they belong to.
#[derive(Debug)]
pub struct Flow<'a, S> {
    /// Who is whose neighbour.
    pub tessellation: &'a Tessellation,
    /// Positions (N).
    pub positions: &'a [Vector<S>],
    /// The model; its responses are not in the velocities yet.
    pub model: &'a Model<S>,
    /// Velocities (N), NaN for cells that have none.
    pub velocities: &'a [Vector<S>],
}

impl<S: Scalar> Flow<'_, S> {
    /// Whether a cell has a velocity: its polygon and those of its neighbours are closed.
    pub fn moves(&self, cell: usize) -> bool {
        has_velocity(self.tessellation, cell)
    }

    /// The velocities with those of cells without one set to zero.
    pub fn held(&self) -> Vec<Vector<S>> {
        let zero = Vector::new(S::constant(0.0), S::constant(0.0));
        let of = |(cell, v): (usize, &Vector<S>)| if self.moves(cell) { *v } else { zero };
        self.velocities.iter().enumerate().map(of).collect()
    }

    /// The derivative `J u` of the terms' velocities when all cells are displaced along `u` (N).
    pub fn along(&self, direction: &[Vector<S>]) -> Vec<Vector<S>> {
        let moved: Vec<Vector<Dual<S>>> = (self.positions.iter().zip(direction))
            .map(|(r, u)| Vector::new(Dual::new(r.x, u.x), Dual::new(r.y, u.y)))
            .collect();
        let model = self.model.map(Dual::from_re);
        let mut v = Vec::new();
        VelocityAssembly::default().evaluate_terms(self.tessellation, &moved, &model, &mut v);
        v.iter().map(|v| Vector::new(v.x.eps, v.y.eps)).collect()
    }

    /// Each vector of a field by cells.
    pub(crate) fn each(&self, mut of: impl FnMut(usize, Vector<S>) -> Vector<S>) -> Vec<Vector<S>> {
        self.velocities.iter().enumerate().map(|(cell, v)| of(cell, *v)).collect()
    }
}

/// Velocities of a model's terms with their Jacobian.
#[derive(Debug)]
pub struct Linearisation<'a> {
    /// The velocities.
    pub flow: Flow<'a, f64>,
    /// Their derivative by all positions.
    pub jacobian: &'a BlockMatrix,
}

/// What is added to a row of a matrix, by its number.
pub type Rows<'a> = Box<dyn Fn(usize, &mut RowAssembly) + Sync + 'a>;

/// When a response acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// On the velocities of the terms; all additive responses act on the same.
    Additive,
    /// On the sum of terms and additive responses.
    Implicit,
}

/// How exact the derivative of a response by positions is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exactness {
    /// To rounding.
    Exact,
    /// Entries are left out that are smaller than this fraction of the largest.
    Truncated(f64),
    /// The second derivative of the terms is left out.
    FirstOrder,
}

/// One effect on the velocities of the terms, for a coefficient of one.
pub trait FlowResponse {
    /// Name in tables and messages.
    fn name(&self) -> &'static str;

    /// Its formula, as plain text.
    fn formula(&self) -> &'static str;

    /// What a reflection does to it.
    fn parity(&self) -> Parity;

    /// Whether velocities that sum to zero still do.
    fn conserves_momentum(&self) -> bool {
        false
    }

    /// When it acts.
    fn stage(&self) -> Stage {
        Stage::Additive
    }

    /// What it adds to the velocities (N).
    fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>>;

    /// What it adds to the rows of the Jacobian.
    fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a>;

    /// How exact [`linearise`](Self::linearise) is.
    fn exactness(&self) -> Exactness {
        Exactness::Exact
    }
}

/// Adds the responses of a model, if it has some, to the velocities of its terms.
pub(crate) fn respond<S: Scalar>(
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    model: &Model<S>,
    velocities: &mut [Vector<S>],
) {
    if model.responses.is_empty() {
        return;
    }
    let mut before = velocities.to_vec();
    for stage in [Stage::Additive, Stage::Implicit] {
        for weighted in model.responses.iter().filter(|w| w.response.stage() == stage) {
            if stage == Stage::Implicit {
                before.copy_from_slice(velocities);
            }
            let flow = Flow { tessellation, positions, model, velocities: &before };
            let added = weighted.response.respond(&flow, weighted.coefficient);
            for (v, more) in velocities.iter_mut().zip(added) {
                *v += more;
            }
        }
    }
}

/// The Jacobian of a whole model from that of its terms.
pub(crate) fn respond_jacobian(
    tessellation: &Tessellation,
    positions: &[Vector<f64>],
    model: &Model<f64>,
    of_terms: BlockMatrix,
) -> BlockMatrix {
    let mut velocities = Vec::new();
    VelocityAssembly::default().evaluate_terms(tessellation, positions, model, &mut velocities);
    let mut jacobian = of_terms;
    let at_stage = |stage| model.responses.iter().filter(move |w| w.response.stage() == stage);
    // All additive responses act on the same; those that are implicit one after another.
    let mut groups = vec![at_stage(Stage::Additive).collect::<Vec<_>>()];
    groups.extend(at_stage(Stage::Implicit).map(|weighted| vec![weighted]));
    groups.retain(|group| !group.is_empty());
    for (number, group) in groups.iter().enumerate() {
        let flow = Flow { tessellation, positions, model, velocities: &velocities };
        let at = Linearisation { flow, jacobian: &jacobian };
        let more: Vec<_> = group.iter().map(|w| w.response.linearise(&at, w.coefficient)).collect();
        let sum = assemble(jacobian.rows(), |cell, row| {
            if has_velocity(tessellation, cell) {
                row.add_scaled_row(1.0, &jacobian, cell);
                more.iter().for_each(|more| more(cell, row));
            }
        });
        drop(more);
        if number + 1 < groups.len() {
            let added: Vec<_> = group.iter().map(|w| w.response.respond(&at.flow, w.coefficient)).collect();
            for added in added {
                velocities.iter_mut().zip(added).for_each(|(v, more)| *v += more);
            }
        }
        jacobian = sum;
    }
    jacobian
}

macro_rules! responses {
    ($($response:ident),+ $(,)?) => {
        /// Any response.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum Response {
            $(#[doc = concat!("See [`", stringify!($response), "`].")] $response($response),)+
        }

        impl Response {
            /// Every response there is, with the default of whatever constants it has.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$response($response::default())),+]
            }
        }

        impl FlowResponse for Response {
            fn name(&self) -> &'static str {
                match self { $(Self::$response(response) => response.name()),+ }
            }

            fn formula(&self) -> &'static str {
                match self { $(Self::$response(response) => response.formula()),+ }
            }

            fn parity(&self) -> Parity {
                match self { $(Self::$response(response) => response.parity()),+ }
            }

            fn conserves_momentum(&self) -> bool {
                match self { $(Self::$response(response) => response.conserves_momentum()),+ }
            }

            fn stage(&self) -> Stage {
                match self { $(Self::$response(response) => response.stage()),+ }
            }

            fn respond<S: Scalar>(&self, flow: &Flow<'_, S>, coefficient: S) -> Vec<Vector<S>> {
                match self { $(Self::$response(response) => response.respond(flow, coefficient)),+ }
            }

            fn linearise<'a>(&'a self, at: &'a Linearisation<'a>, coefficient: f64) -> Rows<'a> {
                match self { $(Self::$response(response) => response.linearise(at, coefficient)),+ }
            }

            fn exactness(&self) -> Exactness {
                match self { $(Self::$response(response) => response.exactness()),+ }
            }
        }

        columns_of!(Response: $($response,)+);
    };
}

responses! {
    InternalDrag,
    FrictionGradient,
    SizeFriction,
    FlowBlur,
    FlowGain,
    TimeLag,
    CellCentreChirality,
    CentroidBias,
}
