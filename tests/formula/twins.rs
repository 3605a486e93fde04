//! Every built-in model beside its twin as formulas in a sweep file: the same drift to rounding, the same densities,
//! the same located values.

use pbif::cancellation::Cancellation;
use pbif::continuation::{Label, SweepResult};
use pbif::density::total_variation;
use pbif::generator::{GeneratorOptions, assemble, cell_masses};
use pbif::space::CellSpace;
use pbif::stationary::generator::{RateMethod, RateOptions, RateSolver};
use pbif::sweep_file::Settings;
use pbif::system::{System, contract, registry};

use crate::common::sweeps::settings;

/// A built-in model, its twin's tables, and what both are swept with.
struct Twins {
    name: &'static str,
    /// Lines of the table `system` of the twin.
    typed: &'static [&'static str],
    parameters: &'static str,
    /// The swept parameter, from, to and number of values.
    sweep: (&'static str, f64, f64, usize),
    /// Half-width and number of cells along x and y, and further lines of the table `cells`.
    cells: (f64, usize, &'static [&'static str]),
}

/// An oscillator with this friction and these equations of its states.
macro_rules! oscillator {
    ($name:literal, $friction:literal, [$($states:literal),*], $parameters:literal, $sweep:expr, $cells:expr) => {
        Twins {
            name: $name,
            typed: &[
                "equations.x = 'y'",
                concat!("equations.y = '-kappa y - x (alpha + mu x^2) - ", $friction, "'"),
                "noise.y = 'sqrt(sigma2)'",
                $($states),*
            ],
            parameters: concat!("sigma2 = 0.2, ", $parameters),
            sweep: $sweep,
            cells: $cells,
        }
    };
}

const GRADED: (f64, usize, &[&str]) = (3.0, 30, &["y.grade = 'auto'"]);
const BOX: (f64, usize, &[&str]) = (2.5, 10, &["z.count = 6"]);
const ALPHA: (&str, f64, f64, usize) = ("alpha", -0.5, 0.5, 2);

