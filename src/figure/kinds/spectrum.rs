//! Power spectra at several parameter values over the frequency (`spectrum_x`; the magnitude of cross spectra), and
//! covariances over the lag (`correlation_x`), each with the band of its error.

use super::{Drawn, Kind, Sketch, Sweep};
use crate::continuation::{Fluctuations, Point, SweepResult};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::style::{MARGIN, Stroke};
use crate::figure::parts::track::{self, Curve, Track, draw_track};
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};
use crate::system::{Family, SpectrumQuestion};

/// Size of the panel on a page of its own width, in pixels, and that width.
const PANEL: (f64, f64) = (380.0, 230.0);
const USUAL: f64 = 480.0;
/// Room right of the panel, for half a label.
const BESIDE: f64 = 14.0;

/// A figure of each spectrum that is asked for, and of each correlation.
pub(super) const KIND: Kind = Kind {
    names: &["spectrum", "correlation"],
    usual: Some("spectrum"),
    sketches,
};

fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let mut all = Vec::new();
    for name in ["spectrum", "correlation"] {
        for one in spectra_of(sweep.family()) {
            let (result, chosen) = (sweep.result, sweep.chosen.clone());
            let file = format!("{name}_{}", one.file);
            all.push(Sketch::new(file, move |print| match name {
                "spectrum" => draw_spectrum(result, &chosen, &one, print),
                _ => draw_correlation(result, &chosen, &one, print),
            }));
        }
    }
    all
}

/// A spectrum that is asked for.
pub(super) struct SpectrumOf {
    /// Its name in tables.
    pub(super) of: String,
    /// The same as a part of a file's name.
    pub(super) file: String,
    /// The symbols of what it is of, as markup.
    pub(super) title: String,
    pub(super) is_cross: bool,
}

/// The spectra that a family asks for.
pub(super) fn spectra_of(family: &Family) -> Vec<SpectrumOf> {
    let Some(question) = &family.questions.spectrum else {
        return Vec::new();
    };
    let of_pair = |&(one, other): &(usize, usize)| {
        let of = question.name((one, other));
        let symbol = |number: usize| names::fluctuating(family, &question.observables[number]);
        let title = if one == other {
            symbol(one)
        } else {
            format!("{}, {}", symbol(one), symbol(other))
        };
        SpectrumOf {
            file: of.replace(", ", "_"),
            of,
            title,
            is_cross: one != other,
        }
    };
    question.pairs.iter().map(of_pair).collect()
}

/// What a point has of a spectrum.
pub(super) fn of_point<'a>(point: &'a Point, asked: &SpectrumOf) -> Option<&'a Fluctuations> {
    point
        .report
        .fluctuations
        .iter()
        .find(|one| one.of == asked.of)
}

/// Power over each frequency, or the magnitude of a cross spectrum, with its error.
pub(super) fn powers(one: &Fluctuations) -> Vec<(f64, f64)> {
    if one.imaginary.is_empty() {
        return one.power.clone();
    }
    let parts = one.power.iter().zip(&one.imaginary);
    parts
        .map(|(real, other)| (real.0.hypot(other.0), real.1.hypot(other.1)))
        .collect()
}

/// Title of the axis of frequencies, and where each stands on it: logarithms where they stand evenly in these.
pub(super) fn frequencies(question: &SpectrumQuestion) -> (bool, Vec<f64>) {
    let is_logarithmic = question.band.from.is_some();
    let all = question.band.frequencies().into_iter();
    let placed = all.map(|one| if is_logarithmic { one.log10() } else { one });
    (is_logarithmic, placed.collect())
}

/// What the axis of frequencies says.
pub(super) const FREQUENCY: &str = "angular frequency $ω$";

/// Title of an axis of power.
pub(super) fn power_title(asked: &SpectrumOf) -> String {
    match asked.is_cross {
        false => format!("power of {}", asked.title),
        true => format!("cross power of {}", asked.title),
    }
}

fn draw_spectrum(
    result: &SweepResult,
    chosen: &[&Point],
    asked: &SpectrumOf,
    print: &Print<'_>,
) -> Drawn {
    let question = result.subject.family.questions.spectrum.as_ref()?;
    let (is_logarithmic, places) = frequencies(question);
    let lines: Vec<Line> = chosen
        .iter()
        .filter_map(|point| Some((point.value, powers(of_point(point, asked)?))))
        // A power that may be none, as that of a velocity at zero is, has no place among logarithms.
        .map(|(value, known)| Line {
            value,
            places: places
                .iter()
                .copied()
                .zip(known)
                .filter(|(_, known)| known.0 > known.1)
                .collect(),
        })
        .collect();
    let seen = format!(
        "{} spectrum of {} in the steady state{}, {}, each with the band of its error.",
        if asked.is_cross {
            "Magnitude of the cross"
        } else {
            "Power"
        },
        caption::in_letters(&asked.title),
        caption::at(&result.subject.family, lines.iter().map(|line| line.value)),
        match question.sides.factor() {
            1.0 => "over frequencies of either sign",
            _ => "over positive frequencies, which have all of the power",
        },
    );
    let chart = Chart {
        abscissa: FREQUENCY.to_owned(),
        is_logarithmic,
        ordinate: power_title(asked),
        is_over_decades: true,
        columns: ["frequency", "power"].map(str::to_owned),
        seen,
    };
    chart.draw(result, &lines, print)
}

