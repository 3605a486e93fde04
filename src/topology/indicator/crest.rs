//! Flanks of a joint density along its crests: where a peak and a saddle are about to be born, or to vanish, away from
//! any centre.
//!
//! Along an axis the highest points of the lines across it make crests, of which there may be several side by side. The
//! slope of log p along a crest is that along the axis, because p is level across it; its extrema are the shoulders at
//! which pairs are born, as those of a marginal are.

use super::Flank;
use crate::density::EstimatedDensity;
use crate::space::Axis;
use crate::topology::field::{Field, Jet};
use crate::topology::{Detection, Feature, FeatureKind, Verdict};

/// Cells by which a crest may move aside from one line to the next: steeper ones are followed along the other axis.
const ASIDE: f64 = 2.0;

/// Least bend of the slope along a crest over what its curvature across would make of it: the crest of a ring has none.
const LEAST_BEND: f64 = 0.01;

/// By how many times what the second scheme differs by an extremum must stand out.
const CLEAR: f64 = 3.0;

/// Steps of Newton's method to the top of a line.
const STEPS: usize = 2;

/// A point of a crest.
#[derive(Clone, Copy)]
struct Top {
    /// Across the axis.
    place: f64,
    /// Of log p along the axis.
    slope: f64,
    /// By how much the second scheme differs from it.
    error: f64,
    /// -(log p)'' across it.
    curvature: f64,
    /// Of the density, over its largest value.
    height: f64,
}

/// The extrema of the slope along crests, with the axis that each runs along. They say where to look, and are read on
/// the centres of cells. There are none where a derivative of the density jumps, of marginals, of sampled densities,
/// and where there is a centre of symmetry: indicators are read there, and the crest of a ring about it has no slope.
/// Of extrema below a floor, a share of the maximum, only those are given of which both schemes are sure.
///
/// Peaks of crests that cells do not count are given too, as extrema that are not sure: along a crest that crosses
/// cells obliquely the values of cells rise and fall with the distance of the crest from their centres, and a peak that
/// is lower than this does not show.
pub(crate) fn flanks_of_crests(
    estimated: &EstimatedDensity,
    floor: f64,
    detected: &Detection,
) -> Vec<Flank> {
    let is_smooth = estimated.structure.kinks.iter().all(|kink| kink.is_bend());
    let usable = is_smooth && estimated.structure.centre.is_none() && !estimated.is_noisy();
    let usable = usable && estimated.density.axes.len() == 2;
    match Field::new(estimated).filter(|_| usable) {
        Some(field) => [0, 1]
            .into_iter()
            .flat_map(|along| {
                let crests = Crests::new(estimated, &field, along);
                let uncounted = crests.uncounted(floor, detected);
                [crests.flanks(floor), uncounted].concat()
            })
            .collect(),
        None => Vec::new(),
    }
}

/// The highest points of the lines across an axis.
struct Crests<'f> {
    along: usize,
    /// The axis along which the crests run, and the one across.
    axes: [&'f Axis; 2],
    /// Of each line of cells.
    tops: Vec<Vec<Top>>,
}

impl<'f> Crests<'f> {
    fn new(estimated: &EstimatedDensity, field: &'f Field<'_>, along: usize) -> Self {
        let axes = [along, 1 - along].map(|axis| &field.axes()[axis]);
        let lines = 0..axes[0].count();
        Self {
            along,
            axes,
            tops: lines
                .map(|line| tops(estimated, field, along, line))
                .collect(),
        }
    }

