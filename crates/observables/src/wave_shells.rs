//! The waves that a recording can be resolved into, in shells of wave numbers.

use crate::structure_factor::wave_vectors;
use crate::tapers::{RESOLUTION, SHARED};
use crate::window::Window;
use crate::{Frame, Plan};
use std::f64::consts::TAU;
use voronudge_geometry::{Domain, PeriodicBox, Vector};

/// Waves of about one wave number.
#[derive(Debug, Clone)]
pub(crate) struct Shell {
    /// Mean wave number.
    pub wave_number: f64,
    /// Which waves.
    pub waves: Vec<usize>,
}

impl Shell {
    fn of(own: Vec<usize>, waves: &[Vector<f64>]) -> Self {
        let sum: f64 = own.iter().map(|wave| waves[*wave].norm()).sum();
        Self { wave_number: sum / own.len() as f64, waves: own }
    }
}

/// Wave vectors, one of each pair ±q, and their shells. Those of a window have an even number of periods in it.
#[derive(Debug, Clone)]
pub(crate) struct WaveShells {
    pub waves: Vec<Vector<f64>>,
    pub shells: Vec<Shell>,
    /// What they are seen through; none of a periodic box.
    pub window: Option<Window>,
}

impl WaveShells {
    /// Waves up to a wave number; none without a window to see them through.
    pub fn of(frame: &Frame, plan: &Plan, largest: f64) -> Option<Self> {
        let (cell_box, window) = match frame.tessellation.domain() {
            Domain::Periodic(cell_box) => (cell_box, None),
            Domain::Open => {
                (PeriodicBox::new(plan.window?.lengths.map(|length| length / RESOLUTION)).ok()?, plan.window)
            }
        };
        let waves = wave_vectors(&cell_box, largest);
        let [width, height] = cell_box.lengths();
        let shell = TAU / width.max(height);
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); (largest / shell) as usize + 1];
        for (wave, q) in waves.iter().enumerate() {
            members[(q.norm() / shell - 0.5).max(0.0) as usize].push(wave);
        }
        members.retain(|own| !own.is_empty());
        let shells: Vec<Shell> = members.into_iter().map(|own| Shell::of(own, &waves)).collect();
        (!shells.is_empty()).then_some(Self { waves, shells, window })
    }

    /// In shells so narrow that the longest wave of each is at most `ratio` times as long as the shortest.
    #[must_use]
    pub fn narrowed(mut self, ratio: f64) -> Self {
        let mut order: Vec<usize> = (0..self.waves.len()).collect();
        order.sort_by(|a, b| self.waves[*a].norm().total_cmp(&self.waves[*b].norm()).then(a.cmp(b)));
        let mut members: Vec<Vec<usize>> = Vec::new();
        for wave in order {
            match members.last_mut() {
                Some(own) if self.waves[wave].norm() <= ratio * self.waves[own[0]].norm() => own.push(wave),
                _ => members.push(vec![wave]),
            }
        }
        self.shells = members.into_iter().map(|own| Shell::of(own, &self.waves)).collect();
        self
    }

    /// Standard error of a mean over waves, over that of independent ones.
    pub fn dependence(&self) -> f64 {
        if self.window.is_some() { SHARED.sqrt() } else { 1.0 }
    }
}
