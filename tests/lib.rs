//! Tests of claims that span several crates are in `claims/`.
