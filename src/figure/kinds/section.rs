//! Sections of a joint density through its centre of symmetry, or its summit where it has none: as they are
//! (`section_xy`), and with an integral of one, which makes them conditional densities (`conditional_xy`).

use std::borrow::Cow;

use crate::density::{Density, EstimatedDensity, Kink, Structure, Variants};
use crate::space::Axis;
use crate::topology::Between;

use super::joint::figure;
use super::marginals::{Overlaid, draw_overlaid, values_of};
use super::{Drawn, Kind, Sketch, Sweep};
use crate::figure::canvas::page::Page;
use crate::figure::canvas::symbols;
use crate::figure::parts::joint_map::Joint;
use crate::figure::parts::{caption, view};
use crate::figure::print::Print;

pub(super) const KIND: Kind = Kind {
    names: &["section", "conditional"],
    usual: None,
    sketches,
};

/// Two figures an observed pair of axes: the density on a line, and the same with an integral of one, which is the
/// density of one axis where the other has a value.
fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let pairs = sweep.pairs().flat_map(|(number, pair)| {
        let kinds = [("section", false), ("conditional", true)];
        kinds.map(|(name, is_conditional)| {
            let (result, points) = (sweep.result, sweep.chosen.clone());
            Sketch::new(format!("{name}_{pair}"), move |print| {
                draw(&Joint::new(result, number, &points)?, is_conditional, print)
            })
        })
    });
    pairs.collect()
}

/// The figure; `None` without a density.
fn draw(joint: &Joint<'_>, is_conditional: bool, print: &Print<'_>) -> Drawn {
    let points = joint.points.iter().enumerate();
    let found: Vec<(usize, &EstimatedDensity)> = points
        .filter_map(|(place, point)| Some((place, view::density(point, joint.number)?)))
        .collect();
    let centre = found.first().and_then(|(_, estimated)| centre(estimated))?;
    let page = draw_lines(joint, (&found, centre), is_conditional, print)?;
    let mut way = lines_in_words(joint, &found, centre);
    if is_conditional {
        way += ", each with an integral of one";
    }
    Some(figure((joint, &print.look), &way, &page))
}

/// Which lines the sections of all values lie on, for captions.
fn lines_in_words(
    joint: &Joint<'_>,
    found: &[(usize, &EstimatedDensity)],
    [x, y]: [f64; 2],
) -> String {
    let [first, second, _] = joint.titles.each_ref().map(|one| caption::in_letters(one));
    let [x, y] = [x, y].map(caption::number);
    let is_symmetric = |(_, estimated): &(usize, &EstimatedDensity)| {
        estimated.structure.centre == found[0].1.structure.centre
    };
    let (place, estimated) = found[0];
    let centre = match estimated.structure.centre {
        Some(_) => "centre of symmetry",
        None => "summit",
    };
    let through = match (&estimated.structure.centre, found) {
        (_, [_]) => format!("its {centre}"),
        (Some(_), _) if found.iter().all(is_symmetric) => format!("its {centre}"),
        _ => {
            let value = std::iter::once(joint.points[place].value);
            format!(
                "the {centre}{}",
                caption::at(&joint.result.subject.family, value)
            )
        }
    };
    format!("on the lines {second} = {y} and {first} = {x} through {through}")
}

fn draw_lines(
    joint: &Joint<'_>,
    (found, centre): (&[(usize, &EstimatedDensity)], [f64; 2]),
    is_conditional: bool,
    print: &Print<'_>,
) -> Option<Page> {
    let [first, second, _] = &joint.titles;
    let mut panels = Vec::new();
    for (along, own, other) in [(0, first, second), (1, second, first)] {
        let at = centre[1 - along];
        let sections = found.iter().filter_map(|(place, estimated)| {
            let section = section(estimated, along, at, is_conditional)?;
            Some((*place, Cow::Owned(section)))
        });
        let value = symbols::value(at);
        let title = match (is_conditional, along) {
            (true, _) => format!("$p$({own} | {other} = {value})"),
            (false, 0) => symbols::density_of(&[own.clone(), value]),
            (false, _) => symbols::density_of(&[value, own.clone()]),
        };
        panels.extend(Overlaid::new(print, own, sections.collect(), &title));
    }
    draw_overlaid(
        &values_of(&joint.result.subject.family, joint.points),
        (0, &panels),
        print,
    )
}

/// The centre of symmetry of a joint density, else its summit: in the cell of the largest value, at a place of no more
/// digits than the width of the cell has.
fn centre(estimated: &EstimatedDensity) -> Option<[f64; 2]> {
    if let Some([x, y]) = estimated.structure.centre.as_deref() {
        return Some([*x, *y]);
    }
    let [across, along] = &estimated.density.axes[..] else {
        return None;
    };
    let values = estimated.density.values.iter().enumerate();
    let (cell, _) = values.max_by(|a, b| a.1.total_cmp(b.1))?;
    let (x, y) = (cell / along.count(), cell % along.count());
    let place = |axis: &Axis, cell: usize| {
        let middle = axis.centres().get(cell).copied()?;
        let decimals = (-axis.width(cell).log10().floor()) as i32;
        let step = 10_f64.powi(decimals);
        Some((middle * step).round() / step)
    };
    Some([place(across, x)?, place(along, y)?])
}

/// The kinks that a section along an axis crosses.
fn kinks_along(estimated: &EstimatedDensity, along: usize) -> Vec<Kink> {
    let kinks = estimated.structure.kinks.iter();
    let crossed = kinks.filter(|kink| kink.axis == along);
    crossed
        .map(|kink| Kink {
            axis: 0,
            ..kink.clone()
        })
        .collect()
}

