//! Every method against every density that is known exactly, and located bifurcations against exact ones. Prints the
//! tables of docs/validation.md, the same on every machine but for the last digit; about a minute on two free cores.
//!
//! Run with `cargo run --release --example validation`.

#![allow(clippy::print_stdout)] // An example talks to its reader.

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource, LocateOptions, sweep};
use pbif::density::{EstimatedDensity, Observable, hellinger_of_masses, total_variation_of_masses};
use pbif::generator::{AdvectiveScheme, automatic_grading};
use pbif::method::{
    Correction, GeneratorMethodOptions, MethodOptions, MethodSource, MonteCarloOptions, Problem,
    SgcmOptions, StepChoice,
};
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, registry};
use pbif::topology::{DetectOptions, PersistenceDetector};

type AnyError = Box<dyn std::error::Error>;

/// The nodes on [-1, 1] and the weights, Σ = 1, of the four-point Gauss-Legendre rule.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
    (-0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.339_981_043_584_856_26, 0.326_072_577_431_273_07),
    (0.861_136_311_594_052_6, 0.173_927_422_568_726_93),
];

/// A system at one parameter value.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    model: &'static str,
    parameters: &'static [(&'static str, f64)],
    /// The parameter that a source of densities varies, and its value.
    parameter: (&'static str, f64),
    /// Ω is ± this on every axis.
    half: f64,
}

const COULOMB: &[(&str, f64)] = &[("kappa", 0.01), ("mu", 0.01), ("sigma2", 0.01)];

/// Systems whose density is known.
const CASES: [Case; 7] = [
    Case {
        name: "coulomb, f_c = 0",
        model: "coulomb",
        parameters: COULOMB,
        parameter: ("f_c", 0.0),
        half: 4.6,
    },
    Case {
        name: "linear oscillator (Gaussian)",
        model: "coulomb",
        parameters: &[("kappa", 0.1), ("mu", 0.0), ("sigma2", 0.1)],
        parameter: ("f_c", 0.0),
        half: 4.6,
    },
    Case {
        name: "rayleigh, a = -0.2",
        model: "rayleigh",
        parameters: &[("b", 0.2), ("sigma2", 0.2)],
        parameter: ("a", -0.2),
        half: 3.4,
    },
    Case {
        name: "rayleigh, a = 0.2",
        model: "rayleigh",
        parameters: &[("b", 0.2), ("sigma2", 0.2)],
        parameter: ("a", 0.2),
        half: 3.8,
    },
    Case {
        name: "bistable, a = -0.5",
        model: "bistable",
        parameters: &[("sigma2", 0.1)],
        parameter: ("a", -0.5),
        half: 2.0,
    },
    Case {
        name: "bistable, a = 0",
        model: "bistable",
        parameters: &[("sigma2", 0.1)],
        parameter: ("a", 0.0),
        half: 2.0,
    },
    Case {
        name: "bistable, a = 1",
        model: "bistable",
        parameters: &[("sigma2", 0.1)],
        parameter: ("a", 1.0),
        half: 2.2,
    },
];

/// How far a density is from the exact one.
struct Error {
    total_variation: f64,
    hellinger: f64,
    /// Total variation that sampling alone is expected to make: ½ Σ E|error| of normal errors.
    from_sampling: f64,
}

impl Case {
    fn dimension(&self) -> Result<usize, AnyError> {
        Ok(registry::find(self.model)?.axes.len())
    }

    /// `count` equal cells an axis.
    fn cells(&self, count: usize) -> Result<CellSpace, AnyError> {
        let axis = Axis::uniform(-self.half, self.half, count)?;
        Ok(CellSpace::new(vec![axis; self.dimension()?])?)
    }

    /// Along its parameter.
    fn problem(
        &self,
        (from, to): (f64, f64),
        space: &CellSpace,
        observable: Observable,
    ) -> Result<Problem, AnyError> {
        let path = Path::parameter(self.parameter.0, from, to);
        let family = Family::new(registry::find(self.model)?, self.parameters, path)?;
        Ok(Problem::new(family, space.clone(), vec![observable])?)
    }

    /// The density of the whole state.
    fn solve(
        &self,
        space: &CellSpace,
        method: &MethodOptions,
        observable: Observable,
    ) -> Result<EstimatedDensity, AnyError> {
        let value = self.parameter.1;
        let problem = self.problem((value, value), space, observable)?;
        let source = MethodSource::new(&problem, method, &Cancellation::new())?;
        let mut session = source.open(&Cancellation::new());
        let found = session.solve(value)?;
        found
            .densities
            .into_iter()
            .next()
            .ok_or_else(|| "no steady state".into())
    }

