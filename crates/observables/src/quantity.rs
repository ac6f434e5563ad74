//! What is measured.

/// Powers of a length and of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimensions {
    /// Power of the length.
    pub length: i32,
    /// Power of the time.
    pub time: i32,
}

impl Dimensions {
    const NONE: Self = Self { length: 0, time: 0 };
    const LENGTH: Self = Self { length: 1, time: 0 };
    const TIME: Self = Self { length: 0, time: 1 };

    /// What a value in units of `length` and `time` is to be multiplied with.
    pub fn factor(self, length: f64, time: f64) -> f64 {
        length.powi(self.length) * time.powi(self.time)
    }
}

/// What is measured: a number, or a function of a lag, a distance, a wave number or a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// `⟨|v|²⟩`
    MeanSquareVelocity,
    /// `⟨|r_i(t + τ) − r_i(t)|²⟩`
    MeanSquareDisplacement,
    /// `⟨v_i(t + τ)·v_i(t)⟩` over the mean square of both.
    VelocityAutocorrelation,
    /// `⟨v_i·v_j⟩` of cells at a distance, over the mean square of both.
    VelocityCorrelation,
    /// The same of what a model leaves of the velocities, in time.
    ResidualAutocorrelation,
    /// The same in space.
    ResidualCorrelation,
    /// T1 transitions per cell and time: contacts of a frame that its predecessor did not have.
    TransitionRate,
    /// Share of the contacts that are contacts still, or again, a lag later.
    ContactSurvival,
    /// Share of cells that have kept all their neighbours for a lag.
    ExchangeWaiting,
    /// T1 transitions at a distance from another one between the same frames, over as many as if they knew nothing of each other.
    ExchangeCorrelation,
    /// Density of the angle φ from x of the contacts that are made in T1 transitions.
    ExchangeDirection,
    /// Mean of `cos 2φ`.
    ExchangeAlignment,
    /// Mean angle by which the four cells turn anticlockwise.
    ExchangeTurn,
    /// Share of avalanches, T1 transitions that touch within a time, of a size.
    AvalancheSizes,
    /// The same of transitions at each other's times.
    AvalancheSizesShuffled,
    /// `⟨s²⟩/⟨s⟩` of their sizes.
    AvalancheSize,
    /// The same of transitions at each other's times.
    AvalancheSizeShuffled,
    /// `⟨s²⟩/⟨s⟩` against the time within which transitions touch.
    AvalancheThreshold,
    /// The same of transitions at each other's times.
    AvalancheThresholdShuffled,
    /// Mean time from the first to the last transition of the avalanche of one.
    AvalancheDuration,
    /// Mean root mean square distance from the middle of the avalanche of one.
    AvalancheExtent,
    /// Share of bursts, T1 transitions anywhere that follow each other within a time, of a size.
    BurstSizes,
    /// The same of transitions at any time.
    BurstSizesShuffled,
    /// `⟨s²⟩/⟨s⟩` of their sizes.
    BurstSize,
    /// The same of transitions at any time.
    BurstSizeShuffled,
    /// `⟨s²⟩/⟨s⟩` against the time within which transitions follow each other.
    BurstThreshold,
    /// The same of transitions at any time.
    BurstThresholdShuffled,
    /// Mean fall of the shear stress over a burst.
    BurstStressDrop,
    /// Share of T1 transitions that the same cells undo within that time.
    ExchangeReversal,
    /// Mean of `P/√A`.
    MeanShapeIndex,
    /// Density of the distribution of `P/√A`.
    ShapeIndex,
    /// Density of the distribution of the area, in units of its mean.
    Area,
    /// Share of cells with so many neighbours.
    Neighbours,
    /// `Ψ₆ = |⟨ψ_i⟩|`, mean over frames.
    HexaticOrder,
    /// `⟨|ψ_i|⟩`
    HexaticModulus,
    /// `Re ⟨ψ_i* ψ_j⟩` of cells at a distance.
    HexaticCorrelation,
    /// Density of cells at a distance from a cell, over the mean density.
    PairCorrelation,
    /// `2⟨|Q_i|⟩` of the shape tensors.
    Elongation,
    /// `|⟨Q_i⟩|/⟨|Q_i|⟩`, mean over frames.
    NematicOrder,
    /// `⟨Q_i : Q_j⟩` of cells at a distance, over the mean square of both.
    NematicCorrelation,
    /// Half-integer defects of either sign to a unit area.
    DefectDensity,
    /// Velocity of cells at +½ defects in the direction in which the head of the comet points.
    DefectVelocityAlong,
    /// The same to the left of that direction.
    DefectVelocityAcross,
    /// Anticlockwise velocity at a distance from +½ defects.
    SwirlAroundPlus,
    /// The same around −½ defects.
    SwirlAroundMinus,
    /// `S(q)` of the density.
    Density,
    /// Structure factor of the velocity along the wave vector: compression.
    Compression,
    /// Structure factor of the velocity across the wave vector: vortices.
    Vortices,
}

