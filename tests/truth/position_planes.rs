//! Oscillators whose force jumps or bends at a plane of the position, where no noise acts across: means and deviations
//! against Gibbs' density.

use crate::common::sweeps::solved;
use crate::random_systems::Dice;

/// x'' = F(x) - γ x' + √(2 γ T) ξ, with its potential and the cells on ±4 × ±4.5, or those that are chosen.
struct Oscillator {
    force: String,
    potential: Box<dyn Fn(f64) -> f64>,
    damping: f64,
    temperature: f64,
    cells: Option<usize>,
}

impl Oscillator {
    /// Two wells, the left one deeper, and dry friction's jump as a force of the position.
    fn two_wells(cells: usize) -> Self {
        Self {
            force: "1.256 x - x^3 - 0.431 sign(x - 0.481)".to_owned(),
            potential: Box::new(|x| {
                -0.628 * x * x + 0.25 * x.powi(4) + 0.431 * (x - 0.481_f64).abs()
            }),
            damping: 0.2,
            temperature: 0.386,
            cells: Some(cells),
        }
    }

    /// What jumps or bends, how much and where, is thrown.
    fn random(dice: &mut Dice, jumps: bool) -> Self {
        let (linear, tilt, at) = (
            dice.between(0.5, 1.5),
            dice.between(0.0, 0.4),
            dice.between(-0.3, 0.6),
        );
        let is_double = dice.one_of([0, 0, 1]) == 1;
        let size = match jumps {
            true => dice.between(0.3, 1.5),
            false => dice.between(1.0, 10.0),
        };
        let smooth = match is_double {
            true => format!("{tilt} + {linear} x - x^3"),
            false => format!("{tilt} - {linear} x"),
        };
        let sharp = match jumps {
            true => format!("{size} sign(x - ({at}))"),
            false => format!("{size} max(x - ({at}), 0)"),
        };
        let potential = move |x: f64| {
            let own = match is_double {
                true => -0.5 * linear * x * x + 0.25 * x.powi(4),
                false => 0.5 * linear * x * x,
            };
            let more = match jumps {
                true => (x - at).abs(),
                false => 0.5 * (x - at).max(0.0).powi(2),
            };
            own - tilt * x + size * more
        };
        let cells = [None, Some(60), Some(80), Some(100), Some(140)];
        Self {
            force: format!("{smooth} - {sharp}"),
            potential: Box::new(potential),
            damping: [0.2, 0.5, 1.0][dice.one_of([0, 1, 2])],
            temperature: dice.between(0.15, 0.5),
            cells: cells[dice.one_of([0, 1, 2, 3, 4])],
        }
    }

    /// What is off, and the error that is stated: of the mean and the deviation of x and the deviation of x'.
    /// What has no error, as where a density falls slowly in a range that is given, is left out.
    fn errors(&self) -> Vec<(&'static str, f64, f64)> {
        let (damping, temperature) = (self.damping, self.temperature);
        let cells = self.cells.map_or_else(String::new, |n| {
            format!(
                "[cells]\nx = {{ from = -4, to = 4, count = {n} }}\ny = {{ from = -4.5, to = 4.5, count = {n} }}\n"
            )
        });
        let text = format!(
            "[system.equations]\nx = \"y\"\ny = \"{} - {damping} y\"\n[system.noise]\n\
             y = \"sqrt(2 * {damping} * T)\"\n[sweep]\nparameter = \"T\"\nfrom = {temperature}\nto = {}\npoints = 2\n{cells}",
            self.force,
            temperature + 0.01
        );
        let (_, point) = solved(&text, "", Some(temperature));
        let (mean, deviation) = self.exact();
        [
            ("mean_x", mean),
            ("sd_x", deviation),
            ("sd_y", temperature.sqrt()),
        ]
        .into_iter()
        .filter_map(|(name, exact)| {
            let mut measures = point.report.measures.iter();
            let found = measures.find(|one| one.name == name).unwrap();
            Some((name, (found.value - exact).abs(), found.error?))
        })
        .collect()
    }

    /// Mean and deviation of x by the midpoint rule, whose error at kinks is 1e-8.
    fn exact(&self) -> (f64, f64) {
        let places = (0..80_000).map(|k| -10.0 + (f64::from(k) + 0.5) * 2.5e-4);
        let moments = places.fold([0.0; 3], |sums, x| {
            let weight = (-(self.potential)(x) / self.temperature).exp();
            [
                sums[0] + weight,
                sums[1] + weight * x,
                sums[2] + weight * x * x,
            ]
        });
        let mean = moments[1] / moments[0];
        (mean, (moments[2] / moments[0] - mean * mean).sqrt())
    }
}

#[test]
fn beside_a_jump_means_converge_faster_than_with_the_square_of_the_width() {
    let [coarse, fine] = [70, 140].map(|cells| Oscillator::two_wells(cells).errors());
    for ((name, coarse, _), (_, fine, error)) in coarse.into_iter().zip(fine) {
        // Order 2.5 at least; the fluxes that left out the jump of the slope made 4 of it for the mean.
        assert!(coarse > 5.6 * fine, "{name}: {coarse:e}, then {fine:e}");
        assert!(fine <= error, "{name}: off by {fine:e}, error {error:e}");
    }
}

/// What is off over what is stated, of systems that are thrown, half with a jump.
fn ratios(seed: u64, count: usize) -> Vec<f64> {
    let mut dice = Dice::new(seed);
    let mut all = Vec::new();
    for number in 0..count {
        let one = Oscillator::random(&mut dice, number % 2 == 0);
        for (name, off, error) in one.errors() {
            if off > error {
                println!(
                    "{number} {name} {:?} {}: {:.2}",
                    one.cells,
                    one.force,
                    off / error
                );
            }
            all.push(off / error);
        }
    }
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn stated_errors_beside_planes_of_the_position_hold() {
    let ratios = ratios(0x0705_1710, 6);
    assert!(ratios.iter().all(|ratio| *ratio <= 1.0), "{ratios:.2?}");
    assert!(ratios.iter().any(|ratio| *ratio > 0.2), "{ratios:.2?}");
}

#[test]
#[ignore = "a minute"]
fn stated_errors_beside_planes_of_the_position_at_length() {
    let seed = std::env::var("OTHER_SEEDS").map_or(0, |text| text.parse().unwrap());
    let ratios = ratios(0x0705_1710 + seed, 40);
    let above = ratios.iter().filter(|ratio| **ratio > 1.0).count();
    let squares = ratios.iter().map(|ratio| ratio * ratio).sum::<f64>();
    println!(
        "{} numbers, median {:.2}, root mean square {:.2}, {above} above 1, largest {:.2}",
        ratios.len(),
        ratios[ratios.len() / 2],
        (squares / ratios.len() as f64).sqrt(),
        ratios[ratios.len() - 1]
    );
    // By what schemes differ alone, twice that at jumps, it was one in ten.
    assert!(above * 25 < ratios.len() && ratios[ratios.len() - 1] < 3.0);
}
