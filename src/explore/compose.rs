//! The page of stored densities, put together: what it is told, and its densities packed to fit.

use serde_json::{Value, json};

use super::ExploreError;
use super::frame::{band, frame};
use super::html;
use super::pack::{Packed, Scale, deflate};
use super::plane::PlaneScene;
use super::scene::scene;
use crate::continuation::{Label, Point, Subject};
use crate::density::{EstimatedDensity, Observable};
use crate::space::Axis;
use crate::sweep_file::Sweep;

/// Bits of a marginal: what is packed differs from what is stored by less than a line is wide on any screen.
const MARGINAL_BITS: u32 = 24;
/// Bits of a band.
const BAND_BITS: u32 = 12;

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
        let with_density = |(_, point): &(usize, &Point)| !point.densities.is_empty();
        let points = self.points.iter().copied().enumerate().filter(with_density);
        let mut blocks = Vec::new();
        let mut arrays = Vec::new();
        let points: Vec<(usize, &Point)> = points.collect();
        for (number, observable) in subject.observables.iter().enumerate() {
            let bits = match observable {
                Observable::Marginal(_) => (Scale::Linear, MARGINAL_BITS),
                Observable::Joint(..) => (Scale::Root, joint_bits),
            };
            arrays.push(pack(&points, number, bits, &mut blocks));
        }
        for name in &fields {
            arrays.push(pack_field(&self.points, name, joint_bits, &mut blocks));
        }
        let frames = self.points.iter();
        let frames = frames.map(|point| frame(point, &subject.family));
        let mut told = scene(sweep, self.labels, &fields);
        told["live"] = json!(false);
        told["plane"] = self.plane.map_or(Value::Null, PlaneScene::told);
        // Of a map, the value of its second parameter for every frame.
        told["across"] = json!(self.across);
        told["frames"] = frames.collect();
        told["arrays"] = arrays.into();
        let told = deflate(&serde_json::to_vec(&told)?);
        Ok(html::page(&sweep.settings.title, &told, &blocks, false))
    }
}

/// Packs frames that belong to values of the parameter as a block of the page.
fn add(
    blocks: &mut Vec<Vec<u8>>,
    (frames, at): (&[&[f64]], &[f64]),
    (scale, bits): (Scale, u32),
) -> Value {
    let packed = Packed::new(frames, at, scale, bits);
    blocks.push(packed.bytes);
    json!({
        "block": blocks.len() - 1,
        "top": packed.top,
        "levels": packed.levels,
        "scale": packed.scale.word(),
        "cells": packed.cells,
    })
}

/// Edges of the cells along each axis.
pub(super) fn edges<'a>(axes: impl IntoIterator<Item = &'a Axis>) -> Vec<&'a [f64]> {
    axes.into_iter().map(Axis::edges).collect()
}

/// Packs a field of a passage at all points that have it; where it is not known it is shown as zero.
fn pack_field(points: &[&Point], name: &str, bits: u32, blocks: &mut Vec<Vec<u8>>) -> Value {
    let known = points.iter().enumerate().filter_map(|(number, point)| {
        let mut fields = point.report.fields.iter();
        Some((
            number,
            point.value,
            fields.find(|field| field.name == name)?,
        ))
    });
    let known: Vec<_> = known.collect();
    let values: Vec<&[f64]> = known.iter().map(|one| one.2.values.as_slice()).collect();
    let at: Vec<f64> = known.iter().map(|one| one.1).collect();
    let axes = known.first().map_or(&[][..], |one| &one.2.axes[..]);
    json!({
        "frames": known.iter().map(|one| one.0).collect::<Vec<_>>(),
        "edges": edges(axes),
        "values": (!known.is_empty()).then(|| add(blocks, (&values, &at), (Scale::Root, bits))),
        "band": null,
        "band_is": null,
    })
}

/// Packs the values of one watched density at numbered points that have it, and of a marginal its band.
fn pack(
    points: &[(usize, &Point)],
    observable: usize,
    (scale, bits): (Scale, u32),
    blocks: &mut Vec<Vec<u8>>,
) -> Value {
    let at: Vec<f64> = points.iter().map(|(_, point)| point.value).collect();
    let densities = points.iter();
    let densities: Vec<&EstimatedDensity> = densities
        .filter_map(|(_, point)| point.densities.get(observable))
        .collect();
    let frames = densities.iter().map(|one| one.density.values.as_slice());
    let frames: Vec<&[f64]> = frames.collect();
    let first = densities.first();
    let values = first.map(|_| add(blocks, (&frames, &at), (scale, bits)));
    let is_marginal = first.is_some_and(|one| matches!(one.observable, Observable::Marginal(_)));
    let bands: Option<Vec<_>> = densities.iter().map(|one| band(one)).collect();
    let bands = bands.filter(|_| is_marginal);
    let first_band = bands.as_ref().and_then(|bands| bands.first());
    let band_is = first_band.map(|one| one.1);
    let band = bands.map(|bands| {
        let frames: Vec<&[f64]> = bands.iter().map(|one| one.0.as_slice()).collect();
        add(blocks, (&frames, &at), (Scale::Root, BAND_BITS))
    });
    json!({
        // Numbers of the frames that have a density, ascending.
        "frames": points.iter().map(|one| one.0).collect::<Vec<_>>(),
        "edges": first.map_or(Vec::new(), |one| edges(&one.density.axes)),
        "values": values,
        "band": band,
        "band_is": band_is,
    })
}