fn draw_correlation(
    result: &SweepResult,
    chosen: &[&Point],
    asked: &SpectrumOf,
    print: &Print<'_>,
) -> Drawn {
    let (step, _) = result.subject.family.questions.spectrum.as_ref()?.lags();
    let lines: Vec<Line> = chosen
        .iter()
        .filter_map(|point| {
            let known = &of_point(point, asked)?.correlation;
            let places = known.iter().enumerate();
            Some(Line {
                value: point.value,
                places: places
                    .map(|(lag, &known)| (step * lag as f64, known))
                    .collect(),
            })
        })
        .collect();
    let seen = format!(
        "Covariance of {} over the lag in the steady state{}, each with the band of its error.",
        caption::in_letters(&asked.title),
        caption::at(&result.subject.family, lines.iter().map(|line| line.value)),
    );
    let chart = Chart {
        abscissa: "lag $τ$".to_owned(),
        is_logarithmic: false,
        ordinate: format!("covariance of {}", asked.title),
        is_over_decades: false,
        columns: ["lag", "covariance"].map(str::to_owned),
        seen,
    };
    chart.draw(result, &lines, print)
}

/// Numbers with their errors at one value of the parameter.
pub(super) struct Line {
    pub(super) value: f64,
    pub(super) places: Vec<(f64, (f64, f64))>,
}

/// A panel of lines, one a value of the parameter.
pub(super) struct Chart {
    pub(super) abscissa: String,
    /// Whether places along the abscissa are logarithms.
    pub(super) is_logarithmic: bool,
    pub(super) ordinate: String,
    pub(super) is_over_decades: bool,
    pub(super) columns: [String; 2],
    pub(super) seen: String,
}

impl Chart {
    /// The figure; `None` without anything to draw.
    pub(super) fn draw(self, result: &SweepResult, lines: &[Line], print: &Print<'_>) -> Drawn {
        let (family, look) = (&result.subject.family, &print.look);
        let curves = lines.iter().enumerate().map(|(number, line)| Curve {
            name: names::at(family, line.value),
            stroke: Stroke::curve(number),
            places: line
                .places
                .iter()
                .map(|&(at, known)| (at, known.0))
                .collect(),
            errors: line.places.iter().map(|&(_, known)| known.1).collect(),
        });
        let track = Track {
            title: self.ordinate.clone(),
            is_logarithmic: self.is_over_decades,
            has_zero: !self.is_over_decades,
            least: 0.0,
            share: 1.0,
            curves: curves.collect(),
        };
        let unknown = track::without_errors(std::slice::from_ref(&track)).to_owned();
        let places = || {
            lines
                .iter()
                .flat_map(|line| &line.places)
                .map(|place| place.0)
        };
        let range = (
            places().fold(f64::INFINITY, f64::min),
            places().fold(f64::NEG_INFINITY, f64::max),
        );
        let vertical = track.range().filter(|_| range.0 < range.1)?;
        let high = look.height(PANEL.1, USUAL);
        let layout = if self.is_over_decades {
            Scale::logarithmic
        } else {
            Scale::vertical
        };
        let up = layout(look, vertical, high, &track.title);
        let left = MARGIN + up.left();
        let wide = look.fill(PANEL.0, left + BESIDE + MARGIN);
        let layout = if self.is_logarithmic {
            Scale::logarithmic
        } else {
            Scale::horizontal
        };
        let across = layout(look, range, wide, &self.abscissa);
        let width = left + wide + BESIDE + MARGIN;
        let heading = Heading::new(look, print.title, width);
        let entries = track
            .curves
            .iter()
            .map(|curve| (Swatch::Curve(curve.stroke), curve.name.clone()));
        let legend = Legend::new(look, entries.collect(), width - 2.0 * MARGIN);
        let rect = Rectangle::new((left, heading.height()), (wide, high));
        let below = rect.bottom() + Scale::below();
        let page = Page::new(look, width, below + legend.height() + MARGIN);
        heading.draw(&page);
        draw_track(&page.panel(rect, range, up.range), &track, range, up.range);
        frame::around(&page, rect, (&across, &up));
        legend.draw(&page, left + 0.5 * wide, below);
        let is_logarithmic = self.is_logarithmic;
        let rows = lines.iter().flat_map(|line| {
            line.places.iter().map(move |&(at, (value, error))| {
                let at = if is_logarithmic { 10f64.powf(at) } else { at };
                [line.value, at, value, error].map(table::number).to_vec()
            })
        });
        let columns = [
            family.parameter(),
            &self.columns[0],
            &self.columns[1],
            "error",
        ];
        let table = table::table(&columns, rows);
        Some(Figure::new(
            &page,
            caption::of_sweep(result, self.seen, &[unknown]),
            table,
        ))
    }
}
