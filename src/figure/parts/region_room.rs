//! Where in the regions of a map there is room for words and small densities.

use crate::continuation::map::RegionPicture;

/// How far each pixel is from the border of its region, to the left and right, and up and down.
pub(crate) struct Room<'p> {
    picture: &'p RegionPicture,
    across: Vec<u32>,
    upright: Vec<u32>,
}

impl<'p> Room<'p> {
    pub(crate) fn new(picture: &'p RegionPicture) -> Self {
        let [width, height] = picture.size;
        let mut across = vec![0; picture.pixels.len()];
        let mut upright = vec![0; picture.pixels.len()];
        for row in 0..height {
            let line = (0..width).map(|column| row * width + column);
            run_lengths(&line.collect::<Vec<_>>(), &picture.pixels, &mut across);
        }
        for column in 0..width {
            let line = (0..height).map(|row| row * width + column);
            run_lengths(&line.collect::<Vec<_>>(), &picture.pixels, &mut upright);
        }
        Self {
            picture,
            across,
            upright,
        }
    }

    /// The column and row of a region at which words of this half width and half height have most room; `None` where
    /// they have too little.
    pub(crate) fn best(
        &self,
        region: usize,
        [half_width, half_height]: [f64; 2],
    ) -> Option<[usize; 2]> {
        let [width, height] = self.picture.size;
        let (reach, tall) = (half_width as usize, half_height as usize);
        let mut best: Option<(f64, usize)> = None;
        for (pixel, &owner) in self.picture.pixels.iter().enumerate() {
            if owner != region {
                continue;
            }
            let (column, row) = (pixel % width, pixel / width);
            if column < reach || column + reach >= width || row < tall || row + tall >= height {
                continue;
            }
            // The narrowest place up and down along the words, not only in their middle.
            let along = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| {
                let column = (column as f64 + share * half_width) as usize;
                self.upright[row * width + column.min(width - 1)]
            });
            let lowest = along.into_iter().min().unwrap_or(0);
            let score =
                (f64::from(self.across[pixel]) / half_width).min(f64::from(lowest) / half_height);
            if best.is_none_or(|(known, _)| score > known) {
                best = Some((score, pixel));
            }
        }
        let (_, pixel) = best.filter(|(score, _)| *score >= 1.0)?;
        Some([pixel % width, pixel / width])
    }
}

/// The picture with pixels on some lines taken from their regions, so that words keep off them; places are those of the
/// box with sides of length one.
pub(crate) fn parted_by(picture: &RegionPicture, lines: &[Vec<[f64; 2]>]) -> RegionPicture {
    let mut parted = picture.clone();
    let size = picture.size;
    for piece in lines.iter().flat_map(|line| line.windows(2)) {
        let [from, to] = [piece[0], piece[1]].map(|at| [0, 1].map(|k| at[k] * size[k] as f64));
        let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil();
        for step in 0..=steps as usize {
            let share = step as f64 / steps.max(1.0);
            let [column, row] = [0, 1].map(|k| {
                let at = from[k] + share * (to[k] - from[k]);
                (at.max(0.0) as usize).min(size[k] - 1)
            });
            parted.pixels[row * size[0] + column] = usize::MAX;
        }
    }
    parted
}

/// For the pixels of a line, the distance to the nearer end of the run of one region that each is in.
fn run_lengths(line: &[usize], owners: &[usize], lengths: &mut [u32]) {
    for run in line.chunk_by(|&a, &b| owners[a] == owners[b]) {
        for (index, &pixel) in run.iter().enumerate() {
            lengths[pixel] = index.min(run.len() - 1 - index) as u32;
        }
    }
}