/// The two cells whose middles lie beside a place on an axis, and the weight of the second one.
fn beside(axis: &Axis, at: f64) -> (usize, usize, f64) {
    let centres = axis.centres();
    let above = centres.partition_point(|&centre| centre < at);
    match (above.checked_sub(1), centres.get(above)) {
        (Some(below), Some(&upper)) => (
            below,
            above,
            (at - centres[below]) / (upper - centres[below]),
        ),
        (None, _) => (0, 0, 0.0),
        (Some(below), None) => (below, below, 0.0),
    }
}

/// The density along axis `along` where the other axis has the value `at`, as averages over the cells of its own:
/// followed between the cells of the other, with sampling noise linear between their middles.
fn section(
    estimated: &EstimatedDensity,
    along: usize,
    at: f64,
    is_conditional: bool,
) -> Option<EstimatedDensity> {
    let [first, second] = &estimated.density.axes[..] else {
        return None;
    };
    let (own, other) = if along == 0 {
        (first, second)
    } else {
        (second, first)
    };
    let (below, above, weight) = beside(other, at);
    let cell = |own: usize, other: usize| match along {
        0 => own * second.count() + other,
        _ => other * second.count() + own,
    };
    let of = |values: &[f64]| -> Vec<f64> {
        let value =
            |i: usize| (1.0 - weight) * values[cell(i, below)] + weight * values[cell(i, above)];
        (0..own.count()).map(value).collect()
    };
    let between = Between::new(estimated);
    let mut values = match &between {
        Some(between) => between.section(along, at),
        None => of(&estimated.density.values),
    };
    let mut errors = if estimated.standard_error.len() == estimated.density.values.len() {
        of(&estimated.standard_error)
    } else {
        Vec::new()
    };
    if is_conditional {
        let mass: f64 = values
            .iter()
            .enumerate()
            .map(|(i, value)| value * own.width(i))
            .sum();
        if !(mass > 0.0 && mass.is_finite()) {
            return None;
        }
        values
            .iter_mut()
            .chain(&mut errors)
            .for_each(|value| *value /= mass);
    }
    Some(EstimatedDensity {
        observable: estimated.observable,
        standard_error: errors,
        // What is without sampling noise stays so, whatever its error.
        variants: if between.is_some() {
            Variants::Scheme(values.clone())
        } else {
            Variants::None
        },
        density: Density {
            axes: vec![own.clone()],
            values,
        },
        structure: Structure {
            kinks: between.map_or_else(Vec::new, |_| kinks_along(estimated, along)),
            ..Structure::default()
        },
        negligible: 0.0,
        truncation: Default::default(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::Observable;

    /// A Gaussian in both axes with standard deviations 1 and 0.5, exact in the middles of cells.
    fn gaussian(correlation: f64) -> EstimatedDensity {
        let (x, y) = (
            Axis::uniform(-6.0, 6.0, 240).unwrap(),
            Axis::uniform(-3.0, 3.0, 240).unwrap(),
        );
        let value = |x: f64, y: f64| {
            let (u, v) = (x, y / 0.5);
            let scale = 1.0 - correlation * correlation;
            let exponent = (u * u - 2.0 * correlation * u * v + v * v) / (2.0 * scale);
            (-exponent).exp() / (std::f64::consts::PI * scale.sqrt())
        };
        let (xs, ys) = (x.centres(), y.centres());
        let values = xs
            .iter()
            .flat_map(|&x| ys.iter().map(move |&y| value(x, y)))
            .collect();
        EstimatedDensity {
            observable: Observable::Joint(0, 1),
            standard_error: Vec::new(),
            density: Density {
                axes: vec![x, y],
                values,
            },
            variants: Variants::None,
            structure: Structure::default(),
            negligible: 0.0,
            truncation: Default::default(),
        }
    }

    #[test]
    fn conditional_densities_are_those_of_a_gaussian() {
        // x given y = 0.5 is normal with mean ρ and variance 1 - ρ²: linear between middles 0.025 apart, so 1e-3 at
        // most.
        let (rho, at) = (0.6, 0.5);
        let conditional = section(&gaussian(rho), 0, at, true).unwrap().density;
        let variance = 1.0 - rho * rho;
        let centres = conditional.axes[0].centres();
        for (x, value) in centres.iter().zip(&conditional.values) {
            let exact = (-(x - rho * at / 0.5).powi(2) / (2.0 * variance)).exp()
                / (2.0 * std::f64::consts::PI * variance).sqrt();
            assert!((value - exact).abs() < 1e-3, "{x}: {value} {exact}");
        }
        let mass: f64 = conditional.values.iter().map(|value| value * 0.05).sum();
        assert!((mass - 1.0).abs() < 1e-12);
    }

    #[test]
    fn sections_lie_where_they_should() {
        let joint = gaussian(0.0);
        let section = section(&joint, 1, 0.0, false).unwrap().density;
        let (at_zero, far) = (section.values[120], section.values[160]);
        let exact = |y: f64| (-2.0 * y * y).exp() / std::f64::consts::PI;
        // At x = 0, between two cells: both have exp(-0.025²/2) of what is there.
        assert!((at_zero - exact(0.0125)).abs() < 2e-4 && (far - exact(1.0125)).abs() < 2e-4);
        // Cells of 0.05 and 0.025 tell hundredths of the summit: it is in one of those beside ± 0.025 and ± 0.0125.
        let [x, y] = centre(&joint).unwrap();
        assert!(
            [0.02, 0.03].contains(&x.abs()) && y.abs() == 0.01,
            "{x} {y}"
        );
        assert_eq!(beside(&joint.density.axes[0], 9.0), (239, 239, 0.0));
        assert_eq!(beside(&joint.density.axes[0], -9.0), (0, 0, 0.0));
    }
}
