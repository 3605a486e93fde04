//! Looks for a state at which an operation fails.

use std::collections::VecDeque;

use super::{Bounds, Domain, Hazard, HazardKind};
use crate::formula::analysis::Interval;
use crate::formula::arithmetic::{Binary, Unary};
use crate::formula::graph::{Evaluator, Expression, Node, Point};

/// Boxes that are looked at for each operation, and fewer of a very long expression.
const BOXES: usize = 3000;
/// Operations on intervals that are done for each operation that may fail.
const WORK: usize = 10_000_000;
/// Coordinates whose corners are all tried.
const CORNERS: usize = 6;
/// A box this small against the domain, in every direction, is not halved again.
const SMALLEST: f64 = 1e-7;
/// A divisor this small against others counts as zero where it changes its sign.
const NEXT_TO_ZERO: f64 = 1e-6;

/// Finds a state at which an operation fails, or one next to which that could not be excluded.
pub(super) fn search(
    bounds: &mut Bounds<'_>,
    domain: &Domain,
    part: Expression,
    kind: HazardKind,
) -> Option<Hazard> {
    let mut trial = Trial::new(bounds, part, kind);
    let relevant = relevant(bounds, domain, part);
    for corner in corners(domain) {
        if trial.fails(&corner) {
            return Some(trial.hazard(corner, true));
        }
    }
    let mut ahead = VecDeque::from([domain.clone()]);
    let mut thin = Vec::new();
    let mut looked_at = 0;
    let boxes = (WORK / bounds.parts.len().max(1)).clamp(16, BOXES);
    while let Some(next) = ahead.pop_front() {
        if looked_at == boxes {
            // Too many directions to look into all of it.
            return Some(trial.hazard(middle(&next), false));
        }
        looked_at += 1;
        bounds.work_out(&next);
        if !bounds.hazards.contains(&(part, kind)) {
            // Where its operands are in doubt, their own hazards are told.
            continue;
        }
        let here = middle(&next);
        if trial.fails(&here) {
            return Some(trial.hazard(here, true));
        }
        if let Some(zero) = trial.zero_between() {
            return Some(trial.hazard(zero, true));
        }
        match halves(&next, domain, &relevant) {
            Some(halves) => ahead.extend(halves),
            None => thin.push(here),
        }
    }
    // What is left are single points or surfaces, such as the edge of a branch or the zero of a sum of squares. A pole
    // is between two doubles: no state fails, but the values next to it have no bound.
    let near = thin.into_iter().find(|place| match kind {
        HazardKind::Pole => trial.is_needed_at(place),
        _ => trial.is_next_to_zero(place),
    })?;
    Some(trial.hazard(near, kind == HazardKind::Pole))
}

/// A single choice of all coordinates.
#[derive(Debug, Clone)]
struct Assignment {
    states: Vec<f64>,
    parameters: Vec<f64>,
    time: f64,
}

impl Assignment {
    fn point(&self) -> Point<'_> {
        Point {
            states: &self.states,
            parameters: &self.parameters,
            time: self.time,
        }
    }

    fn between(&self, other: &Self) -> Self {
        let mean =
            |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).map(|(a, b)| a + 0.5 * (b - a)).collect();
        Self {
            states: mean(&self.states, &other.states),
            parameters: mean(&self.parameters, &other.parameters),
            time: self.time + 0.5 * (other.time - self.time),
        }
    }
}

fn middle(domain: &Domain) -> Assignment {
    let middle = |intervals: &[Interval]| intervals.iter().map(|x| x.middle()).collect();
    Assignment {
        states: middle(&domain.states),
        parameters: middle(&domain.parameters),
        time: domain.time.middle(),
    }
}

/// All intervals of a domain: states, parameters, time.
fn coordinates(domain: &mut Domain) -> impl Iterator<Item = &mut Interval> {
    let states = domain.states.iter_mut();
    states
        .chain(&mut domain.parameters)
        .chain(std::iter::once(&mut domain.time))
}

