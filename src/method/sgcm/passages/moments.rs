//! What the paths of a cell are counted by: moments of where they start and where they end, and of what they met.
//!
//! A function of the state is linear in each cell, c_0 + Σ_a c_a u_a with u_a from -½ to ½ across it. Of a path that
//! starts at u and ends at v in another cell the products of (1, u) and (1, v) are summed, of one that has entered the
//! region those of (1, u) and what is known of it.

use std::collections::HashMap;

use crate::MAX_DIMENSION;
use crate::monte_carlo::PathEnd;

/// Numbers of a linear function at most.
pub(super) const WIDEST: usize = MAX_DIMENSION + 1;

/// (1, u).
pub(super) type Basis = [f64; WIDEST];

/// Places of what is always known of a path among its numbers: the time it spent in the map step, the square of that,
/// and whether it has entered the region. Shares of exits and looks come behind.
pub(super) const SPENT: usize = 0;
pub(super) const SQUARE: usize = 1;
pub(super) const ENDED: usize = 2;
pub(super) const EXITS: usize = 3;

/// What is asked of every path.
#[derive(Debug, Clone)]
pub(super) struct Asked {
    pub(super) map_step: f64,
    /// Parts of the region.
    pub(super) exits: usize,
    /// Times within the map step at which it is asked whether a path still goes on, ascending.
    pub(super) looks: Vec<f64>,
}

impl Asked {
    /// How many numbers are known of a path.
    pub(super) fn count(&self) -> usize {
        EXITS + self.exits + self.looks.len()
    }

    fn tell(&self, end: &PathEnd, numbers: &mut Vec<f64>) {
        numbers.clear();
        let spent = end.time.min(self.map_step);
        let has_ended = end.time.is_finite();
        numbers.extend([spent, spent * spent, f64::from(u8::from(has_ended))]);
        let is_exit = |part| has_ended && end.exit == part;
        numbers.extend((0..self.exits).map(|part| f64::from(u8::from(is_exit(part)))));
        let goes_on = |look: &f64| f64::from(u8::from(end.time > *look));
        numbers.extend(self.looks.iter().map(goes_on));
    }
}

/// (1, u) of a place in a cell.
pub(super) fn basis(place: &[f64; MAX_DIMENSION]) -> Basis {
    let mut basis = [1.0; WIDEST];
    basis[1..].copy_from_slice(place);
    basis
}

/// Sums over the paths of a cell that belong together.
#[derive(Debug, Clone, Default)]
pub(super) struct Moments {
    /// Cells in which they end, ascending.
    pub(super) ends: Vec<u32>,
    /// Σ (1, u) ⊗ (1, v) of each, by rows.
    pub(super) blocks: Vec<f32>,
    /// Σ (1, u) ⊗ (1, u).
    pub(super) gram: Vec<f64>,
    /// Σ (1, u) times each number that is known of a path.
    pub(super) told: Vec<f64>,
    pub(super) paths: usize,
}

/// Moments in the making.
pub(super) struct Collector<'a> {
    asked: &'a Asked,
    width: usize,
    places: HashMap<u32, usize>,
    blocks: Vec<f64>,
    moments: Moments,
    numbers: Vec<f64>,
}

impl<'a> Collector<'a> {
    pub(super) fn new(asked: &'a Asked, dimension: usize) -> Self {
        let width = dimension + 1;
        Self {
            asked,
            width,
            places: HashMap::new(),
            blocks: Vec::new(),
            moments: Moments {
                gram: vec![0.0; width * width],
                told: vec![0.0; width * asked.count()],
                ..Moments::default()
            },
            numbers: Vec::new(),
        }
    }

    /// Counts a path from its start to its end, and to the cell in which it is there unless it has entered the region.
    pub(super) fn add(&mut self, start: &Basis, end: &PathEnd, cell: Option<(u32, Basis)>) {
        let width = self.width;
        self.asked.tell(end, &mut self.numbers);
        let moments = &mut self.moments;
        moments.paths += 1;
        let count = self.numbers.len();
        for p in 0..width {
            for q in 0..width {
                moments.gram[p * width + q] += start[p] * start[q];
            }
            let told = &mut moments.told[p * count..(p + 1) * count];
            for (sum, number) in told.iter_mut().zip(&self.numbers) {
                *sum += start[p] * number;
            }
        }
        let Some((cell, end)) = cell else {
            return;
        };
        let next = self.places.len();
        let place = *self.places.entry(cell).or_insert(next);
        if place == next {
            self.blocks.resize((next + 1) * width * width, 0.0);
        }
        let block = &mut self.blocks[place * width * width..];
        for p in 0..width {
            for q in 0..width {
                block[p * width + q] += start[p] * end[q];
            }
        }
    }

    pub(super) fn finish(self) -> Moments {
        let mut ends: Vec<(u32, usize)> = self.places.into_iter().collect();
        ends.sort_unstable();
        let size = self.width * self.width;
        let block = |&(_, place): &(u32, usize)| &self.blocks[place * size..(place + 1) * size];
        let blocks = ends.iter().flat_map(block).map(|&sum| sum as f32).collect();
        Moments {
            blocks,
            ends: ends.iter().map(|end| end.0).collect(),
            ..self.moments
        }
    }
}
