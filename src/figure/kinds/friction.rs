//! A friction law as a test bench shows it: force against velocity, and the hysteresis loops of a body that is pulled
//! to and fro.

use super::Sketch;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::page::{Heading, Page, Rectangle, Shape};
use crate::figure::canvas::style::{INK, MARGIN, Stroke};
use crate::figure::canvas::symbols;
use crate::figure::parts::caption::{number, version};
use crate::figure::print::{Figure, Print};
use crate::numerics::ends_of;
use crate::system::friction::pulled::{
    MOST_CYCLES, Pulled, closes, cycle, has_friction, steady_sliding, yielding_distance,
};
use crate::system::{DISPLACEMENT, Model, ParameterValues, System, VELOCITY};

/// Size of a panel on a page of its own width, in pixels, and that width.
const PANEL: (f64, f64) = (270.0, 230.0);
const USUAL: f64 = 640.0;
/// Room between the panels and right of them.
const BESIDE: f64 = 16.0;
/// Amplitudes of the loops, in distances over which the contact yields.
const AMPLITUDES: [f64; 3] = [0.5, 1.5, 4.0];
/// Largest velocity, in velocities on which a law depends.
const FASTEST: [(&str, f64); 2] = [("v_s", 3.0), ("v_m", 1.8)];
/// Velocities of steady sliding on either side of a jump.
const VELOCITIES: usize = 120;
/// Share of a range that is left free at both ends.
const FREE: f64 = 0.06;
/// Parameters of the oscillator around the law, on which nothing here depends.
const OUTSIDE: [&str; 4] = ["alpha", "kappa", "mu", "sigma2"];

/// The figure of a model with a friction law that exerts a force.
pub(in crate::figure) fn sketches<'a>(
    model: &'a Model,
    values: &'a ParameterValues,
) -> Vec<Sketch<'a>> {
    if !has_friction(model.system(values).as_ref()) {
        return Vec::new();
    }
    let draw = move |print: &Print<'_>| {
        let bench = Bench::new(model, values, model.system(values).as_ref());
        let page = bench.draw(print);
        Some(Figure::new(&page, bench.caption(), bench.data()))
    };
    vec![Sketch::new(format!("friction_{}", model.name), draw)]
}

/// What is drawn of one law.
struct Bench<'a> {
    model: &'a Model,
    values: &'a ParameterValues,
    /// Steady sliding, by ascending velocity; a jump has two points.
    sliding: Vec<(f64, f64)>,
    /// Amplitude and cycle, ascending.
    loops: Vec<(f64, Vec<Pulled>)>,
    fastest: f64,
}

impl<'a> Bench<'a> {
    fn new(model: &'a Model, values: &'a ParameterValues, system: &dyn System) -> Self {
        let named = model.parameters.iter().zip(values.as_slice());
        let base = |name: &str| named.clone().find(|(one, _)| one.name == name);
        let own = FASTEST
            .iter()
            .find_map(|&(name, times)| Some(times * base(name)?.1));
        let belt = base("v_b").map_or(0.0, |(_, velocity)| velocity.abs());
        let fastest = belt + own.unwrap_or(1.0);
        let distance = yielding_distance(system).unwrap_or(1.0);
        let pulled = |share: f64| (share * distance, cycle(system, share * distance, fastest));
        Self {
            model,
            values,
            sliding: sliding(system, fastest),
            loops: AMPLITUDES.map(pulled).into(),
            fastest,
        }
    }

    /// The parameters of the law with their values.
    fn parameters(&self) -> String {
        let named = self.model.parameters.iter().zip(self.values.as_slice());
        let own = named.filter(|(one, _)| !OUTSIDE.contains(&one.name.as_str()));
        let words: Vec<String> = own
            .map(|(one, value)| format!("{} = {}", one.name, number(*value)))
            .collect();
        words.join(", ")
    }

