//! Trajectories between two regions, a batch at a time: in which of the two each was last, for how long, and how long
//! it was on its way from the one to the other.
//!
//! Where noise acts on the level of a region, a trajectory may have been inside between two states that are outside, as
//! in `walk.rs`. The first moment inside within a step is drawn from the bridge's distribution, and the last one from
//! the same of the bridge with its time turned round.

use super::batch::{Limits, Purpose};
use super::passing::Passing;
use super::walk::{Border, Chance, Meeting, StepLevels};
use crate::sampling::Stepper;
use crate::system::{LANES, Lanes};

/// The region that is left, and the one that is come to, by their places.
const FROM: usize = 0;
const TO: usize = 1;

/// Exponent from which on a probability e^-x is none.
const NEVER: f64 = 40.0;

/// Levels of a region, and the root of the variance that noise gives each per unit of time.
type Levels = (Lanes, Lanes);

/// What was counted on a trajectory.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct TransitionCounts {
    /// How often it came to the second region from the first one.
    pub(super) transitions: f64,
    /// Time that it was on its way then.
    pub(super) on_way: f64,
    /// Time during which the first region was the last one of the two.
    pub(super) from_last: f64,
    /// Time during which it was known which of the two was.
    pub(super) time: f64,
}

impl TransitionCounts {
    /// This one and so many times another.
    pub(super) fn plus(&self, times: f64, other: &Self) -> Self {
        Self {
            transitions: self.transitions + times * other.transitions,
            on_way: self.on_way + times * other.on_way,
            from_last: self.from_last + times * other.from_last,
            time: self.time + times * other.time,
        }
    }
}

/// The random numbers with which a batch meets borders during one step, or during the two halves of it: both time steps
/// have the same ones.
#[derive(Clone, Copy)]
pub(super) struct Chances {
    pub(super) seed: u64,
    /// Number of the step and the batch; no two have the same.
    pub(super) number: u64,
}

impl Chances {
    /// Those of a trajectory and a region; `drawn` of them were used up in this step.
    fn of(&self, lane: usize, region: usize, drawn: u8) -> Chance {
        let lane = self.number * LANES as u64 + lane as u64;
        let number = (lane * 2 + region as u64) * 4 + u64::from(drawn);
        Chance::new(self.seed, Purpose::Meeting, number)
    }
}

/// Trajectories with one time step.
pub(super) struct Crossings<'a> {
    borders: &'a [Border<'a>; 2],
    stepper: Stepper<'a>,
    time_step: f64,
    states: Vec<Lanes>,
    /// Levels of both regions.
    seen: [Levels; 2],
    /// Which trajectories have passed through either region in the step that is being made.
    passing: [[Option<Passing>; LANES]; 2],
    /// Probability that a region was not met since random numbers were used up, and how many were.
    unmet: [Lanes; 2],
    drawn: [[u8; LANES]; 2],
    /// The region that each was in last.
    region: [Option<usize>; LANES],
    /// The last moment in the first region, and the first one there since the second.
    left: Lanes,
    came: Lanes,
    /// Since when a trajectory counts; infinite where it is not known yet in which region it was last.
    begun: Lanes,
    tallies: [TransitionCounts; LANES],
    steps: u64,
}

impl<'a> Crossings<'a> {
    pub(super) fn new(
        borders: &'a [Border<'a>; 2],
        (stepper, time_step): (Stepper<'a>, f64),
        states: Vec<Lanes>,
    ) -> Self {
        Self {
            seen: [FROM, TO].map(|region| borders[region].at(&states, time_step)),
            borders,
            stepper,
            time_step,
            states,
            passing: [const { [const { None }; LANES] }; 2],
            unmet: [[1.0; LANES]; 2],
            drawn: [[0; LANES]; 2],
            region: [None; LANES],
            left: [0.0; LANES],
            came: [0.0; LANES],
            begun: [f64::INFINITY; LANES],
            tallies: [TransitionCounts::default(); LANES],
            steps: 0,
        }
    }

    fn now(&self) -> f64 {
        self.steps as f64 * self.time_step
    }

    /// Forgets what was counted.
    pub(super) fn begin(&mut self) {
        self.tallies = [TransitionCounts::default(); LANES];
        let now = self.now();
        let known = self.begun.iter_mut().filter(|begun| begun.is_finite());
        known.for_each(|begun| *begun = now);
    }

    /// New random numbers for the steps that follow.
    pub(super) fn renew(&mut self) {
        self.unmet = [[1.0; LANES]; 2];
        self.drawn = [[0; LANES]; 2];
    }

