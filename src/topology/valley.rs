//! Valleys of a joint density: from the saddles between two peaks downhill on either side.

use super::FeatureKind;
use super::critical::Critical;
use super::field::{Field, Jet};
use crate::density::EstimatedDensity;

/// Length of a step, in cells.
const STEP: f64 = 0.5;

/// Share of a step that has to lead on along the direction of the valley at its saddle.
const PROGRESS: f64 = 0.1;

/// Nodes on either side of a saddle.
const NODES: usize = 24;

/// Directions in which the way down from a saddle is looked for, over half a turn.
const DIRECTIONS: usize = 36;

/// How far away it is looked for, in cells.
const LOOK: f64 = 1.5;

/// Points on either side of one whose errors are taken for its own.
const BESIDE: usize = 6;

/// Cells within which a higher one is looked for from a maximum of cells that is no peak.
const REACH: usize = 4;

/// Cells from a peak at which a climb is there.
const ARRIVED: f64 = 2.0;

/// A valley between the basins of two peaks.
pub(super) struct Valley {
    /// Its saddle.
    pub(super) origin: [f64; 2],
    /// Its direction there, in units of the standard deviations.
    pub(super) direction: [f64; 2],
    pub(super) nodes: Vec<Node>,
}

/// A point of a border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    /// The distance from the saddle along the direction of the valley, or the angle.
    pub(super) along: f64,
    /// The distance from the line through the saddle in this direction, or from the point inside.
    pub(super) across: f64,
    /// By how much that may be off.
    pub(super) error: f64,
}

/// A joint density in which valleys are followed.
pub(super) struct Trace<'a> {
    field: &'a Field<'a>,
    /// Standard deviations of the axes.
    pub(super) units: [f64; 2],
    /// The height up to which the density is not known.
    negligible: f64,
    columns: usize,
}

/// What a valley is followed by: the order of the reconstruction, and the values of the cells.
type Look<'a> = (usize, &'a [f64]);

impl<'a> Trace<'a> {
    /// `None` where a standard deviation is zero.
    pub(super) fn new(field: &'a Field<'a>, estimated: &EstimatedDensity) -> Option<Self> {
        let masses = estimated.density.masses();
        let whole: f64 = masses.iter().sum();
        let mean = |of: &dyn Fn(&[f64]) -> f64| {
            let all = masses.iter().enumerate();
            all.map(|(cell, mass)| mass * of(&field.centre(cell)))
                .sum::<f64>()
                / whole
        };
        let deviation = |k: usize| {
            let centre = mean(&|at| at[k]);
            mean(&|at| (at[k] - centre).powi(2)).sqrt()
        };
        let units = [deviation(0), deviation(1)];
        let columns = field.axes().last()?.count();
        let negligible = estimated.negligible_height() * estimated.density.maximum();
        (units[0] > 0.0 && units[1] > 0.0).then_some(Self {
            field,
            units,
            negligible,
            columns,
        })
    }

    /// The peak to which each cell climbs, from neighbour to neighbour.
    pub(super) fn climbs(&self, peaks: &[[f64; 2]]) -> Vec<Option<usize>> {
        let cells = self.field.values().len();
        let mut known: Vec<Option<Option<usize>>> = vec![None; cells];
        for cell in 0..cells {
            let mut path = vec![cell];
            let end = loop {
                let at = path[path.len() - 1];
                if let Some(known) = known[at] {
                    break known;
                }
                match self.higher(at, 1).or_else(|| self.higher(at, REACH)) {
                    Some(next) if self.arrived(at, peaks).is_none() => path.push(next),
                    _ => break self.arrived(at, peaks),
                }
            };
            path.into_iter().for_each(|one| known[one] = Some(end));
        }
        known.into_iter().map(Option::flatten).collect()
    }

    /// The highest cell within so many, where it is higher than the cell itself.
    fn higher(&self, cell: usize, reach: usize) -> Option<usize> {
        let values = self.field.values();
        let best = self
            .window(cell, reach)
            .max_by(|&a, &b| values[a].total_cmp(&values[b]))?;
        (values[best] > values[cell]).then_some(best)
    }

