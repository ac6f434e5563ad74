use voronudge_model::Parameters;

/// A time step with which mean square velocities of the base model have converged to a few per cent:
///
/// `Δt = 0.01 / max(K_P, K_P |α|, K_A ℓ_0²)`
///
/// Larger steps may run and be wrong. `⟨v²⟩` of 100 cells at `K_A = 0.1`, `K_P = 1`, `P_0 = 4` (scatter about 3 %):
///
/// | Δt | α = 1 | α = 2.9 |
/// |---|---|---|
/// | 0.02 | 7.6 | 31 |
/// | 0.01 | 8.3 | 51 |
/// | 0.005 | 8.0 | 55 |
/// | 0.0025 | 7.9 | 55 |
///
/// The fastest linear mode of the honeycomb decays at `24 K_P (1 − P_0/P_MF)` and turns at `8√3 K_P |α|`; the classical
/// Runge–Kutta method is stable up to 2.8 divided by either. Disordered tissues have stiffer places, short edges above
/// all, hence the margin. `spacing` is `ℓ_0`, the square root of the mean cell area. Returns infinity if all three rates
/// are zero.
///
/// ```
/// use voronudge_model::Parameters;
/// use voronudge_simulate::recommended_time_step;
/// let step = recommended_time_step(&Parameters { chirality: -2.0, ..Parameters::default() }, 1.0);
/// assert_eq!(step, 0.005);
/// ```
pub fn recommended_time_step(parameters: &Parameters<f64>, spacing: f64) -> f64 {
    let perimeter_rate = parameters.perimeter_elasticity.abs() * parameters.chirality.abs().max(1.0);
    let area_rate = parameters.area_elasticity.abs() * spacing * spacing;
    0.01 / perimeter_rate.max(area_rate)
}
