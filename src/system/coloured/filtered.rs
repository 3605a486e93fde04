//! A system whose white noises come through filters, the states of which are axes of its own.

use std::sync::Arc;

use super::filter::Filter;
use crate::system::{LANES, Lanes, SwitchingSurface, Symmetry, System};

/// A system whose white noises come through filters, the states of which are axes after those of the system, noise by
/// noise.
pub(super) struct Filtered {
    system: Arc<dyn System>,
    /// Axes of the system without its filters.
    own: usize,
    filter: Filter,
    /// The last axis of each filter.
    noise_axes: Vec<usize>,
}

impl Filtered {
    pub(super) fn new(system: Arc<dyn System>, filter: Filter) -> Self {
        let (own, states) = (system.dimension(), filter.states());
        let channels = 0..system.noise_axes().len();
        Self {
            own,
            noise_axes: channels
                .map(|channel| own + (channel + 1) * states - 1)
                .collect(),
            filter,
            system,
        }
    }

    /// Whether an amplitude changes its sign with a reflection of the system: its noise is then reflected too, but for
    /// the axis's own sign. `None` where it does neither.
    fn is_odd(&self, channel: usize, symmetry: &Symmetry) -> Option<bool> {
        if self.system.additive_amplitude(channel).is_some() {
            return Some(false);
        }
        let states: Vec<Lanes> = (0..self.own)
            .map(|axis| {
                let centre = symmetry.centre[axis];
                // Spread over both sides of the centre, of no simple ratio between the axes.
                let step = 0.618_033_988_75 + 0.07 * axis as f64;
                std::array::from_fn(|lane| {
                    centre + 4.0 * (((lane + 1) as f64 * step).fract() - 0.5)
                })
            })
            .collect();
        let images: Vec<Lanes> = (0..self.own)
            .map(|axis| match symmetry.reflected[axis] {
                true => states[axis].map(|x| 2.0 * symmetry.centre[axis] - x),
                false => states[axis],
            })
            .collect();
        let at = |states: &[Lanes]| {
            let mut amplitude = [0.0; LANES];
            self.system.amplitude(channel, 0.0, states, &mut amplitude);
            amplitude
        };
        let (here, there) = (at(&states), at(&images));
        let size = here.iter().map(|b| b.abs()).fold(0.0, f64::max);
        let mut signs = [1.0, -1.0].into_iter();
        let sign = signs.find(|sign| {
            let mut pairs = here.iter().zip(&there);
            pairs.all(|(b, image)| (image - sign * b).abs() <= 1e-9 * size)
        });
        sign.map(|sign| sign < 0.0)
    }
}

impl System for Filtered {
    fn dimension(&self) -> usize {
        self.own + self.noise_axes.len() * self.filter.states()
    }

    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let (own, filters) = states.split_at(self.own);
        let (slopes, relaxations) = drift.split_at_mut(self.own);
        self.system.drift(time, own, slopes);
        let driven = self.system.noise_axes();
        let size = self.filter.states();
        let channels = filters
            .chunks_exact(size)
            .zip(relaxations.chunks_exact_mut(size));
        for (channel, (filter, rates)) in channels.enumerate() {
            let mut amplitude = [0.0; LANES];
            self.system.amplitude(channel, time, own, &mut amplitude);
            let slopes = &mut slopes[driven[channel]];
            for lane in 0..LANES {
                slopes[lane] += self.filter.gain * amplitude[lane] * filter[0][lane];
            }
            self.filter.rates(filter, rates);
        }
    }

    fn noise_axes(&self) -> &[usize] {
        &self.noise_axes
    }

    fn additive_amplitude(&self, channel: usize) -> Option<f64> {
        (channel < self.noise_axes.len()).then_some(self.filter.amplitude)
    }

    fn period(&self) -> Option<f64> {
        self.system.period()
    }

    fn bounds(&self, axis: usize) -> Option<(f64, f64)> {
        (axis < self.own)
            .then(|| self.system.bounds(axis))
            .flatten()
    }

    fn filtered_noise(&self, axis: usize) -> Option<(f64, f64)> {
        (self.own..self.dimension())
            .contains(&axis)
            .then_some((0.0, 1.0))
    }

    fn relaxation_rate(&self, axis: usize) -> Option<f64> {
        let is_driven = self.system.noise_axes().contains(&axis);
        (axis < self.own && !is_driven)
            .then(|| self.system.relaxation_rate(axis))
            .flatten()
    }

    fn switching_surfaces(&self) -> Vec<SwitchingSurface> {
        self.system.switching_surfaces()
    }

    /// That of the system; a filter goes with the axis that it drives.
    fn symmetry(&self) -> Option<Symmetry> {
        let mut symmetry = self.system.symmetry()?;
        let driven = self.system.noise_axes();
        let filters: Option<Vec<bool>> = (0..driven.len())
            .map(|channel| {
                let odd = self.is_odd(channel, &symmetry)?;
                Some(symmetry.reflected[driven[channel]] != odd)
            })
            .collect();
        let states = self.filter.states();
        let filters = filters?.into_iter();
        let reflected = filters.flat_map(|one| std::iter::repeat_n(one, states));
        symmetry.reflected.extend(reflected);
        symmetry.centre.resize(self.dimension(), 0.0);
        Some(symmetry)
    }
}