impl Quantity {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 48] = [
        Self::MeanSquareVelocity,
        Self::MeanSquareDisplacement,
        Self::VelocityAutocorrelation,
        Self::VelocityCorrelation,
        Self::ResidualAutocorrelation,
        Self::ResidualCorrelation,
        Self::TransitionRate,
        Self::ContactSurvival,
        Self::ExchangeWaiting,
        Self::ExchangeCorrelation,
        Self::ExchangeDirection,
        Self::ExchangeAlignment,
        Self::ExchangeTurn,
        Self::AvalancheSizes,
        Self::AvalancheSizesShuffled,
        Self::AvalancheSize,
        Self::AvalancheSizeShuffled,
        Self::AvalancheThreshold,
        Self::AvalancheThresholdShuffled,
        Self::AvalancheDuration,
        Self::AvalancheExtent,
        Self::BurstSizes,
        Self::BurstSizesShuffled,
        Self::BurstSize,
        Self::BurstSizeShuffled,
        Self::BurstThreshold,
        Self::BurstThresholdShuffled,
        Self::BurstStressDrop,
        Self::ExchangeReversal,
        Self::MeanShapeIndex,
        Self::ShapeIndex,
        Self::Area,
        Self::Neighbours,
        Self::HexaticOrder,
        Self::HexaticModulus,
        Self::HexaticCorrelation,
        Self::PairCorrelation,
        Self::Elongation,
        Self::NematicOrder,
        Self::NematicCorrelation,
        Self::DefectDensity,
        Self::DefectVelocityAlong,
        Self::DefectVelocityAcross,
        Self::SwirlAroundPlus,
        Self::SwirlAroundMinus,
        Self::Density,
        Self::Compression,
        Self::Vortices,
    ];

    /// Its name in reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::MeanSquareVelocity => "mean_square_velocity",
            Self::MeanSquareDisplacement => "mean_square_displacement",
            Self::VelocityAutocorrelation => "velocity_autocorrelation",
            Self::VelocityCorrelation => "velocity_correlation",
            Self::ResidualAutocorrelation => "residual_autocorrelation",
            Self::ResidualCorrelation => "residual_correlation",
            Self::TransitionRate => "t1_rate",
            Self::ContactSurvival => "contact_survival",
            Self::ExchangeWaiting => "t1_waiting",
            Self::ExchangeCorrelation => "t1_correlation",
            Self::ExchangeDirection => "t1_direction",
            Self::ExchangeAlignment => "t1_alignment",
            Self::ExchangeTurn => "t1_turn",
            Self::AvalancheSizes => "avalanche_sizes",
            Self::AvalancheSizesShuffled => "avalanche_sizes_shuffled",
            Self::AvalancheSize => "avalanche_size",
            Self::AvalancheSizeShuffled => "avalanche_size_shuffled",
            Self::AvalancheThreshold => "avalanche_size_by_time",
            Self::AvalancheThresholdShuffled => "avalanche_size_by_time_shuffled",
            Self::AvalancheDuration => "avalanche_duration",
            Self::AvalancheExtent => "avalanche_extent",
            Self::BurstSizes => "burst_sizes",
            Self::BurstSizesShuffled => "burst_sizes_shuffled",
            Self::BurstSize => "burst_size",
            Self::BurstSizeShuffled => "burst_size_shuffled",
            Self::BurstThreshold => "burst_size_by_time",
            Self::BurstThresholdShuffled => "burst_size_by_time_shuffled",
            Self::BurstStressDrop => "burst_stress_drop",
            Self::ExchangeReversal => "t1_reversed",
            Self::MeanShapeIndex => "mean_shape_index",
            Self::ShapeIndex => "shape_index",
            Self::Area => "area",
            Self::Neighbours => "neighbours",
            Self::HexaticOrder => "hexatic_order",
            Self::HexaticModulus => "hexatic_mean_modulus",
            Self::HexaticCorrelation => "hexatic_correlation",
            Self::PairCorrelation => "pair_correlation",
            Self::Elongation => "mean_elongation",
            Self::NematicOrder => "nematic_order",
            Self::NematicCorrelation => "nematic_correlation",
            Self::DefectDensity => "defect_density",
            Self::DefectVelocityAlong => "defect_velocity_along",
            Self::DefectVelocityAcross => "defect_velocity_across",
            Self::SwirlAroundPlus => "swirl_around_plus_defects",
            Self::SwirlAroundMinus => "swirl_around_minus_defects",
            Self::Density => "density_structure_factor",
            Self::Compression => "longitudinal_structure_factor",
            Self::Vortices => "transverse_structure_factor",
        }
    }

    /// The same in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::MeanSquareVelocity => "mean square velocity",
            Self::MeanSquareDisplacement => "mean square displacement",
            Self::VelocityAutocorrelation => "autocorrelation of velocities",
            Self::VelocityCorrelation => "correlation of velocities",
            Self::ResidualAutocorrelation => "autocorrelation of residuals",
            Self::ResidualCorrelation => "correlation of residuals",
            Self::TransitionRate => "T1 transitions per cell and time",
            Self::ContactSurvival => "contacts that last",
            Self::ExchangeWaiting => "cells that keep their neighbours",
            Self::ExchangeCorrelation => "T1 transitions around another",
            Self::ExchangeDirection => "directions of contacts that are made",
            Self::ExchangeAlignment => "contacts made along x, ⟨cos 2φ⟩",
            Self::ExchangeTurn => "turn of cells in a T1, anticlockwise",
            Self::AvalancheSizes => "sizes of avalanches",
            Self::AvalancheSizesShuffled => "sizes of avalanches at random",
            Self::AvalancheSize => "T1 transitions in the avalanche of one",
            Self::AvalancheSizeShuffled => "the same at random times",
            Self::AvalancheThreshold => "sizes of avalanches by threshold",
            Self::AvalancheThresholdShuffled => "sizes of avalanches at random by threshold",
            Self::AvalancheDuration => "duration of the avalanche of a T1",
            Self::AvalancheExtent => "extent of the avalanche of a T1",
            Self::BurstSizes => "sizes of bursts",
            Self::BurstSizesShuffled => "sizes of bursts at random",
            Self::BurstSize => "T1 transitions in the burst of one",
            Self::BurstSizeShuffled => "the same at any time",
            Self::BurstThreshold => "sizes of bursts by threshold",
            Self::BurstThresholdShuffled => "sizes of bursts at random by threshold",
            Self::BurstStressDrop => "fall of the shear stress in a burst",
            Self::ExchangeReversal => "T1 transitions undone at once",
            Self::MeanShapeIndex => "mean shape index",
            Self::ShapeIndex => "distribution of the shape index",
            Self::Area => "distribution of the area",
            Self::Neighbours => "numbers of neighbours",
            Self::HexaticOrder => "hexatic order",
            Self::HexaticModulus => "hexatic order of single cells",
            Self::HexaticCorrelation => "correlation of hexatic order",
            Self::PairCorrelation => "pair correlation",
            Self::Elongation => "mean elongation",
            Self::NematicOrder => "nematic order",
            Self::NematicCorrelation => "correlation of shapes",
            Self::DefectDensity => "defects to a unit area",
            Self::DefectVelocityAlong => "velocity at +½ defects, ahead",
            Self::DefectVelocityAcross => "velocity at +½ defects, to the left",
            Self::SwirlAroundPlus => "swirl around +½ defects",
            Self::SwirlAroundMinus => "swirl around −½ defects",
            Self::Density => "structure factor of the density",
            Self::Compression => "structure factor of compressing flow",
            Self::Vortices => "structure factor of swirling flow",
        }
    }

    /// Whether it is a single number.
    pub fn is_number(self) -> bool {
        self.axis().is_none()
    }

    /// What it is a function of, in words, and in which powers of units; `None` for a number.
    pub fn axis(self) -> Option<(&'static str, Dimensions)> {
        Some(match self {
            Self::MeanSquareVelocity
            | Self::TransitionRate
            | Self::MeanShapeIndex
            | Self::HexaticOrder
            | Self::HexaticModulus
            | Self::Elongation
            | Self::NematicOrder
            | Self::DefectDensity
            | Self::DefectVelocityAlong
            | Self::DefectVelocityAcross
            | Self::ExchangeAlignment
            | Self::ExchangeTurn
            | Self::AvalancheSize
            | Self::AvalancheSizeShuffled
            | Self::AvalancheDuration
            | Self::AvalancheExtent
            | Self::BurstSize
            | Self::BurstSizeShuffled
            | Self::BurstStressDrop
            | Self::ExchangeReversal => return None,
            Self::MeanSquareDisplacement
            | Self::VelocityAutocorrelation
            | Self::ResidualAutocorrelation
            | Self::ContactSurvival
            | Self::ExchangeWaiting => ("lag", Dimensions::TIME),
            Self::VelocityCorrelation
            | Self::ResidualCorrelation
            | Self::HexaticCorrelation
            | Self::PairCorrelation
            | Self::NematicCorrelation
            | Self::ExchangeCorrelation
            | Self::SwirlAroundPlus
            | Self::SwirlAroundMinus => ("distance", Dimensions::LENGTH),
            Self::AvalancheSizes
            | Self::AvalancheSizesShuffled
            | Self::BurstSizes
            | Self::BurstSizesShuffled => ("T1 transitions", Dimensions::NONE),
            Self::AvalancheThreshold
            | Self::AvalancheThresholdShuffled
            | Self::BurstThreshold
            | Self::BurstThresholdShuffled => ("longest time between transitions", Dimensions::TIME),
            Self::ExchangeDirection => ("angle from x, radians", Dimensions::NONE),
            Self::ShapeIndex => ("shape index P/√A", Dimensions::NONE),
            Self::Area => ("area / mean area", Dimensions::NONE),
            Self::Neighbours => ("neighbours", Dimensions::NONE),
            Self::Density | Self::Compression | Self::Vortices => {
                ("wave number", Dimensions { length: -1, time: 0 })
            }
        })
    }

    /// Powers of the units of its value.
    pub fn dimensions(self) -> Dimensions {
        match self {
            Self::MeanSquareVelocity | Self::Compression | Self::Vortices => {
                Dimensions { length: 2, time: -2 }
            }
            Self::MeanSquareDisplacement => Dimensions { length: 2, time: 0 },
            Self::TransitionRate | Self::BurstStressDrop => Dimensions { length: 0, time: -1 },
            Self::AvalancheDuration => Dimensions::TIME,
            Self::AvalancheExtent => Dimensions::LENGTH,
            Self::DefectDensity => Dimensions { length: -2, time: 0 },
            Self::DefectVelocityAlong
            | Self::DefectVelocityAcross
            | Self::SwirlAroundPlus
            | Self::SwirlAroundMinus => Dimensions { length: 1, time: -1 },
            _ => Dimensions::NONE,
        }
    }
}
