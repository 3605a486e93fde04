//! Drift and diffusion along grid lines, evaluated in batches.

use super::GeneratorError;
use super::geometry::{AxisGeometry, inner_points};
use super::line::Line;
use crate::MAX_DIMENSION;
use crate::system::{LANES, Lanes, System};

/// The quadrature points of every cell, ascending: `4 count` coordinates.
pub(super) fn quadrature_points(axis: &AxisGeometry) -> Vec<f64> {
    let mut points = Vec::with_capacity(4 * axis.count());
    for (cell, &node) in axis.nodes.iter().enumerate() {
        points.extend(inner_points([axis.edges[cell], node, axis.edges[cell + 1]]));
    }
    points
}

/// Distance from a plane at which its sides are told apart, as a share of the distance of the nodes on both sides.
const BESIDE: f64 = 1e-9;

/// Distance over which slopes on the sides of a plane are taken, as the same share. Over half a cell a drift that
/// bends evenly would turn at the plane too, by as much as makes errors of third order.
const NEAR: f64 = 1e-4;

/// Evaluates drift and diffusion along grid lines, with buffers that are kept from line to line.
pub(super) struct LineSampler<'a> {
    system: &'a dyn System,
    axis: usize,
    is_noisy: bool,
    /// State through which the line goes; the entry of its own axis is ignored.
    pub(super) state: [f64; MAX_DIMENSION],
    states: [Lanes; MAX_DIMENSION],
    drift: [Lanes; MAX_DIMENSION],
    /// What was sampled.
    pub(super) line: Line,
}

impl<'a> LineSampler<'a> {
    pub(super) fn new(system: &'a dyn System, axis: usize) -> Self {
        Self {
            system,
            axis,
            is_noisy: system.is_noisy(axis),
            state: [0.0; MAX_DIMENSION],
            states: [[0.0; LANES]; MAX_DIMENSION],
            drift: [[0.0; LANES]; MAX_DIMENSION],
            line: Line::default(),
        }
    }

    /// Fills the line with values at the nodes and, on a noisy axis, at the quadrature points.
    pub(super) fn sample(
        &mut self,
        nodes: &[f64],
        quadrature: &[f64],
    ) -> Result<(), GeneratorError> {
        let mut line = std::mem::take(&mut self.line);
        self.evaluate(nodes, &mut line.drift, &mut line.diffusion)?;
        if self.is_noisy {
            self.evaluate(quadrature, &mut line.inner_drift, &mut line.inner_diffusion)?;
        }
        self.line = line;
        Ok(())
    }

    /// Corrects what was sampled on a line of cells beside a plane across another axis, at which coefficients bend. The
    /// flux f along that axis leaves (h/48) Δ(∂²f/∂x²) too much there, which by the equation is what rates that are
    /// h/48 times the jump of their slope too high make of p (`AdvectiveScheme::at_break`), whether noise acts across
    /// the plane or not. Where coefficients jump, the slope of p does too, which `LineRates` makes good.
    pub(super) fn correct(
        &mut self,
        (axis, plane): (usize, f64),
        [below, above]: [f64; 2],
        nodes: &[f64],
        quadrature: &[f64],
    ) -> Result<(), GeneratorError> {
        let mut own = std::mem::take(&mut self.line);
        let (here, size) = (self.state[axis], above - below);
        let places = [-NEAR - BESIDE, -BESIDE, BESIDE, NEAR + BESIDE];
        let places = places.map(|share| plane + share * size);
        let mut sampled = Vec::with_capacity(places.len());
        for place in places {
            self.state[axis] = place;
            self.sample(nodes, quadrature)?;
            sampled.push(std::mem::take(&mut self.line));
        }
        self.state[axis] = here;
        // Of the cell whose node the line goes through.
        let width = 2.0 * (here - plane).abs();
        for (kind, values) in own.samples().into_iter().enumerate() {
            for (index, value) in values.iter_mut().enumerate() {
                let [below_it, left, right, above_it] =
                    [0, 1, 2, 3].map(|place: usize| sampled[place].samples()[kind][index]);
                let bend = (above_it - right) - (left - below_it);
                *value -= width / 48.0 * bend / (NEAR * size);
            }
        }
        self.line = own;
        Ok(())
    }

    fn evaluate(
        &mut self,
        coordinates: &[f64],
        drift: &mut Vec<f64>,
        diffusion: &mut Vec<f64>,
    ) -> Result<(), GeneratorError> {
        let dimension = self.system.dimension();
        drift.clear();
        diffusion.clear();
        for (lanes, &value) in self.states.iter_mut().zip(&self.state) {
            lanes.fill(value);
        }
        for batch in coordinates.chunks(LANES) {
            self.states[self.axis][..batch.len()].copy_from_slice(batch);
            let states = &self.states[..dimension];
            self.system.drift(0.0, states, &mut self.drift[..dimension]);
            drift.extend_from_slice(&self.drift[self.axis][..batch.len()]);
            if self.is_noisy {
                let mut sum = [0.0; LANES];
                for noise in self.system.noises_on(self.axis) {
                    for (sum, amplitude) in sum.iter_mut().zip(noise.amplitudes(0.0, states)) {
                        *sum += 0.5 * amplitude * amplitude;
                    }
                }
                diffusion.extend_from_slice(&sum[..batch.len()]);
            }
        }
        if drift
            .iter()
            .chain(diffusion.iter())
            .all(|value| value.is_finite())
        {
            return Ok(());
        }
        Err(GeneratorError::NotFinite {
            axis: self.axis,
            state: self.state[..dimension].to_vec(),
        })
    }
}
