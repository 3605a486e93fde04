//! What captions say of what is drawn, and that only what is known is drawn.

use pbif::continuation::Label;
use pbif::figure::{Figure, Figures};

use crate::common::closed_forms::bistable;
use crate::common::sweeps::swept;

/// A figure of a sweep file's sweep.
fn figure(text: &str, name: &str, at: &[f64]) -> Figure {
    let (sweep, result) = swept(text, "");
    let figures = Figures::of_sweep(&result, &sweep.settings.title, at)
        .carried_by(sweep.problem.family(), sweep.problem.space().axes());
    figures.draw(name).unwrap().remove(0)
}

#[test]
fn sections_name_the_lines_that_all_values_share() {
    // The summit is at x = a: only at the first value do the lines go through it.
    let text = "\
[system]
equations = { x = 'a - x', y = '-y' }
noise = { x = '1', y = '1' }
[sweep]
parameter = 'a'
from = 0.5
to = 1.0
points = 2
[cells]
x = { from = -4, to = 5, count = 36 }
y = { from = -4, to = 4, count = 32 }
[detect]
joint = [['x', 'y']]
";
    let both = figure(text, "section_xy", &[0.5, 1.0]).caption;
    let (_, lines) = both.split_once(", on the lines y = ").unwrap();
    assert!(lines.contains(" at a = 0.5. System"), "{both}");
    let one = figure(text, "conditional_xy", &[1.0]).caption;
    assert!(one.contains(" through its "), "{one}");
    assert!(one.contains(", each with an integral of one."), "{one}");
}

#[test]
fn a_spectrogram_marks_its_own_changes_alone() {
    // The spectrum of x has a maximum above zero where g² < 2, that of v everywhere.
    let text = "\
[system]
equations = { x = 'v', v = '-x - g v' }
noise = { v = 'sqrt(2 g)' }
[sweep]
parameter = 'g'
from = 1.2
to = 1.6
points = 3
[cells]
x = { from = -5, to = 5, count = 40 }
v = { from = -5, to = 5, count = 40 }
[spectrum]
of = ['x', 'v']
to = 3.0
";
    let (_, result) = swept(text, "");
    let figures = Figures::of_sweep(&result, "", &[]);
    let legend = "change of a spectrum";
    for (name, is_own) in [("spectrogram_x", true), ("spectrogram_v", false)] {
        let figure = figures.draw(name).unwrap().remove(0);
        let svg = figure.svg();
        assert!(svg.contains(">SB1<"), "{name}");
        assert_eq!(svg.contains(legend), is_own, "{name}");
        assert_eq!(figure.caption.contains("SB1"), is_own, "{name}");
    }
}

#[test]
fn the_band_of_a_change_is_its_stated_error() {
    let drawn = |change: fn(&mut f64, &mut f64, &mut f64)| {
        let mut result = bistable();
        for row in &mut result.labels {
            if let Label::Bifurcation(row) = row {
                change(&mut row.error, &mut row.lower, &mut row.upper);
            }
        }
        let figures = Figures::of_sweep(&result, "", &[]);
        ["diagram_x", "peaks_x"].map(|name| figures.draw(name).unwrap().remove(0).svg())
    };
    let usual = drawn(|_, _, _| {});
    let of_bracket = drawn(|_, lower, upper| (*lower, *upper) = (*lower - 0.2, *upper + 0.2));
    let of_error = drawn(|error, _, _| *error += 0.2);
    assert!(of_bracket == usual, "a bracket is no error");
    assert!(of_error[0] != usual[0] && of_error[1] != usual[1]);
}

#[test]
fn a_density_without_a_bound_has_no_height() {
    let text = "\
[system]
equations = { x = 'a x - x^2' }
noise = { x = 'sqrt(0.6) x', interpretation = 'stratonovich' }
[sweep]
parameter = 'a'
from = 0.2
to = 0.8
points = 7
[cells]
x = { from = 0, to = 6, count = 200 }
";
    // p ~ x^(a/0.3 - 1): the peak at the end has a height from a = 0.3 on.
    let peaks = figure(text, "peaks_x", &[]);
    let said = "A peak at an end where the density has no bound has no height.";
    assert!(peaks.caption.contains(said), "{}", peaks.caption);
    let mut rows = peaks.data.lines().skip(1);
    assert!(rows.all(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let value: f64 = cells[0].parse().unwrap();
        cells[3].is_empty() == (value < 0.2999)
    }));
    assert!(!peaks.svg().contains(">10<"), "no axis over decades");
}

#[test]
fn captions_tell_the_harmonics_of_a_forcing() {
    let text = "\
[system]
equations = { x = '-x + A cos(w t)' }
noise = { x = '1' }
parameters = { w = 1.0 }
[sweep]
parameter = 'A'
from = 0.1
to = 0.2
points = 2
[cells]
x = { from = -4, to = 4, count = 40 }
t = { modes = 7 }
";
    let caption = figure(text, "marginals", &[0.1]).caption;
    let said = "Carried by modes: the phase of the forcing by 7 harmonics. Computed with pbif";
    assert!(caption.contains(said), "{caption}");
}