    pub(super) fn step(&mut self, normals: &[Lanes], chances: &Chances) {
        let states = self.states.clone();
        self.stepper.advance_with(&mut self.states, 0, 1, normals);
        let before = self.seen;
        self.seen = [FROM, TO].map(|region| self.borders[region].at(&self.states, self.time_step));
        self.passing = [FROM, TO].map(|region| {
            let levels = [&before[region].0, &self.seen[region].0];
            self.borders[region].passing([&states, &self.states], levels)
        });
        let near = [FROM, TO].map(|region| self.near(&before, region));
        for (lane, near_from) in near[FROM].into_iter().enumerate() {
            let waits_for_second = self.region[lane] != Some(TO);
            if !(near_from || waits_for_second && near[TO][lane]) {
                continue;
            }
            let of_from = self.met(&before, (lane, FROM), chances);
            match (self.region[lane], of_from) {
                (Some(FROM), _) => match self.met(&before, (lane, TO), chances) {
                    Some(of_to) => self.arrive(lane, of_from, of_to),
                    None => {
                        if let Some(meeting) = of_from {
                            self.left[lane] = self.moment(meeting.last);
                        }
                    }
                },
                (_, Some(meeting)) => {
                    let came = self.moment(meeting.first);
                    self.came[lane] = came;
                    self.left[lane] = self.moment(meeting.last).max(came);
                    self.begun[lane] = self.begun[lane].min(came);
                    self.region[lane] = Some(FROM);
                }
                (None, None) => {
                    if let Some(meeting) = self.met(&before, (lane, TO), chances) {
                        self.begun[lane] = self.moment(meeting.first);
                        self.region[lane] = Some(TO);
                    }
                }
                (Some(_), None) => {}
            }
        }
        self.steps += 1;
    }

    /// Which trajectories may have met a region in the step that was made.
    fn near(&self, before: &[Levels; 2], region: usize) -> [bool; LANES] {
        let ((from, speeds), (to, next_speeds)) = (&before[region], &self.seen[region]);
        let unit = 0.5 * NEVER * self.time_step;
        std::array::from_fn(|lane| {
            let is_far = from[lane] * to[lane] >= unit * speeds[lane] * next_speeds[lane];
            let passes = self.passing[region][lane].is_some();
            from[lane] < 0.0 || to[lane] < 0.0 || !is_far || passes
        })
    }

    /// The moment of a share of the step that is being made.
    fn moment(&self, share: f64) -> f64 {
        (self.steps as f64 + share) * self.time_step
    }

    /// A trajectory comes to the second region from the first one, which it may have met in the same step.
    fn arrive(&mut self, lane: usize, of_from: Option<Meeting>, of_to: Meeting) {
        let arrived = self.moment(of_to.first);
        let left = of_from.map(|meeting| self.moment(meeting.last.min(of_to.first)));
        let tally = &mut self.tallies[lane];
        tally.transitions += 1.0;
        tally.on_way += arrived - left.unwrap_or(self.left[lane]);
        tally.from_last += arrived - self.came[lane].max(self.begun[lane]);
        self.region[lane] = Some(TO);
    }

    /// How a trajectory met a region in the step that was made; `None` where it did not.
    fn met(
        &mut self,
        before: &[Levels; 2],
        (lane, region): (usize, usize),
        chances: &Chances,
    ) -> Option<Meeting> {
        let at = |(levels, speeds): &Levels| (levels[lane], speeds[lane]);
        let ends = StepLevels::new(at(&before[region]), at(&self.seen[region]), self.time_step);
        let (unmet, drawn) = (&mut self.unmet[region][lane], &mut self.drawn[region][lane]);
        match (ends.before < 0.0, ends.after < 0.0) {
            (true, true) => Some(Meeting {
                first: 0.0,
                last: 1.0,
            }),
            (false, false) => {
                if let Some(passing) = &self.passing[region][lane] {
                    let chance = chances.of(lane, region, *drawn);
                    (*unmet, *drawn) = (1.0, *drawn + 1);
                    let [after, first] = passing.beyond;
                    let last = ends.backward(at(&self.seen[region]), first);
                    return Some(Meeting {
                        first: ends
                            .onward(at(&before[region]), after)
                            .meeting(&chance)
                            .first,
                        last: last.meeting(&chance).last,
                    });
                }
                let factor = ends.unmet();
                if factor == 1.0 {
                    return None;
                }
                *unmet *= factor;
                let chance = chances.of(lane, region, *drawn);
                if *unmet >= chance.unmet {
                    return None;
                }
                (*unmet, *drawn) = (1.0, *drawn + 1);
                Some(ends.meeting(&chance))
            }
            _ => Some(ends.meeting(&chances.of(lane, region, *drawn))),
        }
    }

    /// What was counted up to now.
    pub(super) fn tallies(&self) -> [TransitionCounts; LANES] {
        let now = self.now();
        std::array::from_fn(|lane| {
            let mut tally = self.tallies[lane];
            let begun = self.begun[lane];
            if self.region[lane] == Some(FROM) {
                tally.from_last += now - self.came[lane].max(begun);
            }
            tally.time = (now - begun).max(0.0);
            tally
        })
    }

    /// Trajectories that have run away.
    pub(super) fn runaways(&self, limits: &Limits) -> usize {
        let ran = |lane: &usize| {
            let state: Vec<f64> = self.states.iter().map(|lanes| lanes[*lane]).collect();
            !limits.hold(&state)
        };
        (0..LANES).filter(ran).count()
    }
}