    /// The point of a line that continues a crest beside it.
    fn near(&self, line: usize, top: &Top) -> Option<Top> {
        let across = self.axes[1];
        let reach = ASIDE * across.width(across.find(top.place)?);
        let distance = |one: &&Top| (one.place - top.place).abs();
        let nearest = self.tops[line]
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|one| distance(one) <= reach).copied()
    }

    /// Points of inner lines with their neighbours below and above along the crest.
    fn inner(&self) -> impl Iterator<Item = (usize, [Top; 3])> {
        let lines = 1..self.tops.len().saturating_sub(1);
        lines.flat_map(move |line| {
            self.tops[line].iter().filter_map(move |here| {
                let [left, right] = [line - 1, line + 1].map(|one| self.near(one, here));
                Some((line, [left?, *here, right?]))
            })
        })
    }

    /// Peaks along crests of which the schemes are sure and that would count, where fewer are counted on their crest.
    /// What rings have of peaks is not looked for.
    fn uncounted(&self, floor: f64, detected: &Detection) -> Vec<Flank> {
        if detected.signature.rings > 0 {
            return Vec::new();
        }
        let sure = |top: &Top| top.slope.abs() > CLEAR * top.error;
        let peaks = self.inner().filter(|(_, [_, here, right])| {
            here.slope > 0.0 && right.slope < 0.0 && sure(here) && sure(right)
        });
        let peaks = peaks.map(|(line, [_, here, _])| (line, here));
        let peaks: Vec<(usize, Top)> = peaks
            .filter(|&(line, here)| self.prominence(line, here) > floor)
            .collect();
        let uncounted = peaks.iter().filter(|&&(line, here)| {
            let crest = self.crest(line, here);
            let of_crest = peaks.iter().filter(|(line, top)| {
                let mut points = crest.iter();
                points.any(|(one, at)| one == line && at.place == top.place)
            });
            self.counted(&crest, detected) < of_crest.count()
        });
        uncounted
            .map(|&(line, here)| Flank {
                rising: false,
                place: self.axes[0].centre(line),
                value: here.slope,
                line: 1 + self.along,
                is_sure: false,
            })
            .collect()
    }

    /// The points of a crest to one side of one of its points, as far as it can be followed.
    fn to_side(&self, line: usize, top: Top, side: isize) -> impl Iterator<Item = (usize, Top)> {
        let lines = (1..).map_while(move |steps: isize| line.checked_add_signed(steps * side));
        let lines = lines.take_while(|&one| one < self.tops.len());
        lines.scan(top, |here, line| {
            *here = self.near(line, here)?;
            Some((line, *here))
        })
    }

    /// All points of the crest of a point.
    fn crest(&self, line: usize, top: Top) -> Vec<(usize, Top)> {
        let sides = [-1, 1].into_iter();
        let sides = sides.flat_map(|side| self.to_side(line, top, side));
        sides.chain([(line, top)]).collect()
    }

    /// Height of a point of a crest above the lowest on the way to higher ones, or to where it can be followed, on the
    /// side where that is less deep, as a share of the maximum of the density.
    fn prominence(&self, line: usize, top: Top) -> f64 {
        let beside = [line.saturating_sub(1), line + 1];
        let highest = beside.iter().filter_map(|&one| self.near(one, &top));
        let highest = highest.fold(top.height, |most, one| most.max(one.height));
        let lowest = [-1, 1].map(|side| {
            let way = self.to_side(line, top, side).map(|(_, one)| one.height);
            let way = way.take_while(|&height| height <= highest);
            way.fold(highest, f64::min)
        });
        highest - lowest[0].max(lowest[1])
    }

    /// How many peaks were detected on a crest. Where it crosses cells obliquely, the highest of its cells
    /// may be far from its peak.
    fn counted(&self, crest: &[(usize, Top)], detected: &Detection) -> usize {
        let counts =
            |one: &&Feature| one.kind == FeatureKind::Peak && one.verdict == Verdict::Present;
        let [axis, across] = self.axes;
        let is_on = |peak: &&Feature| {
            let [along, aside] = [self.along, 1 - self.along].map(|k| peak.position[k]);
            let (Some(line), Some(cell)) = (axis.find(along), across.find(aside)) else {
                return false;
            };
            let mut beside = crest.iter().filter(|(one, _)| *one == line);
            beside.any(|(_, top)| (top.place - aside).abs() <= ASIDE * across.width(cell))
        };
        let peaks = detected.features.iter().filter(counts);
        peaks.filter(is_on).count()
    }

    /// The extrema of the slope along crests.
    fn flanks(&self, floor: f64) -> Vec<Flank> {
        let axis = self.axes[0];
        let mut found = Vec::new();
        for (line, [left, here, right]) in self.inner() {
            let (up, down) = (here.slope - left.slope, here.slope - right.slope);
            let bend = (up + down) / axis.width(line).powi(2);
            let is_turn = (up >= 0.0 && down > 0.0) || (up <= 0.0 && down < 0.0);
            let errors = left.error + here.error + right.error;
            let is_sure = (up + down).abs() > CLEAR * errors && here.slope.abs() > here.error;
            let may_be_zero = here.slope.abs() <= CLEAR * here.error && here.height > floor;
            let is_bent = bend.abs() > LEAST_BEND * here.curvature.powf(1.5);
            if is_turn && (is_sure || may_be_zero) && is_bent {
                let rising = bend > 0.0;
                found.push(Flank {
                    rising,
                    place: axis.centre(line),
                    value: if rising { here.slope } else { -here.slope },
                    line: 1 + self.along,
                    is_sure,
                });
            }
        }
        found
    }
}

