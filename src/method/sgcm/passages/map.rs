//! The cell map of paths until they enter a region: sampled from every cell that is reached from the start.

use super::moments::{Asked, Basis, Collector, Moments, basis};
use crate::MAX_DIMENSION;
use crate::method::MethodError;
use crate::monte_carlo::{CellPath, CellPaths, PathEnd, PathsFrom};
use crate::numerics::in_parallel;
use crate::space::CellSpace;

/// What the paths of a cell do.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// With half of the time step, by group.
    pub(super) groups: Vec<Moments>,
    /// With the whole time step, all groups.
    pub(super) coarse: Moments,
}

/// Paths of the start.
pub(super) enum StartColumn {
    /// From a state.
    State(Column),
    /// Those of a cell that start in the region of the start, by the place of the cell: all of them without a column of
    /// their own.
    Cell(usize, Option<Column>),
}

/// The sampled map.
pub(super) struct PassageMap {
    pub(super) dimension: usize,
    pub(super) asked: Asked,
    /// Number of each cell in the cell space, ascending.
    pub(super) cells: Vec<usize>,
    /// Of each cell; ends are places in the list of cells.
    pub(super) columns: Vec<Column>,
    pub(super) starts: Vec<StartColumn>,
    pub(super) groups: usize,
    /// Paths that have entered the region.
    pub(super) exits: f64,
    /// Paths that have run away.
    pub(super) runaways: usize,
}

/// What is sampled of a cell or a state.
struct Sampled {
    all: Column,
    /// Paths that start in the region of the start, where there are such and others.
    from_region: Option<Column>,
    has_start: bool,
    runaways: usize,
}

/// Of each group, and with the whole time step.
type Collectors<'a> = (Vec<Collector<'a>>, Collector<'a>);

/// How cells are sampled.
pub(super) struct Sampler<'a> {
    pub(super) paths: &'a CellPaths<'a>,
    pub(super) space: &'a CellSpace,
    pub(super) groups: usize,
    pub(super) asked: &'a Asked,
    /// Whether the start lies in a region.
    pub(super) has_region: bool,
}

