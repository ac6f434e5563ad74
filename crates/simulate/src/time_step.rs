use voronudge_model::Parameters;

/// A time step with which the base model can be expected to integrate stably and to about three digits:
///
/// `Δt = 0.02 / max(K_P, K_P |α|, K_A ℓ_0²)`
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
/// assert_eq!(step, 0.01);
/// ```
pub fn recommended_time_step(parameters: &Parameters<f64>, spacing: f64) -> f64 {
    let perimeter_rate = parameters.perimeter_elasticity.abs() * parameters.chirality.abs().max(1.0);
    let area_rate = parameters.area_elasticity.abs() * spacing * spacing;
    0.02 / perimeter_rate.max(area_rate)
}
