//! The resolved sweep file: every key with its value, defaults filled in. Read again it gives the same sweep.

use std::fmt::Write as _;

use crate::density::Observable;
use crate::method::{GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions};
use crate::sweep_file::keys::{SWITCH, number, quoted, step};

use super::{AxisCells, SweepSpec};

impl SweepSpec {
    /// The sweep as a complete sweep file.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_toml(&mut text);
        text
    }

    fn write_toml(&self, text: &mut String) -> std::fmt::Result {
        let family = self.problem.family();
        let (from, to) = family.ends();
        writeln!(text, "title = {}\n", quoted(&self.title))?;
        writeln!(text, "[system]\nmodel = {}\n", quoted(&family.model().name))?;
        writeln!(text, "[system.parameters]")?;
        for (name, value) in family.fixed() {
            writeln!(text, "{name} = {}", number(value))?;
        }
        writeln!(
            text,
            "\n[sweep]\nparameter = {}",
            quoted(family.parameter())
        )?;
        writeln!(text, "from = {}\nto = {}", number(from), number(to))?;
        writeln!(text, "points = {}\n\n[cells]", self.points)?;
        for (axis, cells) in family.model().axes.iter().zip(&self.cells) {
            writeln!(text, "{} = {}", axis.name, axis_toml(cells))?;
        }
        self.write_choices(text)
    }

    /// The tables whose keys all have defaults.
    fn write_choices(&self, text: &mut String) -> std::fmt::Result {
        writeln!(text, "\n[method]\nkind = {}", quoted(self.method.kind()))?;
        match &self.method {
            MethodOptions::Generator(method) => write_generator(text, method)?,
            MethodOptions::Sgcm(method) => write_sgcm(text, method)?,
            MethodOptions::MonteCarlo(method) => write_monte_carlo(text, method)?,
        }
        let (marginals, joint) = self.observables_toml();
        writeln!(
            text,
            "\n[detect]\nmarginals = [{marginals}]\njoint = [{joint}]"
        )?;
        writeln!(text, "confidence = {}", number(self.detect.confidence))?;
        writeln!(text, "floor = {}", number(self.detect.floor))?;
        writeln!(
            text,
            "\n[locate]\ntolerance = {}",
            number(self.locate.tolerance)
        )?;
        let distance = number(self.locate.largest_distance);
        writeln!(text, "largest_distance = {distance}")?;
        let check = quoted(SWITCH[usize::from(!self.locate.grid_check)]);
        writeln!(text, "grid_check = {check}")?;
        let formats = self
            .figure_formats
            .iter()
            .map(|format| quoted(format.name()));
        writeln!(text, "\n[figures]\nat = [{}]", numbers(&self.figures_at))?;
        writeln!(text, "formats = [{}]", joined(formats))
    }

    fn observables_toml(&self) -> (String, String) {
        let name = |axis: usize| quoted(self.problem.family().axis(axis));
        let marginals =
            self.problem
                .observables()
                .iter()
                .filter_map(|observable| match *observable {
                    Observable::Marginal(axis) => Some(name(axis)),
                    Observable::Joint(..) => None,
                });
        let joint = self
            .problem
            .observables()
            .iter()
            .filter_map(|observable| match *observable {
                Observable::Marginal(_) => None,
                Observable::Joint(one, other) => Some(format!("[{}, {}]", name(one), name(other))),
            });
        (joined(marginals), joined(joint))
    }
}

fn write_generator(text: &mut String, method: &GeneratorMethodOptions) -> std::fmt::Result {
    writeln!(text, "scheme = {}", quoted(method.scheme.name()))?;
    writeln!(text, "memory_limit = {}", number(method.memory_limit))?;
    write_shared(text, method.solver_tolerance, method.escape_limit)
}

fn write_sgcm(text: &mut String, method: &SgcmOptions) -> std::fmt::Result {
    writeln!(text, "map_step = {}", step(method.map_step))?;
    writeln!(text, "time_step = {}", step(method.time_step))?;
    writeln!(text, "samples = {}\nseed = {}", method.samples, method.seed)?;
    writeln!(text, "integrator = {}", quoted(method.integrator.name()))?;
    writeln!(text, "replicates = {}", method.replicates)?;
    writeln!(text, "correction = {}", quoted(method.correction.name()))?;
    writeln!(text, "solver = {}", quoted(method.solver.name()))?;
    write_shared(text, method.solver_tolerance, method.escape_limit)
}

fn write_monte_carlo(text: &mut String, method: &MonteCarloOptions) -> std::fmt::Result {
    writeln!(text, "estimator = {}", quoted(method.estimator.name()))?;
    writeln!(text, "time_step = {}", step(method.time_step))?;
    writeln!(text, "burn_in = {}", step(method.burn_in))?;
    writeln!(text, "length = {}", step(method.length))?;
    writeln!(text, "error = {}", number(method.error))?;
    writeln!(text, "trajectories = {}", step(method.trajectories))?;
    writeln!(text, "seed = {}", method.seed)?;
    writeln!(text, "integrator = {}", quoted(method.integrator.name()))?;
    writeln!(text, "escape_limit = {}", number(method.escape_limit))
}

fn write_shared(text: &mut String, tolerance: f64, escape_limit: f64) -> std::fmt::Result {
    writeln!(text, "solver_tolerance = {}", number(tolerance))?;
    writeln!(text, "escape_limit = {}", number(escape_limit))
}

fn axis_toml(cells: &AxisCells) -> String {
    let (from, to, count) = (number(cells.from), number(cells.to), cells.count);
    let grade = cells.grading.as_ref().map_or(String::new(), |grading| {
        let (at, smallest) = (numbers(&grading.at), number(grading.smallest));
        format!(", grade = {{ at = [{at}], smallest = {smallest} }}")
    });
    format!("{{ from = {from}, to = {to}, count = {count}{grade} }}")
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(", ")
}

fn numbers(values: &[f64]) -> String {
    joined(values.iter().map(|&value| number(value)))
}
