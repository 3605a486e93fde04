//! The paper's argument, held by bins: at its eight values the densities by the generator and by free trajectories
//! agree within three standard errors in every bin of a marginal but 1 %. The tables of docs/paper.md are printed by
//!
//!     cargo test --release --test methods agreement:: -- --ignored --nocapture
//!
//! What is compared is what the sweeps ship: systems, cells and values are read from their files. The marginal of
//! Dahl's friction state is compared over the bins on which its series is laid out, with as many modes as its steep
//! edges take: many more than the densities of x and y do.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource as _;
use pbif::density::{EstimatedDensity, Observable, Variants, estimate};
use pbif::generator::AdvectiveScheme;
use pbif::method::{
    GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource, Problem,
};
use pbif::space::{Axis, CellSpace};
use pbif::sweep_file::SweepFile;
use pbif::system::{self, Family, Model};

/// A shipped sweep.
struct Example {
    model: Arc<Model>,
    /// Values of the parameters that are not swept.
    fixed: Vec<(String, f64)>,
    parameter: String,
    space: CellSpace,
    scheme: AdvectiveScheme,
    /// The paper's values.
    at: Vec<f64>,
}

impl Example {
    /// With automatic gradings found.
    fn read(name: &str, overrides: &[&str]) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = root.join("sweeps").join(format!("{name}.toml"));
        let mut file = SweepFile::read(&path).unwrap();
        let settings = file.set_all("test", overrides).validate().unwrap();
        let sweep = settings.prepare(&Cancellation::new()).unwrap();
        let family = sweep.problem.family();
        let fixed = family.fixed().map(|(name, value)| (name.to_owned(), value));
        Self {
            model: family.model().clone(),
            fixed: fixed.collect(),
            parameter: family.parameter().to_owned(),
            space: sweep.problem.space().clone(),
            scheme: sweep.settings.method.generator.scheme,
            at: sweep.settings.figures.at.clone(),
        }
    }

    /// The largest number of modes of an axis.
    fn most_modes(&self) -> usize {
        let axes = self.space.axes().iter();
        let modes = axes.filter(|axis| axis.is_modes()).map(Axis::count);
        modes.max().unwrap_or(0)
    }

    /// One marginal an axis.
    fn observables(&self) -> Vec<Observable> {
        (0..self.space.dimension())
            .map(Observable::Marginal)
            .collect()
    }

    /// The same with the bins of the series in place of axes of modes.
    fn cut_into_bins(&self) -> CellSpace {
        let bins = |axis: &Axis| match axis.is_modes() {
            true => Axis::uniform(axis.from(), axis.to(), BINS_OF_A_SERIES).unwrap(),
            false => axis.clone(),
        };
        CellSpace::new(self.space.axes().iter().map(bins).collect()).unwrap()
    }

    /// Of one value alone.
    fn problem(&self, value: f64, space: &CellSpace) -> Problem {
        let fixed = self
            .fixed
            .iter()
            .map(|(name, value)| (name.as_str(), *value));
        let path = system::Path::parameter(self.parameter.as_str(), value, value);
        let family = Family::new(self.model.clone(), &fixed.collect::<Vec<_>>(), path).unwrap();
        Problem::new(family, space.clone(), self.observables()).unwrap()
    }

    fn generator(&self, value: f64, scheme: AdvectiveScheme) -> Vec<EstimatedDensity> {
        let options = GeneratorMethodOptions {
            scheme,
            ..GeneratorMethodOptions::default()
        };
        let problem = self.problem(value, &self.space);
        let source = GeneratorSource::new(&problem, &options).unwrap();
        let mut session = source.open(&Cancellation::new());
        session.solve(value).unwrap().densities
    }

    /// Densities by trajectories planned for this value alone, and the steps they took.
    fn trajectories(&self, value: f64, error: f64, seed: u64) -> (Vec<EstimatedDensity>, u64) {
        let observables = self.observables();
        let options = MonteCarloOptions {
            error,
            seed,
            ..MonteCarloOptions::default()
        };
        let space = self.cut_into_bins();
        let problem = self.problem(value, &space);
        let source = MonteCarloSource::new(&problem, &options, &Cancellation::new()).unwrap();
        let (solution, found) = source.estimate(value, &Cancellation::new()).unwrap();
        assert!(
            solution.report.findings.is_empty(),
            "{:?}",
            solution.report.findings
        );
        let marginal = |&observable| estimate(&space, observable, &found.mass, &found.replicates);
        let densities: Result<Vec<_>, _> = observables.iter().map(marginal).collect();
        (densities.unwrap(), found.steps)
    }
}

