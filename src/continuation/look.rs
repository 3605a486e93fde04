//! What a closer look has found, and how its rows take the place of those of the sweep.

use super::label::{self, Label, Located};
use super::solved_point::{is_coarse, least_shown};
use super::{BifurcationStatus, CellCheck, Doubt, Point, SweepResult};
use crate::density::Observable;
use crate::numerics::sort_ascending;
use crate::topology::{DetectOptions, Detection, Signature};

/// What is counted in an observable at a value.
pub(super) fn counted<'p>(
    mut points: impl Iterator<Item = &'p Point>,
    value: f64,
    place: usize,
) -> Option<Signature> {
    let point = points.find(|point| point.value == value)?;
    Some(point.detections.get(place)?.signature)
}

/// From the last value before a row at which its observable is counted as before it to the first one after it at which
/// it is counted as after it; the row's own ends where there are none. Between them its own pair is what may not be
/// sure.
pub(super) fn counted_around<'p>(
    points: impl DoubleEndedIterator<Item = &'p Point> + Clone,
    row: &Located,
    place: usize,
) -> [f64; 2] {
    let [lower, upper] = row.hull();
    let counting = |signature: Signature| {
        let counted = points.clone().filter(move |one| {
            let shown = one.detections.get(place);
            shown.is_some_and(|shown| shown.signature == signature)
        });
        counted.map(|one| one.value)
    };
    let below = counting(row.before).rfind(|value| *value <= lower);
    let above = counting(row.after).find(|value| *value >= upper);
    [below.unwrap_or(lower), above.unwrap_or(upper)]
}

/// What a closer look has found: the rows that take the place of those of the sweep in a stretch of it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CloserLook {
    /// The density that was looked at.
    pub observable: Observable,
    /// The ends of the stretch, ascending, in units of the parameter: two values that the sweep has solved.
    pub stretch: [f64; 2],
    /// What the sweep counts there.
    pub ends: [Signature; 2],
    /// The rows between them, ascending.
    pub rows: Vec<Located>,
}

impl CloserLook {
    /// Whether both are of one observable and stretch.
    pub(super) fn is_at(&self, other: &Self) -> bool {
        (self.observable, self.stretch) == (other.observable, other.stretch)
    }

    /// Says of those of its rows that are not proven that more cells are needed.
    pub(super) fn doubt(&mut self, is_proven: &[bool]) {
        let rows = self.rows.iter_mut().zip(is_proven);
        for (row, _) in rows.filter(|one| !one.1) {
            row.doubts.push(Doubt::CoarseCells(row.error, None));
        }
    }

    /// Whether a row of the sweep lies in the stretch.
    pub(super) fn holds(&self, row: &Located) -> bool {
        let [lower, upper] = self.stretch;
        row.observable == self.observable && (lower..=upper).contains(&row.value)
    }

    /// Whether it shows that nothing happens in its stretch, where there are no rows, and the sweep counts the same.
    pub(super) fn shows_nothing(
        &self,
        rows: &[Located],
        (place, points): (usize, &[&Point]),
    ) -> bool {
        let [from, to] = self.stretch;
        let mut within = points.iter().filter(|one| (from..=to).contains(&one.value));
        let signature = |one: &&Point| one.detections.get(place).map(|one| one.signature);
        let is_same = within.all(|one| signature(one) == Some(self.ends[0]));
        is_same && self.rows.is_empty() && !rows.iter().any(|row| self.holds(row))
    }

    /// Takes the place of the rows of the stretch if it tells more than they do; whether it did.
    pub(super) fn replace(&self, rows: &mut Vec<Located>) -> bool {
        let (before, others): (Vec<Located>, Vec<Located>) =
            rows.iter().cloned().partition(|row| self.holds(row));
        if self.rows.is_empty() && !self.is_whole(&before) {
            return false;
        }
        let own = self.rows_beside(&before);
        let is_first = before.is_empty() && !own.is_empty();
        let (told, tells) = (Told::by(&before), Told::by(&own));
        let is_more = match tells {
            Told::Located => told < tells || before.len() < own.len(),
            // Of two values that are both less certain than wanted, that of finer cells is the better one, unless it
            // confirms the other with a larger error, of fewer grids.
            Told::Values => {
                let is_alike = told == tells && before.len() == own.len();
                told < tells || is_first || (is_alike && !self.confirms_widely(&before))
            }
            Told::Bands => false,
        };
        // A row with a value says that something happens: what leads to it, or from it, is told with its doubts.
        let of = |rows: &[Located]| (located(rows), with_values(rows));
        let tells_of_more = of(&before) < of(&own) && before.len() <= own.len();
        let is_more = is_more || tells_of_more || self.is_narrower(&before);
        if is_more {
            *rows = others;
            rows.extend(own);
            sort_ascending(rows, |one| one.value);
        }
        is_more
    }

