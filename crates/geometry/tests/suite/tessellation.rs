//! Topology: twins, triangles, the Delaunay property.

use crate::samples::{honeycomb, periodic, random, sheared, squares};
use voronudge_geometry::{Domain, Error, PeriodicBox, Tessellation, Vector, circumcentre};

type Tissue = (Vec<Vector<f64>>, Domain);

fn tissues() -> Result<Vec<Tissue>, Error> {
    let (lattice, lengths) = honeycomb(4, 4);
    Ok(vec![
        (random(120, [8.0, 8.0], 1), periodic([8.0, 8.0])?),
        (random(50, [3.0, 12.0], 2), sheared([3.0, 12.0], 0.8)?),
        (random(120, [8.0, 8.0], 3), Domain::Open),
        (lattice, periodic(lengths)?),
        (squares(5, 7), periodic([5.0, 7.0])?),
        (random(3, [1.0, 1.0], 4), periodic([1.0, 1.0])?),
        (random(1, [1.0, 2.0], 5), periodic([1.0, 2.0])?),
    ])
}

#[test]
fn twins_are_involutive_and_see_opposite_images() -> Result<(), Error> {
    for (positions, domain) in tissues()? {
        let tessellation = Tessellation::new(&positions, domain)?;
        for cell in 0..tessellation.len() {
            for h in tessellation.ring(cell) {
                let g = tessellation.twin(h);
                assert_eq!(tessellation.twin(g), h);
                assert_ne!(g, h);
                assert_eq!(tessellation.neighbour(g), cell);
                assert!(tessellation.ring(tessellation.neighbour(h)).contains(&g));
                assert_eq!(tessellation.image(g), tessellation.image(h).map(|n| -n));
                let there = tessellation.displacement(&positions, cell, h);
                let back = tessellation.displacement(&positions, tessellation.neighbour(h), g);
                assert!((there + back).norm() < 1e-12);
            }
        }
    }
    Ok(())
}

#[test]
fn rings_are_counter_clockwise() -> Result<(), Error> {
    for (positions, domain) in tissues()? {
        let tessellation = Tessellation::new(&positions, domain)?;
        for cell in (0..tessellation.len()).filter(|&cell| tessellation.is_closed(cell)) {
            let ring: Vec<_> =
                tessellation.ring(cell).map(|h| tessellation.displacement(&positions, cell, h)).collect();
            let turn: f64 = (0..ring.len())
                .map(|m| (ring[m], ring[(m + 1) % ring.len()]))
                .map(|(a, b)| (a.x * b.y - a.y * b.x).atan2(a.dot(&b)))
                .inspect(|angle| assert!(*angle > 0.0))
                .sum();
            assert!((turn - std::f64::consts::TAU).abs() < 1e-9);
        }
    }
    Ok(())
}

#[test]
fn triangles_and_edges_obey_euler() -> Result<(), Error> {
    for (positions, domain) in tissues()? {
        let cells = positions.len();
        let tessellation = Tessellation::new(&positions, domain)?;
        let (edges, triangles) = (tessellation.edges().len(), tessellation.triangles().len());
        assert_eq!(2 * edges, tessellation.half_edges());
        match domain {
            Domain::Periodic(_) => assert_eq!((edges, triangles), (3 * cells, 2 * cells)),
            Domain::Open => assert_eq!(cells + triangles, edges + 1),
        }
    }
    Ok(())
}

#[test]
fn circumcircles_are_empty() -> Result<(), Error> {
    let tissues = [
        (random(50, [7.0, 7.0], 21), sheared([7.0, 7.0], 0.0)?),
        (random(50, [4.0, 12.0], 22), sheared([4.0, 12.0], 1.3)?),
        (random(4, [1.0, 1.0], 23), sheared([1.0, 1.0], 0.4)?),
        (random(60, [7.0, 7.0], 24), Domain::Open),
    ];
    for (positions, domain) in tissues {
        let tessellation = Tessellation::new(&positions, domain)?;
        let images: Vec<Vector<f64>> = match domain {
            Domain::Open => vec![Vector::zeros()],
            Domain::Periodic(b) => (0..49).map(|k| b.translation([k % 7 - 3, k / 7 - 3])).collect(),
        };
        for triangle in tessellation.triangles() {
            let corner = |k: usize| match domain {
                Domain::Open => positions[triangle.cells[k] as usize],
                Domain::Periodic(b) => {
                    positions[triangle.cells[k] as usize] + b.translation(triangle.images[k].map(i32::from))
                }
            };
            let (r, a, b) = (corner(0), corner(1), corner(2));
            let c = circumcentre(a - r, b - r);
            let nearest = (positions.iter())
                .flat_map(|p| images.iter().map(move |t| p + t))
                .map(|p| (p - r - c).norm())
                .fold(f64::INFINITY, f64::min);
            assert!((nearest / c.norm() - 1.0).abs() < 1e-9, "{triangle:?}: {nearest} < {}", c.norm());
        }
    }
    Ok(())
}

#[test]
fn renewed_is_new() -> Result<(), Error> {
    for domain in [periodic([9.0, 9.0])?, Domain::Open] {
        let mut tessellation = Tessellation::new(&random(150, [9.0, 9.0], 31), domain)?;
        for (seed, cells) in [(32, 150), (33, 40), (34, 300)] {
            let positions = random(cells, [9.0, 9.0], seed);
            tessellation.renew(&positions)?;
            assert_eq!(tessellation, Tessellation::new(&positions, domain)?);
        }
    }
    Ok(())
}

/// In a tiny unit the fast triangulation takes all cells for one, so that the exact one is used: both must end at the same neighbours.
#[test]
fn neighbours_do_not_depend_on_the_unit() -> Result<(), Error> {
    let unit = 2f64.powi(-80);
    let mut lattices = Vec::new();
    for size in [1e-15, 1e-13, 1e-11, 1e-6] {
        let positions: Vec<_> = (squares(40, 40).into_iter().zip(random(1600, [size, size], 36)))
            .map(|(r, shift)| r + shift)
            .collect();
        // Below, cells of an open field lie on a circle exactly, and the library decides.
        if size > 1e-14 {
            lattices.push((positions.clone(), Domain::Open));
        }
        lattices.push((positions, periodic([40.0, 40.0])?));
    }
    let many = (random(5000, [70.0, 70.0], 37), sheared([70.0, 70.0], 13.0)?);
    for (positions, domain) in tissues()?.into_iter().chain(lattices).chain([many]) {
        let small = match domain {
            Domain::Periodic(cell_box) => Domain::Periodic(PeriodicBox::sheared(
                cell_box.lengths().map(|l| l * unit),
                cell_box.offset() * unit,
            )?),
            Domain::Open => Domain::Open,
        };
        let shrunk: Vec<_> = positions.iter().map(|r| r * unit).collect();
        assert!(Tessellation::new(&positions, domain)?.edges() == Tessellation::new(&shrunk, small)?.edges());
    }
    Ok(())
}

#[test]
fn a_failed_renewal_can_be_followed_by_a_good_one() -> Result<(), Error> {
    let positions = random(60, [9.0, 9.0], 35);
    let mut tessellation = Tessellation::new(&positions, periodic([9.0, 9.0])?)?;
    let mut broken = positions.clone();
    broken[7].x = f64::NAN;
    assert!(tessellation.renew(&broken).is_err());
    tessellation.renew(&positions)?;
    assert_eq!(tessellation, Tessellation::new(&positions, periodic([9.0, 9.0])?)?);
    Ok(())
}