/// The corners of a domain in its first few directions.
fn corners(domain: &Domain) -> Vec<Assignment> {
    let mut corners = vec![domain.clone()];
    let count = domain.states.len() + domain.parameters.len() + 1;
    let mut directions = 0;
    for number in 0..count {
        let wide = coordinates(&mut corners[0].clone())
            .nth(number)
            .is_some_and(|interval| interval.is_bounded() && interval.width() > 0.0);
        if !wide || directions == CORNERS {
            continue;
        }
        directions += 1;
        let mut both = Vec::with_capacity(2 * corners.len());
        for corner in corners {
            let (mut low, mut high) = (corner.clone(), corner);
            if let Some(interval) = coordinates(&mut low).nth(number) {
                *interval = Interval::point(interval.low);
            }
            if let Some(interval) = coordinates(&mut high).nth(number) {
                *interval = Interval::point(interval.high);
            }
            both.extend([low, high]);
        }
        corners = both;
    }
    corners.iter().map(middle).collect()
}

/// The directions that change whether an operation fails or is needed, in the order of [`coordinates`].
fn relevant(bounds: &Bounds<'_>, domain: &Domain, part: Expression) -> Vec<bool> {
    let (states, parameters) = (domain.states.len(), domain.parameters.len());
    let mut relevant = vec![false; states + parameters + 1];
    let conditions = bounds
        .parts
        .iter()
        .filter_map(|&own| match bounds.graph.node(own) {
            Node::Select(condition, ..) => Some(condition),
            _ => None,
        });
    for expression in conditions.chain([part]) {
        let dependence = bounds.graph.dependence(expression);
        let of_parameters = dependence.parameters.iter().map(|number| states + number);
        let time = dependence.time.then_some(states + parameters);
        for place in dependence
            .states
            .iter()
            .copied()
            .chain(of_parameters)
            .chain(time)
        {
            if let Some(mark) = relevant.get_mut(place) {
                *mark = true;
            }
        }
    }
    relevant
}

/// Two halves of a box across its widest relevant direction, measured by the domain; `None` if it is thin in all.
fn halves(whole: &Domain, domain: &Domain, relevant: &[bool]) -> Option<[Domain; 2]> {
    let mut domain = domain.clone();
    let mut of_domain = coordinates(&mut domain);
    let mut widest: Option<(usize, f64)> = None;
    for (number, interval) in coordinates(&mut whole.clone()).enumerate() {
        let size = of_domain.next().map_or(0.0, |interval| interval.width());
        let share = if size.is_finite() && size > 0.0 {
            interval.width() / size
        } else {
            0.0
        };
        let matters = relevant.get(number) == Some(&true);
        if matters && share > SMALLEST && widest.is_none_or(|(_, most)| share > most) {
            widest = Some((number, share));
        }
    }
    let (number, _) = widest?;
    let (mut lower, mut upper) = (whole.clone(), whole.clone());
    let lower_half = coordinates(&mut lower).nth(number)?;
    let upper_half = coordinates(&mut upper).nth(number)?;
    let middle = lower_half.middle();
    (lower_half.high, upper_half.low) = (middle, middle);
    Some([lower, upper])
}

/// Evaluates the operation at single places.
struct Trial<'a> {
    graph: &'a crate::formula::graph::Graph,
    expression: Expression,
    parts: Vec<Expression>,
    part: Expression,
    kind: HazardKind,
    evaluator: Evaluator,
    /// Places with a positive and a negative divisor, and the largest divisor so far.
    positive: Option<Assignment>,
    negative: Option<Assignment>,
    largest: f64,
}

impl<'a> Trial<'a> {
    fn new(bounds: &Bounds<'a>, part: Expression, kind: HazardKind) -> Self {
        Self {
            graph: bounds.graph,
            expression: bounds.expression,
            parts: bounds.parts.clone(),
            part,
            kind,
            evaluator: Evaluator::new(bounds.graph, &[bounds.expression]),
            positive: None,
            negative: None,
            largest: 0.0,
        }
    }

    fn hazard(&self, place: Assignment, certain: bool) -> Hazard {
        Hazard {
            kind: self.kind,
            part: self.part,
            state: place.states,
            parameters: place.parameters,
            time: place.time,
            certain,
        }
    }

