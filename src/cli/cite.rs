//! `pbif cite`: BibTeX entries of the program, and of a run's model and method.

use super::{CommandError, Outcome, print};
use crate::run::StoredRun;
use crate::sweep_file::Sweep;

/// Where methods are from, a BibTeX entry each.
const GENERATOR: &str = "\
@article{scharfetter1969,
  author = {Scharfetter, D. L. and Gummel, H. K.},
  title = {Large-signal analysis of a silicon {Read} diode oscillator},
  journal = {IEEE Transactions on Electron Devices},
  volume = {16},
  number = {1},
  pages = {64--77},
  year = {1969},
  note = {Exponentially fitted finite volumes, the second discretisation by which errors are stated}
}
";
const CELL_MAPPING: &str = "\
@book{hsu1987,
  author = {Hsu, C. S.},
  title = {Cell-to-Cell Mapping: A Method of Global Analysis for Nonlinear Systems},
  publisher = {Springer},
  address = {New York},
  year = {1987}
}
";
const TRAJECTORIES: &str = "\
@book{kloeden1992,
  author = {Kloeden, Peter E. and Platen, Eckhard},
  title = {Numerical Solution of Stochastic Differential Equations},
  publisher = {Springer},
  address = {Berlin},
  year = {1992}
}
";
const PERSISTENCE: &str = "\
@article{edelsbrunner2002,
  author = {Edelsbrunner, Herbert and Letscher, David and Zomorodian, Afra},
  title = {Topological persistence and simplification},
  journal = {Discrete \\& Computational Geometry},
  volume = {28},
  pages = {511--533},
  year = {2002},
  note = {How peaks and craters are told from noise}
}
";

/// Prints the entries; without a run, those of the program and of what every run uses.
///
/// # Errors
/// [`CommandError::Run`] and [`CommandError::Input`] when the run cannot be read.
pub(super) fn run(run: Option<&std::path::Path>) -> Result<Outcome, CommandError> {
    let Some(path) = run else {
        let version = env!("CARGO_PKG_VERSION");
        return print(&format!("{}\n{PERSISTENCE}", program(version, None, None)));
    };
    let stored = StoredRun::open(path)?;
    let spec = stored.sweep_file().validate()?.fixed()?;
    let year = stored.started().and_then(|date| date.get(..4));
    let entries = [
        program(stored.version(), stored.commit(), year),
        model(&spec),
        method(stored.sweep()["method"]["kind"].as_str()).to_owned(),
        PERSISTENCE.to_owned(),
    ];
    print(&entries.join("\n"))
}

/// The entry of the program in the version that was used.
fn program(version: &str, commit: Option<&str>, year: Option<&str>) -> String {
    let mut text = format!(
        "@software{{pbif,\n  author = {{{{The pbif authors}}}},\n  title = {{pbif: stochastic {{P}}-bifurcations of noisy, possibly non-smooth oscillators}},\n  \
         version = {{{version}}}"
    );
    if let Some(year) = year {
        text += &format!(",\n  year = {{{year}}}");
    }
    if let Some(commit) = commit {
        text += &format!(",\n  note = {{commit {commit}}}");
    }
    text + "\n}\n"
}

/// The entry of the model, with its equations.
fn model(spec: &Sweep) -> String {
    let model = spec.problem.family().model();
    let equations: Vec<String> = model.equations.iter().map(|one| escape(one)).collect();
    let source = match model.source.as_str() {
        "" => "equations of the sweep file".to_owned(),
        source => escape(source),
    };
    format!(
        "@misc{{model-{},\n  title = {{{}}},\n  howpublished = {{{}}},\n  note = {{{source}}}\n}}\n",
        model.name,
        escape(&model.title),
        equations.join("; ")
    )
}

/// Text that TeX prints as it is.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        match letter {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => escaped.extend(['\\', letter]),
            '\\' => escaped += "\\textbackslash{}",
            '^' => escaped += "\\^{}",
            '~' => escaped += "\\~{}",
            letter => escaped.push(letter),
        }
    }
    escaped
}

fn method(kind: Option<&str>) -> &'static str {
    match kind {
        Some("sgcm") => CELL_MAPPING,
        Some("monte-carlo") => TRAJECTORIES,
        _ => GENERATOR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_have_balanced_braces_and_their_version() {
        let entry = program("0.1.0", Some("abc"), Some("2026"));
        for text in [&entry, GENERATOR, CELL_MAPPING, TRAJECTORIES, PERSISTENCE] {
            let count = |brace: char| text.chars().filter(|c| *c == brace).count();
            assert_eq!(count('{'), count('}'), "{text}");
            assert!(text.starts_with('@') && text.ends_with("}\n"), "{text}");
        }
        assert!(
            entry.contains("version = {0.1.0},\n  year = {2026},\n  note = {commit abc}\n}"),
            "{entry}"
        );
        assert_eq!(escape("x^2 & 50 %"), "x\\^{}2 \\& 50 \\%");
    }
}
