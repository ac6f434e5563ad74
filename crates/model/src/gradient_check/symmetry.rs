//! The tissue moved, wrapped, turned and mirrored, and tessellated anew.

use super::sample::Sample;
use super::{Comparison, Pair, Quantity, Subject};
use crate::{Environment, FlowResponse, ForceTerm, Model, Parity, velocities};
use nalgebra::Matrix2;
use std::sync::Arc;
use voronudge_geometry::{Domain, Error, PeriodicBox, Tessellation, Vector};

/// An equivalent tissue.
struct Image {
    quantity: Quantity,
    positions: Vec<Vector<f64>>,
    tessellation: Tessellation,
    /// What happens to vectors.
    map: Matrix2<f64>,
    environment: Arc<Environment>,
}

impl Image {
    fn new(
        quantity: Quantity,
        positions: Vec<Vector<f64>>,
        domain: Domain,
        map: Matrix2<f64>,
        environment: Environment,
    ) -> Result<Self, Error> {
        let tessellation = Tessellation::new(&positions, domain)?;
        Ok(Self { quantity, positions, tessellation, map, environment: Arc::new(environment) })
    }
}

/// All equivalent tissues of a sample.
pub(super) struct Images(Vec<Image>);

impl Images {
    pub fn of(sample: &Sample) -> Result<Self, Error> {
        let (positions, domain) = (&sample.positions, sample.tessellation.domain());
        let mapped = |map: &Matrix2<f64>| positions.iter().map(|r| map * r).collect::<Vec<_>>();
        let identity = Matrix2::identity();
        let environment = |map: &Matrix2<f64>, shift: Vector<f64>| sample.environment.moved(map, shift);
        let zero = Vector::zeros();
        let shift = Vector::new(0.37, -1.61) * sample.spacing;
        let shifted = positions.iter().map(|r| r + shift).collect();
        let mut images = vec![Image::new(
            Quantity::Translation,
            shifted,
            domain,
            identity,
            environment(&identity, shift),
        )?];
        if let Domain::Periodic(cell_box) = domain {
            let lattice =
                |cell: usize| cell_box.translation([(cell % 3) as i32 - 1, (cell / 3 % 3) as i32 - 1]);
            let wrapped = positions.iter().enumerate().map(|(cell, r)| r + lattice(cell)).collect();
            images.push(Image::new(
                Quantity::Wrapping,
                wrapped,
                domain,
                identity,
                environment(&identity, zero),
            )?);
        }
        let (turn, turned) = rotation(&domain)?;
        images.push(Image::new(Quantity::Rotation, mapped(&turn), turned, turn, environment(&turn, zero))?);
        let mirror = Matrix2::new(-1.0, 0.0, 0.0, 1.0);
        let mirrored = match domain {
            Domain::Periodic(b) => Domain::Periodic(PeriodicBox::sheared(b.lengths(), -b.offset())?),
            Domain::Open => Domain::Open,
        };
        images.push(Image::new(
            Quantity::Mirror,
            mapped(&mirror),
            mirrored,
            mirror,
            environment(&mirror, zero),
        )?);
        Ok(Self(images))
    }

    /// Velocities of the image against the image of the velocities.
    pub fn compare(&self, subject: &Subject) -> Vec<(Quantity, Comparison)> {
        let reflected = reflect(&subject.model);
        let oriented = subject.parities().any(|parity| matches!(parity, Parity::Oriented | Parity::Mixed));
        let compare = |image: &Image| {
            let model = match image.quantity {
                Quantity::Mirror => &reflected,
                _ => &subject.model,
            };
            let model = model.clone().within(&image.environment);
            let found = velocities(&image.tessellation, &image.positions, &model);
            let mut pairs = Vec::with_capacity(found.len());
            for (cell, v) in subject.velocities.iter().enumerate() {
                // Rounding may take a cell of a straight rim onto the hull or off it.
                let lost = matches!(image.tessellation.domain(), Domain::Open) && !found[cell].x.is_finite();
                if subject.moves(cell) && subject.sample.unambiguous[cell] && !lost {
                    pairs.push(Pair { cell, found: found[cell], expected: image.map * v });
                }
            }
            (image.quantity, subject.compare(subject.sample.reach, &pairs))
        };
        let turns = |image: &&Image| matches!(image.quantity, Quantity::Rotation | Quantity::Mirror);
        self.0.iter().filter(|image| !(oriented && turns(image))).map(compare).collect()
    }
}

/// The model with the coefficients of chiral terms and responses reversed.
fn reflect(model: &Model<f64>) -> Model<f64> {
    let sign = |parity| if parity == Parity::Chiral { -1.0 } else { 1.0 };
    let mut reflected = model.clone();
    for weighted in &mut reflected.terms {
        weighted.coefficient *= sign(weighted.term.parity());
    }
    for weighted in &mut reflected.responses {
        weighted.coefficient *= sign(weighted.response.parity());
    }
    reflected
}

/// A turn under which the domain is of the same kind, and what it becomes.
fn rotation(domain: &Domain) -> Result<(Matrix2<f64>, Domain), Error> {
    Ok(match domain {
        Domain::Open => {
            let (sin, cos) = 0.7f64.sin_cos();
            (Matrix2::new(cos, -sin, sin, cos), Domain::Open)
        }
        Domain::Periodic(cell_box) if cell_box.offset() == 0.0 => {
            let [x, y] = cell_box.lengths();
            (Matrix2::new(0.0, -1.0, 1.0, 0.0), Domain::Periodic(PeriodicBox::new([y, x])?))
        }
        Domain::Periodic(cell_box) => (-Matrix2::identity(), Domain::Periodic(*cell_box)),
    })
}
