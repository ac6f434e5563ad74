//! One cell's element: forces on its vertices, handed on to the centres of its neighbours.

use crate::{CellElement, Model, RingForces, Site, WeightedTerm};
use voronudge_geometry::{
    Arithmetic, CellPolygon, Domain, Elementary, Scalar, Shape, Tessellation, Vector, quarter_turn,
};

/// The forces that a cell exerts on its vertices, as multiples of the gradients of its area and perimeter.
#[derive(Debug, Clone, Copy)]
pub struct VertexForces<S> {
    /// Multiple of `∂A/∂r_v`: a pressure.
    pub area: S,
    /// Multiple of `∂P/∂r_v`: minus a tension.
    pub perimeter: S,
    /// Multiple of `ẑ × ∂P/∂r_v`: a torque of the cortex.
    pub chiral_tension: S,
}

impl<S: Arithmetic> VertexForces<S> {
    /// The sum over terms for a cell of the given shape.
    #[inline(always)]
    pub fn of(terms: &[WeightedTerm<S>], shape: Shape<S>) -> Self {
        let zero = S::constant(0.0);
        let mut forces = Self { area: zero, perimeter: zero, chiral_tension: zero };
        for weighted in terms {
            weighted.term.act_on_shape(shape, weighted.coefficient, &mut forces);
        }
        forces
    }

    /// The sum over terms for one cell of a model, with the parameters that are its own.
    #[inline(always)]
    pub fn of_cell(model: &Model<S>, site: Site<'_, S>, shape: Shape<S>) -> Self
    where
        S: Elementary,
    {
        if model.cells_are_alike() {
            return Self::of(&model.terms, shape);
        }
        let zero = S::constant(0.0);
        let mut forces = Self { area: zero, perimeter: zero, chiral_tension: zero };
        for weighted in &model.terms {
            let (term, coefficient) = match weighted.term.modulated(&site) {
                Some((term, weight)) => (term, weighted.coefficient * weight),
                None => {
                    let own = model.environment.cell_factors().term(weighted, site.cell);
                    (own.term, own.coefficient)
                }
            };
            term.act_on_shape(shape, coefficient, &mut forces);
        }
        forces
    }

    /// Adds `factor · ∂A/∂r_v` to every vertex.
    #[inline(always)]
    pub fn along_area_gradient(&mut self, factor: S) {
        self.area += factor;
    }

    /// Adds `factor · ∂P/∂r_v` to every vertex.
    #[inline(always)]
    pub fn along_perimeter_gradient(&mut self, factor: S) {
        self.perimeter += factor;
    }

    /// Adds `factor · ẑ × ∂P/∂r_v` to every vertex.
    #[inline(always)]
    pub fn along_turned_perimeter_gradient(&mut self, factor: S) {
        self.chiral_tension += factor;
    }

    /// The force on a vertex with the given gradients of the cell's area and perimeter.
    #[inline(always)]
    pub fn on_vertex(&self, area_gradient: Vector<S>, perimeter_gradient: Vector<S>) -> Vector<S> {
        let turned = quarter_turn(perimeter_gradient);
        Vector::new(
            area_gradient.x * self.area
                + perimeter_gradient.x * self.perimeter
                + turned.x * self.chiral_tension,
            area_gradient.y * self.area
                + perimeter_gradient.y * self.perimeter
                + turned.y * self.chiral_tension,
        )
    }

    /// Writes the force on each neighbour of the cell, one for each side, and returns the force on the cell itself:
    /// minus their sum.
    #[inline(always)]
    pub fn on_ring(&self, polygon: &CellPolygon<S>, ring_forces: &mut [Vector<S>]) -> Vector<S> {
        let zero = S::constant(0.0);
        let (mut carried, mut on_cell) = (Vector::new(zero, zero), Vector::new(zero, zero));
        let corners = polygon.corners();
        let ring_forces = &mut ring_forces[..corners.len()];
        for m in 0..corners.len() {
            let force = self.on_vertex(polygon.area_gradient(m), polygon.perimeter_gradient(m));
            let [on_this, on_next] = corners[m].pull_back(force);
            ring_forces[m] = carried + on_this;
            carried = on_next;
            on_cell -= on_this + on_next;
        }
        if let Some(first) = ring_forces.first_mut() {
            *first += carried;
        }
        on_cell
    }
}

/// The elements of one cell under some models.
pub(crate) fn elements_of<S: Scalar>(
    cell: usize,
    tessellation: &Tessellation,
    positions: &[Vector<S>],
    models: &[Model<S>],
    polygon: &mut CellPolygon<S>,
    forces: &mut [Vector<S>],
    on_cell: &mut [Vector<S>],
) {
    if !tessellation.is_closed(cell) {
        let nan = S::constant(f64::NAN);
        on_cell.fill(Vector::new(nan, nan));
        forces.fill(Vector::new(nan, nan));
        return;
    }
    let (neighbours, domain) = (tessellation.neighbours(cell), tessellation.domain());
    polygon.fill(tessellation, positions, cell);
    let of_models = on_cell.iter_mut().zip(forces.chunks_exact_mut(neighbours.len()));
    for (model, (on_cell, on_ring)) in models.iter().zip(of_models) {
        *on_cell = element(model, cell, neighbours, positions[cell], domain, polygon, on_ring);
    }
}

/// One element: writes the forces on the ring and returns that on the cell itself.
#[inline]
pub(crate) fn element<S: Scalar>(
    model: &Model<S>,
    cell: usize,
    neighbours: &[u32],
    position: Vector<S>,
    domain: Domain,
    polygon: &CellPolygon<S>,
    on_ring: &mut [Vector<S>],
) -> Vector<S> {
    let site = model.site(cell, neighbours.len(), position);
    let mut on_cell = VertexForces::of_cell(model, site, polygon.shape()).on_ring(polygon, on_ring);
    if model.has_ring_terms() {
        let element =
            CellElement { cell, neighbours, polygon, position, domain, environment: &model.environment };
        ring_terms(&model.terms, &element, &mut RingForces { on_ring, on_cell: &mut on_cell });
    }
    on_cell
}

/// Adds the forces of those terms that are ring terms, for one cell.
pub(crate) fn ring_terms<S: Elementary>(
    terms: &[WeightedTerm<S>],
    element: &CellElement<'_, S>,
    forces: &mut RingForces<'_, S>,
) {
    for weighted in terms {
        weighted.term.act_on_ring(element, weighted.coefficient, forces);
    }
}