/// How two estimates of a marginal compare, over bins.
struct Agreement {
    /// Bins with at least [`LEAST_MASS`] of the mass.
    bins: usize,
    /// Those of them further apart than three standard errors.
    beyond: usize,
    /// Largest difference in standard errors.
    largest: f64,
    /// Mean square of the differences in standard errors: about 1 where sampling alone makes them.
    mean_square: f64,
    /// Half the L1 distance of all bins.
    distance: f64,
    /// What sampling alone is expected to make of it.
    from_sampling: f64,
    /// Bins that vary for themselves, from the correlation of the jackknife's replicates.
    independent: f64,
}

/// Bins over which the program lays a series out.
const BINS_OF_A_SERIES: usize = 60;

/// Bins with less are not compared: few independent visits stand behind them, and their errors are not normal.
const LEAST_MASS: f64 = 1e-5;

/// Bins are cells joined until they are as wide as this many equal ones would be. The cells beside a switching surface
/// are far narrower than what trajectories resolve: a Heun step that crosses it is off by up to f_c dt.
const EQUAL_BINS: f64 = 100.0;

impl Agreement {
    fn of(reference: &EstimatedDensity, sampled: &EstimatedDensity) -> Self {
        let bins = bins(&sampled.density.axes[0]);
        let joined = |values: &[f64]| -> Vec<f64> {
            let volumes = sampled.density.volumes();
            let mass =
                |bin: &Range<usize>| bin.clone().map(|cell| values[cell] * volumes[cell]).sum();
            bins.iter().map(mass).collect()
        };
        let Variants::Jackknife(replicates) = &sampled.variants else {
            panic!("trajectories have replicates");
        };
        let replicates: Vec<Vec<f64>> = replicates.iter().map(|one| joined(one)).collect();
        let exact = joined(&reference.density.values);
        let found = joined(&sampled.density.values);
        let deviations: Vec<Vec<f64>> = (0..found.len())
            .map(|bin| centred(&replicates, bin))
            .collect();
        let groups = replicates.len() as f64;
        let errors: Vec<f64> = deviations
            .iter()
            .map(|values| ((groups - 1.0) / groups * dot(values, values)).sqrt())
            .collect();
        let watched: Vec<usize> = (0..found.len())
            .filter(|&bin| found[bin] > LEAST_MASS)
            .collect();
        let ratio = |&bin: &usize| (exact[bin] - found[bin]) / errors[bin];
        let ratios: Vec<f64> = watched.iter().map(ratio).collect();
        let distances = exact.iter().zip(&found).map(|(a, b)| (a - b).abs());
        let scatter = (2.0 / std::f64::consts::PI).sqrt();
        Self {
            bins: watched.len(),
            beyond: ratios.iter().filter(|ratio| ratio.abs() > 3.0).count(),
            largest: ratios.iter().fold(0.0, |most, ratio| most.max(ratio.abs())),
            mean_square: dot(&ratios, &ratios) / ratios.len() as f64,
            distance: 0.5 * distances.sum::<f64>(),
            from_sampling: 0.5 * scatter * errors.iter().sum::<f64>(),
            independent: independent_bins(
                &watched
                    .iter()
                    .map(|&bin| &deviations[bin])
                    .collect::<Vec<_>>(),
            ),
        }
    }

    fn share_beyond(&self) -> f64 {
        self.beyond as f64 / self.bins as f64
    }
}

/// Ranges of neighbouring cells, see [`EQUAL_BINS`].
fn bins(axis: &Axis) -> Vec<Range<usize>> {
    let least = (axis.to() - axis.from()) / EQUAL_BINS;
    let (mut bins, mut first) = (Vec::new(), 0);
    for cell in 0..axis.count() {
        // A rounding error must not join cells of exactly this width.
        if axis.edges()[cell + 1] - axis.edges()[first] > 0.999 * least {
            bins.push(first..cell + 1);
            first = cell + 1;
        }
    }
    bins
}

