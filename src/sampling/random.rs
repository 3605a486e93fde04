//! Keyed streams of standard normal numbers, [`LANES`] at a time.
//!
//! A stream is a function of (seed, cell, block) alone: never of the parameter, so that transition
//! probabilities vary smoothly along a sweep (common random numbers), and never of the thread. Each lane runs
//! its own xoshiro256+ (Blackman and Vigna 2021). Results are the same bits on every instruction set: only
//! +, -, ×, /, √ and integer operations occur, which IEEE 754 fixes, and nothing is fused.

use multiversion::multiversion;

use super::four_point::{A_WORD, four_point};
use super::normal::normal_pair;
use crate::system::{LANES, Lanes};

/// One 64-bit word of the generators' states.
type Words = [u64; LANES];

/// Rows that begin where lines of the cache do: a register that is loaded across two lines takes twice as long.
#[repr(align(64))]
pub(super) struct OnLines<T>(pub(super) T);

/// What a stream is keyed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct StreamKey {
    /// The run's seed.
    pub(crate) seed: u64,
    /// Number of the cell in the cell space.
    pub(crate) cell: u64,
    /// Number of the batch within the cell.
    pub(crate) block: u64,
}

impl StreamKey {
    /// A word that mixes all of the key.
    pub(crate) fn word(self) -> u64 {
        let seed = mix(self.seed.wrapping_add(WEYL));
        let cell = mix(seed ^ self.cell.wrapping_mul(WEYL).wrapping_add(1));
        mix(cell ^ self.block.wrapping_mul(WEYL).wrapping_add(2))
    }
}

/// 2⁶⁴ over the golden ratio, the increment of splitmix64.
const WEYL: u64 = 0x9e37_79b9_7f4a_7c15;

