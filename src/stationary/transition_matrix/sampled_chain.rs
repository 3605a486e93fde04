//! Chains like those that sampling gives, for tests and benches: a damped rotation with noise, mapped by a few
//! trajectories a cell. Shared by `benches/stationary.rs`, so it uses nothing of the crate.

use sprs::CsMat;

/// A small generator of random numbers (splitmix64), for data that need no quality.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Uniform in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Nearly standard normal: the sum of twelve uniform numbers, centred.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Settings of [`sampled_chain`].
pub(crate) struct Settings {
    /// Cells an axis of the square [-1, 1]².
    pub(crate) count: usize,
    /// Trajectories a cell.
    pub(crate) samples: usize,
    /// Factor of the radius a step: the second eigenvalue but for numerical diffusion.
    pub(crate) damping: f64,
    /// Steady standard deviation of each axis.
    pub(crate) spread: f64,
    /// Whether states that leave the square are lost; otherwise they stop at its edge.
    pub(crate) leaks: bool,
    /// Seed.
    pub(crate) seed: u64,
}

/// P by rows and the escape of each cell, cells in C order.
pub(crate) fn sampled_chain(settings: &Settings) -> (CsMat<f64>, Vec<f64>) {
    let count = settings.count;
    let n = count * count;
    let noise = settings.spread * (1.0 - settings.damping.powi(2)).sqrt();
    let (sin, cos) = 1.0_f64.sin_cos();
    let mut escape = vec![0.0; n];
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    let share = 1.0 / settings.samples as f64;
    for (cell, lost) in escape.iter_mut().enumerate() {
        let mut random = Random((cell as u64) << 20 ^ settings.seed);
        let mut targets = Vec::with_capacity(settings.samples);
        for _ in 0..settings.samples {
            let place =
                |index: usize, offset: f64| 2.0 * (index as f64 + offset) / count as f64 - 1.0;
            let x = place(cell / count, random.uniform()) * settings.damping;
            let y = place(cell % count, random.uniform()) * settings.damping;
            let image = [cos * x + sin * y, cos * y - sin * x].map(|z| z + noise * random.normal());
            if settings.leaks && image.iter().any(|z| z.abs() >= 1.0) {
                *lost += share;
                continue;
            }
            let index =
                |z: f64| (((z + 1.0) / 2.0 * count as f64).max(0.0) as usize).min(count - 1);
            targets.push(index(image[0]) * count + index(image[1]));
        }
        targets.sort_unstable();
        for group in targets.chunk_by(|a, b| a == b) {
            rows.push(group[0]);
            values.push(group.len() as f64 * share);
        }
        starts.push(rows.len());
    }
    (
        CsMat::new_csc((n, n), starts, rows, values).to_csr(),
        escape,
    )
}
