//! Regions of one signature: every place of the box belongs to the nearest node that no curve parts it from.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::found::{MapNode, RegimeMap};
use crate::continuation::curve::distance;
use crate::numerics::sort_descending;
use crate::topology::Signature;

/// Nodes nearer to a curve than this share of the distance between coarse nodes tell nothing of its sides: features are
/// counted a little later than they are born.
const BESIDE: f64 = 0.75;
/// No region.
const NONE: u32 = u32::MAX;

/// A connected region of one signature.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// The signature of one observable there; `None` where there is no density.
    pub signature: Option<Signature>,
    /// Its share of the box.
    pub share: f64,
    /// Values of both parameters at a place well inside.
    pub inside: [f64; 2],
    /// How far that place is from the region's border, in sides of the box.
    pub room: f64,
}

/// The regions of one observable as a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionPicture {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The region of every pixel, rows from the lower end of the second parameter upward.
    pub pixels: Vec<usize>,
    /// The regions, the largest first.
    pub regions: Vec<Region>,
}

impl RegimeMap {
    /// The regions of an observable (by its place in
    /// [`Subject::observables`](crate::continuation::Subject::observables)), in a picture of so many columns and rows;
    /// `None` without a node, or a picture of nothing.
    pub fn regions(&self, observable: usize, size: [usize; 2]) -> Option<RegionPicture> {
        if self.nodes.is_empty() || size.contains(&0) {
            return None;
        }
        let signature = |node: &MapNode| node.signatures.get(observable).copied();
        let mut kinds: Vec<Option<Signature>> = Vec::new();
        let seeds = self.nodes.iter().map(|node| {
            let signature = signature(node);
            let known = kinds.iter().position(|one| *one == signature);
            let kind = known.unwrap_or_else(|| {
                kinds.push(signature);
                kinds.len() - 1
            });
            let place = self.plane.place(node.values);
            Seed { place, kind }
        });
        let seeds: Vec<Seed> = seeds.collect();
        let flooded = flood(size, &self.lines(observable), &seeds, self.smallest_cell());
        let region = |one: &FloodedRegion| Region {
            signature: kinds.get(one.kind).copied().flatten(),
            share: one.share,
            inside: self.plane.values(one.inside),
            room: one.room,
        };
        Some(RegionPicture {
            size,
            regions: flooded.regions.iter().map(region).collect(),
            pixels: flooded.pixels,
        })
    }

    /// The curves of an observable in the box with sides of length one.
    fn lines(&self, observable: usize) -> Vec<Vec<[f64; 2]>> {
        let of_it = |curve: &&crate::continuation::curve::Curve| {
            self.place_of(curve.observable) == Some(observable)
        };
        let curves = self.curves.iter().filter(of_it);
        curves
            .map(|curve| {
                let points = curve.points.iter();
                points.map(|point| self.plane.place(point.values)).collect()
            })
            .collect()
    }

    /// The longer side of the smallest cell, in sides of the box.
    fn smallest_cell(&self) -> f64 {
        let longer =
            (self.cells.iter()).map(|[low, high]| (high[0] - low[0]).max(high[1] - low[1]));
        longer.fold(f64::INFINITY, f64::min).min(1.0)
    }
}

/// A node of a known kind, in the box with sides of length one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seed {
    pub(crate) place: [f64; 2],
    pub(crate) kind: usize,
}

/// Regions of places in the box with sides of length one.
#[derive(Debug)]
pub(crate) struct Flooded {
    /// The region of every pixel, rows from the lower end of the second parameter upward.
    pub(crate) pixels: Vec<usize>,
    /// The regions, the largest first.
    pub(crate) regions: Vec<FloodedRegion>,
}

/// Places of one kind that hang together.
#[derive(Debug, Clone)]
pub(crate) struct FloodedRegion {
    pub(crate) kind: usize,
    /// Share of the box.
    pub(crate) share: f64,
    /// A place well inside.
    pub(crate) inside: [f64; 2],
    /// How far that is from the border.
    pub(crate) room: f64,
}

/// Gives every pixel of a picture to the nearest seed that no line parts it from; `smallest` is the longer side of the
/// smallest cell between the seeds. Pixels of one kind that hang together are a region.
pub(crate) fn flood(
    size: [usize; 2],
    lines: &[Vec<[f64; 2]>],
    seeds: &[Seed],
    smallest: f64,
) -> Flooded {
    let canvas = Canvas { size };
    let walls = canvas.walls(lines);
    let seeds = seeds.iter().map(|seed| {
        let is_beside = (lines.iter()).any(|line| distance(line, seed.place) < BESIDE * smallest);
        (canvas.pixel(seed.place), seed.kind as u32, is_beside)
    });
    let owners = canvas.owners(&walls, &seeds.collect::<Vec<_>>());
    let (mut pixels, count) = canvas.components(&owners);
    let depth = canvas.depth(&pixels);
    let total = pixels.len() as f64;
    let shorter = size[0].min(size[1]) as f64;
    let none = FloodedRegion {
        kind: NONE as usize,
        share: 0.0,
        inside: [0.0; 2],
        room: -1.0,
    };
    let mut regions = vec![none; count];
    for (pixel, &region) in pixels.iter().enumerate() {
        let room = f64::from(depth[pixel]) / shorter;
        let region = &mut regions[region];
        region.kind = owners[pixel] as usize;
        region.share += 1.0 / total;
        if room > region.room {
            region.room = room;
            region.inside = canvas.middle(pixel);
        }
    }
    let mut order: Vec<usize> = (0..count).collect();
    sort_descending(&mut order, |&place| regions[place].share);
    let mut place = vec![0; count];
    (order.iter().enumerate()).for_each(|(new, &old)| place[old] = new);
    pixels.iter_mut().for_each(|pixel| *pixel = place[*pixel]);
    Flooded {
        pixels,
        regions: order.into_iter().map(|old| regions[old].clone()).collect(),
    }
}