    /// Integrals of the exact density over the cells, four Gauss-Legendre points an axis, Σ = 1.
    fn exact(&self, space: &CellSpace) -> Result<Vec<f64>, AnyError> {
        let mut given = self.parameters.to_vec();
        given.push(self.parameter);
        let system = registry::find(self.model)?.system_with(&given)?;
        let mut masses = Vec::with_capacity(space.n_cells());
        for cell in 0..space.n_cells() {
            let mut mass = 0.0;
            for point in 0..GAUSS.len().pow(space.dimension() as u32) {
                let (mut state, mut weight, mut rest) =
                    (space.centre(cell), space.volume(cell), point);
                for (axis, coordinate) in state.iter_mut().enumerate() {
                    let (place, share) = GAUSS[rest % GAUSS.len()];
                    rest /= GAUSS.len();
                    *coordinate +=
                        0.5 * place * space.axes()[axis].width(space.position(cell, axis));
                    weight *= share;
                }
                let logarithm = system.exact_log_density(&state).ok_or("no exact density")?;
                mass += weight * logarithm.exp();
            }
            masses.push(mass);
        }
        let total: f64 = masses.iter().sum();
        Ok(masses.iter().map(|mass| mass / total).collect())
    }

    fn error(&self, space: &CellSpace, method: &MethodOptions) -> Result<Error, AnyError> {
        let whole = match space.dimension() {
            1 => Observable::Marginal(0),
            _ => Observable::Joint(0, 1),
        };
        let found = self.solve(space, method, whole)?;
        let (masses, exact) = (found.density.masses(), self.exact(space)?);
        let errors = found.standard_error.iter().zip(found.density.volumes());
        let errors: f64 = errors.map(|(error, volume)| error * volume).sum();
        Ok(Error {
            total_variation: total_variation_of_masses(&masses, &exact)?,
            hellinger: hellinger_of_masses(&masses, &exact)?,
            from_sampling: 0.5 * errors * (2.0 / std::f64::consts::PI).sqrt(),
        })
    }
}

fn generator(scheme: AdvectiveScheme) -> MethodOptions {
    MethodOptions::Generator(GeneratorMethodOptions {
        scheme,
        // Errors of these grids come down to 1e-7.
        solver_tolerance: 1e-11,
        ..GeneratorMethodOptions::default()
    })
}

fn sgcm(samples: usize, map_step: f64, correction: Correction) -> MethodOptions {
    MethodOptions::Sgcm(SgcmOptions {
        samples,
        map_step: StepChoice::Fixed(map_step),
        correction,
        ..SgcmOptions::default()
    })
}

/// Rows of the generator's table: every case, every scheme, cells doubled twice.
pub(crate) fn generator_rows(coarsest: usize, doublings: u32) -> Result<Vec<String>, AnyError> {
    let mut rows = Vec::new();
    for case in &CASES {
        // On one axis nothing is advected across another axis' noise: the density is a quadrature, whatever the scheme.
        let one_axis = case.cells(coarsest)?.dimension() == 1;
        for scheme in AdvectiveScheme::ALL
            .into_iter()
            .take(if one_axis { 1 } else { 3 })
        {
            let mut before: Option<f64> = None;
            for doubling in 0..doublings {
                let count = coarsest << doubling;
                let found = case.error(&case.cells(count)?, &generator(scheme))?;
                let (tv, hellinger) = (found.total_variation, found.hellinger);
                let order = before.map_or(String::new(), |before| {
                    format!("{:.1}", (before / tv).log2())
                });
                let name = case.name;
                let scheme = if one_axis {
                    "quadrature"
                } else {
                    scheme.name()
                };
                rows.push(format!(
                    "| {name} | {scheme} | {count} | {tv:.1e} | {hellinger:.1e} | {order} |"
                ));
                before = Some(tv);
            }
        }
    }
    Ok(rows)
}

/// Rows of the slope law: p'(0+)/p(0) of the y marginal over its exact value -2 f_c/σ².
pub(crate) fn slope_rows(values: &[f64]) -> Result<Vec<String>, AnyError> {
    let mut rows = Vec::new();
    for &f_c in values {
        let half = if f_c < 0.0 { 4.6 } else { 3.6 };
        let case = Case {
            parameter: ("f_c", f_c),
            half,
            ..CASES[0]
        };
        let mut given = case.parameters.to_vec();
        given.push(case.parameter);
        let system = registry::find(case.model)?.system_with(&given)?;
        let grading =
            automatic_grading(system.as_ref(), &[(-half, half); 2], 1, 100).ok_or("no surface")?;
        let y = Axis::graded(-half, half, 100, &grading)?;
        let space = CellSpace::new(vec![Axis::uniform(-half, half, 100)?, y])?;
        for scheme in AdvectiveScheme::ALL {
            let found = case.solve(&space, &generator(scheme), Observable::Marginal(1))?;
            let ratio = slope_at_zero(&found)? / (-2.0 * f_c / 0.01);
            rows.push(format!("| {f_c} | {} | {ratio:.4} |", scheme.name()));
        }
    }
    Ok(rows)
}

