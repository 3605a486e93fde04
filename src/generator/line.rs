//! The flux through every face of one grid line, as weights on the cells around the face.
//!
//! Along a noisy axis y the drift is split into a smooth part, which the grid resolves, and the rest, r: the jumps of
//! friction, and whatever else bends within a few cells. The smooth part is *advected*. The rest is *fitted*: with
//! φ' = -r/D the flux r p - ∂(D p)/∂y is -e^{-φ} ∂(e^{φ} D p)/∂y, exact for the equilibrium D p ∝ e^{-φ}, and the
//! derivative of the smooth product is taken to fourth order. What of r is too strong against diffusion for the grid is
//! advected too. (Damping was fitted once, as far as the grid allows. Where that bends along a line, the error is of
//! second order and far above what schemes differ by: docs/accuracy.md.)
//!
//! At a switching surface r jumps and φ has a kink. Density and flux are continuous there, hence D p e^{φ} is
//! smooth to first order and its stencils may cross the surface: the kink of the density sits in φ, exactly,
//! and the scheme is the same at every friction level. The advected part takes p e^{φ} there too. (Stencils closed
//! on either side, with a penalty on the jump, were measured to be no better on a graded axis and half as accurate on a
//! uniform one.)

use super::geometry::{AxisGeometry, End};
use super::scheme::{REACH, Window};
use super::smooth::SmoothPart;

/// Largest change of φ over a cell that is fitted; what is left is advected. Below half of it nothing is held back.
const FITTED_LIMIT: f64 = 2.0;

/// Drift and diffusion along a line. Each cell has four quadrature points, two Gauss points a half-cell.
#[derive(Debug, Default, Clone)]
pub(super) struct Line {
    /// Drift along the axis at the nodes.
    pub(super) drift: Vec<f64>,
    /// Drift at the quadrature points, `4 cells`; empty on an axis without noise.
    pub(super) inner_drift: Vec<f64>,
    /// Diffusion D = Σ b²/2 at the nodes; empty on an axis without noise.
    pub(super) diffusion: Vec<f64>,
    /// Diffusion at the quadrature points.
    pub(super) inner_diffusion: Vec<f64>,
    smooth: SmoothPart,
    advected: Vec<f64>,
    /// By what the advected density is damped.
    speed: Vec<f64>,
    potential: Vec<f64>,
    face_potential: Vec<f64>,
    gradient: Vec<Window>,
}

/// The identity below half of `FITTED_LIMIT`, then bending to it with two continuous derivatives.
fn limited(change: f64) -> f64 {
    let free = 0.5 * FITTED_LIMIT;
    let size = change.abs();
    if size <= free {
        return change;
    }
    let excess = (size - free) / (FITTED_LIMIT - free);
    let bent = free + (FITTED_LIMIT - free) * excess / (1.0 + excess * excess).sqrt();
    bent.copysign(change)
}

/// -dφ/dy: drift over diffusion, held back where a cell of this width cannot resolve it.
fn fitted_rate(rest: f64, diffusion: f64, width: f64) -> f64 {
    limited(rest * width / diffusion.max(f64::MIN_POSITIVE)) / width
}

impl Line {
    /// All that was sampled: drift and diffusion at the nodes, and at the quadrature points.
    pub(super) fn samples(&mut self) -> [&mut Vec<f64>; 4] {
        [
            &mut self.drift,
            &mut self.inner_drift,
            &mut self.diffusion,
            &mut self.inner_diffusion,
        ]
    }

    /// Makes of the samples what the fluxes of all schemes share.
    pub(super) fn prepare(&mut self, axis: &AxisGeometry) {
        self.speed.clear();
        if self.is_noisy() {
            self.split(axis);
            self.damp(axis);
            self.gradients(axis);
        } else {
            self.advected.clone_from(&self.drift);
            self.speed
                .extend(self.drift.iter().map(|drift| drift.abs()));
        }
    }

    fn is_noisy(&self) -> bool {
        !self.diffusion.is_empty()
    }

    /// Writes the weights of the flux toward larger coordinates through each face: `fluxes[face][k]` multiplies
    /// the unknown of cell `face + k - 3`. At an open end the flux is what leaves, never what comes in. The line has
    /// been prepared with the same axis, or one of another advective scheme; derivatives beside walls are the scheme's.
    pub(super) fn fluxes(&mut self, axis: &AxisGeometry, fluxes: &mut [Window]) {
        if self.is_noisy() && axis.has_wall_stencils {
            self.gradients(axis);
        }
        for (face, flux) in fluxes.iter_mut().enumerate() {
            *flux = self.advective(axis, face);
        }
        if self.is_noisy() {
            for (face, flux) in fluxes.iter_mut().enumerate() {
                self.add_fitted(axis, face, flux);
            }
        }
        let last = axis.count();
        fluxes[0] = self.end_flux(axis, false);
        fluxes[last] = self.end_flux(axis, true);
    }