/// The points of crests on the line of cells at a place of an axis.
fn tops(estimated: &EstimatedDensity, field: &Field<'_>, along: usize, line: usize) -> Vec<Top> {
    let (axis, across) = (&field.axes()[along], &field.axes()[1 - along]);
    let values = field.values();
    let cell = |place: usize| match along {
        0 => line * across.count() + place,
        _ => place * axis.count() + line,
    };
    let least = estimated.negligible_height() * estimated.density.maximum();
    let is_top = |place: &usize| {
        let [below, here, above] = [place - 1, *place, place + 1].map(|one| values[cell(one)]);
        here > least && here >= below && here > above
    };
    let followed = |place: usize| -> Option<Top> {
        let mut at = [axis.centre(line); 2];
        at[1 - along] = across.centre(place);
        let (unit, width) = (field.unit(1 - along), across.width(place));
        let mut jet = field.jet(&at)?;
        for _ in 0..STEPS {
            let step = -unit * jet.first[1 - along] / jet.second[2 * (1 - along)];
            at[1 - along] =
                (at[1 - along] + step.clamp(-width, width)).clamp(across.from(), across.to());
            jet = field.jet(&at)?;
        }
        let slope = |jet: &Jet| jet.first[along] / (field.unit(along) * jet.value);
        let second = match field.second_scheme() {
            Some(values) => field.stencil(&at, 0)?.jet(values),
            None => jet,
        };
        let curvature = -jet.second[2 * (1 - along)] / (unit * unit * jet.value);
        (jet.value > least && curvature > 0.0).then(|| Top {
            place: at[1 - along],
            slope: slope(&jet),
            error: (slope(&second) - slope(&jet)).abs(),
            curvature,
            height: jet.value / estimated.density.maximum(),
        })
    };
    (1..across.count().saturating_sub(1))
        .filter(is_top)
        .filter_map(followed)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::flanks_of_crests;
    use crate::density::{Density, EstimatedDensity, Observable};
    use crate::space::Axis;
    use crate::topology::{DetectOptions, Detector, Flank, PersistenceDetector};

    /// log p = 2 (θ x - cosh x + c x²/2) - (y - x/2)²: along the crest y = x/2 the slope is 2 (θ - sinh x + c x), with
    /// extrema where cosh x = c.
    fn tilted(c: f64, theta: f64, cells: usize) -> EstimatedDensity {
        density(cells, &|x, y| {
            2.0 * (theta * x - x.cosh() + 0.5 * c * x * x) - (y - 0.5 * x).powi(2)
        })
    }

    fn density(cells: usize, log: &dyn Fn(f64, f64) -> f64) -> EstimatedDensity {
        let axis = Axis::uniform(-3.0, 3.0, cells).unwrap();
        let centres = axis.centres();
        let rows = centres.iter();
        let values: Vec<f64> = rows
            .flat_map(|x| centres.iter().map(move |y| log(*x, *y).exp()))
            .collect();
        EstimatedDensity {
            negligible: 1e-7,
            ..EstimatedDensity::new(
                Observable::Joint(0, 1),
                Density {
                    axes: vec![axis.clone(), axis],
                    values,
                },
            )
        }
    }

    /// The peaks that are counted, and the flanks.
    fn seen(density: &EstimatedDensity) -> (usize, Vec<Flank>) {
        let detected = PersistenceDetector::new(DetectOptions::default(), 1).detect(density);
        let flanks = flanks_of_crests(density, 1e-3, &detected);
        (detected.signature.peaks, flanks)
    }

    /// Where the slope along the crest has its extrema, and the tilt at which it is zero there.
    fn fold(c: f64) -> (f64, f64) {
        let at = c.acosh();
        (at, (at.sinh() - c * at).abs())
    }

    #[test]
    fn the_slope_along_a_crest_passes_zero_with_its_folds() {
        let c = 1.2;
        let (at, fold) = fold(c);
        for theta in [-2.0, -0.5, 0.5, 2.0].map(|share| share * fold) {
            for rising in [false, true] {
                let (_, found) = seen(&tilted(c, theta, 100));
                let is_it = |one: &&Flank| one.line == 1 && one.rising == rising && one.is_sure;
                let found = found.iter().find(is_it).unwrap();
                let side = if rising { 1.0 } else { -1.0 };
                let exact = 2.0 * (side * theta + fold);
                // Read half a cell of 0.06 from the extremum at most, where the slope bends by 2 sinh x.
                let read = at.sinh() * 0.03 * 0.03;
                assert!((found.place - side * at).abs() < 0.06, "{found:?}");
                assert!(
                    (found.value - exact).abs() < 2.0 * read,
                    "{found:?} {exact}"
                );
            }
        }
    }

    /// A narrow crest has the highest of its cells far from its peak, which is counted there, and nothing is told.
    #[test]
    fn a_peak_that_is_counted_far_from_the_top_of_its_crest_is_not_told() {
        let c = 1.02;
        for shift in [0.0, 0.01, 0.02, 0.035, 0.05, 0.07] {
            let log = |x: f64, y: f64| {
                let along = -x.cosh() + 0.5 * c * x * x + 0.02 * x;
                2.0 * along - 12.0 * (y - 0.1 * x - shift).powi(2)
            };
            let (counted, flanks) = seen(&density(41, &log));
            let told: Vec<_> = flanks.iter().filter(|one| !one.is_sure).collect();
            assert_eq!((counted, told.len()), (1, 0), "{shift}: {told:?}");
        }
    }

    /// Between the folds there are two peaks. Odd numbers of cells show one where the tilt is near a fold, even ones
    /// both: the crest tells of the other where one is counted, and beyond the folds it tells nothing.
    #[test]
    fn peaks_of_a_crest_that_cells_do_not_count_are_told() {
        // At 1.05 the second peak is lower than the floor where the tilt is nearer to the fold.
        for (c, odd, nearer) in [(1.05, 41, 0.6), (1.08, 31, 0.8), (1.12, 25, 0.8)] {
            let (_, fold) = fold(c);
            for (cells, share, peaks, told) in [
                (odd, 0.6, 1, true),
                (odd, nearer, 1, true),
                (odd, 1.2, 1, false),
                (odd, 2.0, 1, false),
                (40, 0.6, 2, false),
                (40, 1.2, 1, false),
            ] {
                let (counted, flanks) = seen(&tilted(c, share * fold, cells));
                let is_told = flanks.iter().any(|one| !one.is_sure);
                assert_eq!(
                    (counted, is_told),
                    (peaks, told),
                    "{c}, {cells} cells, {share}"
                );
            }
        }
    }
}
