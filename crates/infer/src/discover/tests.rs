//! Tests of the search on a small tissue.
