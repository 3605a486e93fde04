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
    arrays: Vec<Arrays<'a>>,
}

/// Where the values of one watched density stand.
#[derive(Debug, Serialize)]
struct Arrays<'a> {
    /// Numbers of the frames that have a density, ascending.
    frames: &'a [usize],
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
        let scene = Scene::new(sweep, self.labels);
        let subject = self.subject;
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
            arrays.push(pack(&points, number, bits, &mut blocks)?);
        }
        for one in &mut arrays {
            one.frames = &numbers;
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

/// Packs the values of one watched density, and of a marginal its band.
fn pack<'a>(
    points: &[&Point],
    observable: usize,
    (scale, bits): (Scale, u32),
    blocks: &mut Vec<Vec<u8>>,
) -> Result<Arrays<'a>, ExploreError> {
    let at: Vec<f64> = points.iter().map(|point| point.value).collect();
    let densities = || {
        points
            .iter()
            .filter_map(|point| point.densities.get(observable))
    };
    let mut add = |frames: &[&[f64]], scale: Scale, bits: u32| -> Result<Packing, ExploreError> {
        let packed = Packed::new(frames, &at, scale, bits);
        blocks.push(packed.bytes);
        Ok(Packing {
            block: blocks.len() - 1,
            top: packed.top,
            levels: packed.levels,
            scale: packed.scale,
            cells: packed.cells,
        })
    };
    let frames: Vec<&[f64]> = densities()
        .map(|one| one.density.values.as_slice())
        .collect();
    let Some(first) = densities().next() else {
        return Ok(Arrays {
            frames: &[],
            edges: Vec::new(),
            values: None,
            band: None,
            band_is: None,
        });
    };
    let values = add(&frames, scale, bits)?;
    let is_marginal = matches!(first.observable, Observable::Marginal(_));
    let bands: Option<Vec<_>> = densities().map(band).collect();
    let bands = bands.filter(|_| is_marginal);
    let band_is = bands
        .as_ref()
        .and_then(|bands| bands.first())
        .map(|one| one.1);
    let band = bands.map(|bands| {
        let frames: Vec<&[f64]> = bands.iter().map(|one| one.0.as_slice()).collect();
        add(&frames, Scale::Root, BAND_BITS)
    });
    Ok(Arrays {
        frames: &[],
        edges: (first.density.axes.iter())
            .map(|axis| axis.edges().to_vec())
            .collect(),
        values: Some(values),
        band: band.transpose()?,
        band_is,
    })
}
