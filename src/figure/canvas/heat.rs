//! Heat maps as small indexed PNGs: one embedded picture instead of a rectangle a cell, so that a figure of
//! 500² cells stays small. Resampled by nearest cell where cells differ in width.

use super::look::Look;
use crate::figure::FigureError;

/// Palette entry of places without a value; it is transparent.
const NOTHING: u8 = 255;
/// Colours of the scale.
const COLOURS: usize = 255;

/// A picture of values: `width × height`, from the upper left, rows downward.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    width: usize,
    height: usize,
    indices: Vec<u8>,
}

impl Picture {
    /// A picture whose pixel `(column, row)`, counted from the **lower** left, has the share (0 to 1) of the
    /// largest value that `share` gives; `None` and NaN are left transparent.
    pub(crate) fn new(
        (width, height): (usize, usize),
        share: impl Fn(usize, usize) -> Option<f64>,
    ) -> Self {
        let index = |column: usize, row: usize| match share(column, row) {
            Some(share) if !share.is_nan() => {
                (share.clamp(0.0, 1.0) * (COLOURS - 1) as f64).round() as u8
            }
            _ => NOTHING,
        };
        let rows = (0..height).rev();
        let indices = rows.flat_map(|row| (0..width).map(move |column| (column, row)));
        Self {
            width,
            height,
            indices: indices.map(|(column, row)| index(column, row)).collect(),
        }
    }

    /// The picture as an indexed PNG.
    ///
    /// # Errors
    /// [`FigureError::Png`].
    pub(crate) fn png(&self, look: &Look) -> Result<Vec<u8>, FigureError> {
        let mut palette = Vec::with_capacity(3 * COLOURS + 3);
        for colour in 0..COLOURS {
            let (r, g, b) = look.colours.colour(colour as f64 / (COLOURS - 1) as f64);
            palette.extend([r, g, b]);
        }
        palette.extend([255, 255, 255]);
        let mut opacity = vec![255; COLOURS];
        opacity.push(0);
        encode((self.width, self.height), palette, opacity, &self.indices)
    }
}

/// A picture of areas, each of one colour, as an indexed PNG: the pixel `(column, row)`, counted from the **lower**
/// left, has the colour with the number that `number` gives, of at most 256.
///
/// # Errors
/// [`FigureError::Png`].
pub(crate) fn patches(
    (width, height): (usize, usize),
    colours: &[(u8, u8, u8)],
    number: impl Fn(usize, usize) -> usize,
) -> Result<Vec<u8>, FigureError> {
    let palette = colours.iter().flat_map(|&(r, g, b)| [r, g, b]).collect();
    let rows = (0..height).rev();
    let pixels = rows.flat_map(|row| (0..width).map(move |column| (column, row)));
    let last = colours.len().saturating_sub(1);
    let indices: Vec<u8> = pixels
        .map(|(column, row)| number(column, row).min(last) as u8)
        .collect();
    encode((width, height), palette, vec![255; colours.len()], &indices)
}

/// Pixels that are places in a palette, rows from the upper one downward.
fn encode(
    (width, height): (usize, usize),
    palette: Vec<u8>,
    opacity: Vec<u8>,
    indices: &[u8],
) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette);
    encoder.set_trns(opacity);
    encoder.set_compression(png::Compression::High);
    // Rows of a map repeat: the filter `up` turns them into zeros.
    encoder.set_filter(png::Filter::Up);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(indices)?;
    writer.finish()?;
    Ok(bytes)
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
        let picture = Picture::new((2, 2), share);
        assert_eq!(picture.indices, [NOTHING, 254, 0, NOTHING]);
        let look = Look::default();
        let png = picture.png(&look).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&png));
        decoder.set_transformations(png::Transformations::EXPAND);
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
