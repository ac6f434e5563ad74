//! Cells that crawl: each has a velocity of its own that goes on from one interval to the next.
//!
//! The polarity p_i of a cell is a stationary process, `ẋ_i = F_i + p_i`, `ṗ = −p/τ + noise`: the self-propelled Voronoi model, in which
//! `p = v₀ (cos θ, sin θ)` and `τ = 1/D_r`, has the same covariance, `⟨p(t)·p(t′)⟩ = v₀² exp(−|t − t′|/τ)`. Its values at the frames are unknowns
//! of the fit, in units of length as u = pT, and hold each other as
//!
//! ```text
//! S(u) = σ_v²/σ_u² [ ‖u_0‖² + Σ_f ‖u_{f+1} − ρ_f u_f‖² / (1 − ρ_f²) ],      ρ_f = exp(−h_f/τ)
//! ```
//!
//! Over an interval h a cell crawls by `(u_f + u_{f+1})/2 · h/T`. Means over intervals of x = h/τ relaxation times are then correlated as those of
//! the process are, if `σ_u = v₀T/√2 · 2 tanh(x/2)/x`; what their variances differ by is new in each interval and part of σ_v.
//!
//! σ_u, τ and both noise levels follow together from the restricted likelihood. Errors of positions cannot pose as memory, because they are in the
//! same fit: they make successive displacements *anti*-correlated.

/// How often cells take on the polarity of their neighbours in an interval, at first.
const FIRST_ALIGNMENT: f64 = 0.1;

/// How the polarity of a cell goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Memory {
    /// x = T/τ: relaxation times in the usual interval T.
    pub times: f64,
    /// σ_p = σ_u/T: standard deviation of one component, as a velocity.
    pub speed: f64,
    /// Which share of the variance of first polarities is independent of where the cells are.
    pub free: f64,
    /// J T: how often in the usual interval a cell takes on the polarity of its neighbours; zero if it does not.
    pub alignment: f64,
}

impl Memory {
    /// Before anything is known.
    pub const FIRST: Self = Self { times: 0.1, speed: 0.5, free: 1.0, alignment: 0.0 };

    /// Before anything is known, of cells that may align or do not.
    pub fn first(align: bool) -> Self {
        Self { alignment: if align { FIRST_ALIGNMENT } else { 0.0 }, ..Self::FIRST }
    }

    /// v₀, the root mean square of the polarity of cells that do not align.
    pub fn root_mean_square(self) -> f64 {
        let half = 0.5 * self.times;
        self.speed * 2.0_f64.sqrt() * half / half.tanh()
    }

    /// Of cells with this v₀ that do not align, and of which D_r T and J T are these.
    pub fn of(root_mean_square: f64, times: f64, alignment: f64) -> Self {
        let unit = Self { times, speed: 1.0, free: 1.0, alignment };
        Self { speed: root_mean_square / unit.root_mean_square(), ..unit }
    }

    /// ρ, a, and the standard deviation of what is new in a component, as a velocity, after so many usual intervals.
    pub fn step(self, since: f64) -> [f64; 3] {
        let (own, rho) = innovation(since, self.times);
        [rho, share(self, since), self.speed / own.sqrt()]
    }

    /// The correlation of the mean polarities of successive intervals.
    pub fn correlation(self) -> f64 {
        let x = self.times;
        // The difference loses digits where x is small.
        if x < 1e-3 {
            return 1.0 - 2.0 * x / 3.0;
        }
        (1.0 - (-x).exp()).powi(2) / (2.0 * (x - 1.0 + (-x).exp()))
    }

    /// How far two are from each other.
    pub fn change(self, other: Self) -> f64 {
        let gone = |x: f64, y: f64| ((-x).exp() - (-y).exp()).abs();
        gone(self.times, other.times)
            + gone(self.alignment, other.alignment)
            + (self.speed / other.speed).ln().abs()
    }
}

/// `1/(1 − ρ²)` and ρ of a polarity after so long.
pub(super) fn innovation(since: f64, times: f64) -> (f64, f64) {
    let rho = (-times * since).exp();
    (1.0 / (1.0 - rho * rho), rho)
}

/// a of [`super::alignment`] after so long.
pub(super) fn share(memory: Memory, since: f64) -> f64 {
    -(-memory.alignment * since).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means over intervals of what is interpolated between the polarities at frames are correlated as those of the process, and the speed
    /// is that at any time.
    #[test]
    fn means_over_intervals_are_those_of_the_process() {
        for times in [1e-4, 0.02, 0.5, 2.0] {
            let memory = Memory { times, speed: 0.7, ..Memory::FIRST };
            let rho = (-times).exp();
            // Of (u_0 + u_1)/2 with (u_1 + u_2)/2, σ_u = 1.
            let neighbours = 0.25 * (1.0 + 2.0 * rho + rho * rho);
            let v_0 = memory.root_mean_square();
            // ∫∫ v_0²/2 exp(−|s − t|) over an interval of x and the next.
            let of_process = 0.5 * v_0 * v_0 * (1.0 - rho).powi(2) / (times * times);
            let own = memory.speed * memory.speed * neighbours;
            assert!((own / of_process - 1.0).abs() < 1e-6, "{times}: {own} {of_process}");
        }
        let correlation = |times: f64| Memory { times, speed: 1.0, ..Memory::FIRST }.correlation();
        assert!((correlation(9.99e-4) - correlation(1.001e-3)).abs() < 1e-5);
        assert!(correlation(1e-4) > 0.999 && correlation(20.0) < 0.03);
    }
}
