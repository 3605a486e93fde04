//! Pixels as a PNG (ISO/IEC 15948): 8 bits a channel, colours themselves or places in a palette.

use miniz_oxide::deflate::compress_to_vec_zlib;

/// What a pixel's bytes are.
pub(super) enum Pixels<'a> {
    /// Red, green, blue; so many pixels to a metre.
    Colours(u32),
    /// The number of a red, green, blue and opacity.
    Palette(&'a [[u8; 4]]),
}

/// Filters, which a row begins with: its bytes as they are, or their differences from those of the row above.
const UNCHANGED: u8 = 0;
const FROM_ABOVE: u8 = 2;

/// Rows of pixels, from the upper one downward, as a PNG.
pub(super) fn encode((width, height): (u32, u32), pixels: &Pixels<'_>, bytes: &[u8]) -> Vec<u8> {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    // The last tenth of a large file's size would take as long as all the rest.
    let (channels, kind, level) = match pixels {
        Pixels::Colours(_) => (3, 2, 6),
        Pixels::Palette(_) => (1, 3, 9),
    };
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    chunk(
        &mut file,
        b"IHDR",
        &[&size[..], &[8, kind, 0, 0, 0]].concat(),
    );
    let rows = bytes.chunks((channels * width as usize).max(1));
    let mut data = Vec::with_capacity(bytes.len() + height as usize);
    match pixels {
        Pixels::Colours(metre) => {
            let metre = metre.to_be_bytes();
            chunk(&mut file, b"pHYs", &[&metre[..], &metre, &[1]].concat());
            // Areas of one colour are shortest as they are: differences between rows or pixels make files longer.
            rows.for_each(|row| data.extend(std::iter::once(&UNCHANGED).chain(row)));
        }
        Pixels::Palette(colours) => {
            let opaque = colours.iter().flat_map(|&[r, g, b, _]| [r, g, b]);
            chunk(&mut file, b"PLTE", &opaque.collect::<Vec<u8>>());
            let opacity = colours.iter().map(|&[_, _, _, alpha]| alpha);
            chunk(&mut file, b"tRNS", &opacity.collect::<Vec<u8>>());
            // Rows of a map repeat: differences from the row above are zeros.
            let mut above = vec![0; width as usize];
            for row in rows {
                data.push(FROM_ABOVE);
                data.extend(
                    row.iter()
                        .zip(&above)
                        .map(|(one, other)| one.wrapping_sub(*other)),
                );
                above = row.to_vec();
            }
        }
    }
    chunk(&mut file, b"IDAT", &compress_to_vec_zlib(&data, level));
    chunk(&mut file, b"IEND", &[]);
    file
}

/// A chunk: its length, its name, its bytes, and their check.
fn chunk(file: &mut Vec<u8>, name: &[u8; 4], bytes: &[u8]) {
    file.extend((bytes.len() as u32).to_be_bytes());
    file.extend(name);
    file.extend(bytes);
    let check = name.iter().chain(bytes).fold(!0, |check: u32, &byte| {
        TABLE[usize::from(check as u8 ^ byte)] ^ (check >> 8)
    });
    file.extend((!check).to_be_bytes());
}

/// What the cyclic redundancy check (ISO 3309) makes of each byte.
const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut check = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            check = if check & 1 == 1 {
                0xedb8_8320 ^ (check >> 1)
            } else {
                check >> 1
            };
            bit += 1;
        }
        table[byte] = check;
        byte += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    /// What another reader finds: header, pixels as red, green, blue (and opacity).
    fn read(file: &[u8]) -> (png::Info<'static>, Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().clone(), pixels)
    }

    #[test]
    fn colours_come_back_with_their_resolution() {
        let bytes: Vec<u8> = (0..3 * 7 * 5).map(|byte| (31 * byte) as u8).collect();
        let (info, pixels) = read(&encode((7, 5), &Pixels::Colours(11811), &bytes));
        assert_eq!((info.width, info.height, pixels), (7, 5, bytes));
        let metre = info.pixel_dims.unwrap();
        assert_eq!(
            (metre.xppu, metre.yppu, metre.unit),
            (11811, 11811, png::Unit::Meter)
        );
    }

    #[test]
    fn numbers_come_back_as_colours_of_the_palette() {
        let palette = [[1, 2, 3, 255], [40, 50, 60, 0], [7, 8, 9, 255]];
        let numbers = [0, 1, 2, 2, 2, 1];
        let (info, pixels) = read(&encode((3, 2), &Pixels::Palette(&palette), &numbers));
        assert_eq!((info.width, info.height), (3, 2));
        let expected = numbers.map(|number| palette[usize::from(number)]).concat();
        assert_eq!(pixels, expected);
    }
}
