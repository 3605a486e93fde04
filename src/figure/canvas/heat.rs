//! Heat maps as small indexed PNGs: one embedded picture instead of a rectangle a cell, so that a figure of
//! 500² cells stays small. Resampled by nearest cell where cells differ in width.

use super::look::Look;
use super::png::{self, Pixels};

/// Palette entry of places without a value; it is transparent.
const NOTHING: u8 = 255;
/// Colours of the scale.
const COLOURS: usize = 255;

/// A picture of a few colours, rows from the upper one downward.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    /// Columns and rows.
    pub(super) size: (usize, usize),
    /// Red, green, blue and opacity, which is none or all, of each number.
    pub(super) palette: Vec<[u8; 4]>,
    /// The number of each pixel's colour.
    pub(super) numbers: Vec<u8>,
}

impl Picture {
    /// A picture of values, in the colours of a look: its pixel `(column, row)`, counted from the **lower** left, has
    /// the share (0 to 1) of the largest value that `share` gives; `None` and NaN are left transparent.
    pub(crate) fn new(
        look: &Look,
        size: (usize, usize),
        share: impl Fn(usize, usize) -> Option<f64>,
    ) -> Self {
        let colours = (0..COLOURS).map(|number| {
            let (r, g, b) = look.colours.colour(number as f64 / (COLOURS - 1) as f64);
            [r, g, b, 255]
        });
        let number = |column: usize, row: usize| match share(column, row) {
            Some(share) if !share.is_nan() => {
                let along = look.along_colours(share).clamp(0.0, 1.0);
                (along * (COLOURS - 1) as f64).round() as u8
            }
            _ => NOTHING,
        };
        Self {
            size,
            palette: colours.chain([[255, 255, 255, 0]]).collect(),
            numbers: pixels(size, number),
        }
    }

    /// All colours from the first to the last, upward.
    pub(crate) fn ramp(look: &Look) -> Self {
        let linear = Look {
            is_logarithmic: false,
            ..*look
        };
        let last = (COLOURS - 1) as f64;
        Self::new(&linear, (1, COLOURS), |_, row| Some(row as f64 / last))
    }

    /// A picture of areas, each of one colour: the pixel `(column, row)`, counted from the **lower** left, has the
    /// colour with the number that `number` gives, of at most 256.
    pub(crate) fn patches(
        size: (usize, usize),
        colours: &[(u8, u8, u8)],
        number: impl Fn(usize, usize) -> usize,
    ) -> Self {
        let last = colours.len().saturating_sub(1);
        Self {
            size,
            palette: colours.iter().map(|&(r, g, b)| [r, g, b, 255]).collect(),
            numbers: pixels(size, |column, row| number(column, row).min(last) as u8),
        }
    }

    /// The picture as an indexed PNG.
    pub(super) fn png(&self) -> Vec<u8> {
        let size = (self.size.0 as u32, self.size.1 as u32);
        png::encode(size, &Pixels::Palette(&self.palette), &self.numbers)
    }
}

/// The numbers of all pixels, rows from the upper one downward.
fn pixels((width, height): (usize, usize), number: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let rows = (0..height).rev();
    let places = rows.flat_map(|row| (0..width).map(move |column| (column, row)));
    places.map(|(column, row)| number(column, row)).collect()
}

/// For each of `count` pixels over `from..to`, the interval of `edges` (ascending) that holds its middle.
pub(crate) fn nearest(edges: &[f64], (from, to): (f64, f64), count: usize) -> Vec<usize> {
    let last = edges.len().saturating_sub(2);
    (0..count)
        .map(|pixel| {
            let middle = from + (to - from) * (pixel as f64 + 0.5) / count as f64;
            let below = edges.partition_point(|&edge| edge <= middle);
            below.saturating_sub(1).min(last)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_start_at_the_lower_left_and_leave_gaps_transparent() {
        let share = |column: usize, row: usize| match (column, row) {
            (0, 0) => Some(0.0),
            (1, 1) => Some(1.0),
            (1, 0) => Some(f64::NAN),
            _ => None,
        };
        let look = Look::default();
        let picture = Picture::new(&look, (2, 2), share);
        assert_eq!(picture.numbers, [NOTHING, 254, 0, NOTHING]);
        let file = picture.png();
        let mut decoder = ::png::Decoder::new(std::io::Cursor::new(&file));
        decoder.set_transformations(::png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels[3], 0);
        let (r, g, b) = look.colours.colour(1.0);
        assert_eq!(pixels[4..8], [r, g, b, 255]);
        let (r, g, b) = look.colours.colour(0.0);
        assert_eq!(pixels[8..12], [r, g, b, 255]);
    }

    #[test]
    fn pixels_take_the_cell_that_holds_their_middle() {
        let edges = [0.0, 0.1, 0.5, 1.0];
        assert_eq!(nearest(&edges, (0.0, 1.0), 5), [1, 1, 2, 2, 2]);
        assert_eq!(nearest(&edges, (0.0, 1.0), 20)[..3], [0, 0, 1]);
    }
}
