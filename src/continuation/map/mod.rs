//! Maps of regimes: the signatures of densities over a box in the plane of two parameters, and the curves that part
//! them.
//!
//! A coarse grid is solved strip by strip, to and fro, so that neighbours follow each other; where signatures of
//! neighbours differ, the grid is refined. From every change that an indicator decides its curve is followed, each
//! once. Strips, and parts of a refinement, are sessions of their own that share nothing, so that a map is the same on
//! any number of threads.
//!
//! # Decisions
//!
//! **A map opens many sessions and keeps few densities.** `continuation::map` asks for a source along a path of its own
//! for every strip of its grid, every part of a refinement and every curve: nothing is shared, so a map does not depend
//! on threads. A node's densities are let go once its neighbours have the same signatures; only about changes they are
//! needed, to tell which indicator's zero to follow.
//!
//! **A shard of a map leaves nodes and changes, not densities.** A shard looks for the changes between its own nodes,
//! where their densities are at hand, and stores only what they tell. The merge needs densities at the borders between
//! shards alone; curves run through all shards, so it follows them.

mod crossing;
mod curve_line;
mod found;
mod lattice;
mod level_curves;
mod node;
mod regions;
mod samples;
mod shards;
mod solve;
mod starts;
mod states;
mod trace;

pub use found::{MapNode, MapWork, RegimeMap, RegionSample, Untraced, UntracedChange};
pub use regions::{Region, RegionPicture};
pub(crate) use regions::{Seed, flood};
pub(crate) use shards::{MapChange, MapShard};
pub(crate) use states::{PlaneState, plane_states};

use super::curve::{Curve, CurveOptions, LevelCurve, Plane, agree};
use super::{DensitySource, Shard, SourceError};
use crate::cancellation::Cancellation;
use crate::system::MeasureLevel;
use crate::topology::Detector;
use lattice::Lattice;
use solve::Solver;

/// Settings of maps.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOptions {
    /// Values of the first and of the second parameter that make the coarse grid, both ends included; at least 2 of
    /// each.
    pub counts: [usize; 2],
    /// How often a cell of the coarse grid is halved at most, where signatures differ.
    pub depth: usize,
    /// How curves are followed; `None` for a map without.
    pub curves: Option<CurveOptions>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            counts: [21, 21],
            depth: 2,
            curves: Some(CurveOptions::default()),
        }
    }
}

/// Makes a source of densities that solves along the path of a plane. It is asked for one for every session, each along
/// a path of its own.
pub type SourceInPlane<'a> =
    dyn Fn(&Plane) -> Result<Box<dyn DensitySource>, SourceError> + Sync + 'a;

/// Levels of numbers whose curves a map shows.
#[derive(Clone, Copy)]
pub struct MapLevels<'a> {
    /// The numbers and their levels.
    pub asked: &'a [MeasureLevel],
    /// Makes a source as that of the map, of which these numbers are wanted too.
    pub source: &'a LevelSource<'a>,
}

/// Makes a source of densities and of the numbers of some levels along the path of a plane.
pub type LevelSource<'a> =
    dyn Fn(&Plane, &[MeasureLevel]) -> Result<Box<dyn DensitySource>, SourceError> + Sync + 'a;

/// What a map tells while it is made.
#[derive(Debug, Clone, Copy)]
pub enum MapProgress<'a> {
    /// A node was solved.
    Solved {
        /// The node.
        node: &'a MapNode,
        /// How many are done.
        done: usize,
        /// How many are known to be wanted: refinement wants more.
        wanted: usize,
    },
    /// A point of a curve was met.
    Met {
        /// Values of both parameters.
        values: [f64; 2],
        /// How many points of curves there are so far.
        done: usize,
    },
}

/// Who is told how a map goes, from whatever thread.
pub type MapObserver<'a> = dyn Fn(&MapProgress<'_>) + Sync + 'a;

/// Solves the map of a plane's box, and follows its curves.
///
/// Cancelled, it ends early with what was done, and [`RegimeMap::interrupted`] set. A node that fails is data.
///
/// # Errors
/// [`SourceError`] where no source can be made in this plane.
///
/// ```
/// use pbif::cancellation::Cancellation;
/// use pbif::continuation::curve::Plane;
/// use pbif::continuation::map::{MapOptions, regime_map};
/// use pbif::sweep_file::SweepFile;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let never = Cancellation::new();
/// let file = SweepFile::parse("bistable.toml", include_str!("../../../sweeps/bistable.toml"));
/// let sweep = file.validate()?.prepare(&never)?;
/// let plane = Plane::new(("a", -1.0, 1.0), ("sigma2", 0.2, 0.6))?;
/// let options = MapOptions { counts: [7, 4], depth: 1, ..MapOptions::default() };
/// let source = |plane: &Plane| sweep.source_in(plane, &never);
/// let map = regime_map(&source, &plane, &sweep.detector(), &options, &never, &|_| ())?;
/// // One peak becomes two where a = 0, whatever the noise.
/// assert_eq!(map.curves.len(), 1);
/// assert!(map.curves[0].points.iter().all(|point| point.values[0].abs() < 1e-3));
/// # Ok(())
/// # }
/// ```
pub fn regime_map(
    source: &SourceInPlane<'_>,
    plane: &Plane,
    detector: &dyn Detector,
    options: &MapOptions,
    cancellation: &Cancellation,
    observer: &MapObserver<'_>,
) -> Result<RegimeMap, SourceError> {
    let maker = MapMaker {
        source,
        levels: None,
        plane,
        detector,
        options,
        cancellation,
        observer,
    };
    maker.whole()
}

