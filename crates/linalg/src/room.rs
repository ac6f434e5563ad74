//! Memory for matrices that come and go: a page that is new to a process costs more than what is done with it.

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Memory that is gone, for what is to come, ascending.
static SPARE: Mutex<Vec<Vec<f64>>> = Mutex::new(Vec::new());

/// Pieces of it that are kept at most.
const SPARES: usize = 64;

/// Numbers below which the allocator does as well.
const SMALL: usize = 16_000;

/// Some numbers, of no particular value at first.
#[derive(Debug, Clone)]
pub(crate) struct Room {
    values: Vec<f64>,
}

impl Room {
    /// `None` if there is no memory for so many.
    pub fn new(count: usize) -> Option<Self> {
        let mut values = spare(count);
        if values.len() < count {
            values.try_reserve_exact(count - values.len()).ok()?;
            values.resize(count, 0.0);
        }
        values.truncate(count);
        Some(Self { values })
    }
}

/// The smallest spare piece that is large enough, or the largest that is not, to grow: so there are never more than were in use at once. One of quite
/// another size is for something else.
fn spare(count: usize) -> Vec<f64> {
    if count < SMALL {
        return Vec::new();
    }
    let mut spares = SPARE.lock().unwrap_or_else(PoisonError::into_inner);
    let larger = spares.partition_point(|own| own.capacity() < count);
    let is_alike =
        |at: &usize| spares.get(*at).is_some_and(|own| (count / 2..=2 * count).contains(&own.capacity()));
    let found = Some(larger).filter(is_alike).or(larger.checked_sub(1).filter(is_alike));
    found.map_or_else(Vec::new, |at| spares.remove(at))
}

impl Deref for Room {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl DerefMut for Room {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        if self.values.capacity() < SMALL {
            return;
        }
        let mut spares = SPARE.lock().unwrap_or_else(PoisonError::into_inner);
        let at = spares.partition_point(|own| own.capacity() < self.values.capacity());
        spares.insert(at, std::mem::take(&mut self.values));
        if spares.len() > SPARES {
            // The smallest cost least.
            spares.remove(0);
        }
    }
}