    fn draw(&self, print: &Print<'_>) -> Page {
        let look = &print.look;
        let cycles = || self.loops.iter().flat_map(|(_, cycle)| cycle);
        let forces = cycles().map(|one| one.force);
        let forces = range(forces.chain(self.sliding.iter().map(|one| one.1)));
        let velocities = range([-self.fastest, self.fastest].into_iter());
        let places = range(cycles().map(|one| one.displacement));
        let high = look.height(PANEL.1, USUAL);
        let up = Scale::vertical(look, forces, high, "friction force $F$");
        let left = MARGIN + up.left();
        let wide = 0.5 * look.fill(2.0 * PANEL.0, left + 2.0 * BESIDE + MARGIN);
        let width = left + 2.0 * (wide + BESIDE) + MARGIN;
        let across = |range, axis: usize| {
            let axis = self.model.axes.get(axis);
            let (words, symbol) = axis.map_or(("", ""), |axis| (&axis.meaning, &axis.symbol));
            let title = format!("{} {}", symbols::plain(words), symbols::variable(symbol));
            Scale::horizontal(look, range, wide, &title)
        };
        let scales = [across(velocities, VELOCITY), across(places, DISPLACEMENT)];
        let heading = Heading::new(look, print.title, width);
        let legend = Legend::new(look, self.entries(), width - 2.0 * MARGIN);
        let top = heading.height() + legend.height() + 6.0;
        let page = Page::new(look, width, top + high + Scale::below() + MARGIN);
        heading.draw(&page);
        legend.draw(&page, 0.5 * width, heading.height());
        for (number, (scale, range)) in scales.iter().zip([velocities, places]).enumerate() {
            let rect = Rectangle::new((left + number as f64 * (wide + BESIDE), top), (wide, high));
            let panel = page.panel(rect, range, forces);
            for (number, (_, cycle)) in self.loops.iter().enumerate() {
                let place = |one: &Pulled| {
                    let across = if range == velocities {
                        one.velocity
                    } else {
                        one.displacement
                    };
                    (across, one.force)
                };
                let points: Vec<(f64, f64)> = cycle.iter().map(place).collect();
                panel.draw(&points, Shape::Line(Stroke::curve(number)));
            }
            if number == 0 {
                panel.draw(&self.sliding, Shape::Line(STEADY));
            }
            frame::border(&page, rect);
            scale.draw_below(&page, rect, true);
            up.draw_left(&page, rect, number == 0);
        }
        page
    }

    fn entries(&self) -> Vec<(Swatch, String)> {
        let steady = (!self.sliding.is_empty())
            .then(|| (Swatch::Curve(STEADY), "sliding steadily".to_owned()));
        let symbol = self.model.axes.get(DISPLACEMENT);
        let symbol = symbol.map_or_else(String::new, |axis| symbols::variable(&axis.symbol));
        let loops = self.loops.iter().enumerate().map(|(number, (size, _))| {
            let words = format!("{symbol} within ±{}", symbols::value(*size));
            (Swatch::Curve(Stroke::curve(number)), words)
        });
        steady.into_iter().chain(loops).collect()
    }

    fn caption(&self) -> String {
        let sizes: Vec<String> = self.loops.iter().map(|one| number(one.0)).collect();
        let open = self.loops.iter().filter(|one| !closes(&one.1));
        let open: Vec<String> = open.map(|one| number(one.0)).collect();
        let settled = match open.as_slice() {
            [] => "after the state has come back to itself".to_owned(),
            open => format!(
                "the last of {MOST_CYCLES} cycles, after which the state has not come back to itself for a = {}",
                open.join(", ")
            ),
        };
        let steady = if self.sliding.is_empty() {
            "There is no line of steady sliding, because the internal state does not settle."
        } else {
            "Black: force of a body that slides at a velocity for long."
        };
        format!(
            "{}, {}. Left: friction force against velocity; right: against displacement, with loops whose area is the work of friction in a cycle. \
             {steady} Colours: pulled to and fro, x = a sin(ωt) with a = {} and a largest velocity of {}, {settled}. \
             The viscous part κ y is left out. {}\n",
            self.model.title,
            self.parameters(),
            sizes.join(", "),
            number(self.fastest),
            version(),
        )
    }