impl Sampler<'_> {
    /// The map of all cells that are reached from a state.
    pub(super) fn starting_at(
        &self,
        paths: &CellPaths<'_>,
        state: &[f64],
    ) -> Result<PassageMap, MethodError> {
        let start = self.column(paths, PathsFrom::State(state))?;
        let ends = reached(&start.all).collect();
        let mut map = self.grown(ends)?;
        map.runaways += start.runaways;
        map.exits += self.ended(&start.all);
        map.starts = vec![StartColumn::State(start.all)];
        Ok(map.numbered(self.space))
    }

    /// The map of all cells that are reached from some, in which the start lies.
    pub(super) fn starting_in(&self, cells: Vec<usize>) -> Result<PassageMap, MethodError> {
        Ok(self.grown(cells)?.numbered(self.space))
    }

    fn grown(&self, mut frontier: Vec<usize>) -> Result<PassageMap, MethodError> {
        let mut is_known = vec![false; self.space.n_cells()];
        let mut found: Vec<(usize, Sampled)> = Vec::new();
        loop {
            frontier.sort_unstable();
            frontier.dedup();
            frontier.retain(|&cell| !std::mem::replace(&mut is_known[cell], true));
            if frontier.is_empty() {
                break;
            }
            let sampled = in_parallel(frontier.len(), |number| {
                let cell = frontier[number];
                let column = self.column(self.paths, PathsFrom::Cell(cell))?;
                Ok::<_, MethodError>((cell, column))
            })?;
            frontier = sampled
                .iter()
                .flat_map(|(_, one)| reached(&one.all))
                .collect();
            found.extend(sampled);
        }
        // Cells that lie in the target have no paths.
        found.retain(|(_, one)| one.all.groups.iter().any(|group| group.paths > 0));
        found.sort_unstable_by_key(|entry| entry.0);
        let mut map = PassageMap {
            dimension: self.space.dimension(),
            asked: self.asked.clone(),
            cells: Vec::with_capacity(found.len()),
            columns: Vec::with_capacity(found.len()),
            starts: Vec::new(),
            groups: self.groups,
            exits: 0.0,
            runaways: 0,
        };
        for (place, (cell, one)) in found.into_iter().enumerate() {
            if one.has_start {
                map.starts.push(StartColumn::Cell(place, one.from_region));
            }
            map.exits += self.ended(&one.all);
            map.runaways += one.runaways;
            map.cells.push(cell);
            map.columns.push(one.all);
        }
        Ok(map)
    }

    fn ended(&self, column: &Column) -> f64 {
        let of_group = |group: &Moments| group.told[super::moments::ENDED];
        column.groups.iter().map(of_group).sum()
    }

    fn column(&self, paths: &CellPaths<'_>, from: PathsFrom<'_>) -> Result<Sampled, MethodError> {
        let collector = || Collector::new(self.asked, self.space.dimension());
        let new = || ((0..self.groups).map(|_| collector()).collect(), collector());
        let (mut all, mut of_region): (Collectors<'_>, Collectors<'_>) = (new(), new());
        let (mut count, mut in_region) = (0_usize, 0_usize);
        let runaways = paths.follow(from, |path: &CellPath| {
            let start = basis(&path.start);
            let [coarse, fine] = path.ends.map(|end| (end, self.cell(&end)));
            count += 1;
            in_region += usize::from(path.is_from_region);
            let both = [
                Some(&mut all),
                (path.is_from_region && self.has_region).then_some(&mut of_region),
            ];
            for into in both.into_iter().flatten() {
                into.0[path.group].add(&start, &fine.0, fine.1);
                into.1.add(&start, &coarse.0, coarse.1);
            }
        })?;
        let finish = |(groups, coarse): Collectors<'_>| Column {
            groups: groups.into_iter().map(Collector::finish).collect(),
            coarse: coarse.finish(),
        };
        Ok(Sampled {
            from_region: (in_region > 0 && in_region < count).then(|| finish(of_region)),
            all: finish(all),
            has_start: in_region > 0,
            runaways,
        })
    }

    /// The cell in which a path ends that has not entered the region, and where in it. What is outside of the range
    /// counts as at its end.
    fn cell(&self, end: &PathEnd) -> Option<(u32, Basis)> {
        if end.time.is_finite() {
            return None;
        }
        let (mut number, mut place) = (0, [0.0; MAX_DIMENSION]);
        for (axis, edges) in self.space.axes().iter().enumerate() {
            let (from, to) = (edges.from(), edges.to());
            let x = match edges.is_closed() {
                true => from + (end.state[axis] - from).rem_euclid(to - from),
                false => end.state[axis],
            };
            let x = x.clamp(from, to);
            let position = edges.find(x).unwrap_or(edges.count() - 1);
            let within = (x - edges.edges()[position]) / edges.width(position);
            place[axis] = within.clamp(0.0, 1.0) - 0.5;
            number = number * edges.count() + position;
        }
        Some((number as u32, basis(&place)))
    }
}

fn reached(column: &Column) -> impl Iterator<Item = usize> + '_ {
    let all = column.groups.iter().chain([&column.coarse]);
    all.flat_map(|moments| moments.ends.iter().map(|&cell| cell as usize))
}

impl PassageMap {
    /// Number of paths of the start.
    pub(super) fn start_paths(&self) -> usize {
        let column = |start: &StartColumn| -> usize {
            let column = match start {
                StartColumn::State(column) | StartColumn::Cell(_, Some(column)) => column,
                StartColumn::Cell(cell, None) => &self.columns[*cell],
            };
            column.groups.iter().map(|group| group.paths).sum()
        };
        self.starts.iter().map(column).sum()
    }

    /// Numbers of cells in the space become places in the list of cells; of cells without paths, a place that no cell
    /// has.
    fn numbered(mut self, space: &CellSpace) -> Self {
        let mut places = vec![u32::MAX; space.n_cells()];
        for (place, &cell) in self.cells.iter().enumerate() {
            places[cell] = place as u32;
        }
        let own = self.starts.iter_mut().filter_map(|start| match start {
            StartColumn::State(column) | StartColumn::Cell(_, Some(column)) => Some(column),
            StartColumn::Cell(_, None) => None,
        });
        for column in self.columns.iter_mut().chain(own) {
            for moments in column.groups.iter_mut().chain([&mut column.coarse]) {
                for end in &mut moments.ends {
                    *end = places[*end as usize];
                }
            }
        }
        self
    }
}
