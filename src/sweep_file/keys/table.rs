//! Every key of a sweep file, declared once: path, kind of value, default, meaning, and where the value lives.

use super::field::{
    BOUNDS, Field, PERIOD, UNTIL, always, entries, of_axis, of_bins, of_methods, of_passage,
    optional,
};
use super::in_file::{AUTO, InFile, Named, SWITCH};
use super::kind::{
    ANY, DPI, Kind, LINE, NOT_NEGATIVE, OPEN_UNIT, POSITIVE, SHARE, STEP, TEXT, UP_TO_ONE,
};
use super::{Key, KeyDefault};
use crate::continuation::curve::CurveOptions;
use crate::continuation::map::MapOptions;
use crate::figure::{ColourMap, ColourScale, Format, Ground, Typeface};
use crate::generator::AdvectiveScheme;
use crate::method::{Correction, DerivedMeasure, Estimator};
use crate::sampling::Integrator;
use crate::space::MOST_MODES;
use crate::stationary::Solver;
use crate::sweep_file::draft::{ACCURACY, ExponentKind, MethodKind};
use crate::system::{ExponentMethod, FieldKind, Interpretation, NoiseKind, Sides};

/// Most cells an axis may have: edges are stored, so a slip of the pen must not fill the memory.
const MOST_CELLS: i128 = 1_000_000;

/// Shorthand for a row of the table.
const fn key(
    path: &'static str,
    kind: Kind,
    default: KeyDefault,
    field: Field,
    meaning: &'static str,
) -> Key {
    Key {
        path,
        kind,
        default,
        field,
        meaning,
    }
}

use KeyDefault::{OfOptions, OfSection, Required, Rule};