    /// Cells within so many of a cell, along both axes.
    fn window(&self, cell: usize, reach: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.field.values().len() / self.columns);
        let near =
            move |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
        let (row, column) = (cell / columns, cell % columns);
        near(row, rows)
            .flat_map(move |row| near(column, columns).map(move |one| row * columns + one))
    }

    /// The peak that a cell is at.
    fn arrived(&self, cell: usize, peaks: &[[f64; 2]]) -> Option<usize> {
        let centre = self.field.centre(cell);
        let off = |peak: &[f64; 2]| {
            let of = |k: usize| {
                let width = self.field.cell_width(k, centre[k]) * self.field.unit(k);
                (peak[k] - centre[k]).abs() / width
            };
            of(0).max(of(1))
        };
        let nearest = peaks
            .iter()
            .map(off)
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|one| one.1 <= ARRIVED).map(|one| one.0)
    }

    /// The valleys between a peak and others, from what each cell climbs to; `None` where one cannot be followed. Where
    /// several saddles part the same two, the valley of the highest is followed.
    pub(super) fn valleys(&self, own: usize, climbs: &[Option<usize>]) -> Option<Vec<Valley>> {
        let values = self.field.values();
        let mut highest: Vec<([usize; 2], usize)> = Vec::new();
        for (cell, part) in climbs.iter().enumerate() {
            let Some(part) = *part else { continue };
            for other in self.window(cell, 1) {
                let Some(beyond) = climbs[other].filter(|&beyond| beyond > part) else {
                    continue;
                };
                // The way from one to the other is no higher than the lower of both.
                let pass = if values[cell] < values[other] {
                    cell
                } else {
                    other
                };
                let parts = [part, beyond];
                match highest.iter_mut().find(|one| one.0 == parts) {
                    Some(one) if values[one.1] < values[pass] => one.1 = pass,
                    Some(_) => {}
                    None => highest.push((parts, pass)),
                }
            }
        }
        highest.retain(|&(parts, pass)| parts.contains(&own) && values[pass] > self.negligible);
        highest.iter().map(|&(_, pass)| self.valley(pass)).collect()
    }

    /// The valley through the saddle in or beside a cell.
    fn valley(&self, cell: usize) -> Option<Valley> {
        let values = self.field.values();
        let centre = self.field.centre(cell);
        let of = |values: &[f64]| -> Option<[f64; 2]> {
            let saddle = Critical::near(self.field, &centre, FeatureKind::Valley, values)?;
            saddle.position.get(..2)?.try_into().ok()
        };
        let origin = of(values)?;
        let direction = self.way_down(origin)?;
        let own = self.both_sides(origin, (0, values), (origin, direction))?;
        let mut others =
            vec![self.both_sides(self.rougher(origin), (1, values), (origin, direction))?];
        if let Some(second) = self.field.second_scheme() {
            others.push(self.both_sides(of(second)?, (0, second), (origin, direction))?);
        }
        let nodes = own.iter().map(|node| {
            let off = others.iter().map(|other| {
                // Beyond its ends nothing more is known of the other one than there.
                let ends =
                    [other.first(), other.last()].map(|end| end.map_or(0.0, |one| one.along));
                let at = node.along.clamp(ends[0], ends[1]);
                let own = between(&own, at, |one| one.across);
                (between(other, at, |one| one.across) - own).abs()
            });
            Node {
                error: off.sum(),
                ..*node
            }
        });
        let nodes = thinned(with_errors_beside(nodes.collect(), BESIDE));
        Some(Valley {
            origin,
            direction,
            nodes,
        })
    }

    /// Where the slope of a rougher reconstruction is zero beside a saddle, within a cell.
    fn rougher(&self, origin: [f64; 2]) -> [f64; 2] {
        let values = self.field.values();
        let moved = || {
            let rough = self.field.stencil(&origin, 1)?.jet(values);
            let [xx, xy, yy] = rough.second;
            let determinant = xx * yy - xy * xy;
            let [a, b] = rough.first;
            let step = [
                (xy * b - yy * a) / determinant,
                (xy * a - xx * b) / determinant,
            ];
            step.iter().all(|one| one.is_finite()).then_some(step)
        };
        let step = moved().unwrap_or_default();
        [0, 1].map(|k| {
            let width = self.field.cell_width(k, origin[k]);
            origin[k] + step[k].clamp(-width, width) * self.field.unit(k)
        })
    }

    /// The direction in which the density falls most on both sides of a saddle, at a wall on its only one, in units of
    /// the standard deviations.
    fn way_down(&self, origin: [f64; 2]) -> Option<[f64; 2]> {
        let far = LOOK * self.step(origin) / STEP;
        let heights = (0..DIRECTIONS).filter_map(|number| {
            let angle = std::f64::consts::PI * number as f64 / DIRECTIONS as f64;
            let direction = [angle.cos(), angle.sin()];
            let at = |s: f64| self.place(origin, direction.map(|one| s * one));
            let [one, other] = [far, -far].map(|s| self.jet((0, self.field.values()), at(s)));
            // At a wall there is one side alone.
            let heights = [one, other].into_iter().flatten().map(|jet| jet.value);
            Some((direction, heights.max_by(f64::total_cmp)?))
        });
        heights.min_by(|a, b| a.1.total_cmp(&b.1)).map(|one| one.0)
    }

    /// Length of a step, in units of the standard deviations.
    fn step(&self, at: [f64; 2]) -> f64 {
        let width = |k: usize| self.field.cell_width(k, at[k]) * self.field.unit(k) / self.units[k];
        STEP * width(0).min(width(1))
    }

    fn place(&self, origin: [f64; 2], by: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| origin[k] + by[k] * self.units[k])
    }

    /// The jet at a place within the ranges.
    fn jet(&self, (level, values): Look<'_>, at: [f64; 2]) -> Option<Jet> {
        self.field.cell_at(&at)?;
        Some(self.field.stencil(&at, level)?.jet(values))
    }

    /// The unit vector downhill, in units of the standard deviations; `None` where the density is not known.
    fn downhill(&self, look: Look<'_>, at: [f64; 2]) -> Option<[f64; 2]> {
        let jet = self.jet(look, at)?;
        if jet.value <= self.negligible {
            return None;
        }
        let slope = [0, 1].map(|k| -jet.first[k] * self.units[k] / self.field.unit(k));
        let length = slope[0].hypot(slope[1]);
        (length > 0.0).then(|| slope.map(|one| one / length))
    }

    /// The points of a valley on both sides of a saddle, along a direction from an origin.
    fn both_sides(
        &self,
        saddle: [f64; 2],
        look: Look<'_>,
        (origin, direction): ([f64; 2], [f64; 2]),
    ) -> Option<Vec<Node>> {
        let [a, b] = direction;
        let node = |at: [f64; 2]| {
            let [x, y] = [0, 1].map(|k| (at[k] - origin[k]) / self.units[k]);
            Node {
                along: a * x + b * y,
                across: a * y - b * x,
                error: 0.0,
            }
        };
        let side = |sign: f64| {
            let way = self.way(saddle, look, [sign * a, sign * b]);
            way.into_iter().map(node).collect::<Vec<_>>()
        };
        let (mut nodes, after) = (side(-1.0), side(1.0));
        nodes.reverse();
        nodes.push(node(saddle));
        nodes.extend(after);
        (nodes.len() > 1).then_some(nodes)
    }

    /// Points downhill from a saddle, which begins with a step in the direction.
    fn way(&self, saddle: [f64; 2], look: Look<'_>, direction: [f64; 2]) -> Vec<[f64; 2]> {
        let step = self.step(saddle);
        let mut at = self.place(saddle, direction.map(|one| step * one));
        let mut way = Vec::new();
        let most = 4 * self
            .field
            .axes()
            .iter()
            .map(|axis| axis.count())
            .sum::<usize>();
        while self.field.cell_at(&at).is_some() && way.len() < most {
            way.push(at);
            let half = |slope: [f64; 2]| self.place(at, slope.map(|one| 0.5 * step * one));
            let next = self
                .downhill(look, at)
                .and_then(|slope| self.downhill(look, half(slope)));
            let Some(slope) = next else { break };
            if slope[0] * direction[0] + slope[1] * direction[1] < PROGRESS {
                break;
            }
            at = self.place(at, slope.map(|one| step * one));
        }
        way
    }
}