/// p'(0+)/p(0), from the cubic whose integrals are the masses of the four cells above 0.
fn slope_at_zero(found: &EstimatedDensity) -> Result<f64, AnyError> {
    let (axis, masses) = (&found.density.axes[0], found.density.masses());
    let first = axis.count() / 2;
    let unit = axis.width(first);
    let matrix = nalgebra::Matrix4::from_fn(|row, column| {
        let power = column as i32 + 1;
        let edge = |cell: usize| (axis.edges()[first + cell] / unit).powi(power);
        (edge(row + 1) - edge(row)) / f64::from(power)
    });
    let integrals = nalgebra::Vector4::from_fn(|row, _| masses[first + row]);
    let cubic = matrix.lu().solve(&integrals).ok_or("cells without width")?;
    Ok(cubic[1] / cubic[0] / unit)
}

/// Rows of SGCM, plain and corrected, from the same samples.
pub(crate) fn sgcm_rows(runs: &[(usize, usize, usize, f64)]) -> Result<Vec<String>, AnyError> {
    let mut rows = Vec::new();
    for &(number, count, samples, map_step) in runs {
        let case = CASES[number];
        let space = case.cells(count)?;
        for correction in [Correction::None, Correction::Slope] {
            let found = case.error(&space, &sgcm(samples, map_step, correction))?;
            rows.push(format!(
                "| {} | {count} | {samples} | {map_step} | {} | {:.4} | {:.4} | {:.4} |",
                case.name,
                correction.name(),
                found.total_variation,
                found.hellinger,
                found.from_sampling
            ));
        }
    }
    Ok(rows)
}

/// Rows of Monte Carlo: every case, with the relative standard error of the variances that is asked for.
pub(crate) fn monte_carlo_rows(cases: &[usize], errors: &[f64]) -> Result<Vec<String>, AnyError> {
    let mut rows = Vec::new();
    for &number in cases {
        let case = CASES[number];
        let space = case.cells(50)?;
        for &error in errors {
            let options = MonteCarloOptions {
                error,
                ..MonteCarloOptions::default()
            };
            let found = case.error(&space, &MethodOptions::MonteCarlo(options))?;
            rows.push(format!(
                "| {} | {error} | {:.1e} | {:.1e} | {:.1e} |",
                case.name, found.total_variation, found.hellinger, found.from_sampling
            ));
        }
    }
    Ok(rows)
}

/// A family with a bifurcation at a known value.
struct Sweep {
    case: Case,
    range: (f64, f64),
    points: usize,
    space: CellSpace,
    observable: Observable,
    truth: f64,
}

impl Sweep {
    /// x of `bistable` at a = 0.
    fn wells(points: usize) -> Result<Self, AnyError> {
        let case = Case {
            name: "bistable",
            parameters: &[("sigma2", 0.25)],
            half: 2.2,
            ..CASES[5]
        };
        Ok(Self {
            space: case.cells(100)?,
            case,
            range: (-1.0, 1.0),
            points,
            observable: Observable::Marginal(0),
            truth: 0.0,
        })
    }

    /// `rayleigh`: the crater of (x, y) opens at a = 0, the peak of x splits later.
    fn crater(observable: Observable, count: usize) -> Result<Self, AnyError> {
        let case = Case {
            name: "rayleigh",
            parameters: &[("b", 0.1), ("sigma2", 0.02)],
            half: 2.6,
            ..CASES[2]
        };
        Ok(Self {
            space: case.cells(count)?,
            case,
            range: (-0.1, 0.1),
            points: 11,
            observable,
            truth: match observable {
                Observable::Joint(..) => 0.0,
                Observable::Marginal(_) => rayleigh_split(0.1, 0.02),
            },
        })
    }

    /// The notch of y in `coulomb`: p'(0+)/p(0) = -2 f_c/σ² changes its sign at f_c = 0.
    fn notch() -> Result<Self, AnyError> {
        let case = Case {
            name: "coulomb",
            half: 4.6,
            ..CASES[0]
        };
        Ok(Self {
            space: case.cells(100)?,
            case,
            range: (-0.005, 0.005),
            points: 6,
            observable: Observable::Marginal(1),
            truth: 0.0,
        })
    }

    /// The located value with its error; the range of the family must hold one bifurcation.
    fn locate(&self, method: &MethodOptions) -> Result<(f64, f64), AnyError> {
        let problem = self
            .case
            .problem(self.range, &self.space, self.observable)?;
        let source = MethodSource::new(&problem, method, &Cancellation::new())?;
        let detector = PersistenceDetector::new(DetectOptions::default(), self.points);
        let options = LocateOptions {
            relative_tolerance: 5e-4,
            ..LocateOptions::default()
        };
        let found = sweep(
            &source,
            &detector,
            self.points,
            &options,
            &Cancellation::new(),
            &mut (),
        )?;
        let mut rows = found.bifurcations();
        match (rows.next(), rows.next()) {
            (Some(row), None) => Ok((row.value, row.error)),
            _ => Err(format!("not one bifurcation: {:?}", found.labels).into()),
        }
    }
}