/// What makes a map, whole or in shards.
#[derive(Clone, Copy)]
pub struct MapMaker<'a> {
    /// Makes sources of densities in the plane.
    pub source: &'a SourceInPlane<'a>,
    /// Levels of which curves are wanted besides.
    pub levels: Option<MapLevels<'a>>,
    /// The box.
    pub plane: &'a Plane,
    /// Finds features and indicators.
    pub detector: &'a dyn Detector,
    /// How the map is made.
    pub options: &'a MapOptions,
    /// Ends it early.
    pub cancellation: &'a Cancellation,
    /// Is told how it goes.
    pub observer: &'a MapObserver<'a>,
}

impl MapMaker<'_> {
    /// A source of the densities, and of the numbers of some levels.
    fn source_of(
        &self,
        plane: &Plane,
        asked: &[MeasureLevel],
    ) -> Result<Box<dyn DensitySource>, SourceError> {
        match self.levels.filter(|_| !asked.is_empty()) {
            Some(levels) => (levels.source)(plane, asked),
            None => (self.source)(plane),
        }
    }

    /// The map in one piece; see [`regime_map`].
    ///
    /// # Errors
    /// [`SourceError`] where no source can be made in this plane.
    pub fn whole(&self) -> Result<RegimeMap, SourceError> {
        let lattice = Lattice::new(self.options.counts, self.options.depth);
        let solver = Solver::new(self, &lattice);
        let leaves = solver.solve_all(&lattice.rows(), &|_| false)?;
        let found = crossing::crossings(&solver.grid(), &lattice, self.detector);
        self.finish(&lattice, solver, leaves, found)
    }

    /// A shard of the map: its share of the coarse rows with what refinement asks for between them, and the changes
    /// that are found there. `None` where there are more shards than steps between rows.
    ///
    /// # Errors
    /// [`SourceError`] where no source can be made in this plane.
    pub(crate) fn shard(&self, shard: Shard) -> Result<Option<MapShard>, SourceError> {
        let lattice = Lattice::new(self.options.counts, self.options.depth);
        let Some(rows) = shard.places(self.options.counts[1]) else {
            return Ok(None);
        };
        let solver = Solver::new(self, &lattice);
        solver.solve_all(&rows, &|_| false)?;
        let found = crossing::crossings(&solver.grid(), &lattice, self.detector);
        Ok(Some(MapShard {
            shard,
            nodes: solver.into_nodes(),
            changes: shards::changes(found),
            interrupted: self.cancellation.is_cancelled(),
        }))
    }

    /// The map of all its shards: solves again what stands beside changes at their borders, and follows the curves.
    ///
    /// # Errors
    /// [`SourceError`] where no source can be made in this plane.
    pub(crate) fn merged(&self, shards: &[MapShard]) -> Result<RegimeMap, SourceError> {
        let lattice = Lattice::new(self.options.counts, self.options.depth);
        let solver = Solver::new(self, &lattice);
        shards.iter().for_each(|shard| solver.recall(&shard.nodes));
        let borders: Vec<usize> = shards
            .iter()
            .filter_map(|shard| Some(*shard.shard.places(self.options.counts[1])?.start()))
            .filter(|&row| row > 0)
            .collect();
        let is_at_border = |at: lattice::At| {
            let step = lattice.coarse();
            let mut rows = borders.iter();
            rows.any(|row| at[1].abs_diff(row * step) <= node::NEAR * step)
        };
        let leaves = solver.solve_all(&lattice.rows(), &is_at_border)?;
        let (mut crossings, mut blurred) =
            crossing::crossings(&solver.grid(), &lattice, self.detector);
        let changes = shards.iter().flat_map(|shard| &shard.changes);
        shards::gather(changes, &mut crossings, &mut blurred);
        self.finish(&lattice, solver, leaves, (crossings, blurred))
    }

    /// The map with its curves and a density of each regime.
    fn finish(
        &self,
        lattice: &Lattice,
        solver: Solver<'_>,
        leaves: Vec<lattice::Leaf>,
        (crossings, blurred): (Vec<crossing::Crossing>, Vec<crossing::Blurred>),
    ) -> Result<RegimeMap, SourceError> {
        let subject = (self.source)(&self.plane.afresh())?.subject().clone();
        let mut work = MapWork {
            nodes: solver.work(),
            ..MapWork::default()
        };
        let (mut curves, mut untraced) = (Vec::new(), Vec::new());
        let mut levels = Vec::new();
        if let Some(options) = &self.options.curves {
            let tracer = trace::Tracer {
                maker: self,
                options,
            };
            (curves, untraced) = tracer.trace(crossings, blurred, &mut work.curves);
            let solved = solver.grid();
            let all = (lattice, leaves.as_slice(), &*solved);
            let (found, missed) = level_curves::level_curves(self, options, all, &mut work.curves);
            levels = found;
            untraced.extend(missed);
        }
        agree(&mut curves);
        let is_cut = curves.iter().any(Curve::is_interrupted)
            || levels.iter().any(LevelCurve::is_interrupted);
        let corners = leaves.into_iter().map(|leaf| lattice.corners(leaf));
        let mut map = RegimeMap {
            interrupted: self.cancellation.is_cancelled() || is_cut,
            plane: self.plane.clone(),
            nodes: solver.into_nodes(),
            cells: corners.collect(),
            curves,
            levels,
            untraced,
            samples: Vec::new(),
            work,
            subject,
        };
        if !map.interrupted {
            map.samples = samples::samples(&map, self.source, self.cancellation)?;
        }
        Ok(map)
    }
}