    /// Splits the drift, and integrates the potential from the lower end.
    fn split(&mut self, axis: &AxisGeometry) {
        self.smooth.follow(&self.inner_drift);
        self.advected.clear();
        self.potential.clear();
        self.face_potential.clear();
        let mut potential = 0.0;
        self.face_potential.push(potential);
        for cell in 0..axis.count() {
            let (node, width) = (axis.nodes[cell], axis.widths[cell]);
            let smooth = self.smooth.inside(cell, axis.inner_offsets[cell]);
            let rate = |point: usize| {
                let rest = self.inner_drift[4 * cell + point] - smooth[point];
                fitted_rate(rest, self.inner_diffusion[4 * cell + point], width)
            };
            potential -= 0.5 * (node - axis.edges[cell]) * (rate(0) + rate(1));
            self.potential.push(potential);
            potential -= 0.5 * (axis.edges[cell + 1] - node) * (rate(2) + rate(3));
            self.face_potential.push(potential);
            let (drift, diffusion) = (self.drift[cell], self.diffusion[cell]);
            let fitted =
                diffusion * fitted_rate(drift - self.smooth.at_node(cell), diffusion, width);
            self.advected.push(drift - fitted);
        }
    }

    /// Speed |a| of damping, less where diffusion damps a cell anyway: a P/√(P² + 1) with P = a h/D. It is analytic in
    /// the drift, so that Q has a derivative by a parameter at which the drift changes its sign in a cell.
    fn damp(&mut self, axis: &AxisGeometry) {
        let noise = self.diffusion.iter().zip(&axis.widths);
        let noise = noise.map(|(diffusion, width)| diffusion / width);
        let speeds = self.advected.iter().zip(noise);
        self.speed.extend(speeds.map(|(drift, noise)| {
            let scale = drift.hypot(noise).max(f64::MIN_POSITIVE);
            drift * (drift / scale)
        }));
    }

    /// Central flux of the drift times the density, less dissipation.
    fn advective(&self, axis: &AxisGeometry, face: usize) -> Window {
        let stencil = &axis.stencils[face];
        let mut flux = [0.0; 2 * REACH];
        if face == 0 || face == axis.count() {
            return flux;
        }
        let speed = 0.5 * (self.speed[face - 1] + self.speed[face]);
        let share = match axis.is_across[face] && stencil.corrected {
            true => self.share_of_fit(axis, face),
            false => 0.0,
        };
        for (k, weight) in flux.iter_mut().enumerate() {
            let (central, dissipation) = (stencil.central[k], stencil.dissipation[k]);
            if central != 0.0 || dissipation != 0.0 {
                let cell = face + k - REACH;
                let mut carried = central * self.advected[cell];
                if share > 0.0 {
                    carried *= (share * (self.potential[cell] - self.face_potential[face])).exp();
                }
                *weight = (carried - speed * dissipation) / axis.widths[cell];
            }
        }
        if share > 0.0 {
            self.add_bend(axis, (face, share), &mut flux);
        }
        flux
    }

    /// The share of φ with which the advected density is multiplied where a stencil reaches across a switching surface:
    /// nearly all of it as long as φ and what is advected change the density by less than a factor e over a cell, and
    /// next to nothing where they change it by e² or more, as the product is no smoother than the density there. It is
    /// analytic in the drift, as [`Self::damp`] is.
    fn share_of_fit(&self, axis: &AxisGeometry, face: usize) -> f64 {
        let cells = face.saturating_sub(REACH)..(face + REACH).min(axis.count());
        let (mut fitted, mut advected, mut distances) = (0.0, 0.0, 0.0);
        let all = cells.len() as f64;
        for cell in cells {
            let distance = cell as f64 + 0.5 - face as f64;
            distances += distance * distance;
            fitted += (self.potential[cell] - self.face_potential[face]).powi(2);
            let change = self.advected[cell] * axis.widths[cell];
            advected += (change / self.diffusion[cell].max(f64::MIN_POSITIVE)).powi(2) / all;
        }
        let squared = fitted / distances + advected;
        1.0 / (1.0 + (0.5 * squared).powi(4))
    }