/// Pixels over the box with sides of length one.
struct Canvas {
    size: [usize; 2],
}

impl Canvas {
    fn pixel(&self, place: [f64; 2]) -> usize {
        let [column, row] = [0, 1].map(|k| {
            let pixel = (place[k].clamp(0.0, 1.0) * self.size[k] as f64) as usize;
            pixel.min(self.size[k] - 1)
        });
        row * self.size[0] + column
    }

    fn middle(&self, pixel: usize) -> [f64; 2] {
        let at = [pixel % self.size[0], pixel / self.size[0]];
        [0, 1].map(|k| (at[k] as f64 + 0.5) / self.size[k] as f64)
    }

    fn neighbours(&self, pixel: usize) -> impl Iterator<Item = usize> {
        let [width, height] = self.size;
        let (column, row) = (pixel % width, pixel / width);
        let all = [
            (column > 0).then(|| pixel - 1),
            (column + 1 < width).then_some(pixel + 1),
            (row > 0).then(|| pixel - width),
            (row + 1 < height).then_some(pixel + width),
        ];
        all.into_iter().flatten()
    }

    /// Pixels that lines run through, so densely that no way from pixel to neighbour leads across.
    fn walls(&self, lines: &[Vec<[f64; 2]>]) -> Vec<bool> {
        let mut walls = vec![false; self.size[0] * self.size[1]];
        let fine = 3.0 * self.size[0].max(self.size[1]) as f64;
        for piece in lines.iter().flat_map(|line| line.windows(2)) {
            let [a, b] = [piece[0], piece[1]];
            let steps = (fine * (b[0] - a[0]).hypot(b[1] - a[1])).ceil().max(1.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                walls[self.pixel([0, 1].map(|k| a[k] + share * (b[k] - a[k])))] = true;
            }
        }
        walls
    }

    /// The kind of the nearest seed for every pixel, by ways that cross no wall. Seeds beside a wall count where no
    /// other leads, and walls fall to either side.
    fn owners(&self, walls: &[bool], seeds: &[(usize, u32, bool)]) -> Vec<u32> {
        let mut owners = vec![NONE; walls.len()];
        let of = |beside: bool| {
            let seeds = seeds.iter().filter(move |seed| seed.2 == beside);
            seeds.map(|&(pixel, kind, _)| (pixel, kind))
        };
        self.flood(&mut owners, Some(walls), of(false));
        self.flood(&mut owners, Some(walls), of(true));
        let owned = owners.clone();
        let rest = owned.into_iter().enumerate().filter(|one| one.1 != NONE);
        self.flood(&mut owners, None, rest);
        owners
    }

    fn flood(
        &self,
        owners: &mut [u32],
        walls: Option<&[bool]>,
        seeds: impl Iterator<Item = (usize, u32)>,
    ) {
        // Steps and the seed's pixel make the order whole, so that ties fall alike always.
        let mut open: BinaryHeap<Reverse<(u32, usize, usize, u32)>> = BinaryHeap::new();
        for (pixel, kind) in seeds {
            if owners[pixel] == NONE || walls.is_none() {
                open.push(Reverse((0, pixel, pixel, kind)));
            }
        }
        let mut reached = vec![false; owners.len()];
        while let Some(Reverse((steps, seed, pixel, kind))) = open.pop() {
            if reached[pixel] || (owners[pixel] != NONE && steps > 0) {
                continue;
            }
            reached[pixel] = true;
            owners[pixel] = kind;
            if walls.is_some_and(|walls| walls[pixel]) {
                continue;
            }
            for next in self.neighbours(pixel) {
                if !reached[next] && owners[next] == NONE {
                    open.push(Reverse((steps + 1, seed, next, kind)));
                }
            }
        }
    }

    /// Numbers of the regions of pixels that hang together, and how many there are.
    fn components(&self, owners: &[u32]) -> (Vec<usize>, usize) {
        let mut numbers = vec![usize::MAX; owners.len()];
        let mut count = 0;
        for first in 0..owners.len() {
            if numbers[first] != usize::MAX {
                continue;
            }
            let mut open = vec![first];
            numbers[first] = count;
            while let Some(pixel) = open.pop() {
                for next in self.neighbours(pixel) {
                    if numbers[next] == usize::MAX && owners[next] == owners[pixel] {
                        numbers[next] = count;
                        open.push(next);
                    }
                }
            }
            count += 1;
        }
        (numbers, count)
    }

    /// Steps from every pixel to the border of its region, or of the picture.
    fn depth(&self, numbers: &[usize]) -> Vec<u32> {
        let mut depth = vec![u32::MAX; numbers.len()];
        let is_border = |pixel: usize| {
            let mut count = 0;
            let inner = self.neighbours(pixel).all(|next| {
                count += 1;
                numbers[next] == numbers[pixel]
            });
            !inner || count < 4
        };
        let mut front: Vec<usize> = (0..numbers.len())
            .filter(|&pixel| is_border(pixel))
            .collect();
        front.iter().for_each(|&pixel| depth[pixel] = 0);
        let mut steps = 0;
        while !front.is_empty() {
            steps += 1;
            let mut next_front = Vec::new();
            for &pixel in &front {
                for next in self.neighbours(pixel) {
                    if depth[next] == u32::MAX {
                        depth[next] = steps;
                        next_front.push(next);
                    }
                }
            }
            front = next_front;
        }
        depth
    }
}

#[cfg(test)]
mod tests;
