//! A system whose white noises come through filters, the states of which are axes of its own.

use std::sync::{Arc, OnceLock};

use super::filter::Filter;
use crate::system::{Facts, LANES, Lanes, Noise, Symmetry, System};

/// A system whose white noises come through filters, the states of which are axes after those of the system, noise by
/// noise.
pub(super) struct Filtered {
    system: Arc<dyn System>,
    /// Axes of the system without its filters.
    own: usize,
    filter: Filter,
    /// On the last axis of each filter.
    noises: Vec<Noise>,
    facts: OnceLock<Facts>,
}

impl Filtered {
    pub(super) fn new(system: Arc<dyn System>, filter: Filter) -> Self {
        let (own, states) = (system.dimension(), filter.states());
        let channels = 1..=system.noises().len();
        let noises =
            channels.map(|number| Noise::constant(own + number * states - 1, filter.amplitude));
        Self {
            own,
            noises: noises.collect(),
            facts: OnceLock::new(),
            filter,
            system,
        }
    }

    fn find_facts(&self) -> Facts {
        let mut facts = self.system.facts().clone();
        facts
            .relaxation_rates
            .retain(|&axis, _| !self.system.is_noisy(axis));
        let filters = self.own..self.dimension();
        facts.filtered_noise = filters.map(|axis| (axis, (0.0, 1.0))).collect();
        facts.symmetry = facts.symmetry.and_then(|symmetry| self.extend(symmetry));
        facts
    }

    /// The symmetry of the system with its filters: each goes with the axis that it drives.
    fn extend(&self, mut symmetry: Symmetry) -> Option<Symmetry> {
        let noises = self.system.noises().iter();
        let filters = noises.map(|noise| {
            let odd = self.is_odd(noise, &symmetry)?;
            Some(symmetry.reflected[noise.axis] != odd)
        });
        let filters = filters.collect::<Option<Vec<bool>>>()?.into_iter();
        let states = self.filter.states();
        let reflected = filters.flat_map(|one| std::iter::repeat_n(one, states));
        symmetry.reflected.extend(reflected);
        symmetry.centre.resize(self.dimension(), 0.0);
        Some(symmetry)
    }

    /// Whether an amplitude changes its sign with a reflection of the system: its noise is then reflected too, but for
    /// the axis's own sign. `None` where it does neither.
    fn is_odd(&self, noise: &Noise, symmetry: &Symmetry) -> Option<bool> {
        if noise.additive().is_some() {
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
            .map(|axis| states[axis].map(|x| symmetry.image(axis, x)))
            .collect();
        let (here, there) = (
            noise.amplitudes(0.0, &states),
            noise.amplitudes(0.0, &images),
        );
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
        self.own + self.noises.len() * self.filter.states()
    }

    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let (own, filters) = states.split_at(self.own);
        let (slopes, relaxations) = drift.split_at_mut(self.own);
        self.system.drift(time, own, slopes);
        let size = self.filter.states();
        let filters = filters
            .chunks_exact(size)
            .zip(relaxations.chunks_exact_mut(size));
        for (noise, (filter, rates)) in self.system.noises().iter().zip(filters) {
            let amplitude = noise.amplitudes(time, own);
            let slopes = &mut slopes[noise.axis];
            for lane in 0..LANES {
                slopes[lane] += self.filter.gain * amplitude[lane] * filter[0][lane];
            }
            self.filter.rates(filter, rates);
        }
    }

    fn noises(&self) -> &[Noise] {
        &self.noises
    }

    fn facts(&self) -> &Facts {
        self.facts.get_or_init(|| self.find_facts())
    }
}
