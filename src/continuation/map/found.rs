//! What a map gives: nodes with their signatures, the curves between them, and what no curve explains.

use crate::continuation::curve::{
    CodimensionTwo, Curve, CurveWork, LevelCurve, Plane, codimension_two,
};
use crate::continuation::{Finding, PointStatus, Subject};
use crate::density::Density;
use crate::system::MeasureLevel;
use crate::topology::Signature;

/// A solved place of a map.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MapNode {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// How often the coarse grid was halved for it.
    pub level: usize,
    /// How the solve went.
    pub status: PointStatus,
    /// The signature of every watched density, in the order of [`Subject::observables`]; empty without a density.
    pub signatures: Vec<Signature>,
    /// Whether all that the signatures count was seen.
    pub is_seen: bool,
    /// Why there is no density, where a sentence is known.
    pub reason: Option<String>,
    /// The numbers whose levels are asked for, in the order of these, as far as they are known.
    #[cfg_attr(
        feature = "serde",
        serde(default, skip_serializing_if = "Vec::is_empty")
    )]
    pub numbers: Vec<Option<f64>>,
    /// What must be known of it, as of a point of a sweep.
    #[cfg_attr(
        feature = "serde",
        serde(
            default,
            skip_serializing_if = "Vec::is_empty",
            with = "crate::continuation::finding::stored"
        )
    )]
    pub findings: Vec<Finding>,
}

impl MapNode {
    /// Whether its cells are too wide to count by.
    pub fn has_wide_cells(&self) -> bool {
        self.findings.iter().any(Finding::is_of_wide_cells)
    }
}

/// What changes between neighbouring nodes.
#[derive(Debug, Clone, PartialEq)]
pub enum UntracedChange {
    /// The signature of an observable, by its place in [`Subject::observables`].
    Signature(usize),
    /// A number passes its level.
    Level(MeasureLevel),
}

/// Places where something changes and no curve was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Untraced {
    /// What changes.
    pub of: UntracedChange,
    /// How many pairs of neighbouring nodes show it.
    pub pairs: usize,
    /// Values of both parameters between one of these pairs.
    pub near: [f64; 2],
    /// Why.
    pub reason: String,
}

/// A density at a place well inside a region.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionSample {
    /// The observable, by its place in [`Subject::observables`].
    pub observable: usize,
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Its density there, ∫ = 1.
    pub density: Density,
}

/// What a map took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MapWork {
    /// For its nodes, without those that were known.
    pub nodes: CurveWork,
    /// For curves and their checks, with those that turned out to be one that was there.
    pub curves: CurveWork,
}

/// A map of regimes.
#[derive(Debug, Clone)]
pub struct RegimeMap {
    /// What was watched.
    pub subject: Subject,
    /// The box.
    pub plane: Plane,
    /// The solved nodes, by the second parameter and then the first.
    pub nodes: Vec<MapNode>,
    /// The cells whose corners they are, lower and upper corner of each in the box with sides of length one.
    pub cells: Vec<[[f64; 2]; 2]>,
    /// The curves, in the order in which they were followed.
    pub curves: Vec<Curve>,
    /// The curves of the levels that the family asks for, one after the other as the levels are.
    pub levels: Vec<LevelCurve>,
    /// Changes that no curve explains.
    pub untraced: Vec<Untraced>,
    /// A density of each signature, in its largest region; none of a map that was interrupted.
    pub samples: Vec<RegionSample>,
    /// What it took.
    pub work: MapWork,
    /// Whether it was interrupted before it was complete.
    pub interrupted: bool,
}

impl RegimeMap {
    /// The points of codimension two of its curves, by their places in [`RegimeMap::curves`].
    pub fn codimension_two(&self) -> Vec<CodimensionTwo> {
        codimension_two(&self.curves)
    }

    /// How many of its nodes have cells that are too wide to count by.
    pub(crate) fn nodes_with_wide_cells(&self) -> usize {
        let nodes = self.nodes.iter();
        nodes.filter(|node| node.has_wide_cells()).count()
    }

    /// The place of an observable among those that are watched; `None` for one that is not.
    pub(crate) fn place_of(&self, observable: crate::density::Observable) -> Option<usize> {
        let mut observables = self.subject.observables.iter();
        observables.position(|&one| one == observable)
    }
}
