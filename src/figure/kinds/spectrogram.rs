//! Power spectra all along a sweep (`spectrogram_x`): colours over the parameter and the frequency, the frequency of
//! the highest maximum as a line, and the values at which the shape of the spectrum changes.

use super::diagram::{column_edges, hatch_column};
use super::spectrum::{
    FREQUENCY, SpectrumOf, frequencies, of_point, power_title, powers, spectra_of,
};
use super::{Drawn, Kind, Sketch, Sweep};
use crate::continuation::measure::SPECTRAL_PEAK;
use crate::continuation::{Label, LevelCrossing, SweepResult};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::heat::{self, Picture};
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::look::{DECADES, Look};
use crate::figure::canvas::page::{Heading, Page, Rectangle, Shape};
use crate::figure::canvas::style::{MARGIN, PNG_SCALE};
use crate::figure::parts::along::parameter_range;
use crate::figure::parts::bifurcations::Labels;
use crate::figure::parts::meeting::meet_births;
use crate::figure::parts::view::middles;
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};

/// Size of the map on a page of its own width, in pixels, and that width.
const MAP: (f64, f64) = (380.0, 250.0);
const USUAL: f64 = 505.0;

/// A figure of each power spectrum that is asked for.
pub(super) const KIND: Kind = Kind {
    names: &["spectrogram"],
    usual: Some("spectrogram"),
    sketches: |sweep: &Sweep<'_>| {
        let result = sweep.result;
        let sketch = |one: SpectrumOf| {
            let file = format!("spectrogram_{}", one.file);
            Sketch::new(file, move |print| draw(result, &one, print))
        };
        spectra_of(sweep.family()).into_iter().map(sketch).collect()
    },
};

fn draw(result: &SweepResult, asked: &SpectrumOf, print: &Print<'_>) -> Drawn {
    let (family, points) = (&result.subject.family, &result.points);
    // Power is read over decades, whatever densities have.
    let look = &Look {
        is_logarithmic: true,
        ..print.look
    };
    let (is_logarithmic, places) = frequencies(family.questions.spectrum.as_ref()?);
    let columns: Vec<Option<Vec<f64>>> = points
        .iter()
        .map(|point| {
            let known = powers(of_point(point, asked)?);
            Some(known.into_iter().map(|(power, _)| power.abs()).collect())
        })
        .collect();
    let largest = columns
        .iter()
        .flatten()
        .flatten()
        .copied()
        .fold(0.0, f64::max);
    let (from, to) = (*places.first()?, *places.last()?);
    if !(largest > 0.0 && largest.is_finite() && columns.len() > 1) {
        return None;
    }
    let range = parameter_range(points);
    let high = look.height(MAP.1, USUAL);
    let layout = if is_logarithmic {
        Scale::logarithmic
    } else {
        Scale::vertical
    };
    let up = layout(look, (from, to), high, FREQUENCY);
    let bar = ColourBar::new(look, largest, high, &power_title(asked));
    let left = MARGIN + up.left();
    let wide = look.fill(MAP.0, left + bar.width() + MARGIN);
    let across = Scale::horizontal(look, range, wide, &names::parameter(family));
    let width = left + wide + bar.width() + MARGIN;
    let heading = Heading::new(look, print.title, width);
    let labels = Labels::of_spectrum(look, result, &asked.of, (range, (left, wide)));
    let above = labels.height().max(ColourBar::above());
    let map = Rectangle::new((left, heading.height() + above), (wide, high));
    let peaks = peaks(result, asked, is_logarithmic, (from, to));
    let mut entries = Vec::new();
    if !peaks.is_empty() {
        entries.push((Swatch::Peaks, "highest maximum".to_owned()));
    }
    entries.extend(labels.entries());
    let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
    let below = map.bottom() + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    let panel = page.panel(map, range, (from, to));
    let edges = column_edges(points, range);
    for (column, known) in columns.iter().enumerate() {
        if known.is_none() {
            hatch_column(&page, &panel, &edges[column..], (from, to));
        }
    }
    let size = [map.width, map.height].map(|length| (length * PNG_SCALE).round() as usize);
    let owners = heat::nearest(&edges, range, size[0]);
    let rows = middles((from, to), size[1]);
    let shares: Vec<(usize, f64)> = rows.iter().map(|&row| beside(&places, row)).collect();
    let picture = Picture::new(look, (size[0], size[1]), |column, row| {
        let known = columns[owners[column]].as_ref()?;
        let (below, share) = shares[row];
        let (a, b) = (known[below], *known.get(below + 1)?);
        Some((a + share * (b - a)) / largest)
    });
    panel.draw(&[(range.0, from), (range.1, to)], Shape::Image(picture));
    labels.draw_lines(look, &panel, (from, to));
    for run in &peaks {
        let run = across_column(run, &edges);
        panel.mark(&run, legend::peaks(&run));
    }
    frame::border(&page, map);
    labels.draw_texts(&page, map);
    across.draw_below(&page, map, true);
    up.draw_left(&page, map, true);
    bar.draw(&page, map, &[]);
    legend.draw(&page, map.left + 0.5 * map.width, below);
    let seen = format!(
        "Power spectrum of {} (colours, logarithmic over {DECADES} decades) over {}, with the frequency of its highest maximum above zero.",
        caption::in_letters(&asked.title),
        caption::parameter(family)
    );
    let marked = [spectral_rows(result, asked)];
    Some(Figure::new(
        &page,
        caption::of_sweep(result, seen, &marked),
        rows_of(result, asked),
    ))
}