/// The replicates' values of a bin less their mean.
fn centred(replicates: &[Vec<f64>], bin: usize) -> Vec<f64> {
    let mean = replicates.iter().map(|one| one[bin]).sum::<f64>() / replicates.len() as f64;
    replicates.iter().map(|one| one[bin] - mean).collect()
}

fn dot(first: &[f64], second: &[f64]) -> f64 {
    first.iter().zip(second).map(|(a, b)| a * b).sum()
}

/// n² over the sum of squared correlations: n for bins without correlation, 1 for bins that move as one. Replicates of
/// G blocks correlate by chance with a mean square of 1/(G - 1), which is taken off.
fn independent_bins(deviations: &[&Vec<f64>]) -> f64 {
    let by_chance = 1.0 / (deviations[0].len() as f64 - 1.0);
    let mut squares = 0.0;
    for (number, first) in deviations.iter().enumerate() {
        for second in &deviations[..number] {
            let square = dot(first, second).powi(2) / dot(first, first) / dot(second, second);
            squares += 2.0 * (square - by_chance) / (1.0 - by_chance);
        }
    }
    let bins = deviations.len() as f64;
    bins * bins / (bins + squares)
}

/// Compares all marginals at one value and prints a row each. Those of axes of modes are taken from `with_modes`, where
/// given.
fn compare(
    example: &Example,
    with_modes: Option<&Example>,
    value: f64,
    sampling: (f64, u64),
) -> Vec<Agreement> {
    compare_and_keep(example, with_modes, value, sampling).0
}

/// The same, with the densities of the trajectories.
fn compare_and_keep(
    example: &Example,
    with_modes: Option<&Example>,
    value: f64,
    (error, seed): (f64, u64),
) -> (Vec<Agreement>, Vec<EstimatedDensity>) {
    let timed = |example: &Example| {
        let clock = Instant::now();
        let densities = example.generator(value, example.scheme);
        (densities, clock.elapsed().as_secs_f64())
    };
    let (mut reference, solved) = timed(example);
    let mut times = format!("generator {solved:.2} s");
    if let Some((other, (densities, solved))) = with_modes.map(|other| (other, timed(other))) {
        times += &format!(", with {} modes {solved:.2} s", other.most_modes());
        let axes = other.space.axes().iter().zip(densities);
        for (slot, (axis, density)) in reference.iter_mut().zip(axes) {
            if axis.is_modes() {
                *slot = density;
            }
        }
    }
    let clock = Instant::now();
    let (sampled, steps) = example.trajectories(value, error, seed);
    let run = clock.elapsed().as_secs_f64();
    println!(
        "{} = {value}: {times}, {steps:.2e} Heun steps {run:.1} s",
        example.parameter
    );
    let pairs = reference.iter().zip(&sampled).zip(&example.model.axes);
    let compared = pairs.map(|((reference, sampled), axis)| {
        let found = Agreement::of(reference, sampled);
        println!("| {value} | {} {found}", axis.name);
        found
    });
    (compared.collect(), sampled)
}

impl std::fmt::Display for Agreement {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            to,
            "| {} | {} | {:.1} % | {:.1} | {:.2} | {:.1e} | {:.1e} | {:.0} |",
            self.bins,
            self.beyond,
            100.0 * self.share_beyond(),
            self.largest,
            self.mean_square,
            self.distance,
            self.from_sampling,
            self.independent
        )
    }
}

const HEADER: &str = "| value | marginal | bins | beyond 3 standard errors | share | largest | mean square | TV | TV from sampling | independent bins |";

fn wanted_error() -> f64 {
    let given = std::env::var("ERROR").ok();
    given.map_or(MonteCarloOptions::default().error, |text| {
        text.parse().unwrap()
    })
}

/// Bins of all marginals together, and how many of them are further apart than three standard errors.
fn pooled<'a>(found: impl IntoIterator<Item = &'a Agreement>) -> (usize, usize) {
    let add = |(bins, beyond), one: &Agreement| (bins + one.bins, beyond + one.beyond);
    found.into_iter().fold((0, 0), add)
}

