//! Memory for matrices that come and go: a page that is new to a process costs more than what is done with it.

use crate::Error;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// Memory that is gone, for what is to come, ascending.
static SPARE: Mutex<Vec<Vec<f64>>> = Mutex::new(Vec::new());

/// Pieces of it that are kept at most.
const SPARES: usize = 64;

/// Numbers below which the allocator does as well.
const SMALL: usize = 16_000;

/// Some numbers, of no particular value at first.
#[derive(Debug)]
pub(crate) struct Room {
    values: Vec<f64>,
}

impl Room {
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(count: usize) -> Result<Self, Error> {
        let mut values = spare(count);
        if values.len() < count {
            values
                .try_reserve_exact(count - values.len())
                .map_err(|_| Error::OutOfMemory { order: count })?;
            values.resize(count, 0.0);
        }
        values.truncate(count);
        Ok(Self { values })
    }
}

/// The smallest spare piece that is large enough.
fn spare(count: usize) -> Vec<f64> {
    if count < SMALL {
        return Vec::new();
    }
    let mut spares = SPARE.lock().unwrap_or_else(PoisonError::into_inner);
    let first = spares.partition_point(|own| own.capacity() < count);
    // One that is far too large is for something else.
    match spares.get(first).is_some_and(|own| own.capacity() <= 2 * count) {
        true => spares.remove(first),
        false => Vec::new(),
    }
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

impl Clone for Room {
    fn clone(&self) -> Self {
        Self { values: self.values.clone() }
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