/// Where x of `rayleigh` goes from one peak to two: the zero of ∂²p/∂x² at x = 0, p = ∫ exp(2(aH - bH²/2)/σ²) dy with
/// H = (x² + y²)/2, hence of ∫ (a - bH) exp(…) dy there; bisection, and sums over equal steps (exact for this
/// integrand).
fn rayleigh_split(b: f64, sigma2: f64) -> f64 {
    let curvature = |a: f64| -> f64 {
        let term = |k: i32| {
            let energy = 0.5 * (f64::from(k) * 2e-3).powi(2);
            (a - b * energy) * (2.0 * (a * energy - 0.5 * b * energy * energy) / sigma2).exp()
        };
        (-2000..=2000).map(term).sum()
    };
    let (mut below, mut above) = (0.0, 0.1);
    while above - below > 1e-13 {
        let middle = 0.5 * (below + above);
        match curvature(middle) < 0.0 {
            true => below = middle,
            false => above = middle,
        }
    }
    0.5 * (below + above)
}

/// Rows of located values.
pub(crate) fn location_rows(with_sampling: bool) -> Result<Vec<String>, AnyError> {
    let (x, joint) = (Observable::Marginal(0), Observable::Joint(0, 1));
    let direct = || generator(AdvectiveScheme::default());
    let mut runs = vec![
        (Sweep::wells(41)?, "generator", direct()),
        (Sweep::crater(joint, 100)?, "generator", direct()),
        (Sweep::crater(x, 100)?, "generator", direct()),
        (Sweep::notch()?, "generator", direct()),
    ];
    if with_sampling {
        let sampled = |samples, map_step| sgcm(samples, map_step, Correction::Slope);
        runs.push((
            Sweep::wells(11)?,
            "sgcm, 10⁴ samples, Δt = 5",
            sampled(10_000, 5.0),
        ));
        runs.push((
            Sweep::crater(joint, 50)?,
            "sgcm, 400 samples, Δt = 30",
            sampled(400, 30.0),
        ));
    }
    let mut rows = Vec::new();
    for (family, name, method) in runs {
        let (value, error) = family.locate(&method)?;
        let model = registry::find(family.case.model)?;
        let axes = &model.axes;
        let observable: String = family
            .observable
            .axes()
            .iter()
            .map(|&axis| axes[axis].name.as_str())
            .collect();
        rows.push(format!(
            "| {} | {observable} | {} | {name} | {} | {} | {} |",
            family.case.name,
            family.case.parameter.0,
            small(family.truth),
            small((value - family.truth).abs()),
            small(error)
        ));
    }
    Ok(rows)
}

/// What is below 1e-9 is rounding, and differs from machine to machine.
fn small(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        value if value < 1e-9 => "< 1e-9".to_owned(),
        value => format!("{value:.2e}"),
    }
}

fn print(title: &str, header: &str, rows: &[String]) {
    let columns = header.matches('|').count() - 1;
    println!("## {title}\n\n{header}\n|{}", " --- |".repeat(columns));
    rows.iter().for_each(|row| println!("{row}"));
    println!();
}

fn main() -> Result<(), AnyError> {
    print(
        "Generator",
        "| system | scheme | cells an axis | TV | Hellinger | order |",
        &generator_rows(40, 3)?,
    );
    print(
        "Slope law at the switching surface",
        "| f_c | scheme | slope over the law |",
        &slope_rows(&[0.01, 0.001, -0.001, -0.01])?,
    );
    print(
        "SGCM",
        "| system | cells an axis | samples | Δt | correction | TV | Hellinger | TV from sampling |",
        &sgcm_rows(&SGCM_RUNS)?,
    );
    print(
        "Monte Carlo",
        "| system | wanted error | TV | Hellinger | TV from sampling |",
        &monte_carlo_rows(&[0, 1, 2, 3, 4, 5, 6], &[0.02, 0.005])?,
    );
    print(
        "Located bifurcations",
        "| family | observable | parameter | method | truth | off by | stated error |",
        &location_rows(true)?,
    );
    Ok(())
}

/// Case, cells an axis, samples a cell, map step.
const SGCM_RUNS: [(usize, usize, usize, f64); 5] = [
    (0, 50, 500, 1.0),
    (0, 50, 2000, 1.0),
    (0, 50, 2000, 3.0),
    (3, 50, 500, 1.0),
    (6, 100, 2000, 0.5),
];
