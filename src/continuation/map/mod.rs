//! Maps of regimes: the signatures of densities over a box in the plane of two parameters, and the curves that part them.
//!
//! A coarse grid is solved strip by strip, to and fro, so that neighbours follow each other; where signatures of neighbours differ, the grid
//! is refined. From every change that an indicator decides its curve is followed, each once. Strips, and parts of a refinement, are sessions of their
//! own that share nothing, so that a map is the same on any number of threads.

mod crossing;
mod found;
mod lattice;
mod node;
mod regions;
mod samples;
mod solve;
mod states;
mod trace;

pub use found::{MapNode, MapWork, RegimeMap, RegionSample, Untraced};
pub(crate) use regions::{FloodedRegion, Seed, flooded};
pub use regions::{Region, RegionPicture};
pub use states::{PlaneState, plane_states};

use super::curve::{CurveOptions, Plane, agree};
use super::{DensitySource, SourceError};
use crate::cancellation::Cancellation;
use crate::topology::Detector;
use lattice::Lattice;
use solve::Solver;

/// Settings of maps.
#[derive(Debug, Clone, PartialEq)]
pub struct MapOptions {
    /// Values of the first and of the second parameter that make the coarse grid, both ends included; at least 2 of each.
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

/// Makes a source of densities that solves along the path of a plane. It is asked for one for every session, each along a path of its own.
pub type SourceInPlane<'a> =
    dyn Fn(&Plane) -> Result<Box<dyn DensitySource>, SourceError> + Sync + 'a;

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
/// let source = |plane: &Plane| sweep.boxed_source_in(plane, &never);
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
    regime_map_from(
        source,
        plane,
        detector,
        options,
        &[],
        cancellation,
        observer,
    )
}

/// Goes on with a map of which some nodes are known already, from [`RegimeMap::nodes`] or as they were told, with the same options. Of those, the ones
/// beside changes are solved again, since their densities are needed; all others are taken as they are, and curves are followed anew.
///
/// # Errors
/// [`SourceError`] where no source can be made in this plane.
pub fn regime_map_from(
    source: &SourceInPlane<'_>,
    plane: &Plane,
    detector: &dyn Detector,
    options: &MapOptions,
    known: &[MapNode],
    cancellation: &Cancellation,
    observer: &MapObserver<'_>,
) -> Result<RegimeMap, SourceError> {
    let subject = source(&plane.afresh())?.subject().clone();
    let lattice = Lattice::new(options.counts, options.depth);
    let solver = Solver::new(source, plane, &lattice, detector, cancellation, observer);
    solver.recall(known);
    let leaves = solver.solve_all()?;
    let (crossings, blurred) = crossing::crossings(&solver.grid(), &lattice, detector);
    let mut work = MapWork {
        nodes: solver.work(),
        ..MapWork::default()
    };
    let (mut curves, untraced) = match &options.curves {
        Some(curves) => {
            let tracer = trace::Tracer {
                source,
                plane,
                detector,
                options: curves,
                cancellation,
                observer,
            };
            tracer.trace(crossings, blurred, &mut work.curves)
        }
        None => (Vec::new(), Vec::new()),
    };
    agree(&mut curves);
    let is_cut = curves
        .iter()
        .any(|curve: &super::curve::Curve| curve.is_interrupted());
    let mut map = RegimeMap {
        interrupted: cancellation.is_cancelled() || is_cut,
        plane: plane.clone(),
        nodes: solver.into_nodes(),
        cells: leaves
            .into_iter()
            .map(|leaf| lattice.corners(leaf))
            .collect(),
        curves,
        untraced,
        samples: Vec::new(),
        work,
        subject,
    };
    if !map.interrupted {
        map.samples = samples::samples(&map, source, cancellation)?;
    }
    Ok(map)
}
