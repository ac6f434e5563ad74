//! The examples run.

#[path = "../examples/custom_effect.rs"]
mod custom_effect;
#[path = "../examples/differentiate.rs"]
mod differentiate;
#[path = "../examples/discover.rs"]
mod discover;
#[path = "../examples/infer.rs"]
mod infer;
#[path = "../examples/simulate.rs"]
mod simulate;

/// What an example ends with.
type Outcome = Result<(), Box<dyn std::error::Error>>;

#[test]
fn simulate_runs() -> Outcome {
    simulate::main()
}

#[test]
fn differentiate_runs() -> Outcome {
    differentiate::main()
}

#[test]
fn infer_runs() -> Outcome {
    infer::main()
}

#[test]
fn discover_runs() -> Outcome {
    discover::main()
}

#[test]
fn custom_effect_runs() -> Outcome {
    custom_effect::main()
}