#[rustfmt::skip]
const TWINS: [Twins; 11] = [
    oscillator!("coulomb", "f_c sign(y)", [], "alpha = 1, kappa = 0.2, mu = 0.1",
        ("f_c", -0.1, 0.05, 4), (4.0, 30, &["y.grade = 'auto'"])),
    oscillator!("dahl", "lambda z", ["equations.z = 'y - lambda/f_c*abs(y)*z'", "bounds.z = ['-f_c/lambda', 'f_c/lambda']"],
        "kappa = 0.3, mu = 0.3, lambda = 0.5, f_c = 0.25", ALPHA, (2.5, 14, &["z.count = 8"])),
    oscillator!("dahl_eq8", "lambda z", ["equations.z = 'y - lambda/f_c*abs(y)*x'"],
        "kappa = 0.3, mu = 0.3, lambda = 0.5, f_c = 0.25", ALPHA, (2.5, 10, &["z = { from = -2, to = 2, count = 6 }"])),
    oscillator!("stribeck", "(f_c + (f_s - f_c)*exp(-((y - v_b)/v_s)^2))*sign(y - v_b)", [],
        "kappa = 0.2, mu = 1, f_c = 0.1, f_s = 0.2, v_s = 0.5, v_b = 0.4", ("alpha", 0.5, 1.0, 2), GRADED),
    oscillator!("stribeck_cubic", "f_s*sign(y - v_b) + 1.5*(f_s - f_m)*((y - v_b)/v_m)*(1 - ((y - v_b)/v_m)^2/3)", [],
        "kappa = 0.2, mu = 1, f_s = 0.2, f_m = 0.1, v_m = 0.8, v_b = 0", ("alpha", 0.5, 1.0, 2), GRADED),
    oscillator!("lugre", "lambda z - eta*(y - lambda/(f_c + (f_s - f_c)*exp(-(y/v_s)^2))*abs(y)*z)", [
            "equations.z = 'y - lambda/(f_c + (f_s - f_c)*exp(-(y/v_s)^2))*abs(y)*z'",
            "bounds.z = ['-f_s/lambda', 'f_s/lambda']"
        ], "kappa = 0.2, mu = 1, lambda = 0.5, eta = 0.1, f_c = 0.25, f_s = 0.5, v_s = 0.8", ALPHA, BOX),
    oscillator!("elasto_plastic", "lambda z - eta rate", [
            "equations.z = 'rate'",
            "define.w = 'lambda z*sign(y)'",
            "define.way = 'min(max((w - f_b)/f_t, 0), 1)'",
            "define.rate = 'y (1 - (1 - cos(pi way))/2*w/(f_b + f_t))'",
            "bounds.z = ['-(f_b + f_t)/lambda', '(f_b + f_t)/lambda']"
        ], "kappa = 0.2, mu = 1, lambda = 0.5, eta = 0.1, f_b = 0.1, f_t = 0.15", ALPHA, BOX),
    oscillator!("bouc_wen", "lambda z", [
            "equations.z = 'A y - beta*abs(y)*z - gamma*y*abs(z)'",
            "bounds.z = ['-A/(beta + gamma)', 'A/(beta + gamma)']"
        ], "kappa = 0.2, mu = 1, lambda = 0.3, A = 1, beta = 0.7, gamma = 0.3", ALPHA, BOX),
    oscillator!("bliman_sorine", "u + v", [
            "equations.u = '(f_1 y - abs(y)*u)/(rho epsilon)'",
            "equations.v = '(f_2 y - abs(y)*v)/epsilon'",
            "bounds = { u = ['-f_1', 'f_1'], v = ['-f_2', 'f_2'] }"
        ], "kappa = 0.2, mu = 1, f_1 = 0.4, f_2 = 0.2, epsilon = 1, rho = 0.5", ALPHA,
        (2.5, 8, &["u.count = 4", "v.count = 4"])),
    Twins {
        name: "rayleigh",
        typed: &["equations = { x = 'y', y = '-(b H - a) y - x' }", "noise.y = 'sqrt(sigma2)'", "define.H = '(x^2 + y^2)/2'"],
        parameters: "b = 1, sigma2 = 0.2",
        sweep: ("a", -0.2, 0.4, 4),
        cells: (3.0, 30, &[]),
    },
    Twins {
        name: "bistable",
        typed: &["equations.x = 'a x - x³'", "noise.x = 'sqrt(sigma2)'"],
        parameters: "sigma2 = 0.25",
        sweep: ("a", -1.0, 1.0, 5),
        cells: (2.5, 100, &[]),
    },
];

impl Twins {
    /// The built-in model and its twin, ready to be swept.
    fn both(&self) -> [Settings; 2] {
        let (parameter, from, to, points) = self.sweep;
        let (half, count, further) = self.cells;
        let axes: &[&str] = match self.name {
            "bistable" => &["x"],
            _ => &["x", "y"],
        };
        let cells = axes.iter().map(|axis| {
            format!("{axis}.from = -{half}\n{axis}.to = {half}\n{axis}.count = {count}\n")
        });
        let model = format!("model = '{}'", self.name);
        [model, self.typed.join("\n")].map(|system| {
            let text = format!(
                "[system]\n{system}\nparameters = {{ {} }}\n\
                 [sweep]\nparameter = '{parameter}'\nfrom = {from}\nto = {to}\npoints = {points}\n\
                 [cells]\n{}{}\n",
                self.parameters,
                cells.clone().collect::<String>(),
                further.join("\n"),
            );
            settings(&text, "locate.grid_check=off")
        })
    }
}

fn run(settings: Settings) -> SweepResult {
    let never = Cancellation::new();
    let sweep = settings.prepare(&never).unwrap();
    sweep.run(&never, &mut ()).unwrap()
}

#[test]
fn every_built_in_model_has_its_twin() {
    let built_in: Vec<&str> = registry::models()
        .iter()
        .map(|one| one.name.as_str())
        .collect();
    assert_eq!(TWINS.map(|twins| twins.name).to_vec(), built_in);
}