    /// What is zero where the divisor of a quotient or the base of a power is, and changes its sign there if anything
    /// does: of (1 - x)² it is 1 - x.
    fn divisor(&self) -> Option<Expression> {
        let mut divisor = match self.graph.node(self.part) {
            Node::Binary(Binary::Divide, _, divisor) => divisor,
            Node::Binary(Binary::Power, base, _) => base,
            _ => return None,
        };
        loop {
            divisor = match self.graph.node(divisor) {
                Node::Unary(Unary::Abs | Unary::Sqrt, of) => of,
                Node::Binary(Binary::Multiply, of, same) if of == same => of,
                Node::Binary(Binary::Power, base, exponent) if self.is_positive(exponent) => base,
                _ => return Some(divisor),
            };
        }
    }

    fn is_positive(&self, expression: Expression) -> bool {
        matches!(self.graph.node(expression), Node::Constant(number) if number.value() > 0.0)
    }

    /// Whether the operation is needed at a place and has finite operands but no finite value.
    fn fails(&mut self, place: &Assignment) -> bool {
        self.evaluator.evaluate(self.graph, &place.point());
        if let Some(divisor) = self.divisor().map(|divisor| self.evaluator.value(divisor)) {
            let side = if divisor > 0.0 {
                &mut self.positive
            } else {
                &mut self.negative
            };
            if divisor != 0.0 && divisor.is_finite() && side.is_none() {
                *side = Some(place.clone());
            }
            if divisor.is_finite() {
                self.largest = self.largest.max(divisor.abs());
            }
        }
        let node = self.graph.node(self.part);
        let finite = node
            .operands()
            .all(|operand| self.evaluator.value(operand).is_finite());
        finite && !self.evaluator.value(self.part).is_finite() && self.is_needed()
    }

    fn is_needed_at(&mut self, place: &Assignment) -> bool {
        self.evaluator.evaluate(self.graph, &place.point());
        self.is_needed()
    }

    /// Whether the expression needs the operation at the place last evaluated: no `if` passes it by.
    fn is_needed(&self) -> bool {
        let mut needed = crate::formula::graph::PartMap::new(&self.parts, false);
        needed.set(self.expression, true);
        for &part in self.parts.iter().rev() {
            if needed.get(part) != Some(true) {
                continue;
            }
            match self.graph.node(part) {
                Node::Select(condition, yes, no) => {
                    needed.set(condition, true);
                    let taken = if self.evaluator.value(condition) == 0.0 {
                        no
                    } else {
                        yes
                    };
                    needed.set(taken, true);
                }
                node => node
                    .operands()
                    .for_each(|operand| needed.set(operand, true)),
            }
        }
        needed.get(self.part) == Some(true)
    }

    /// A place between two with divisors of different signs at which the divisor is zero.
    fn zero_between(&mut self) -> Option<Assignment> {
        if self.kind != HazardKind::DivisionByZero {
            return None;
        }
        let (mut above, mut below) = (self.positive.clone()?, self.negative.clone()?);
        for _ in 0..100 {
            let between = above.between(&below);
            let divisor = self.divisor_at(&between)?;
            if divisor == 0.0 {
                above = between;
                break;
            }
            *(if divisor > 0.0 {
                &mut above
            } else {
                &mut below
            }) = between;
        }
        let small = self.divisor_at(&above)?.abs() <= NEXT_TO_ZERO * self.largest;
        if small && self.is_needed() {
            return Some(above);
        }
        // The sign changes by a jump: look for another pair.
        (self.positive, self.negative) = (None, None);
        None
    }

    fn divisor_at(&mut self, place: &Assignment) -> Option<f64> {
        self.evaluator.evaluate(self.graph, &place.point());
        let divisor = self.evaluator.value(self.divisor()?);
        divisor.is_finite().then_some(divisor)
    }

    /// Whether a divisor is very small at a place where it is needed.
    fn is_next_to_zero(&mut self, place: &Assignment) -> bool {
        let limit = NEXT_TO_ZERO * self.largest;
        self.divisor_at(place)
            .is_some_and(|divisor| divisor.abs() <= limit)
            && self.is_needed()
    }
}
