//! What moves cells besides the model, by options of its own or as effects of the catalogue.

use crate::arguments::ChosenEffects;
use crate::failure::Failure;
use clap::Args;
use voronudge_model::Effect;
use voronudge_simulate::{Driving, Shear};

#[derive(Debug, Args)]
pub(super) struct DrivingArguments {
    /// Speed of self-propulsion, in length/time.
    #[arg(long, value_name = "SPEED", default_value_t = 0.0, allow_negative_numbers = true)]
    self_propulsion: f64,
    /// Rotational diffusion of the direction of self-propulsion, in 1/time.
    #[arg(long, value_name = "D_R", default_value_t = 0.0, allow_negative_numbers = true)]
    rotational_diffusion: f64,
    /// Let the speed of self-propulsion fluctuate as its direction does. The polarity is then an Ornstein–Uhlenbeck
    /// process, with --self-propulsion as its root mean square.
    #[arg(long)]
    free_speed: bool,
    /// With --self-propulsion: rate at which a cell with six neighbours turns towards the mean direction of their
    /// self-propulsion, in 1/time.
    #[arg(long, value_name = "J", default_value_t = 0.0, allow_negative_numbers = true)]
    alignment: f64,
    /// With --self-propulsion: how fast it turns away from contacts, in length/time².
    #[arg(long, value_name = "B", default_value_t = 0.0, allow_negative_numbers = true)]
    contact_inhibition: f64,
    /// With --self-propulsion: rate at which it turns towards the velocity that the forces produce, in 1/time.
    #[arg(long, value_name = "KAPPA", default_value_t = 0.0, allow_negative_numbers = true)]
    velocity_alignment: f64,
    /// Translational diffusion, the noise of the positions, in length²/time.
    #[arg(long, value_name = "D", default_value_t = 0.0, allow_negative_numbers = true)]
    diffusion: f64,
}

impl DrivingArguments {
    /// The driving; effects that are about it are taken out of those of the model.
    pub fn driving(
        &self,
        effects: &mut ChosenEffects,
        shear: Option<Shear>,
        seed: u64,
    ) -> Result<Driving, Failure> {
        let Self { self_propulsion, rotational_diffusion, free_speed, .. } = *self;
        let mut driving = Driving {
            shear,
            speed: self_propulsion,
            rotational_diffusion,
            free_speed,
            alignment: self.alignment,
            contact_inhibition: self.contact_inhibition,
            velocity_alignment: self.velocity_alignment,
            diffusion: self.diffusion,
            seed,
        };
        let Driving { speed, rotational_diffusion, .. } = &mut driving;
        take(
            effects,
            "polarity",
            [("--self-propulsion", speed), ("--rotational-diffusion", rotational_diffusion)],
        )?;
        take(effects, "polarity_alignment", [("--alignment", &mut driving.alignment)])?;
        take(effects, "contact_inhibition", [("--contact-inhibition", &mut driving.contact_inhibition)])?;
        take(effects, "velocity_alignment", [("--velocity-alignment", &mut driving.velocity_alignment)])?;
        take(effects, "random_motion", [("--diffusion", &mut driving.diffusion)])?;
        let (turns, frees) = ("turns directions of", "frees the speed of");
        let asked = [
            (driving.alignment != 0.0, "--alignment", turns),
            (driving.contact_inhibition != 0.0, "--contact-inhibition", turns),
            (driving.velocity_alignment != 0.0, "--velocity-alignment", turns),
            (free_speed, "--free-speed", frees),
        ];
        match asked.into_iter().find(|(is_asked, ..)| *is_asked && driving.speed == 0.0) {
            Some((_, option, what)) => {
                let hint = format!(
                    "give --self-propulsion or --effect polarity too, or leave {option}, or the effect that says the same, out"
                );
                Err(Failure::new(format!("{option} {what} self-propulsion, and there is none"))
                    .with_hint(hint))
            }
            None => Ok(driving),
        }
    }
}

/// The coefficients of an effect in place of options that say the same.
fn take<const N: usize>(
    effects: &mut ChosenEffects,
    id: &str,
    options: [(&str, &mut f64); N],
) -> Result<(), Failure> {
    let Some(values) = effects.take(id) else { return Ok(()) };
    let fault = |message: String| Failure::new(format!("--effect {id}: {message}"));
    if values.len() != N {
        let coefficients = Effect::from_id(id).map_or("", |effect| effect.coefficients);
        return Err(fault(format!("{} coefficients are given, but there are {N}", values.len()))
            .with_hint(format!("the coefficients are: {coefficients}")));
    }
    for ((option, own), value) in options.into_iter().zip(values) {
        if *own != 0.0 {
            return Err(
                fault(format!("{option} is given too, and says the same")).with_hint("leave one of them out")
            );
        }
        *own = value;
    }
    Ok(())
}
