//! Samples put in the order of the cells in which they ended.

/// Most bits of a number by which samples are sorted at once.
const MOST_BITS: u32 = 8;

/// Sorts samples by end cell, those of a cell in the order in which they came. A sample is its end cell, `largest` at
/// most, above 32 bits that are left alone. It is a radix sort: one pass for each group of bits of a cell's number.
pub(super) fn sort_by_cell(samples: &mut Vec<u64>, room: &mut Vec<u64>, largest: usize) {
    let bits = usize::BITS - largest.leading_zeros();
    let passes = bits.div_ceil(MOST_BITS);
    room.resize(samples.len(), 0);
    for pass in 0..passes {
        let width = bits.div_ceil(passes);
        let part = |sample: u64| (sample >> (32 + pass * width)) as usize & ((1 << width) - 1);
        let mut places = [0_usize; 1 << MOST_BITS];
        for &sample in samples.iter() {
            places[part(sample)] += 1;
        }
        let mut sum = 0;
        for place in &mut places {
            sum += std::mem::replace(place, sum);
        }
        for &sample in samples.iter() {
            let place = &mut places[part(sample)];
            room[*place] = sample;
            *place += 1;
        }
        std::mem::swap(samples, room);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::mix;

    #[test]
    fn samples_are_sorted_whatever_the_number_of_cells() {
        for largest in [0, 1, 255, 256, 3600, 70_000, (1 << 24) + 5, (1 << 32) - 2] {
            let cell = |sample: u64| mix(sample) % (largest as u64 + 1);
            let mut samples: Vec<u64> = (0..1000).map(|k| cell(k) << 32 | k).collect();
            samples.push((largest as u64) << 32 | 1000);
            let mut expected = samples.clone();
            expected.sort_unstable();
            sort_by_cell(&mut samples, &mut Vec::new(), largest);
            assert_eq!(samples, expected, "{largest}");
        }
    }
}
