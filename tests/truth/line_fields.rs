//! Fields of passages on one axis beside an end at which noise dies, where cells alone are off by more than they say.

use statrs::distribution::{Continuous as _, ContinuousCDF as _, Gamma};

use crate::common::sweeps::solved;

/// Growth with a rate that fluctuates: the density is that of a gamma distribution of the shape a/D and the scale D.
const GROWTH: &str = r#"
[system.equations]
x = "a x - x^2"
[system.noise]
interpretation = "stratonovich"
x = "sqrt(2 D) x"
[system.parameters]
D = 0.3
[sweep]
parameter = "a"
from = 0.4
to = 1.2
points = 2
[cells]
x = { count = 45 }
[passage.rise]
from = "x < 0.5"
to = "x > 1.3"
fields = ["committor", "mean-time", "reactive-density", "reactive-current"]
"#;

/// ∫ f dx by Gauss's rule of two points in ln x, whose error here is 1e-12 of it.
fn integral(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let count = 4000;
    let width = (to / from).ln() / f64::from(count);
    let half = 0.5 * width / 3.0_f64.sqrt();
    let middles = (0..count).map(|k| from.ln() + (f64::from(k) + 0.5) * width);
    let ends = middles.flat_map(|middle| [middle - half, middle + half].map(f64::exp));
    ends.map(|x| 0.5 * width * x * f(x)).sum()
}

#[test]
fn fields_beside_an_end_at_which_noise_dies_are_those_of_quadrature() {
    let (low, high) = (0.5, 1.3);
    for (a, d, cells) in [
        (0.4, 0.3, 45),
        (1.2, 0.3, 45),
        (0.7, 0.45, 80),
        (1.1, 0.12, 30),
    ] {
        let words = format!("system.parameters.D={d} cells.x.count={cells}");
        let (sweep, solution) = solved(GROWTH, &words, Some(a));
        let density = Gamma::new(a / d, 1.0 / d).unwrap();
        // Resistance, over a unit of length, to the flow of probability.
        let resistance = |x: f64| 1.0 / (d * x * x * density.pdf(x));
        let whole = integral(resistance, low, high);
        let committor = |x: f64| integral(resistance, low, x.clamp(low, high)) / whole;
        let on_way = |x: f64, value: f64| if low < x && x < high { value } else { 0.0 };
        let exact = |name: &str, x: f64| match name {
            "rise_committor" => committor(x),
            "rise_mean_time" if x < high => integral(|y| resistance(y) * density.cdf(y), x, high),
            "rise_mean_time" => 0.0,
            "rise_reactive_density" => {
                let next = committor(x);
                on_way(x, density.pdf(x) * next * (1.0 - next))
            }
            "rise_reactive_current_x" => on_way(x, 1.0 / whole),
            other => panic!("{other}"),
        };
        let centres = sweep.problem.space().axes()[0].centres();
        assert_eq!(solution.report.fields.len(), 4);
        for field in &solution.report.fields {
            for ((&x, &value), &error) in centres.iter().zip(&field.values).zip(&field.errors) {
                let exact = exact(&field.name, x);
                let off = (value - exact).abs();
                assert!(
                    off <= error + 1e-10 * exact && error <= 1e-5 * exact,
                    "{} at {x}, a = {a}: {value} ± {error:.1e}, exactly {exact}",
                    field.name
                );
            }
        }
    }
}
