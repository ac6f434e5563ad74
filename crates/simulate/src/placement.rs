//! Starting positions: random sequential addition with a least distance.

use crate::Error;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use voronudge_geometry::{PeriodicBox, Vector};

/// The generator of random numbers used by simulations: the same seed gives the same numbers on every machine.
pub type Generator = Pcg64;

/// A generator made from a seed, which the caller records.
///
/// ```
/// use rand::Rng;
/// use voronudge_simulate::generator;
/// assert_eq!(generator(5).random::<u64>(), generator(5).random::<u64>());
/// ```
pub fn generator(seed: u64) -> Generator {
    Generator::seed_from_u64(seed)
}

/// The seed of one of many runs that share a seed: a function of the three numbers only, so that a run does not depend on
/// which others are made, in which order, or where.
///
/// ```
/// use voronudge_simulate::seed_of_run;
/// assert_eq!(seed_of_run(1, 7, 0), seed_of_run(1, 7, 0));
/// assert_ne!(seed_of_run(1, 7, 0), seed_of_run(1, 7, 1));
/// assert_ne!(seed_of_run(1, 7, 0), seed_of_run(1, 0, 7));
/// ```
pub fn seed_of_run(seed: u64, point: u64, replica: u64) -> u64 {
    let stream = u128::from(point) << 64 | u128::from(replica);
    Pcg64::new(u128::from(seed) << 64 | 0x9E37_79B9_7F4A_7C15, stream).random()
}

/// The seed of one of many equal runs that share a seed: of the first it is that seed, so that one run alone is the first of
/// many; of the others [`seed_of_run`]. So runs that are repeated with a neighbouring seed share nothing with those before.
///
/// ```
/// use voronudge_simulate::seed_of_replica;
/// assert_eq!(seed_of_replica(1, 0), 1);
/// assert_ne!(seed_of_replica(1, 1), seed_of_replica(2, 0));
/// ```
pub fn seed_of_replica(seed: u64, replica: u64) -> u64 {
    if replica == 0 { seed } else { seed_of_run(seed, 0, replica) }
}

/// Uniform random positions, each drawn anew until it is far enough from those before it.
///
/// Where the box is too full for the distance asked for, the distance is relaxed step by step; so this ends at any
/// density.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomPlacement {
    /// Number of cells `N`.
    pub cells: usize,
    /// The periodic box, of area `S`.
    pub cell_box: PeriodicBox,
    /// Least distance between two cells in units of their mean spacing `√(S/N)`.
    pub least_distance: f64,
}

impl RandomPlacement {
    /// Tries for one cell before the distance is relaxed. At 0.8 spacings about one place in a thousand is free for the last
    /// cells.
    const TRIES: usize = 20_000;
    /// Factor of the distance then.
    const RELAXATION: f64 = 0.9;

    /// A placement with the usual least distance of 0.7 spacings.
    ///
    /// Close pairs make long thin triangles and with them velocities so large that the first steps fail; at 0.7 the
    /// fastest of a million cells moves by less than half a spacing in a [recommended](crate::recommended_time_step)
    /// step. Random addition jams where discs of the least distance as diameter cover 0.547 of the plane, at 0.83 spacings; 0.8
    /// is reached.
    pub fn new(cells: usize, cell_box: PeriodicBox) -> Self {
        Self { cells, cell_box, least_distance: 0.7 }
    }

    /// Draws the positions (N), inside the rectangle `[0, L_x) × [0, L_y)`, in the unit of the box.
    ///
    /// # Errors
    /// [`Error::NoCells`] for zero cells, [`Error::LeastDistance`] for a negative or non-finite distance.
    ///
    /// ```
    /// use voronudge_geometry::PeriodicBox;
    /// use voronudge_simulate::{RandomPlacement, generator};
    /// let cell_box = PeriodicBox::new([10.0, 10.0])?;
    /// let positions = RandomPlacement::new(100, cell_box).draw(&mut generator(1))?;
    /// let nearest = (0..100)
    ///     .flat_map(|i| (0..i).map(move |j| (i, j)))
    ///     .map(|(i, j)| cell_box.shortest(positions[i] - positions[j]).norm())
    ///     .fold(f64::INFINITY, f64::min);
    /// assert!(nearest >= 0.7);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn draw(&self, rng: &mut impl Rng) -> Result<Vec<Vector<f64>>, Error> {
        if self.cells == 0 {
            return Err(Error::NoCells);
        }
        if !(self.least_distance.is_finite() && self.least_distance >= 0.0) {
            return Err(Error::LeastDistance { value: self.least_distance });
        }
        let spacing = (self.cell_box.area() / self.cells as f64).sqrt();
        let mut distance = self.least_distance * spacing;
        let mut positions = Vec::with_capacity(self.cells);
        let mut bins = Bins::new(&self.cell_box, distance, self.cells);
        let [width, height] = self.cell_box.lengths();
        while positions.len() < self.cells {
            let candidate = (0..Self::TRIES)
                .map(|_| Vector::new(rng.random_range(0.0..width), rng.random_range(0.0..height)))
                .find(|&r| !bins.any_within(&self.cell_box, &positions, r, distance));
            match candidate {
                Some(r) => {
                    bins.enter(&self.cell_box, r);
                    positions.push(r);
                }
                None => distance *= Self::RELAXATION,
            }
        }
        Ok(positions)
    }
}

/// Bins no narrower than the least distance, in lattice coordinates, each a chain of positions.
struct Bins {
    counts: [usize; 2],
    /// Last position entered into each bin.
    last: Vec<Option<u32>>,
    /// The position entered before each position into the same bin.
    before: Vec<Option<u32>>,
}

impl Bins {
    fn new(cell_box: &PeriodicBox, distance: f64, cells: usize) -> Self {
        let [_, height] = cell_box.lengths();
        let width = cell_box.area() / height.hypot(cell_box.offset());
        let most = (cells as f64).sqrt().ceil() * 2.0;
        let counts = [width, height].map(|side| (side / distance).min(most).max(1.0) as usize);
        Self { counts, last: vec![None; counts[0] * counts[1]], before: Vec::with_capacity(cells) }
    }

    fn bin(&self, cell_box: &PeriodicBox, r: Vector<f64>) -> [usize; 2] {
        let [width, height] = cell_box.lengths();
        let y = r.y / height;
        let x = ((r.x - y * cell_box.offset()) / width).rem_euclid(1.0);
        let [columns, rows] = self.counts;
        [((x * columns as f64) as usize).min(columns - 1), ((y * rows as f64) as usize).min(rows - 1)]
    }

    fn enter(&mut self, cell_box: &PeriodicBox, r: Vector<f64>) {
        let [column, row] = self.bin(cell_box, r);
        let last = &mut self.last[row * self.counts[0] + column];
        let index = self.before.len() as u32;
        self.before.push(last.replace(index));
    }

    fn any_within(
        &self,
        cell_box: &PeriodicBox,
        positions: &[Vector<f64>],
        r: Vector<f64>,
        distance: f64,
    ) -> bool {
        let [column, row] = self.bin(cell_box, r);
        let [columns, rows] = self.counts;
        let around = |bin: usize, count: usize| [bin + count - 1, bin, bin + 1].map(|b| b % count);
        around(row, rows).into_iter().any(|row| {
            around(column, columns).into_iter().any(|column| {
                let chain = std::iter::successors(self.last[row * columns + column], |&index| {
                    self.before[index as usize]
                });
                chain
                    .into_iter()
                    .any(|index| cell_box.shortest(positions[index as usize] - r).norm() < distance)
            })
        })
    }
}