    /// The rows, with those of the sweep in place of less certain ones that confirm them.
    fn rows_beside(&self, before: &[Located]) -> Vec<Located> {
        let confirmed = |own: &Located| {
            let like = |one: &&Located| {
                let is_same = (one.before, one.after) == (own.before, own.after);
                let [lower, upper] = own.hull();
                is_located(one) && is_same && (lower..=upper).contains(&one.value)
            };
            before.iter().find(like).filter(|_| !is_located(own))
        };
        let rows = self.rows.iter();
        rows.map(|own| confirmed(own).unwrap_or(own).clone())
            .collect()
    }

    /// Whether rows of the sweep begin and end with what it counts at the ends of the stretch. Else one of them is of a
    /// change that the counts have beside the stretch, about which finer cells that see nothing inside say nothing.
    fn is_whole(&self, rows: &[Located]) -> bool {
        let [before, after] = &self.ends;
        let begins = rows.first().is_none_or(|row| row.before == *before);
        begins && rows.last().is_none_or(|row| row.after == *after)
    }

    /// Whether as many rows as others have their values within theirs, and leave more in doubt.
    fn confirms_widely(&self, before: &[Located]) -> bool {
        let mut pairs = self.rows.iter().zip(before);
        let is_within = |(own, other): (&Located, &Located)| {
            let [lower, upper] = other.hull();
            (lower..=upper).contains(&own.value)
        };
        pairs.all(is_within) && in_doubt(&self.rows) > in_doubt(before)
    }

    /// Whether rows that two grids do not agree on by chance, and that neither finer cells nor other rows contradict,
    /// leave a shorter stretch in doubt than others, with no fewer located. Values that finer cells do not have leave
    /// all in doubt.
    fn is_narrower(&self, before: &[Located]) -> bool {
        let is_contradicted = |row: &Located| {
            row.status() == BifurcationStatus::Unconfirmed
                || row.doubts.contains(&Doubt::DoesNotContinue)
                || row.doubts.contains(&Doubt::CoarseCells(row.error, None))
        };
        let is_denied = |row: &Located| row.doubts.contains(&Doubt::NotOnFinerCells);
        let is_open = before.is_empty() || before.iter().any(is_denied);
        let is_new = is_open && !self.rows.is_empty();
        !self.rows.iter().any(is_contradicted)
            && located(before) <= located(&self.rows)
            && (is_new || in_doubt(&self.rows) < in_doubt(before))
    }
}

/// The length of what rows that are not located leave in doubt.
fn in_doubt(rows: &[Located]) -> f64 {
    let rows = rows.iter().filter(|row| !is_located(row));
    let lengths = rows.map(Located::hull).map(|[lower, upper]| upper - lower);
    lengths.sum()
}

/// How many rows are located.
fn located(rows: &[Located]) -> usize {
    rows.iter().filter(|row| is_located(row)).count()
}

/// How many rows have values, whatever their errors.
fn with_values(rows: &[Located]) -> usize {
    rows.iter().filter(|row| has_value(row)).count()
}

/// Whether a row is in doubt for no more than its error.
fn has_value(row: &Located) -> bool {
    let reason = row.reason();
    reason.is_none_or(|one| matches!(one, Doubt::CoarseCells(..) | Doubt::SolverError(_)))
}

fn is_located(row: &Located) -> bool {
    row.status() == BifurcationStatus::Located
}

/// How much rows tell of what happens in a stretch.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Told {
    /// Of some only where something happens.
    Bands,
    /// Values of all, with errors that are larger than wanted.
    Values,
    Located,
}

impl Told {
    fn by(rows: &[Located]) -> Self {
        if rows.iter().all(is_located) {
            Self::Located
        } else if rows.iter().all(has_value) {
            Self::Values
        } else {
            Self::Bands
        }
    }
}

/// Whether a feature is unresolved whose persistence is no lower, against the highest one, than what is looked for.
fn has_unresolved(shown: &Detection) -> bool {
    let highest = shown.features.iter().map(|one| one.density);
    shown.has_unresolved(DetectOptions::default().floor * highest.fold(0.0, f64::max))
}

impl SweepResult {
    /// The densities that the sweep counts differently at some of its values although finer cells have shown that
    /// nothing changes between them: its cells are too wide to count by.
    pub fn miscounted(&self) -> Vec<Observable> {
        let is_miscounted = |&(place, observable): &(usize, &Observable)| {
            let is_looked_at = self.looks.iter().any(|look| look.observable == *observable);
            let has_rows = self.bifurcations().any(|row| row.observable == *observable);
            let detections = self
                .points
                .iter()
                .filter_map(|one| one.detections.get(place));
            let mut counts = detections.map(|one| one.signature);
            let first = counts.next();
            is_looked_at && !has_rows && counts.any(|one| Some(one) != first)
        };
        let observables = self.subject.observables.iter().enumerate();
        let miscounted = observables.filter(is_miscounted);
        miscounted.map(|(_, observable)| *observable).collect()
    }

    /// The densities without sampling noise in which at some value a feature is no lower than what is looked for by
    /// default, and may be what errors make, of which neither a row nor a closer look tells.
    pub fn undecided(&self) -> Vec<Observable> {
        let observables = self.untold(|point, place| {
            let shown = point.detections.get(place);
            shown.is_some_and(has_unresolved).then_some(())
        });
        observables.into_iter().map(|one| one.0).collect()
    }