#[test]
fn twins_have_the_same_drift_noise_and_facts() {
    for twins in TWINS {
        let name = twins.name;
        let families = twins.both().map(|one| one.family);
        let end = families[0].ends().1;
        let [built_in, typed] = [0, 1].map(|which| families[which].at(end).unwrap());
        for number in 0..1000 {
            let state: Vec<f64> = (0..built_in.dimension())
                .map(|axis| 2.0 * ((number * (2 * axis + 3)) as f64).sin())
                .collect();
            let drifts = built_in.drift_at(0.0, &state).into_iter();
            for (a, b) in drifts.zip(typed.drift_at(0.0, &state)) {
                // A few roundings of terms that are at most about 10.
                assert!((a - b).abs() < 2e-14, "{name} at {state:?}: {a} {b}");
            }
        }
        let [own, other] = [&built_in, &typed].map(|system| {
            let noises = system.noises().iter();
            let noises = noises.map(|noise| (noise.axis, noise.additive()));
            noises.collect::<Vec<_>>()
        });
        assert_eq!(own, other, "{name}");
        assert_eq!(typed.facts(), built_in.facts(), "{name}");
        let mut values: Vec<(&str, f64)> = families[1].fixed().collect();
        values.push((families[1].parameter(), end));
        let values = families[1].model().values(&values).unwrap();
        let ranges = vec![(-2.0, 2.0); typed.dimension()];
        let verified = contract::verify_model(families[1].model(), &values, &ranges);
        assert_eq!(verified, Ok(()), "{name}");
    }
}

/// Steady masses of the cells by factors alone, Σ = 1.
pub(super) fn masses(system: &dyn System, space: &CellSpace) -> Vec<f64> {
    let generator = assemble(system, space, &GeneratorOptions::default()).unwrap();
    let options = RateOptions {
        method: Some(RateMethod::Lu),
        tolerance: 1e-14,
        ..RateOptions::default()
    };
    let mut solver = RateSolver::new(space.clone(), options);
    let steady = solver.solve(&generator.matrix, &generator.escape, None);
    cell_masses(system, space, &steady.unwrap().mass)
}

#[test]
fn twins_have_the_same_density_to_rounding() {
    for twins in TWINS {
        if !["coulomb", "dahl", "bistable"].contains(&twins.name) {
            continue;
        }
        let [one, other] = twins.both().map(|settings| {
            let sweep = settings.prepare(&Cancellation::new()).unwrap();
            let family = sweep.problem.family();
            let system = family.at(family.ends().1).unwrap();
            masses(&*system, sweep.problem.space())
        });
        let pairs = one.iter().zip(&other);
        let distance = 0.5 * pairs.map(|(a, b)| (a - b).abs()).sum::<f64>();
        assert!(distance < 1e-12, "{}: {distance:e}", twins.name);
    }
}

#[test]
fn twins_have_the_same_densities_and_located_values() {
    for twins in TWINS {
        let [one, other] = twins.both().map(run);
        assert_eq!(one.points.len(), other.points.len(), "{}", twins.name);
        for (a, b) in one.points.iter().zip(&other.points) {
            assert_eq!(a.report.status, b.report.status, "{}", twins.name);
            for (p, q) in a.densities.iter().zip(&b.densities) {
                let distance = total_variation(&p.density, &q.density).unwrap();
                // The solver stops at 1e-8; roundings differ.
                assert!(distance < 1e-7, "{}: {distance}", twins.name);
            }
        }
        assert_eq!(one.labels.len(), other.labels.len(), "{}", twins.name);
        for (a, b) in one.labels.iter().zip(&other.labels) {
            let status = |row: &Label| row.bifurcation().map(|one| one.status());
            assert_eq!((a.name(), status(a)), (b.name(), status(b)));
            let both = (a.value(), b.value());
            assert!(
                (both.0 - both.1).abs() < 1e-6,
                "{} {}: {both:?}",
                twins.name,
                a.name()
            );
        }
    }
}
