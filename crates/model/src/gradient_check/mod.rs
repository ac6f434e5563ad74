//! gradient check
