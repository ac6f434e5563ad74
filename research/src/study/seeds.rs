//! Many seeds, and what they come to.

use voronudge_simulate::seed_of_replica;

/// Quartiles of some numbers: lower, median, upper. NaN of none.
pub fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|p| {
        let Some(last) = values.len().checked_sub(1) else {
            return f64::NAN;
        };
        let at = p * last as f64;
        let low = at.floor() as usize;
        values[low] + at.fract() * (values[(low + 1).min(last)] - values[low])
    })
}

/// Tissues that differ in their starting positions alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Replicas {
    /// The seed that theirs are made from: those of neighbouring ones share none.
    pub seed: u64,
    pub count: u64,
}

impl Replicas {
    pub fn seeds(self) -> impl Iterator<Item = u64> {
        (0..self.count).map(move |replica| seed_of_replica(self.seed, replica))
    }
}

/// Mean and standard error of the mean.
pub fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}

/// Runs a task for each seed, one thread per seed and none within, so that times are those of one core.
pub fn on_one_core_each<R: Send>(
    seeds: u64,
    task: impl Fn(u64) -> Result<R, Box<dyn std::error::Error>> + Sync,
) -> Result<Vec<R>, Box<dyn std::error::Error>> {
    on_cores(std::thread::available_parallelism()?.get(), seeds, task)
}

/// The same on as many cores as are given.
pub fn on_cores<R: Send>(
    cores: usize,
    seeds: u64,
    task: impl Fn(u64) -> Result<R, Box<dyn std::error::Error>> + Sync,
) -> Result<Vec<R>, Box<dyn std::error::Error>> {
    let next = std::sync::atomic::AtomicU64::new(0);
    let results = std::sync::Mutex::new(Vec::new());
    let work = || -> Result<(), String> {
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| error.to_string())?;
        loop {
            let seed = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if seed >= seeds {
                return Ok(());
            }
            let result = pool.install(|| task(seed).map_err(|error| error.to_string()))?;
            results.lock().map_err(|_| "a thread failed")?.push((seed, result));
        }
    };
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|_| Err("a thread failed".into())))
    })?;
    let mut results = results.into_inner().map_err(|_| "a thread failed")?;
    results.sort_by_key(|(seed, _)| *seed);
    Ok(results.into_iter().map(|(_, result)| result).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_of_neighbouring_seeds_share_no_tissue() {
        let mut seen = std::collections::BTreeSet::new();
        for seed in 0..50 {
            assert!(Replicas { seed, count: 50 }.seeds().all(|own| seen.insert(own)), "{seed}");
        }
    }
}