/// Runs all values of an example and pools all marginals. One bin in a hundred may be further off: the bins of a
/// marginal vary by a few numbers only (its energy above all), so the share of a single one says little.
fn agrees_at_the_values_of_the_paper(
    example: &Example,
    with_modes: Option<&Example>,
    first_seed: u64,
) {
    println!("{HEADER}");
    let found: Vec<Vec<Agreement>> = (first_seed..)
        .zip(&example.at)
        .map(|(seed, &value)| compare(example, with_modes, value, (wanted_error(), seed)))
        .collect();
    for (axis, description) in example.model.axes.iter().enumerate() {
        let (bins, beyond) = pooled(found.iter().map(|marginals| &marginals[axis]));
        println!(
            "{} at all values: {beyond} of {bins} bins",
            description.name
        );
    }
    let (bins, beyond) = pooled(found.iter().flatten());
    println!("together: {beyond} of {bins} bins");
    assert!(100 * beyond <= bins, "{beyond} of {bins} bins");
}

#[test]
#[ignore = "a minute or more: prints a table of docs/paper.md; ERROR=0.001 asks for a smaller sampling error"]
fn coulomb_at_the_four_values_of_the_paper() {
    agrees_at_the_values_of_the_paper(&Example::read("paper_example1", &[]), None, 1);
}

#[test]
#[ignore = "minutes: prints a table of docs/paper.md"]
fn dahl_at_the_four_values_of_the_paper() {
    let shipped = Example::read("paper_example2", &[]);
    let with_modes = Example::read("paper_example2", &MANY_MODES);
    agrees_at_the_values_of_the_paper(&shipped, Some(&with_modes), 11);
}

/// Modes with which the series of Dahl's friction state has converged to what trajectories can tell, see
/// docs/accuracy.md.
const MANY_MODES: [&str; 1] = ["cells.z.modes=96"];

/// What fewer modes, and fewer cells along x and y, change of the density of the friction state, in total variation
/// over its bins.
#[test]
#[ignore = "minutes: prints a table of docs/accuracy.md; AT tries another alpha"]
fn the_series_of_the_friction_state_over_modes_and_cells() {
    let at = std::env::var("AT").map_or(-1.0, |text| text.parse().unwrap());
    let density = |cells: [usize; 2], modes: usize| {
        let overrides = [
            format!("cells.x.count={}", cells[0]),
            format!("cells.y.count={}", cells[1]),
            format!("cells.z.modes={modes}"),
        ];
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let example = Example::read("paper_example2", &overrides);
        let clock = Instant::now();
        let found = example.generator(at, example.scheme).swap_remove(2);
        println!("{cells:?} {modes}: {:.1} s", clock.elapsed().as_secs_f64());
        found.density.masses()
    };
    let distance = |a: &[f64], b: &[f64]| {
        let gaps = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        0.5 * gaps.sum::<f64>()
    };
    let most = density([40, 36], 128);
    for modes in [8, 16, 24, 32, 40, 48, 64, 80, 96, 112] {
        let far = distance(&density([40, 36], modes), &most);
        println!("| {at} | 40 × 36 | {modes} | {far:.1e} |");
    }
    let finest = density([100, 80], 32);
    for cells in [[30, 28], [40, 36], [48, 40], [60, 48], [80, 64]] {
        let far = distance(&density(cells, 32), &finest);
        println!("| {at} | {} × {} | 32 | {far:.1e} |", cells[0], cells[1]);
    }
}

/// The same with fewer trajectories; and a difference of a tenth in f_c would be seen by them.
#[test]
fn a_short_run_agrees_and_would_see_another_parameter_value() {
    let coulomb = Example::read(
        "paper_example1",
        &["cells.x.count=100", "cells.y.count=100"],
    );
    let (mut found, sampled) = compare_and_keep(&coulomb, None, -0.02, (0.01, 1));
    let other = coulomb.generator(-0.018, AdvectiveScheme::Central6);
    let (bins, beyond) = pooled(&[Agreement::of(&other[0], &sampled[0])]);
    assert!(4 * beyond > bins, "{beyond} of {bins} bins");

    let dahl = Example::read("paper_example2", &[]);
    found.extend(compare(&dahl, None, -1.0, (0.02, 11)).into_iter().take(2));
    let (bins, beyond) = pooled(&found);
    assert!(100 * beyond <= bins, "{beyond} of {bins} bins");
}