/// A run of a single value as a line across its column; longer ones as they are.
fn across_column(run: &[(f64, f64)], edges: &[f64]) -> Vec<(f64, f64)> {
    let [(value, peak)] = *run else {
        return run.to_vec();
    };
    let column = edges
        .windows(2)
        .find(|ends| ends[0] <= value && value <= ends[1]);
    let edges = column.unwrap_or_default().iter();
    edges.map(|&edge| (edge, peak)).collect()
}

/// The place below a value among some, ascending, and how far the value is on the way to the next.
fn beside(places: &[f64], value: f64) -> (usize, f64) {
    let above = places.partition_point(|&place| place <= value);
    let below = above.saturating_sub(1).min(places.len().saturating_sub(2));
    let (a, b) = (places[below], places[below + 1]);
    (below, ((value - a) / (b - a)).clamp(0.0, 1.0))
}

/// Frequencies of the highest maximum along the sweep, in runs of neighbouring values that have one, led on to the
/// changes at which they begin and end.
fn peaks(
    result: &SweepResult,
    asked: &SpectrumOf,
    is_logarithmic: bool,
    (from, to): (f64, f64),
) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    for point in &result.points {
        let peak = point.report.of(&SPECTRAL_PEAK, &asked.of);
        let peak = peak.map(|peak| if is_logarithmic { peak.log10() } else { peak });
        match (
            peak.filter(|peak| (from..=to).contains(peak)),
            runs.last_mut(),
        ) {
            (Some(peak), Some(run)) => run.push((point.value, peak)),
            _ => runs.push(Vec::new()),
        }
    }
    runs.retain(|run| !run.is_empty());
    let changes = result.labels.iter().filter_map(Label::spectral_change);
    let own = changes.filter(|change| change.spectral().is_some_and(|(_, of)| of == asked.of));
    let changes: Vec<f64> = own.map(|change| change.value).collect();
    let values: Vec<f64> = result.points.iter().map(|point| point.value).collect();
    meet_births(&mut runs, &changes, &values);
    let in_window = |place: &mut (f64, f64)| place.1 = place.1.clamp(from, to);
    runs.iter_mut().flatten().for_each(in_window);
    runs
}

/// Values at which the shape of the spectrum changes, in words.
fn spectral_rows(result: &SweepResult, asked: &SpectrumOf) -> String {
    let family = &result.subject.family;
    let own = |crossing: &&LevelCrossing| crossing.spectral().is_some_and(|(_, of)| of == asked.of);
    let rows = result.labels.iter().filter_map(|row| {
        let crossing = row.spectral_change().filter(own)?;
        let (value, error) = (crossing.value, crossing.error);
        let value = caption::to_digits_of_error(value, error);
        let change = row.words(family)?.change;
        let parameter = caption::parameter(family);
        Some(format!(
            "{}: {change}, {parameter} = {value} ± {error:.1e}.",
            crossing.label
        ))
    });
    rows.collect::<Vec<_>>().join(" ")
}

fn rows_of(result: &SweepResult, asked: &SpectrumOf) -> String {
    let family = &result.subject.family;
    let frequencies = family
        .questions
        .spectrum
        .as_ref()
        .map(|one| one.band.frequencies());
    let frequencies = frequencies.unwrap_or_default();
    let rows = result.points.iter().flat_map(|point| {
        let known = of_point(point, asked).map(powers).unwrap_or_default();
        let all = frequencies.iter().zip(known);
        let rows = all.map(|(&at, (power, error))| {
            [point.value, at, power, error].map(table::number).to_vec()
        });
        rows.collect::<Vec<_>>()
    });
    table::table(&[family.parameter(), "frequency", "power", "error"], rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_maximum_lies_across_its_column() {
        let edges = [0.0, 0.5, 1.5, 2.0];
        assert_eq!(
            across_column(&[(1.0, 3.0)], &edges),
            [(0.5, 3.0), (1.5, 3.0)]
        );
        assert_eq!(
            across_column(&[(0.0, 3.0)], &edges),
            [(0.0, 3.0), (0.5, 3.0)]
        );
        let run = [(0.0, 3.0), (1.0, 2.0)];
        assert_eq!(across_column(&run, &edges), run);
    }
}
