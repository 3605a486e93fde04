//! Every built-in model beside its twin as formulas in a sweep file: the same drift to rounding, the same densities,
//! the same located values.

use pbif::cancellation::Cancellation;
use pbif::continuation::{Label, SweepResult};
use pbif::density::total_variation;
use pbif::sweep_file::{Settings, SweepFile};
use pbif::system::registry;

/// A built-in model, its twin's tables, and what both are swept with.
struct Twins {
    name: &'static str,
    typed: &'static str,
    common: &'static str,
}

const OSCILLATOR: &str = r#"
system.equations = { x = "y", y = "-kappa y - x (alpha + mu x^2) - f_c sign(y)" }
system.noise = { y = "sqrt(sigma2)" }
"#;

const TWINS: [Twins; 11] = [
    Twins {
        name: "coulomb",
        typed: OSCILLATOR,
        common: r#"
            system.parameters = { alpha = 1, kappa = 0.2, mu = 0.1, sigma2 = 0.2 }
            sweep = { parameter = "f_c", from = -0.1, to = 0.05, points = 4 }
            cells.x = { from = -4, to = 4, count = 30 }
            cells.y = { from = -4, to = 4, count = 30, grade = "auto" }
        "#,
    },
    Twins {
        name: "dahl",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - lambda z"
            system.equations.z = "y - lambda/f_c*abs(y)*z"
            system.noise = { y = "sqrt(sigma2)" }
            system.bounds = { z = ["-f_c/lambda", "f_c/lambda"] }
        "#,
        common: r#"
            system.parameters = { kappa = 0.3, mu = 0.3, lambda = 0.5, f_c = 0.25, sigma2 = 0.2 }
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 14 }
            cells.y = { from = -2.5, to = 2.5, count = 14 }
            cells.z = { count = 8 }
            detect = { marginals = ["x", "y"] }
        "#,
    },
    Twins {
        name: "dahl_eq8",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - lambda z"
            system.equations.z = "y - lambda/f_c*abs(y)*x"
            system.noise = { y = "sqrt(sigma2)" }
        "#,
        common: r#"
            system.parameters = { kappa = 0.3, mu = 0.3, lambda = 0.5, f_c = 0.25, sigma2 = 0.2 }
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 10 }
            cells.y = { from = -2.5, to = 2.5, count = 10 }
            cells.z = { from = -2, to = 2, count = 6 }
        "#,
    },
    Twins {
        name: "stribeck",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - (f_c + (f_s - f_c)*exp(-((y - v_b)/v_s)^2))*sign(y - v_b)"
            system.noise = { y = "sqrt(sigma2)" }
        "#,
        common: r#"
            system.parameters = { kappa = 0.2, mu = 1, sigma2 = 0.2, f_c = 0.1, f_s = 0.2, v_s = 0.5, v_b = 0.4 }
            sweep = { parameter = "alpha", from = 0.5, to = 1, points = 2 }
            cells.x = { from = -3, to = 3, count = 30 }
            cells.y = { from = -3, to = 3, count = 30, grade = "auto" }
        "#,
    },
    Twins {
        name: "stribeck_cubic",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - f_s*sign(y - v_b) + 1.5*(f_s - f_m)*((y - v_b)/v_m)*(1 - ((y - v_b)/v_m)^2/3)"
            system.noise = { y = "sqrt(sigma2)" }
        "#,
        common: r#"
            system.parameters = { kappa = 0.2, mu = 1, sigma2 = 0.2, f_s = 0.2, f_m = 0.1, v_m = 0.8, v_b = 0 }
            sweep = { parameter = "alpha", from = 0.5, to = 1, points = 2 }
            cells.x = { from = -3, to = 3, count = 30 }
            cells.y = { from = -3, to = 3, count = 30, grade = "auto" }
        "#,
    },
    Twins {
        name: "lugre",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - lambda z - eta*(y - lambda/(f_c + (f_s - f_c)*exp(-(y/v_s)^2))*abs(y)*z)"
            system.equations.z = "y - lambda/(f_c + (f_s - f_c)*exp(-(y/v_s)^2))*abs(y)*z"
            system.noise = { y = "sqrt(sigma2)" }
            system.bounds = { z = ["-f_s/lambda", "f_s/lambda"] }
        "#,
        common: r#"
            system.parameters.kappa = 0.2
            system.parameters.mu = 1
            system.parameters.sigma2 = 0.2
            system.parameters.lambda = 0.5
            system.parameters.eta = 0.1
            system.parameters.f_c = 0.25
            system.parameters.f_s = 0.5
            system.parameters.v_s = 0.8
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 10 }
            cells.y = { from = -2.5, to = 2.5, count = 10 }
            cells.z = { count = 6 }
        "#,
    },
    Twins {
        name: "elasto_plastic",
        typed: r#"
            system.equations = { x = "y", y = "-kappa y - x (alpha + mu x^2) - lambda z - eta rate", z = "rate" }
            system.define.w = "lambda z*sign(y)"
            system.define.way = "min(max((w - f_b)/f_t, 0), 1)"
            system.define.rate = "y (1 - (1 - cos(pi way))/2*w/(f_b + f_t))"
            system.noise = { y = "sqrt(sigma2)" }
            system.bounds = { z = ["-(f_b + f_t)/lambda", "(f_b + f_t)/lambda"] }
        "#,
        common: r#"
            system.parameters.kappa = 0.2
            system.parameters.mu = 1
            system.parameters.sigma2 = 0.2
            system.parameters.lambda = 0.5
            system.parameters.eta = 0.1
            system.parameters.f_b = 0.1
            system.parameters.f_t = 0.15
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 10 }
            cells.y = { from = -2.5, to = 2.5, count = 10 }
            cells.z = { count = 6 }
        "#,
    },
    Twins {
        name: "bouc_wen",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - lambda z"
            system.equations.z = "A y - beta*abs(y)*z - gamma*y*abs(z)"
            system.noise = { y = "sqrt(sigma2)" }
            system.bounds = { z = ["-A/(beta + gamma)", "A/(beta + gamma)"] }
        "#,
        common: r#"
            system.parameters = { kappa = 0.2, mu = 1, sigma2 = 0.2, lambda = 0.3, A = 1, beta = 0.7, gamma = 0.3 }
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 10 }
            cells.y = { from = -2.5, to = 2.5, count = 10 }
            cells.z = { count = 6 }
        "#,
    },
    Twins {
        name: "bliman_sorine",
        typed: r#"
            system.equations.x = "y"
            system.equations.y = "-kappa y - x (alpha + mu x^2) - u + v"
            system.equations.u = "(f_1 y - abs(y)*u)/(rho epsilon)"
            system.equations.v = "(f_2 y - abs(y)*v)/epsilon"
            system.noise = { y = "sqrt(sigma2)" }
            system.bounds = { u = ["-f_1", "f_1"], v = ["-f_2", "f_2"] }
        "#,
        common: r#"
            system.parameters = { kappa = 0.2, mu = 1, sigma2 = 0.2, f_1 = 0.4, f_2 = 0.2, epsilon = 1, rho = 0.5 }
            sweep = { parameter = "alpha", from = -0.5, to = 0.5, points = 2 }
            cells.x = { from = -2.5, to = 2.5, count = 8 }
            cells.y = { from = -2.5, to = 2.5, count = 8 }
            cells.u = { count = 4 }
            cells.v = { count = 4 }
        "#,
    },
    Twins {
        name: "rayleigh",
        typed: r#"
            system.equations = { x = "y", y = "-(b H - a) y - x" }
            system.noise = { y = "sqrt(sigma2)" }
            system.define = { H = "(x^2 + y^2)/2" }
        "#,
        common: r#"
            system.parameters = { b = 1, sigma2 = 0.2 }
            sweep = { parameter = "a", from = -0.2, to = 0.4, points = 4 }
            cells.x = { from = -3, to = 3, count = 30 }
            cells.y = { from = -3, to = 3, count = 30 }
        "#,
    },
    Twins {
        name: "bistable",
        typed: r#"
            system.equations = { x = "a x - x³" }
            system.noise = { x = "sqrt(sigma2)" }
        "#,
        common: r#"
            system.parameters = { sigma2 = 0.25 }
            sweep = { parameter = "a", from = -1, to = 1, points = 5 }
            cells.x = { from = -2.5, to = 2.5, count = 100 }
        "#,
    },
];

fn settings(text: &str) -> Settings {
    let mut file = SweepFile::parse("twin.toml", text);
    file.set("locate.grid_check", "off");
    file.validate().unwrap()
}

impl Twins {
    fn both(&self) -> [Settings; 2] {
        let model = format!("system.model = \"{}\"", self.name);
        [model.as_str(), self.typed].map(|system| settings(&format!("{system}\n{}", self.common)))
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
fn twins_have_the_same_drift() {
    for twins in TWINS {
        let systems = twins
            .both()
            .map(|one| one.family.at(one.family.ends().1).unwrap());
        let dimension = systems[0].dimension();
        for number in 0..1000 {
            let state: Vec<f64> = (0..dimension)
                .map(|axis| 2.0 * ((number * (2 * axis + 3)) as f64).sin())
                .collect();
            let [one, other] = [0, 1].map(|which| systems[which].drift_at(0.0, &state));
            for (a, b) in one.iter().zip(&other) {
                // A few roundings of terms that are at most about 10.
                assert!(
                    (a - b).abs() < 2e-14,
                    "{} at {state:?}: {a} {b}",
                    twins.name
                );
            }
        }
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