    /// Where a stencil reaches across a switching surface, the drift times the density is reconstructed as its product
    /// with e^φ (or a share of φ), which has no kink. What a difference of fluxes wants is f - f''/24 of the flux f
    /// itself: what second differences of f over faces are more than those of the product is added here.
    fn add_bend(&self, axis: &AxisGeometry, (face, share): (usize, f64), flux: &mut Window) {
        for beside in [face - 1, face + 1] {
            let change = share * (self.face_potential[beside] - self.face_potential[face]);
            let missing = change.exp_m1() / 24.0;
            let is_whole = beside >= 2 && beside + 1 < axis.count();
            let weights = if is_whole {
                [-1.0, 9.0, 9.0, -1.0]
            } else {
                [0.0, 8.0, 8.0, 0.0]
            };
            for (cell, weight) in (0..4).zip(weights).filter(|(_, weight)| *weight != 0.0) {
                let cell = beside + cell - 2;
                let change = share * (self.potential[cell] - self.face_potential[beside]);
                let value = self.advected[cell] / axis.widths[cell] * change.exp();
                flux[cell + REACH - face] += missing * weight / 16.0 * value;
            }
        }
    }

    /// D p e^{φ} of a cell, per unknown, relative to the potential of a face.
    fn fitted_density(&self, axis: &AxisGeometry, face: usize, cell: usize) -> f64 {
        let potential = self.potential[cell] - self.face_potential[face];
        self.diffusion[cell] / axis.widths[cell] * potential.exp()
    }

    /// Point values of the fitted flux at the faces; none at the ends.
    fn gradients(&mut self, axis: &AxisGeometry) {
        let mut gradient = std::mem::take(&mut self.gradient);
        gradient.clear();
        for (face, stencil) in axis.stencils.iter().enumerate() {
            let mut window = [0.0; 2 * REACH];
            for (k, weight) in window.iter_mut().enumerate() {
                if stencil.derivative[k] != 0.0 {
                    let density = self.fitted_density(axis, face, face + k - REACH);
                    *weight = -stencil.derivative[k] * density / axis.face_widths[face];
                }
            }
            gradient.push(window);
        }
        self.gradient = gradient;
    }

    /// Adds the fitted flux J as J - J''/24, whose differences are the derivative of J to fourth order.
    fn add_fitted(&self, axis: &AxisGeometry, face: usize, flux: &mut Window) {
        let here = &self.gradient[face];
        if !axis.stencils[face].corrected {
            for (weight, here) in flux.iter_mut().zip(here) {
                *weight += here;
            }
            return;
        }
        // The windows of the neighbouring faces are shifted by a cell; their outermost weights are zero.
        let (lower, upper) = (&self.gradient[face - 1], &self.gradient[face + 1]);
        for k in 0..2 * REACH {
            let below = lower.get(k + 1).copied().unwrap_or(0.0);
            let above = k.checked_sub(1).map_or(0.0, |k| upper[k]);
            flux[k] += here[k] + (2.0 * here[k] - below - above) / 24.0;
        }
    }

    /// Flux through the lower or upper end: nothing through a wall, else what drifts and diffuses through half a cell
    /// to where the density is zero.
    fn end_flux(&self, axis: &AxisGeometry, upper: bool) -> Window {
        let mut flux = [0.0; 2 * REACH];
        if axis.ends[usize::from(upper)] == End::Wall {
            return flux;
        }
        let (cell, face, place, outward) = if upper {
            (axis.count() - 1, axis.count(), REACH - 1, 1.0)
        } else {
            (0, 0, REACH, -1.0)
        };
        let drift = outward * self.drift[cell];
        let diffusion = self.diffusion.get(cell).copied().unwrap_or(0.0);
        let speed = 2.0 * diffusion / axis.face_widths[face];
        flux[place] = outward * outflow(drift, speed) / axis.widths[cell];
        flux
    }
}

/// Rate at which a density leaves across a layer beyond which there is none, for the drift and the diffusion over the
/// thickness of the layer: P/(1 - e^{-P}) times the latter, P their ratio.
fn outflow(drift: f64, diffusion: f64) -> f64 {
    let ratio = drift / diffusion;
    if ratio.abs() < f64::EPSILON {
        return diffusion;
    }
    if !ratio.is_finite() {
        return drift.max(0.0);
    }
    drift / -(-ratio).exp_m1()
}