/// Nodes with the largest error of those up to so many beside them: what two readings differ by passes zero.
pub(super) fn with_errors_beside(nodes: Vec<Node>, reach: usize) -> Vec<Node> {
    let beside = |at: usize| at.saturating_sub(reach)..(at + reach + 1).min(nodes.len());
    let largest = |at: usize| {
        let errors = nodes[beside(at)].iter().map(|node| node.error);
        errors.fold(0.0, f64::max)
    };
    let wider = nodes.iter().enumerate().map(|(at, node)| Node {
        error: largest(at),
        ..*node
    });
    wider.collect()
}

/// Fewer nodes, the first and the last among them, with the most by which what lies between is off added to each error.
fn thinned(all: Vec<Node>) -> Vec<Node> {
    let last = all.len() - 1;
    let count = (2 * NODES).min(last);
    let numbers = (0..=count).map(|number| number * last / count.max(1));
    let mut nodes: Vec<Node> = numbers.map(|number| all[number]).collect();
    let off = all.iter().map(|one| {
        let across = between(&nodes, one.along, |node| node.across);
        (across - one.across).abs()
    });
    let most = off.fold(0.0, f64::max);
    nodes.iter_mut().for_each(|node| node.error += most);
    nodes
}

/// What nodes have at a place, linear between them and beyond them.
pub(super) fn between(nodes: &[Node], along: f64, of: impl Fn(&Node) -> f64) -> f64 {
    let after = nodes.partition_point(|node| node.along < along);
    let first = after.saturating_sub(1).min(nodes.len().saturating_sub(2));
    match nodes.get(first..first + 2) {
        Some([one, other]) => {
            let share = (along - one.along) / (other.along - one.along);
            of(one) + share * (of(other) - of(one))
        }
        _ => nodes.first().map_or(0.0, of),
    }
}