    /// The densities without sampling noise whose errors hide peaks at some value, of which neither a row nor a closer
    /// look tells, each with the share of the highest peak by which those stand out at least that are not hidden.
    pub fn coarse(&self) -> Vec<(Observable, f64)> {
        let observables = self.untold(|point, place| {
            let density = point.densities.get(place)?;
            least_shown(density).filter(|_| is_coarse(density))
        });
        let most = |shares: Vec<f64>| shares.into_iter().fold(0.0, f64::max);
        let observables = observables.into_iter();
        observables.map(|(of, shares)| (of, most(shares))).collect()
    }

    /// Densities that have something at values of which neither a row nor a closer look tells, with what they have.
    /// None where finer cells are no matter.
    fn untold<T>(&self, has: impl Fn(&Point, usize) -> Option<T>) -> Vec<(Observable, Vec<T>)> {
        if !matches!(self.subject.cell_check, CellCheck::OnFinerCells { .. }) {
            return Vec::new();
        }
        let untold = |(place, &observable): (usize, &Observable)| {
            let rows = self.bifurcations();
            let rows = rows.filter(|row| row.observable == observable);
            let rows = rows.map(|row| counted_around(self.points.iter(), row, place));
            let looks = self.looks.iter().filter(|one| one.observable == observable);
            let told: Vec<[f64; 2]> = rows.chain(looks.map(|one| one.stretch)).collect();
            let is_told = |value: f64| told.iter().any(|[from, to]| (*from..=*to).contains(&value));
            let points = self.points.iter().filter(|one| !is_told(one.value));
            let found: Vec<T> = points.filter_map(|point| has(point, place)).collect();
            (!found.is_empty()).then_some((observable, found))
        };
        let observables = self.subject.observables.iter().enumerate();
        observables.filter_map(untold).collect()
    }
}

/// The rows of a sweep with those in the place of others that earlier looks of it have found.
pub(super) fn with_looks(
    labels: Vec<Label>,
    looks: &[CloserLook],
    (points, observables): (&[Point], &[Observable]),
) -> Vec<Label> {
    with_rows(labels, |rows| {
        for look in looks {
            let place = observables.iter().position(|one| *one == look.observable);
            let ends = place.map(|place| {
                look.stretch
                    .map(|value| counted(points.iter(), value, place))
            });
            if ends == Some(look.ends.map(Some)) {
                look.replace(rows);
            }
        }
    })
}

/// Labelled points with their rows changed.
pub(super) fn with_rows(labels: Vec<Label>, change: impl FnOnce(&mut Vec<Located>)) -> Vec<Label> {
    let (mut rows, mut others) = (Vec::new(), Vec::new());
    for label in labels {
        match label {
            Label::Bifurcation(row) => rows.push(*row),
            other => others.push(other),
        }
    }
    change(&mut rows);
    let rows = rows
        .into_iter()
        .map(|row| Label::Bifurcation(Box::new(row)));
    label::number(others.into_iter().chain(rows).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peaks(peaks: usize) -> Signature {
        Signature::from([peaks, 0, 0, 0, 0, 0])
    }

    fn row(value: f64, [before, after]: [usize; 2]) -> Located {
        Located {
            label: String::new(),
            value,
            error: 1e-3,
            lower: value - 1e-3,
            upper: value + 1e-3,
            observable: Observable::Marginal(0),
            before: peaks(before),
            after: peaks(after),
            zero: None,
            is_several: false,
            doubts: vec![Doubt::Jump],
        }
    }

    #[test]
    fn what_finer_cells_show_takes_the_place_of_values_that_they_do_not_have() {
        let band = Located {
            lower: 0.4,
            doubts: vec![Doubt::IndicatorLost],
            ..row(0.5, [2, 1])
        };
        let look = CloserLook {
            observable: Observable::Marginal(0),
            stretch: [0.3, 0.6],
            ends: [peaks(2), peaks(1)],
            rows: vec![band.clone()],
        };
        let denied = Located {
            doubts: vec![Doubt::NotOnFinerCells],
            ..row(0.45, [2, 1])
        };
        let mut rows = vec![denied];
        assert!(look.replace(&mut rows));
        assert_eq!(rows, [band]);
        // Another one that is shorter, and that nothing speaks against but a jump, stays.
        let mut rows = vec![row(0.45, [2, 1])];
        assert!(!look.replace(&mut rows));
    }

    #[test]
    fn a_look_that_sees_nothing_leaves_a_change_that_is_counted_beside_it() {
        let look = CloserLook {
            observable: Observable::Marginal(0),
            stretch: [0.4, 0.6],
            ends: [peaks(2), peaks(2)],
            rows: Vec::new(),
        };
        // Four peaks become two below the stretch, though an indicator has its zero inside.
        let mut rows = vec![row(0.5, [4, 2])];
        assert!(!look.replace(&mut rows));
        assert_eq!(rows.len(), 1);
        // What comes and goes inside is none of the density's.
        let mut rows = vec![row(0.45, [2, 3]), row(0.55, [3, 2])];
        assert!(look.replace(&mut rows));
        assert!(rows.is_empty());
    }
}
