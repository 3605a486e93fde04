//! The page of stored densities, put together: what it is told, and its densities packed to fit.

use serde::Serialize;

use super::ExploreError;
use super::frame::{Frame, band};
use super::html;
use super::pack::{Packed, Scale, deflate};
use super::plane::PlaneScene;
use super::scene::Scene;
use crate::continuation::{Label, Point, Subject};
use crate::density::Observable;
use crate::sweep_file::Sweep;

/// Bits of a marginal: what is packed differs from what is stored by less than a line is wide on any screen.
const MARGINAL_BITS: u32 = 24;
/// Bits of a band.
const BAND_BITS: u32 = 12;

/// What the page is told, beside its arrays.
#[derive(Debug, Serialize)]
struct PageData<'a> {
    live: bool,
    #[serde(flatten)]
    scene: &'a Scene,
    /// The plane of a map.
    plane: Option<&'a PlaneScene>,
    /// Of a map, the value of its second parameter for every frame.
    across: &'a [f64],
    frames: Vec<Frame>,
    /// Of every watched density, in their order.
    arrays: Vec<Arrays>,
}

/// Where the values of one watched density stand.
#[derive(Debug, Serialize)]
struct Arrays {
    /// Numbers of the frames that have a density, ascending.
    frames: Vec<usize>,
    /// Edges of the cells along each axis.
    edges: Vec<Vec<f64>>,
    values: Option<Packing>,
    band: Option<Packing>,
    /// What the band is.
    band_is: Option<&'static str>,
}

/// How values are packed that stand in a block of the page.
#[derive(Debug, Serialize)]
struct Packing {
    block: usize,
    top: f64,
    levels: u32,
    scale: Scale,
    cells: usize,
}

/// What a page shows.
pub(super) struct Shown<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) subject: &'a Subject,
    pub(super) labels: &'a [Label],
    pub(super) points: Vec<&'a Point>,
    pub(super) plane: Option<&'a PlaneScene>,
    /// Of a map, the second parameter of every point.
    pub(super) across: Vec<f64>,
}

impl Shown<'_> {
    /// A page whose joint densities have so many bits.
    pub(super) fn compose(&self, joint_bits: u32) -> Result<String, ExploreError> {
        let sweep = self.sweep;
        let subject = self.subject;
        let fields: Vec<&str> = match subject.family.model().axes.len() {
            2 => subject
                .family
                .fields()
                .map(|field| field.name.as_str())
                .collect(),
            _ => Vec::new(),
        };
        let is_known = |name: &&str| {
            let mut fields = self.points.iter().flat_map(|point| &point.report.fields);
            fields.any(|field| field.name == *name)
        };
        let fields: Vec<&str> = fields.into_iter().filter(is_known).collect();
        let scene = Scene::new(sweep, self.labels).with_fields(fields.iter().copied());
        let with_density = |(_, point): &(usize, &Point)| !point.densities.is_empty();
        let points = self.points.iter().copied().enumerate().filter(with_density);
        let (numbers, points): (Vec<usize>, Vec<&Point>) = points.unzip();
        let mut blocks = Vec::new();
        let mut arrays = Vec::new();
        for (number, observable) in subject.observables.iter().enumerate() {
            let bits = match observable {
                Observable::Marginal(_) => (Scale::Linear, MARGINAL_BITS),
                Observable::Joint(..) => (Scale::Root, joint_bits),
            };
            arrays.push(pack(&points, number, bits, &mut blocks));
        }
        for one in &mut arrays {
            one.frames.clone_from(&numbers);
        }
        for name in fields {
            arrays.push(pack_field(&self.points, name, joint_bits, &mut blocks));
        }
        let frames = self.points.iter();
        let told = PageData {
            live: false,
            scene: &scene,
            plane: self.plane,
            across: &self.across,
            frames: frames
                .map(|point| Frame::new(point, &subject.family))
                .collect(),
            arrays,
        };
        let told = deflate(&serde_json::to_vec(&told)?);
        Ok(html::page(&sweep.settings.title, &told, &blocks, false))
    }
}

/// Packs frames that belong to values of the parameter as a block of the page.
fn add(
    blocks: &mut Vec<Vec<u8>>,
    (frames, at): (&[&[f64]], &[f64]),
    (scale, bits): (Scale, u32),
) -> Packing {
    let packed = Packed::new(frames, at, scale, bits);
    blocks.push(packed.bytes);
    Packing {
        block: blocks.len() - 1,
        top: packed.top,
        levels: packed.levels,
        scale: packed.scale,
        cells: packed.cells,
    }
}

/// Packs a field of a passage at all points that have it; where it is not known it is shown as zero.
fn pack_field(points: &[&Point], name: &str, bits: u32, blocks: &mut Vec<Vec<u8>>) -> Arrays {
    let known = points.iter().enumerate().filter_map(|(number, point)| {
        let field = point
            .report
            .fields
            .iter()
            .find(|field| field.name == name)?;
        Some((number, point.value, field))
    });
    let known: Vec<_> = known.collect();
    let values: Vec<&[f64]> = known.iter().map(|one| one.2.values.as_slice()).collect();
    let at: Vec<f64> = known.iter().map(|one| one.1).collect();
    let axes = known.first().map_or(&[][..], |one| &one.2.axes[..]);
    Arrays {
        frames: known.iter().map(|one| one.0).collect(),
        edges: axes.iter().map(|axis| axis.edges().to_vec()).collect(),
        values: (!known.is_empty()).then(|| add(blocks, (&values, &at), (Scale::Root, bits))),
        band: None,
        band_is: None,
    }
}

/// Packs the values of one watched density, and of a marginal its band.
fn pack(
    points: &[&Point],
    observable: usize,
    (scale, bits): (Scale, u32),
    blocks: &mut Vec<Vec<u8>>,
) -> Arrays {
    let at: Vec<f64> = points.iter().map(|point| point.value).collect();
    let densities = || {
        points
            .iter()
            .filter_map(|point| point.densities.get(observable))
    };
    let frames: Vec<&[f64]> = densities()
        .map(|one| one.density.values.as_slice())
        .collect();
    let Some(first) = densities().next() else {
        return Arrays {
            frames: Vec::new(),
            edges: Vec::new(),
            values: None,
            band: None,
            band_is: None,
        };
    };
    let values = add(blocks, (&frames, &at), (scale, bits));
    let is_marginal = matches!(first.observable, Observable::Marginal(_));
    let bands: Option<Vec<_>> = densities().map(band).collect();
    let bands = bands.filter(|_| is_marginal);
    let band_is = bands
        .as_ref()
        .and_then(|bands| bands.first())
        .map(|one| one.1);
    let band = bands.map(|bands| {
        let frames: Vec<&[f64]> = bands.iter().map(|one| one.0.as_slice()).collect();
        add(blocks, (&frames, &at), (Scale::Root, BAND_BITS))
    });
    Arrays {
        frames: Vec::new(),
        edges: (first.density.axes.iter())
            .map(|axis| axis.edges().to_vec())
            .collect(),
        values: Some(values),
        band,
        band_is,
    }
}