/// The order is the one in which a file is best read, and in which it is written.
#[rustfmt::skip]
pub(in crate::sweep_file) static KEYS: &[Key] = &[
    key("title", Kind::Printable, Rule("the model's title, if it has one, and the swept parameter"), optional!(title),
        "Title of the run, used in tables and figures."),
    key("system.model", Kind::Model, Rule("equations of your own, in `system.equations`"), optional!(model),
        "A built-in model; `pbif systems` lists them, `pbif systems NAME` shows one."),
    key("system.title", Kind::Printable, Rule("`title`, if that is given"), optional!(equations.title),
        "Name of a system of your own, in words."),
    key("system.equations.<axis>", Kind::Formula, Rule("a built-in model, by `system.model`"), entries!(equations.drift),
        "Right side of the equation of an axis, without noise; one an axis, 1 to 4 of them, which also gives their order. docs/formulas.md has the language."),
    key("system.noise.kind", Kind::Choice(NoiseKind::words), Rule("`white`"), optional!(noise_kind),
        "`ornstein-uhlenbeck`: coloured noise in place of white, for built-in models too. Each noise keeps its intensity and gets a correlation \
         that falls exponentially over the time `tau`, which is then a parameter; `noise` is an axis (docs/coloured-noise.md). `harmonic`: noise \
         whose spectrum has a peak near the frequency `noise_frequency`, as narrow as `noise_damping` is small; `noise` and `noise_rate` are axes."),
    key("system.noise.interpretation", Kind::Choice(Interpretation::words), Rule("to be given where it makes a difference"), optional!(equations.interpretation),
        "How noise is read whose amplitude depends on the axis that it drives."),
    key("system.noise.<axis>", Kind::Formulas, Rule("no noise on the axis"), entries!(equations.noise),
        "Amplitudes of independent white noises on the equation of an axis: the roots of their intensities."),
    key("system.define.<name>", Kind::Formula, Rule("nothing"), entries!(equations.define),
        "A formula that others may use by this name."),
    key("system.bounds.<axis>", Kind::Bounds, Rule("none"), BOUNDS,
        "Lower and upper value that an axis never leaves, as formulas of parameters; or `periodic` for an angle, which comes back after 2π (docs/angles.md); or `reflecting`, for both ends of its cells or as `[\"reflecting\", \"open\"]` for one: a wall there, at which noise and drift turn back (docs/formulas.md)."),
    key("system.bounds.<axis>.period", Kind::Number(POSITIVE), Rule("2π for an axis that is `periodic`"), PERIOD,
        "Period of an angle that is not measured in radians: `theta = { period = 1.0 }`."),
    key("system.parameters.<parameter>", Kind::Number(ANY), Rule("the model's default, where it has one"),
        entries!(parameters),
        "Value of a parameter of the model. The swept parameter is left out; with equations of your own it may stay."),
    key("sweep.parameter", Kind::Text, Required, optional!(parameter),
        "Name of the parameter that is swept."),
    key("sweep.from", Kind::Number(ANY), Required, optional!(from),
        "First value of the swept parameter."),
    key("sweep.to", Kind::Number(ANY), Required, optional!(to),
        "Last value; it may lie below the first."),
    key("sweep.points", Kind::Integer(2, 1_000_000), Required, optional!(points),
        "Number of parameter values, both ends included, evenly spaced."),
    key("map.parameter", Kind::Text, Rule("no map: a sweep of one parameter"), optional!(map.parameter),
        "Name of a second parameter: `pbif sweep` then makes a map of regimes over both. docs/maps.md says how."),
    key("map.from", Kind::Number(ANY), Rule("required in a map"), optional!(map.from),
        "One end of the second parameter's range."),
    key("map.to", Kind::Number(ANY), Rule("required in a map"), optional!(map.to),
        "The other end."),
    key("map.points", Kind::Integer(2, 10_000), Rule("as many as `sweep.points`"), optional!(map.points),
        "Values of the second parameter in the coarse grid of a map, both ends included; `sweep.points` are those of the first."),
    key("map.depth", Kind::Integer(0, 8), OfSection(|| MapOptions::default().depth.to_string()), optional!(map.depth),
        "How often a cell of the coarse grid is halved at most, where signatures of neighbours differ."),
    key("map.curves", Kind::Choice(switch), Rule("`on`"), optional!(map.curves),
        "Whether the curves between regimes are followed."),
    key("curve.parameter", Kind::Text, Rule("no curves: rows alone"), optional!(curve.parameter),
        "Name of a second parameter: `pbif sweep` then follows located rows in the plane of both, as `pbif curve` does. docs/curves.md says how."),
    key("curve.from", Kind::Number(ANY), Rule("required in a curve"), optional!(curve.from),
        "One end of the box in the second parameter; what the sweep holds it at must be in the box."),
    key("curve.to", Kind::Number(ANY), Rule("required in a curve"), optional!(curve.to),
        "The other end."),
    key("curve.first_from", Kind::Number(ANY), Rule("the lower end of the sweep"), optional!(curve.first_from),
        "Lower end of the box in the swept parameter."),
    key("curve.first_to", Kind::Number(ANY), Rule("the upper end of the sweep"), optional!(curve.first_to),
        "Upper end of the box in the swept parameter."),
    key("curve.rows", Kind::List(&Kind::Text), Rule("every row that an indicator located"), optional!(curve.rows),
        "Labels of the rows that are followed, such as `PB1`."),
    key("curve.step", Kind::Number(STEP), OfSection(|| CurveOptions::default().largest_step.to_string()), optional!(curve.step),
        "Longest step between points of a curve, as a share of the sides of the box."),
    key("curve.branches", Kind::Choice(switch), Rule("`on`"), optional!(curve.branches),
        "Whether the curves that start from points of codimension two are followed too."),
    key("cells.accuracy", Kind::Number(OPEN_UNIT), OfSection(|| ACCURACY.to_string()), optional!(accuracy),
        "Wanted error of the watched densities, in total variation, where counts are left to the program."),
    key("cells.<axis>.range", Kind::Choice(automatic), Rule("`from` and `to`, `auto` without them"), of_axis!(range),
        "`auto` finds a range that holds the density all along the sweep by a few free trajectories; `from` and `to` are then left out, or one of them is given without `range`."),
    key("cells.<axis>.from", Kind::Number(ANY), Rule("the model's bound, where it knows one; 0 where no path crosses it and no end is given; else found"), of_axis!(from),
        "Lower end of the domain along an axis. With `from = 0` alone, of a population or an intensity, the other end is found, and `grade` is `auto`."),
    key("cells.<axis>.to", Kind::Number(ANY), Rule("the model's bound, where it knows one, else found"), of_axis!(to),
        "Upper end of the domain along an axis."),
    key("cells.<axis>.count", Kind::Integer(2, MOST_CELLS), Rule("found by two coarse solves for `cells.accuracy`"), of_axis!(count),
        "Number of cells along an axis; `<axis> = 60` in `[cells]` is short for it. An even number puts a face in the middle."),
    key("cells.<axis>.modes", Kind::Count(2, MOST_MODES as i128), Rule("`auto` where the model marks the axis and `count` is not given"), of_axis!(modes),
        "Number of modes that carry the density along the axis of an internal state without noise (one with bounds, or one that relaxes linearly), or of coloured noise, in place of cells, by the generator; other methods use `count`. `auto` finds how many what is watched needs."),
    key("cells.<axis>.grade", Kind::Choice(automatic), Rule("cells of equal width"), of_axis!(grade),
        "`auto` narrows the cells toward ends at which the noise dies, to a sixty-fourth of their width, and toward the model's switching surfaces, to a quarter of the layer that holds the kink of the density, or a little where the force does not jump; or a table with `at` and `smallest`."),
    key("cells.<axis>.grade.at", Kind::List(&Kind::Number(ANY)), Rule("cells of equal width"), of_axis!(grade_at),
        "Points toward which the cells get narrower, inside the range; a face falls on each."),
    key("cells.<axis>.grade.smallest", Kind::Number(POSITIVE), Rule("cells of equal width"), of_axis!(grade_smallest),
        "Width of the cells at these points; below the width without grading."),
    key("method.kind", Kind::Choice(MethodKind::words), OfOptions, always!(method.kind),
        "How the steady-state density is computed: by the generator of the cell map, solved directly, by `sgcm`, stochastic generalized cell mapping, or by `monte-carlo`, counting free trajectories."),
    key("method.scheme", Kind::Choice(AdvectiveScheme::words), OfOptions, of_methods!(scheme: Generator generator),
        "how advective fluxes are reconstructed. The central schemes are more accurate on fine grids and less robust on coarse ones."),
    key("method.memory_limit", Kind::Number(POSITIVE), OfOptions, of_methods!(memory_limit: Generator generator),
        "gigabytes that factors may take; beyond, a smaller factorisation preconditions. No more segments of a sweep are solved side by side than fit."),
    key("method.map_step", Kind::Step, OfOptions, of_methods!(map_step: Sgcm sgcm),
        "time that one transition of the cell map spans. Longer steps mean less numerical diffusion."),
    key("method.time_step", Kind::Step, OfOptions, of_methods!(time_step: Sgcm sgcm, MonteCarlo monte_carlo),
        "step of the trajectory integrator; by sgcm it must not exceed `map_step`. Its bias is found by halving it, and stated."),
    key("method.samples", Kind::Integer(2, u32::MAX as i128), OfOptions, of_methods!(samples: Sgcm sgcm),
        "trajectories started in each cell."),
    key("method.seed", Kind::Integer(0, i64::MAX as i128), OfOptions, of_methods!(seed: Sgcm sgcm, MonteCarlo monte_carlo),
        "seed of the random streams; the same seed gives the same numbers bit for bit."),
    key("method.integrator", Kind::Choice(Integrator::words), OfOptions, of_methods!(integrator: Sgcm sgcm, MonteCarlo monte_carlo),
        "integrator of the trajectories. `splitting` moves positions apart from velocities, which takes nothing from the damping \
         and allows longer steps. `weak-heun` and `weak-splitting` draw increments of four values in place of normal ones: the \
         same laws to the same order, sooner. `euler-maruyama` takes ω²·time_step away from the damping."),
    key("method.replicates", Kind::Integer(2, 256), OfOptions, of_methods!(replicates: Sgcm sgcm),
        "groups the samples are split into to estimate the sampling error; at most `samples`."),
    key("method.correction", Kind::Choice(Correction::words), OfOptions, of_methods!(correction: Sgcm sgcm),
        "`slope` lets the density vary linearly inside cells, which removes nearly all numerical diffusion; `none` is the method of the paper."),
    key("method.solver", Kind::Choice(Solver::words), OfOptions, of_methods!(solver: Sgcm sgcm),
        "solver of the steady state: multilevel aggregation, or power iteration."),
    key("method.estimator", Kind::Choice(Estimator::words), OfOptions, of_methods!(estimator: MonteCarlo monte_carlo),
        "`ergodic` averages long trajectories over time, `ensemble` counts many trajectories, started all over the domain, at one time."),
    key("method.error", Kind::Number(OPEN_UNIT), OfOptions, of_methods!(error: MonteCarlo monte_carlo),
        "wanted relative standard error of the variance of every axis; what is `\"auto\"` is chosen for it."),
    key("method.burn_in", Kind::Step, OfOptions, of_methods!(burn_in: MonteCarlo monte_carlo),
        "time before states are counted (ensemble: at which they are counted); twelve autocorrelation times by itself."),
    key("method.length", Kind::Step, OfOptions, of_methods!(length: MonteCarlo monte_carlo),
        "time during which `ergodic` counts the states of one trajectory; chosen for `error` by itself."),
    key("method.trajectories", Kind::Step, OfOptions, of_methods!(trajectories: MonteCarlo monte_carlo),
        "trajectories, rounded up to a multiple of 64; 2048 by themselves, in an ensemble as many as `error` takes."),
    key("method.passages", Kind::Integer(64, 1_000_000_000), OfOptions, of_methods!(passages: MonteCarlo monte_carlo),
        "paths that are followed for each passage of `[passage]`."),
    key("method.longest_passage", Kind::Step, OfOptions, of_methods!(longest_passage: MonteCarlo monte_carlo),
        "time at which a path of a passage that still goes on is given up; by itself as long as 1e9 integrator steps allow."),
    key("method.solver_tolerance", Kind::Number(OPEN_UNIT), OfOptions, of_methods!(solver_tolerance: Generator generator, Sgcm sgcm),
        "L1 error of the cell masses at which the solver stops."),
    key("method.escape_limit", Kind::Number(UP_TO_ONE), OfOptions, of_methods!(escape_limit: Generator generator, Sgcm sgcm, MonteCarlo monte_carlo),
        "Largest share of the mass that may leave the domain within one relaxation time before there is said to be no steady state."),
    key("detect.marginals", Kind::List(&Kind::Text), Rule("every axis"), optional!(marginals),
        "Axes whose marginal densities are watched for changes, and quantities, each with its name: `amplitude = sqrt(x^2 + y^2)`."),
    key("detect.joint", Kind::List(&Kind::Pair), Rule("the first two axes"), optional!(joint),
        "Pairs of axes or quantities whose joint densities are watched for changes."),
    key("detect.measures", Kind::List(&Kind::Choice(DerivedMeasure::words)), Rule("none"), optional!(measures),
        "Measures that are derived from the densities that are watched: columns of `points.csv`, each with its error (docs/run-folder.md)."),
    key("detect.bins.<quantity>.from", Kind::Number(ANY), Rule("found by rough solves"), of_bins!(from),
        "First value over which a quantity is watched; what lies beyond is not drawn or counted."),
    key("detect.bins.<quantity>.to", Kind::Number(ANY), Rule("found by rough solves"), of_bins!(to),
        "Last value over which a quantity is watched."),
    key("detect.bins.<quantity>.count", Kind::Integer(8, 100_000), Rule("the largest number of cells of the axes that it depends on, from 40 to 200"), of_bins!(count),
        "Number of bins of a quantity."),
    key("detect.confidence", Kind::Number(OPEN_UNIT), OfOptions, always!(detect.confidence),
        "Probability that no peak or crater of the whole sweep is sampling noise."),
    key("detect.floor", Kind::Number(SHARE), OfOptions, always!(detect.floor),
        "Smallest persistence that counts, as a share of the density's maximum."),
    key("watch.<formula>", Kind::Formula, Rule("none"),
        entries!(averaged),
        "A formula whose mean and standard deviation are columns of `points.csv`, for example `power = \"y^2\"`."),
    key("regions.<region>", Kind::Text, Rule("none"),
        entries!(regions),
        "A region of the state by inequalities, for example `left = \"x < -0.2 and y > 0\"`, joined by `and`, `or`, `not`; names of other regions may stand in it. Or what is found in a watched density: the basin of a peak, as `peak 2 of x` (the second from the left) or `peak 1 of xy`, and `inside ring of xy` or `outside ring of xy`."),
    key("visits.<visits>", Kind::Text, Rule("none"),
        entries!(visits),
        "A region, by its name or an inequality such as `high = \"x > 1\"`, of which `points.csv` tells the share of the time that is spent in it, how often it is entered per unit of time, and how long a visit lasts."),
    key("passage.<passage>.from", Kind::Text, Rule("`start`"), of_passage!(from),
        "Where a passage starts: in a region (by its name, or an inequality), spread as the steady state is there, or `density`, spread as it is everywhere."),
    key("passage.<passage>.start.<axis>", Kind::Number(ANY), Rule("`from`"),
        Field {
            get: |draft, name| {
                let (name, axis) = passage_and_axis(name);
                super::field::entry_of(&draft.passage(name)?.start, axis)
            },
            set: |draft, name, plain| {
                let (name, axis) = passage_and_axis(name);
                super::field::set_entry(&mut draft.passage_mut(name).start, axis, plain);
            },
        },
        "A state in which a passage starts: a coordinate for every axis."),
    key("passage.<passage>.until", Kind::Regions, Rule("`to`"), UNTIL,
        "The region at whose border a passage ends: a name, or an inequality such as `abs(x) > 2`. How long that takes is told in `points.csv`, with errors (docs/passage.md). Of several, `[\"x > 2\", \"x < -2\"]`, any ends it, and the share of each is told."),
    key("passage.<passage>.to", Kind::Text, Rule("`until`"), of_passage!(to),
        "Another word for `until`, which goes with `from`: `exit = { from = \"left\", to = \"right\" }`."),
    key("passage.<passage>.switching", Kind::Choice(switch), Rule("`off`"), of_passage!(switching),
        "Whether the rates from the region `from` to the region `to` and back are wanted as the slowest mode has them (docs/passage.md)."),
    key("passage.<passage>.transitions", Kind::Choice(switch), Rule("`off`"), of_passage!(transitions),
        "Whether it is wanted how often a process goes from the region `from` to the region `to`, and how long it is on the way (docs/passage.md)."),
    key("passage.<passage>.fields", Kind::List(&Kind::Choice(FieldKind::words)), Rule("none"), of_passage!(fields),
        "What is wanted over all states of one or two axes in which a passage may start, as arrays of `densities.zarr` and figures: `mean-time`, and `committor`, the probability to enter the region `to` before the region `from`, or each region of `until` before the others; `reactive-density` and `reactive-current`, where processes are on their way from `from` to `to`, and how they flow."),
    key("passage.<passage>.times", Kind::List(&Kind::Number(POSITIVE)), Rule("none"), of_passage!(times),
        "Times at which the probability is wanted that a passage still goes on."),
    key("passage.<passage>.survival.from", Kind::Number(POSITIVE), Rule("none"), of_passage!(survival.from),
        "First of more such times, for a curve: they are even in logarithms and rounded to three digits."),
    key("passage.<passage>.survival.to", Kind::Number(POSITIVE), Rule("none"), of_passage!(survival.to),
        "Last of the times of the curve."),
    key("passage.<passage>.survival.count", Kind::Integer(3, 200), Rule("36"), of_passage!(survival.count),
        "Number of times of the curve."),
    key("passage.<passage>.quantiles", Kind::List(&Kind::Number(OPEN_UNIT)), Rule("none"), of_passage!(quantiles),
        "Shares of passages: the times by which so many have ended are wanted, 0.5 for the median."),
    key("levels.<measure>", Kind::Number(ANY), Rule("none"),
        entries!(levels),
        "A level of a column of `points.csv` that has an error, such as `exit_mean = 1000`: the values of the parameter at which it is crossed are rows `LV` of the table."),
    key("exponent.kind", Kind::Choice(ExponentKind::words), Rule("no exponent"), optional!(exponent),
        "`fixed-point`: the largest Lyapunov exponent of a fixed point that multiplicative noise leaves alone, at every value, and the values at \
         which it passes zero as rows `DB` (docs/exponents.md). On one axis or two. \
         `largest`: that along the stationary density of a smooth system, with its rows `DB` and the mean divergence."),
    key("exponent.method", Kind::Choice(ExponentMethod::words), Rule("`modes`"), optional!(exponent_method),
        "How the exponent along the density (`largest`) is worked out. `modes`: from the density of state and direction, on one axis or two. \
         `trajectories`: by small deviations from free trajectories, on up to four axes, with a standard error."),
    key("exponent.steps", Kind::Number(POSITIVE), Rule("2e7"), optional!(exponent_steps),
        "Steps of all trajectories together at every value (`trajectories`). The error falls with the root of their number."),
    key("exponent.at.<axis>", Kind::Number(ANY), Rule("0"),
        entries!(fixed_point),
        "Coordinate of the fixed point (`fixed-point`): drift and all noises must be zero there, along the whole sweep."),
    key("relaxation.modes", Kind::Integer(1, 24), Rule("none"), optional!(slow_modes),
        "Slow modes, the deviations from the steady state that live longest: as many decay rates and frequencies are told in `points.csv`, with errors (docs/relaxation.md)."),
    key("spectrum.of", Kind::List(&Kind::Text), Rule("no spectra"), optional!(spectrum.of),
        "What fluctuates: names of axes and of quantities that are watched, each for its power spectrum, or two with a comma between, `\"x, v\"`, \
         for their cross spectrum. Spectra at every value are `spectra.csv`, with errors (docs/spectra.md)."),
    key("spectrum.to", Kind::Number(POSITIVE), Rule("6 times the rate at which states change, where that is largest"), optional!(spectrum.to),
        "Highest angular frequency, per unit time."),
    key("spectrum.from", Kind::Number(POSITIVE), Rule("frequencies stand evenly from 0 on"), optional!(spectrum.from),
        "Lowest frequency of some that stand evenly in their logarithms."),
    key("spectrum.points", Kind::Integer(2, 100_000), Rule("241"), optional!(spectrum.points),
        "How many frequencies there are, both ends included."),
    key("spectrum.sides", Kind::Choice(Sides::words), Rule("`two`"), optional!(spectrum.sides),
        "`two`: the variance is the integral over all frequencies of either sign, over 2π. `one`: over the positive ones, so that the power is twice as large."),
    key("spectrum.lag", Kind::Number(POSITIVE), Rule("no correlations"), optional!(spectrum.lag),
        "Longest lag of the correlation functions, `correlations.csv`, which have as many lags as there are frequencies."),
    key("locate.tolerance", Kind::Number(POSITIVE), Rule("`locate.relative_tolerance` of the swept range"), optional!(locate.tolerance),
        "Wanted width of a P-bifurcation's bracket, in units of the swept parameter."),
    key("locate.relative_tolerance", Kind::Number(OPEN_UNIT), OfOptions, always!(locate.relative_tolerance),
        "Wanted width of a P-bifurcation's bracket, as a share of the swept range; `locate.tolerance` goes before it."),
    key("locate.largest_distance", Kind::Number(SHARE), OfOptions, always!(locate.largest_distance),
        "Hellinger distance between neighbouring densities above which a value between them is solved too."),
    key("locate.grid_check", Kind::Choice(switch), OfOptions, always!(locate.grid_check),
        "Whether located values are checked on a finer grid (by methods without sampling). With `off` they are `unchecked`, and their errors lack what the cells do."),
    key("locate.effort", Kind::Number(NOT_NEGATIVE), OfOptions, always!(locate.effort),
        "Work for changes that are less certain than wanted after that check: finer cells are asked again, and the stretch around a change in doubt is swept again on them, while that costs no more than so many times the solves of the sweep, or a few seconds where the sweep took less."),
    key("figures.at", Kind::List(&Kind::Number(ANY)), Rule("both ends of the sweep and two points between"), optional!(figures_at),
        "Parameter values at which joint densities and marginals are drawn, inside the sweep."),
    key("figures.formats", Kind::List(&Kind::Choice(Format::words)), OfOptions, always!(figures.formats),
        "File formats of the figures; `csv` writes the numbers behind each, `txt` its caption, `tex` the same for LaTeX."),
    key("figures.draw", Kind::List(&Kind::Text), OfOptions, optional!(figures.draw),
        "Figures that are drawn: kinds, such as `diagram`, or single ones, such as `diagram_x`; `all` for every one."),
    key("figures.style.width", Kind::Width, OfOptions, always!(figures.style.width),
        "Width of every figure in millimetres, or by name: one column of a journal (84), one and a half (129), two (174), a slide (254); `own` leaves it to each figure."),
    key("figures.style.text", Kind::Number(TEXT), Rule("8 where a width is given, 18 on slides, else 10.5"), optional!(figures.style.text),
        "Size of axis titles in points; tick labels have nine tenths of it."),
    key("figures.style.line", Kind::Number(LINE), Rule("in proportion to the text, 1 for 8 points"), optional!(figures.style.line),
        "Width of curves in points, other lines in proportion."),
    key("figures.style.dpi", Kind::Number(DPI), OfOptions, always!(figures.style.dpi),
        "Pixels of a PNG to the inch, written into the file."),
    key("figures.style.font", Kind::Choice(Typeface::words), OfOptions, always!(figures.style.font),
        "Typeface: DejaVu Sans or DejaVu Serif."),
    key("figures.style.colours", Kind::Choice(ColourMap::words), OfOptions, always!(figures.style.colours),
        "Colours of maps and surfaces: perceptually uniform, and safe for colour-blind readers; `grey` runs from white to black."),
    key("figures.style.scale", Kind::Choice(ColourScale::words), OfOptions, always!(figures.style.scale),
        "Whether colours of heat maps follow the density in proportion or by decades, four of them below the largest density."),
    key("figures.style.ground", Kind::Choice(Ground::words), OfOptions, always!(figures.style.ground),
        "Light for print, dark for screens."),
    key("figures.style.title", Kind::Choice(switch), OfOptions, always!(figures.style.title),
        "Whether the title of the run stands above each figure; journals want it in the caption."),
    key("figures.style.letters", Kind::Choice(switch), OfOptions, always!(figures.style.letters),
        "Whether the panels of a sheet have letters: (a), (b)."),
];

/// The two names that stand in the path of a start.
fn passage_and_axis(name: &str) -> (&str, &str) {
    name.split_once('.').unwrap_or((name, name))
}

fn switch() -> Vec<&'static str> {
    SWITCH.to_vec()
}

fn automatic() -> Vec<&'static str> {
    vec![AUTO]
}