/// The output function of splitmix64, a bijection of 64-bit words that passes for random.
#[inline(always)]
pub(crate) fn mix(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

/// A number in [0, 1) with 53 random bits from a word.
pub(crate) fn unit(word: u64) -> f64 {
    (word >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// Rows of normals made at once: 8 KB, which stay in the first-level cache with everything else.
pub(super) const ROWS: usize = 16;

/// Independent standard normals in every lane.
pub(crate) struct NormalStream {
    state: OnLines<[Words; 4]>,
    /// Room for rows that are drawn.
    rows: OnLines<[Lanes; ROWS]>,
    /// Room for more of them.
    more: Vec<Lanes>,
}

impl NormalStream {
    /// The stream of a key.
    pub(crate) fn new(key: StreamKey) -> Self {
        let mut state = OnLines([[0; LANES]; 4]);
        seed_lanes(key.word(), &mut state.0);
        Self {
            state,
            rows: OnLines([[0.0; LANES]; ROWS]),
            more: Vec::new(),
        }
    }

    /// Begins anew as the stream of a key.
    pub(crate) fn restart(&mut self, key: StreamKey) {
        seed_lanes(key.word(), &mut self.state.0);
    }

    /// The next rows of standard normals, as of [`NormalStream::fill`], or of four-point numbers, which serve for
    /// laws as normals do. A word makes twelve of those; what is left of the last one is dropped.
    pub(super) fn draw(&mut self, rows: usize, is_for_laws: bool) -> &[Lanes] {
        let drawn = match rows <= ROWS {
            true => &mut self.rows.0[..rows],
            false => {
                self.more.resize(rows, [0.0; LANES]);
                &mut self.more
            }
        };
        match is_for_laws {
            true => fill_for_laws(&mut self.state.0, drawn),
            false => fill(&mut self.state.0, drawn),
        }
        drawn
    }

    /// Fills rows of standard normals. Numbers come in pairs of rows: after an odd number of rows the second
    /// half of the last pair is dropped.
    pub(crate) fn fill(&mut self, normals: &mut [Lanes]) {
        fill(&mut self.state.0, normals);
    }
}

/// Every lane's generator from a scrambled key: the lanes' own keys differ by a bijection's argument, so they
/// never coincide, and splitmix64 expands each to a state, as its authors recommend.
#[multiversion(targets = "simd")]
fn seed_lanes(key: u64, state: &mut [Words; 4]) {
    let [s0, s1, s2, s3] = state;
    for lane in 0..LANES {
        let lane_key = mix(key.wrapping_add(WEYL.wrapping_mul(lane as u64 + 1)));
        s0[lane] = mix(lane_key.wrapping_add(WEYL));
        s1[lane] = mix(lane_key.wrapping_add(WEYL.wrapping_mul(2)));
        s2[lane] = mix(lane_key.wrapping_add(WEYL.wrapping_mul(3)));
        s3[lane] = mix(lane_key.wrapping_add(WEYL.wrapping_mul(4)));
    }
}

#[multiversion(targets = "simd")]
fn fill(state: &mut [Words; 4], normals: &mut [Lanes]) {
    fill_rows(state, normals);
}

#[multiversion(targets = "simd")]
fn fill_for_laws(state: &mut [Words; 4], rows: &mut [Lanes]) {
    let [s0, s1, s2, s3] = state;
    for rows in rows.chunks_mut(A_WORD) {
        let mut random = [0; LANES];
        for lane in 0..LANES {
            let mut words = [s0[lane], s1[lane], s2[lane], s3[lane]];
            random[lane] = next_word(&mut words);
            [s0[lane], s1[lane], s2[lane], s3[lane]] = words;
        }
        for row in rows {
            for lane in 0..LANES {
                row[lane] = four_point(random[lane]);
                random[lane] <<= 4;
            }
        }
    }
}

/// The loop of [`NormalStream::fill`] for whatever instruction set it is inlined into.
#[inline(always)]
pub(super) fn fill_rows(state: &mut [Words; 4], normals: &mut [Lanes]) {
    for rows in normals.chunks_mut(2) {
        match rows {
            [first, second] => fill_pair(state, first, second),
            [first] => fill_pair(state, first, &mut [0.0; LANES]),
            _ => {}
        }
    }
}

#[inline(always)]
fn fill_pair(state: &mut [Words; 4], first: &mut Lanes, second: &mut Lanes) {
    let [s0, s1, s2, s3] = state;
    for lane in 0..LANES {
        let mut words = [s0[lane], s1[lane], s2[lane], s3[lane]];
        let radius = next_word(&mut words);
        let angle = next_word(&mut words);
        [s0[lane], s1[lane], s2[lane], s3[lane]] = words;
        (first[lane], second[lane]) = normal_pair(radius, angle);
    }
}

/// One step of xoshiro256+.
#[inline(always)]
fn next_word(state: &mut [u64; 4]) -> u64 {
    let result = state[0].wrapping_add(state[3]);
    let shifted = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= shifted;
    state[3] = state[3].rotate_left(45);
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_xoshiro::Xoshiro256Plus;
    use rand_xoshiro::rand_core::SeedableRng;
    use statrs::distribution::{ContinuousCDF, Normal};

    fn key(seed: u64, cell: u64, block: u64) -> StreamKey {
        StreamKey { seed, cell, block }
    }

    fn sample(key: StreamKey, rows: usize) -> Vec<Lanes> {
        let mut normals = vec![[0.0; LANES]; rows];
        NormalStream::new(key).fill(&mut normals);
        normals
    }

    #[test]
    fn the_generator_is_xoshiro256_plus() {
        let mut bytes = [0; 32];
        let mut state = [1, 2, 3 << 40, 4];
        for (chunk, word) in bytes.chunks_mut(8).zip(state) {
            chunk.copy_from_slice(&u64::to_le_bytes(word));
        }
        let mut reference = Xoshiro256Plus::from_seed(bytes);
        for _ in 0..100 {
            assert_eq!(next_word(&mut state), reference.next_u64());
        }
    }

    #[test]
    fn the_vector_code_gives_the_bits_of_the_baseline() {
        let normals = sample(key(3, 14, 15), 101);
        let mut baseline = vec![[0.0; LANES]; 101];
        fill_rows(
            &mut NormalStream::new(key(3, 14, 15)).state.0,
            &mut baseline,
        );
        for (left, right) in normals.iter().flatten().zip(baseline.iter().flatten()) {
            assert_eq!(left.to_bits(), right.to_bits());
        }
    }

    #[test]
    fn the_bits_never_change() {
        // Written down once: a change of these breaks the reproducibility of stored runs.
        let normals = sample(key(1, 2, 3), 2);
        let bits = [normals[0][0], normals[1][63]].map(f64::to_bits);
        assert_eq!(bits, [4_595_384_741_968_390_698, 4_597_740_823_309_412_754]);
    }

    #[test]
    fn moments_and_tails_are_normal() {
        let normals = sample(key(5, 0, 0), 40_000);
        let n = 40_000.0 * LANES as f64;
        let moment = |power: i32| normals.iter().flatten().map(|x| x.powi(power)).sum::<f64>() / n;
        // Within five standard errors, √((E x²ᵏ - (E xᵏ)²)/n).
        for (power, mean, variance) in [
            (1, 0.0, 1.0),
            (2, 1.0, 2.0),
            (3, 0.0, 15.0),
            (4, 3.0, 96.0),
            (6, 15.0, 10_395.0 - 225.0),
        ] {
            let error: f64 = moment(power) - mean;
            assert!(
                error.abs() < 5.0 * f64::sqrt(variance / n),
                "{power}: {error}"
            );
        }
        let law = Normal::new(0.0, 1.0).unwrap();
        for limit in [2.0, 3.0, 4.0, 4.5] {
            for sign in [-1.0, 1.0] {
                let beyond = |x: &&f64| sign * **x > limit;
                let count = normals.iter().flatten().filter(beyond).count() as f64;
                let expected = n * law.sf(limit);
                assert!(
                    (count - expected).abs() < 5.0 * expected.sqrt(),
                    "{sign}×{limit}"
                );
            }
        }
    }

    #[test]
    fn numbers_for_laws_have_their_moments_and_are_uncorrelated() {
        let rows = 40_000;
        let mut stream = NormalStream::new(key(7, 0, 0));
        let numbers = stream.draw(rows, true);
        let n = (rows * LANES) as f64;
        let moment = |power: i32| numbers.iter().flatten().map(|x| x.powi(power)).sum::<f64>() / n;
        for (power, mean, variance) in
            [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 13.5), (4, 3.0, 55.0)]
        {
            let error: f64 = moment(power) - mean;
            assert!(
                error.abs() < 5.0 * f64::sqrt(variance / n),
                "{power}: {error}"
            );
        }
        // Between rows of one word and of two, between lanes, and of squares.
        let check = |product: &dyn Fn(usize, usize) -> f64| {
            let pairs = (0..rows - A_WORD)
                .map(|row| (0..LANES).map(|lane| product(row, lane)).sum::<f64>());
            let scaled = pairs.sum::<f64>() / n.sqrt();
            assert!(scaled.abs() < 5.0, "{scaled}");
        };
        for apart in 1..=A_WORD {
            check(&|row, lane| numbers[row][lane] * numbers[row + apart][lane]);
            check(&|row, lane| {
                (numbers[row][lane].powi(2) - 1.0) * (numbers[row + apart][lane].powi(2) - 1.0)
                    / 2.0
            });
        }
        check(&|row, lane| numbers[row][lane] * numbers[row][(lane + 1) % LANES]);
    }

    /// Largest distance between the empirical and the normal distribution function, times √n.
    fn kolmogorov_smirnov(mut values: Vec<f64>) -> f64 {
        let law = Normal::new(0.0, 1.0).unwrap();
        values.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let distance = |(index, x): (usize, &f64)| {
            let cdf = law.cdf(*x);
            (cdf - index as f64 / n)
                .abs()
                .max((index as f64 + 1.0) / n - cdf)
        };
        values.iter().enumerate().map(distance).fold(0.0, f64::max) * n.sqrt()
    }

    #[test]
    fn the_distribution_is_normal_along_a_lane_and_across_keys() {
        // Exceeded with probability 2 exp(-2·2.2²) = 1e-4.
        let normals = sample(key(6, 1, 1), 20_000);
        for lane in [0, 1, 63] {
            let along: Vec<f64> = normals.iter().map(|row| row[lane]).collect();
            assert!(kolmogorov_smirnov(along) < 2.2);
        }
        let across = (0..300).flat_map(|cell| sample(key(6, cell, 0), 1)[0]);
        assert!(kolmogorov_smirnov(across.collect()) < 2.2);
    }

    #[test]
    fn rows_lanes_and_keys_are_uncorrelated() {
        let rows = 20_000;
        let normals = sample(key(8, 0, 0), rows);
        let others = [key(8, 0, 1), key(8, 1, 0), key(9, 0, 0)].map(|key| sample(key, rows));
        // A mean of n products of independent normals has standard deviation 1/√n.
        let check = |product: &dyn Fn(usize, usize) -> f64| {
            let mut sum = 0.0;
            for row in 0..rows - 1 {
                sum += (0..LANES).map(|lane| product(row, lane)).sum::<f64>();
            }
            let scaled = sum / f64::sqrt((rows * LANES) as f64);
            assert!(scaled.abs() < 5.0, "{scaled}");
        };
        check(&|row, lane| normals[row][lane] * normals[row][(lane + 1) % LANES]);
        check(&|row, lane| normals[row][lane] * normals[row + 1][lane]);
        check(&|row, lane| {
            (normals[row][lane].powi(2) - 1.0) * (normals[row + 1][lane].powi(2) - 1.0) / 2.0
        });
        for other in &others {
            check(&|row, lane| normals[row][lane] * other[row][lane]);
        }
    }
}
