//! Densities of a whole sweep in few bytes: quantised, predicted from the values before, deflated.
//!
//! Neighbouring densities of a sweep are nearly on a straight line, so what is kept of a value is how far it lies from
//! the line through the two before it, in whole steps of the quantisation. `page/unpack.js` undoes it with the same
//! arithmetic: every operation is one that IEEE 754 rounds exactly, in the same order.

use miniz_oxide::deflate::compress_to_vec_zlib;

/// How values lie on the steps of a quantisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Evenly.
    Linear,
    /// Their square roots do, with the value's sign: small values keep more digits.
    Root,
}

impl Scale {
    /// The word that the page knows it by.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Root => "root",
        }
    }
}

/// Frames of equally many values, one frame a parameter value, in few bytes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    /// The largest magnitude among all values.
    pub(crate) top: f64,
    /// Number of steps from zero to `top`.
    pub(crate) levels: u32,
    /// How values lie on them.
    pub(crate) scale: Scale,
    /// Values a frame.
    pub(crate) cells: usize,
    /// Number of frames.
    pub(crate) frames: usize,
    /// Distances from the line, zigzag coded, the lowest bytes of all first, deflated (zlib).
    pub(crate) bytes: Vec<u8>,
}

/// The largest step between neighbouring frames, as a multiple of the one before, over which the line is followed;
/// beyond, the value before is the better guess.
const LONGEST: f64 = 2.0;
/// Bits of a quantisation at most: the distances then still fit into 32 bits.
const MOST_BITS: u32 = 28;

impl Packed {
    /// Packs frames that belong to the parameter values `at`, with steps of the largest magnitude over 2^`bits` - 1;
    /// `bits` from 1 to 28. What is not finite becomes zero. Frames that are longer than the first are cut, shorter
    /// ones filled with zeros.
    pub(crate) fn new(frames: &[&[f64]], at: &[f64], scale: Scale, bits: u32) -> Self {
        let cells = frames.first().map_or(0, |frame| frame.len());
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let values = frames.iter().flat_map(|frame| frame.iter());
        let top = values.map(|&value| finite(value).abs()).fold(0.0, f64::max);
        let levels = (1u32 << bits.clamp(1, MOST_BITS)) - 1;
        let mut packed = Self {
            top,
            levels,
            scale,
            cells,
            frames: frames.len(),
            bytes: Vec::new(),
        };
        let mut steps: Vec<Vec<i32>> = Vec::with_capacity(frames.len());
        let mut distances = Vec::with_capacity(frames.len() * cells);
        for (index, frame) in frames.iter().enumerate() {
            let guess = Guess::new(at, index);
            let value = |cell: usize| finite(frame.get(cell).copied().unwrap_or(0.0));
            let step = |cell: usize| packed.step(value(cell));
            let now: Vec<i32> = (0..cells).map(step).collect();
            let guessed = |cell: usize| guess.step(&steps, cell);
            distances.extend((0..cells).map(|cell| zigzag(now[cell] - guessed(cell))));
            steps.push(now);
        }
        packed.bytes = deflate(&planes(&distances, packed.width()));
        packed
    }

    /// The step of a value.
    fn step(&self, value: f64) -> i32 {
        if self.top == 0.0 {
            return 0;
        }
        let share = value / self.top;
        let share = match self.scale {
            Scale::Linear => share,
            Scale::Root => share.signum() * share.abs().sqrt(),
        };
        // At most `levels` in magnitude, which 28 bits hold.
        (share * f64::from(self.levels)).round() as i32
    }

    /// Bytes of a distance: a line through two steps leads at most 5 times as far as the steps go, the zigzag doubles.
    fn width(&self) -> usize {
        let bits = self.levels.ilog2() + 1;
        (bits as usize + 4).div_ceil(8)
    }
}

/// How a frame is guessed from those before it.
struct Guess {
    frame: usize,
    /// How far the line through the two before is followed, in units of their distance.
    ratio: f64,
}

impl Guess {
    fn new(at: &[f64], frame: usize) -> Self {
        let ratio = match (frame.checked_sub(2), frame.checked_sub(1)) {
            (Some(before), Some(last)) => {
                let ratio = (at[frame] - at[last]) / (at[last] - at[before]);
                if ratio > 0.0 && ratio <= LONGEST {
                    ratio
                } else {
                    0.0
                }
            }
            _ => 0.0,
        };
        Self { frame, ratio }
    }

    fn step(&self, steps: &[Vec<i32>], cell: usize) -> i32 {
        let last = match self.frame {
            0 => return 0,
            frame => steps[frame - 1][cell],
        };
        if self.ratio == 0.0 {
            return last;
        }
        let slope = f64::from(last) - f64::from(steps[self.frame - 2][cell]);
        last.wrapping_add((slope * self.ratio + 0.5).floor() as i32)
    }
}

/// Small magnitudes of both signs as small numbers.
fn zigzag(distance: i32) -> u32 {
    ((distance << 1) ^ (distance >> 31)) as u32
}

/// The lowest bytes of all numbers, then the next.
fn planes(numbers: &[u32], width: usize) -> Vec<u8> {
    let plane = |plane: usize| {
        let byte = move |number: &u32| (number >> (8 * plane)) as u8;
        numbers.iter().map(byte)
    };
    (0..width).flat_map(plane).collect()
}

/// A zlib stream.
pub(super) fn deflate(bytes: &[u8]) -> Vec<u8> {
    compress_to_vec_zlib(bytes, 9)
}

