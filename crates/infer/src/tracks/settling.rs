//! How far a fit and its noise levels are brought together, at first, on the way and at the end.

/// How far fit and noise levels are brought together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settling {
    /// Rounds of both at most.
    pub rounds: u64,
    /// Steps of the optimiser in a round.
    pub steps: u64,
    /// Change of log σ that counts as none.
    pub enough: f64,
    /// Whether the error of the dynamics falls in each round where cells crawl, be it likely or not: with a loose one, fits end that write
    /// off motions which a polarity explains.
    pub tightens: bool,
    /// Draws for the slopes of the likelihood, where cells crawl.
    pub draws: usize,
}

/// At first; on the way; at the end.
pub(super) const ROUGH: Settling = Settling { rounds: 5, steps: 2, enough: 0.7, tightens: true, draws: 16 };
pub(super) const PASSING: Settling =
    Settling { rounds: 1, steps: 2, enough: f64::INFINITY, tightens: false, draws: 16 };
pub(super) const FINAL: Settling = Settling { rounds: 8, steps: 1, enough: 0.06, tightens: false, draws: 48 };
