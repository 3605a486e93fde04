//! What the time step of trajectories makes of densities beside a plane where the drift jumps, and of their spread:
//! dry friction in one dimension, whose density is exact.

use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource;
use pbif::density::{EstimatedDensity, Observable};
use pbif::method::{
    MethodOptions, MethodSource, MonteCarloOptions, Problem, SgcmOptions, StepChoice,
};
use pbif::sampling::Integrator;
use pbif::space::{Axis, CellSpace};
use pbif::system::{Family, Path, TypedModel};

use crate::random_systems::Dice;

/// v' = θ - k v - Δ sign(v - c) + s ξ.
struct Friction {
    theta: f64,
    damping: f64,
    level: f64,
    at: f64,
    intensity: f64,
    axis: Axis,
}

impl Friction {
    fn random(dice: &mut Dice) -> Self {
        let (damping, intensity) = (dice.between(0.1, 1.0), dice.between(0.1, 0.8));
        let level = dice.between(0.4, 1.5) * intensity.sqrt();
        let deviation = (0.5 * intensity / damping)
            .sqrt()
            .min(0.7 * intensity / level);
        let cells = dice.one_of([40, 80, 160, 300]);
        Self {
            theta: dice.between(-0.2, 0.2) * level,
            damping,
            level,
            at: [0.0, 0.3 * deviation][dice.one_of([0, 1])],
            intensity,
            axis: Axis::uniform(-5.5 * deviation, 5.5 * deviation, cells).unwrap(),
        }
    }

    fn problem(&self) -> Problem {
        let Self {
            damping,
            level,
            at,
            intensity,
            ..
        } = self;
        let model = TypedModel::new("friction", "Dry friction", ["v"])
            .with_equation("v", format!("theta - {damping} v - {level} sign(v - {at})"))
            .with_noise("v", [format!("sqrt({intensity})")])
            .with_parameters(["theta"]);
        let path = Path::parameter("theta", self.theta, self.theta + 1e-3);
        let family = Family::new(model.build().unwrap(), &[], path).unwrap();
        let space = CellSpace::new(vec![self.axis.clone()]).unwrap();
        Problem::new(family, space, vec![Observable::Marginal(0)]).unwrap()
    }

    /// Means of the exact density over the cells, by Simpson's rule on either side of the plane.
    fn exact(&self) -> Vec<f64> {
        let logarithm = |v: f64| {
            let potential = 0.5 * self.damping * v * v + self.level * (v - self.at).abs();
            2.0 * (self.theta * v - potential) / self.intensity
        };
        let simpson = |from: f64, to: f64| {
            let step = (to - from) / 8.0;
            let weighted = (0..=8).map(|k| {
                let weight = [1.0, 4.0, 2.0, 4.0, 2.0, 4.0, 2.0, 4.0, 1.0][k];
                weight * logarithm(from + k as f64 * step).exp()
            });
            weighted.sum::<f64>() * step / 3.0
        };
        let edges = self.axis.edges().windows(2);
        let masses = edges.map(|edge| {
            let middle = self.at.clamp(edge[0], edge[1]);
            simpson(edge[0], middle) + simpson(middle, edge[1])
        });
        let masses: Vec<f64> = masses.collect();
        let total: f64 = masses.iter().sum();
        let cells = masses.iter().enumerate();
        cells
            .map(|(cell, mass)| mass / total / self.axis.width(cell))
            .collect()
    }

    fn density(&self, options: &MethodOptions) -> EstimatedDensity {
        let never = Cancellation::new();
        let source = MethodSource::new(&self.problem(), options, &never).unwrap();
        let mut session = source.open(&never);
        let solution = session.solve(self.theta).unwrap();
        solution.densities[0].clone()
    }

    /// Squares of what cells with a thousandth of the maximum or more are off by over what is stated, of those within a
    /// quarter of a standard deviation of the plane and of all.
    fn squares(&self, options: &MethodOptions, near: &mut Vec<f64>, all: &mut Vec<f64>) {
        let (found, exact) = (self.density(options), self.exact());
        let errors = found.stated_errors();
        let highest = exact.iter().copied().fold(0.0, f64::max);
        let reach = 0.05 * self.axis.to();
        for (cell, &exact) in exact
            .iter()
            .enumerate()
            .filter(|(_, one)| **one > 1e-3 * highest)
        {
            let square = ((found.density.values[cell] - exact) / errors[cell]).powi(2);
            all.push(square);
            if (self.axis.centre(cell) - self.at).abs() <= reach {
                near.push(square);
            }
        }
    }
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// SGCM with increments of four values and with normal ones, at the step that is chosen and at shorter ones.
fn sgcm(seed: u64) -> MethodOptions {
    let auto = SgcmOptions::default();
    let (integrator, time_step) = match seed % 4 {
        0 => (auto.integrator, StepChoice::Auto),
        1 => (Integrator::Splitting, StepChoice::Auto),
        2 => (auto.integrator, StepChoice::Fixed(0.01)),
        _ => (auto.integrator, StepChoice::Fixed(0.003)),
    };
    MethodOptions::Sgcm(SgcmOptions {
        seed,
        integrator,
        time_step,
        ..auto
    })
}

fn monte_carlo(seed: u64) -> MethodOptions {
    MethodOptions::MonteCarlo(MonteCarloOptions {
        seed,
        ..MonteCarloOptions::default()
    })
}

/// Root mean squares of what values are off by over their stated errors, beside the plane and everywhere.
fn ratios(seeds: std::ops::Range<u64>, options: fn(u64) -> MethodOptions) -> [f64; 2] {
    let (mut near, mut all) = (Vec::new(), Vec::new());
    for seed in seeds {
        Friction::random(&mut Dice::new(77_000 + seed)).squares(
            &options(seed),
            &mut near,
            &mut all,
        );
    }
    let ratios = [root_mean(&near), root_mean(&all)];
    println!("{ratios:.2?}, {} and {} cells", near.len(), all.len());
    ratios
}

/// A step of one of these lengths takes values beside the plane by up to nine times the error of sampling away.
#[test]
fn errors_by_sgcm_hold_beside_friction() {
    let [near, all] = ratios(0..16, sgcm);
    assert!((0.3..1.2).contains(&near) && (0.5..1.1).contains(&all));
}

#[test]
fn errors_by_trajectories_hold_beside_friction() {
    let [near, all] = ratios(0..3, monte_carlo);
    assert!((0.3..1.2).contains(&near) && (0.5..1.1).contains(&all));
}
