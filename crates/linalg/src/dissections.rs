//! Orders of elimination that were found already.

use crate::{DissectedPattern, Error, SymmetricMatrix};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Patterns that are remembered at most, and entries of their matrices.
const PATTERNS: usize = 8;
const ENTRIES: usize = 1_000_000;

type Places = Vec<Option<[f64; 3]>>;

/// Orders of elimination that will be asked for again: a fit meets few patterns, most of them many times.
///
/// They depend on nothing but the pattern and the places, so no result depends on who asked before. Clones share what they know.
#[derive(Debug, Clone, Default)]
pub struct Dissections {
    /// What was asked for last comes first.
    known: Arc<Mutex<VecDeque<(DissectedPattern, Places)>>>,
}

impl Dissections {
    /// As [`DissectedPattern::new`].
    ///
    /// # Errors
    /// As [`DissectedPattern::new`].
    pub fn of(
        &self,
        matrix: &SymmetricMatrix,
        places: &[Option<[f64; 3]>],
    ) -> Result<DissectedPattern, Error> {
        if let Some(pattern) = self.recall(matrix, places) {
            return Ok(pattern);
        }
        let pattern = DissectedPattern::new(matrix, places)?;
        let mut known = self.known();
        known.push_front((pattern.clone(), places.to_vec()));
        known.truncate(PATTERNS);
        while known.len() > 1
            && known.iter().map(|(pattern, _)| pattern.matrix_entries()).sum::<usize>() > ENTRIES
        {
            known.pop_back();
        }
        Ok(pattern)
    }

    fn recall(&self, matrix: &SymmetricMatrix, places: &[Option<[f64; 3]>]) -> Option<DissectedPattern> {
        let mut known = self.known();
        let at = known.iter().position(|(pattern, own)| pattern.is_of(matrix) && own == places)?;
        let found = known.remove(at)?;
        let pattern = found.0.clone();
        known.push_front(found);
        Some(pattern)
    }

    fn known(&self) -> MutexGuard<'_, VecDeque<(DissectedPattern, Places)>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