#[cfg(test)]
mod tests {
    use super::*;

    use miniz_oxide::inflate::decompress_to_vec_zlib;

    impl Packed {
        /// The values again, each within [`Packed::error_at`] of what was packed, as `page/unpack.js` reads them.
        pub(crate) fn unpack(&self, at: &[f64]) -> Vec<Vec<f64>> {
            let bytes = decompress_to_vec_zlib(&self.bytes).unwrap();
            let count = self.frames * self.cells;
            assert_eq!(bytes.len(), count * self.width());
            let distance = |index: usize| {
                let plane = |plane: usize| u32::from(bytes[plane * count + index]) << (8 * plane);
                let code: u32 = (0..self.width()).map(plane).sum();
                (code >> 1) as i32 ^ -((code & 1) as i32)
            };
            let mut steps: Vec<Vec<i32>> = Vec::with_capacity(self.frames);
            for frame in 0..self.frames {
                let guess = Guess::new(at, frame);
                let step = |cell: usize| {
                    distance(frame * self.cells + cell).wrapping_add(guess.step(&steps, cell))
                };
                let now = (0..self.cells).map(step).collect();
                steps.push(now);
            }
            let values = |steps: Vec<i32>| steps.into_iter().map(|step| self.value(step)).collect();
            steps.into_iter().map(values).collect()
        }

        /// Largest difference that packing makes to a value of this magnitude.
        pub(crate) fn error_at(&self, value: f64) -> f64 {
            let levels = f64::from(self.levels);
            // Half a step of the quantisation, and the rounding of the arithmetic.
            let half = match self.scale {
                Scale::Linear => 0.5 / levels,
                Scale::Root if self.top > 0.0 => {
                    ((value.abs() / self.top).sqrt() + 0.25 / levels) / levels
                }
                Scale::Root => 0.0,
            };
            self.top * (half + 4.0 * f64::EPSILON)
        }

        fn value(&self, step: i32) -> f64 {
            let share = f64::from(step) / f64::from(self.levels);
            match self.scale {
                Scale::Linear => share * self.top,
                Scale::Root => share * share.abs() * self.top,
            }
        }
    }

    /// Two bells that part, at uneven values.
    fn frames() -> (Vec<f64>, Vec<Vec<f64>>) {
        let at: Vec<f64> = (0..40)
            .map(|i| f64::from(i) * 0.05 + if i % 7 == 0 { 0.04 } else { 0.0 })
            .collect();
        let frame = |&at: &f64| -> Vec<f64> {
            let bell = |x: f64| (-x * x).exp() - 1e-9 * x;
            (0..200)
                .map(|i| f64::from(i) * 0.05 - 5.0)
                .map(|x| bell(x - at) + bell(x + at))
                .collect()
        };
        let frames = at.iter().map(frame).collect();
        (at, frames)
    }

    #[test]
    fn values_come_back_within_the_stated_error() {
        let (at, frames) = frames();
        let views: Vec<&[f64]> = frames.iter().map(Vec::as_slice).collect();
        for (scale, bits) in [
            (Scale::Linear, 24),
            (Scale::Root, 14),
            (Scale::Root, 8),
            (Scale::Linear, 28),
            (Scale::Root, 1),
        ] {
            let packed = Packed::new(&views, &at, scale, bits);
            let back = packed.unpack(&at);
            assert_eq!((back.len(), back[0].len()), (40, 200));
            let mut largest = 0.0f64;
            for (value, back) in frames.iter().flatten().zip(back.iter().flatten()) {
                let error = (value - back).abs();
                assert!(
                    error <= packed.error_at(*value),
                    "{scale:?} {bits}: {value} {back}"
                );
                largest = largest.max(error / packed.error_at(*value));
            }
            assert!(
                largest > 0.5,
                "the stated error is not far from the largest: {largest}"
            );
        }
    }

    #[test]
    fn a_smooth_sweep_takes_less_than_a_byte_a_value() {
        let (at, frames) = frames();
        let views: Vec<&[f64]> = frames.iter().map(Vec::as_slice).collect();
        let packed = Packed::new(&views, &at, Scale::Root, 12);
        assert!(packed.bytes.len() < 40 * 200, "{}", packed.bytes.len());
    }

    #[test]
    fn nothing_and_what_is_not_finite_can_be_packed() {
        let none = Packed::new(&[], &[], Scale::Root, 14);
        assert_eq!(none.unpack(&[]), Vec::<Vec<f64>>::new());
        let odd: &[f64] = &[f64::NAN, f64::INFINITY, -1.0, 1.0];
        let packed = Packed::new(&[odd], &[0.0], Scale::Root, 14);
        assert_eq!(packed.unpack(&[0.0]), [[0.0, 0.0, -1.0, 1.0]]);
        let zeros = Packed::new(&[&[0.0; 3]], &[0.0], Scale::Linear, 14);
        assert_eq!(zeros.unpack(&[0.0]), [[0.0; 3]]);
        // Alternating extremes at even steps are as far from the line as can be.
        let (up, down) = (&[1.0][..], &[-1.0][..]);
        let wild = Packed::new(
            &[up, down, up, down],
            &[0.0, 1.0, 3.0, 7.0],
            Scale::Linear,
            28,
        );
        let back = wild.unpack(&[0.0, 1.0, 3.0, 7.0]);
        assert_eq!(back, [[1.0], [-1.0], [1.0], [-1.0]]);
    }
}