    fn data(&self) -> String {
        let mut text = "curve,amplitude,displacement,velocity,force\n".to_owned();
        for (velocity, force) in &self.sliding {
            text += &format!("steady,,,{velocity},{force}\n");
        }
        for (size, cycle) in &self.loops {
            for one in cycle {
                let (x, y, force) = (one.displacement, one.velocity, one.force);
                text += &format!("loop,{size},{x},{y},{force}\n");
            }
        }
        text
    }
}

/// The line of steady sliding.
const STEADY: Stroke = Stroke::solid(INK, 2.2);

/// The force of steady sliding between two velocities; empty where it is not known at every one.
fn sliding(system: &dyn System, fastest: f64) -> Vec<(f64, f64)> {
    let surfaces = system.facts().surfaces_on(VELOCITY);
    let mut ends: Vec<f64> = surfaces.filter(|at| at.abs() < fastest).collect();
    ends.push(-fastest);
    ends.push(fastest);
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let mut points = Vec::new();
    for two in ends.windows(2) {
        let (low, high) = (two[0], two[1]);
        // Near a jump, not on it.
        let inside = |share: f64| low + (high - low) * share.clamp(1e-6, 1.0 - 1e-6);
        for place in 0..=VELOCITIES {
            let velocity = inside(place as f64 / VELOCITIES as f64);
            match steady_sliding(system, velocity) {
                Some(force) => points.push((velocity, force)),
                None => return Vec::new(),
            }
        }
    }
    points
}

/// The range of some values with room at its ends.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = ends_of(values);
    let free = if high > low { FREE * (high - low) } else { 1.0 };
    (low - free, high + free)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figures;
    use crate::system::friction::pulled::shown_values;
    use crate::system::registry;

    fn figure(name: &str) -> Option<Figure> {
        let model = registry::find(name).unwrap();
        let values = shown_values(&model, &[]).unwrap();
        let figures = Figures::of_friction(&model, &values, &model.title);
        figures.draw_all().pop()
    }

    #[test]
    fn every_law_is_drawn_and_no_other_model() {
        for model in registry::models() {
            let drawn = figure(&model.name);
            if matches!(model.name.as_str(), "bistable" | "rayleigh") {
                assert_eq!(drawn, None);
                continue;
            }
            let figure = drawn.unwrap();
            assert_eq!(figure.name, format!("friction_{}", model.name));
            let loops = figure.data.lines().filter(|line| line.starts_with("loop,"));
            assert_eq!(loops.count(), 3 * 401, "{}", model.name);
            assert!(!figure.data.contains("NaN") && figure.caption.contains(&model.title));
            assert!(!figure.caption.contains("has not come back to itself"));
            // The misprinted law does not settle.
            let steady = figure.data.contains("steady,");
            assert_eq!(steady, model.name != "dahl_eq8", "{}", model.name);
            assert_eq!(figure.svg().contains("sliding steadily"), steady);
        }
    }

    /// A line for each loop in each panel, and one of steady sliding.
    #[test]
    fn the_loops_are_in_both_panels() {
        let figure = figure("lugre").unwrap();
        let long = |line: &&str| line.contains("<poly") && line.matches(' ').count() > 100;
        let svg = figure.svg().replace("<poly", "\n<poly");
        assert_eq!(svg.lines().filter(long).count(), 7);
        for words in ["velocity", "displacement", "friction force"] {
            assert!(figure.svg().contains(words), "{words}");
        }
        assert!(figure.caption.contains("f_s = 1.5"), "{}", figure.caption);
    }

    /// Between rest and the Stribeck velocity the level of LuGre falls, and the loops lie about it.
    #[test]
    fn steady_sliding_is_the_level() {
        let data = figure("lugre").unwrap().data;
        let steady = data
            .lines()
            .filter_map(|line| line.strip_prefix("steady,,,"));
        for line in steady {
            let (velocity, force) = line.split_once(',').unwrap();
            let (velocity, force): (f64, f64) = (velocity.parse().unwrap(), force.parse().unwrap());
            let level = 1.0 + 0.5 * (-(velocity / 0.5).powi(2)).exp();
            assert!((force - level.copysign(velocity)).abs() < 1e-5, "{line}");
        }
    }
}
